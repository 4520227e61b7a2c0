// SPDX-License-Identifier: MIT
#include <bit>
#include <cstring>

#include "mdhcal/crc32.hpp"
#include "offline/output/blob_writer.hpp"

namespace mdhcal::offline {

namespace at = blob_layout;

namespace {

// Writes fields into a blob of zeros, little-endian on any machine.
class Writer {
 public:
  explicit Writer(Blob& blob) : blob_(blob) {}

  template <class Unsigned>
  void number(std::size_t offset, Unsigned value) {
    for (std::size_t k = 0; k < sizeof value; ++k) blob_.at(offset + k) = static_cast<std::uint8_t>(value >> (8 * k));
  }
  void u32(std::size_t offset, std::uint32_t value) { number(offset, value); }
  void i32(std::size_t offset, std::int32_t value) { number(offset, static_cast<std::uint32_t>(value)); }
  void real(std::size_t offset, double value) { number(offset, std::bit_cast<std::uint64_t>(value)); }
  void real(std::size_t offset, float value) { number(offset, std::bit_cast<std::uint32_t>(value)); }
  template <class Real>
  void reals(std::size_t offset, const Real* values, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) real(offset + sizeof(Real) * k, values[k]);
  }
  void bytes(std::size_t offset, const void* from, std::size_t size) { std::memcpy(&blob_.at(offset), from, size); }

  template <class Real>
  void pose(std::size_t offset, const Pose<Real>& pose) {
    reals(offset, pose.quaternion, 4);
    reals(offset + 4 * sizeof(Real), pose.position_m, 3);
  }
  void link(std::size_t offset, const Link& link) {
    const double values[5] = {link.alpha_rad, link.a_m, link.theta_rad, link.d_m, link.beta_rad};
    reals(offset, values, 5);
  }
  template <class Real>
  void vector(std::size_t offset, const SelfTestVector<Real>& vector) {
    reals(offset, vector.q, max_joints);
    offset += max_joints * sizeof(Real);
    pose(offset, vector.base_T_flange);
    offset += 7 * sizeof(Real);
    reals(offset, vector.inverse_q, max_joints);
    i32(offset + max_joints * sizeof(Real), vector.inverse_status);
  }

 private:
  Blob& blob_;
};

void write_joints(Writer& writer, const BlobContent& model) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(model.geometry.joint_count); ++i) {
    const std::size_t record = at::joints + i * at::joint_size;
    const Joint& joint = model.geometry.joint[i];
    writer.i32(record + at::joint::kind, static_cast<std::int32_t>(joint.kind));
    writer.i32(record + at::joint::sign, joint.sign);
    writer.u32(record + at::joint::flags,
               (joint.has_min != 0 ? at::joint_has_min : 0U) | (joint.has_max != 0 ? at::joint_has_max : 0U));
    if (joint.has_min != 0) writer.real(record + at::joint::min, joint.min);
    if (joint.has_max != 0) writer.real(record + at::joint::max, joint.max);
    writer.link(record + at::joint::nominal, model.nominal[i]);
    writer.link(record + at::joint::corrected, model.geometry.link[i]);
    writer.reals(record + at::joint::coupling, joint.coupling, max_joints);
    writer.real(record + at::joint::max_velocity, model.max_velocity[i]);
  }
}

void write_transmission(Writer& writer, const Transmission& transmission) {
  for (std::size_t i = 0; i < max_joints; ++i) {
    const std::size_t record = at::functions + i * at::function_size;
    const JointFunction& f = transmission.function[i];
    writer.i32(record + at::function::order_count, f.order_count);
    writer.real(record + at::function::seen_min, f.seen_min_rad);
    writer.real(record + at::function::seen_max, f.seen_max_rad);
    writer.reals(record + at::function::cosine, f.cosine_rad, max_orders);
    writer.reals(record + at::function::sine, f.sine_rad, max_orders);
    writer.reals(at::compliance + 8 * max_joints * i, transmission.gravity.compliance[i], max_joints);
  }
  const Gravity& gravity = transmission.gravity;
  writer.reals(at::gravity, gravity.direction, 3);
  writer.real(at::payload, gravity.payload_kg);
  writer.reals(at::payload_com, gravity.payload_com_m, 3);
  writer.reals(at::payload_compliance, gravity.payload_compliance, max_joints);
}

void write_provenance(Writer& writer, const BlobProvenance& provenance) {
  writer.bytes(at::tool_version, provenance.tool_version, at::tool_version_size);
  writer.bytes(at::date, provenance.date, at::date_size);
  writer.bytes(at::method, provenance.method, at::method_size);
  writer.bytes(at::lambda_rule, provenance.lambda_rule, at::lambda_rule_size);
  writer.bytes(at::measurements_sha256, provenance.measurements_sha256, at::sha256_size);
  writer.real(at::lambda, provenance.lambda);
  writer.u32(at::pose_count, provenance.pose_count);
  writer.u32(at::held_out_count, provenance.held_out_count);
  const double held_out[4] = {provenance.mean_before_m, provenance.max_before_m, provenance.mean_after_m,
                              provenance.max_after_m};
  writer.reals(at::held_out, held_out, 4);
  writer.reals(at::region, provenance.region_min_m, 3);
  writer.reals(at::region + 24, provenance.region_max_m, 3);
  const double lean[2] = {provenance.lean_min_m, provenance.lean_max_m};
  writer.reals(at::region + 48, lean, 2);
}

}  // namespace

Blob encode(const BlobContent& model) {
  Blob blob{};
  Writer writer(blob);
  writer.u32(at::magic, at::magic_value);
  writer.number(at::major, at::major_value);
  writer.number(at::minor, at::minor_value);
  writer.u32(at::stated_size, static_cast<std::uint32_t>(at::size));
  writer.u32(at::layout_id, at::layout_id_value);
  const BlobProvenance& provenance = model.provenance;
  writer.u32(at::flags, (model.has_base != 0 ? at::flag_base : 0U) |
                            (provenance.has_measurements != 0 ? at::flag_calibrated : 0U) |
                            (provenance.has_lambda != 0 ? at::flag_lambda : 0U) |
                            (provenance.has_held_out != 0 ? at::flag_held_out : 0U) |
                            (provenance.has_region != 0 ? at::flag_region : 0U));
  writer.i32(at::joint_count, model.geometry.joint_count);
  writer.i32(at::target_count, model.target_count);
  writer.i32(at::family, static_cast<std::int32_t>(model.family));
  writer.u32(at::security_counter, model.security_counter);
  writer.u32(at::arithmetic_id, model.arithmetic_id);
  writer.i32(at::double_vector_count, model.double_vector_count);
  writer.i32(at::float_vector_count, model.float_vector_count);
  writer.bytes(at::name, model.name, at::name_size);
  writer.bytes(at::serial, model.serial, at::serial_size);
  write_joints(writer, model);
  write_transmission(writer, model.transmission);
  writer.pose(at::last_T_flange, model.geometry.last_T_flange);
  if (model.has_base != 0) writer.pose(at::tracker_T_base, model.tracker_T_base);
  for (std::size_t i = 0; i < static_cast<std::size_t>(model.target_count); ++i) {
    const std::size_t record = at::targets + i * at::target_size;
    writer.bytes(record, model.target[i].name, at::target_name_size);
    writer.reals(record + at::target_point, model.target[i].flange_p_m, 3);
  }
  const Tolerances& tolerances = model.tolerances;
  writer.real(at::tolerances, tolerances.position_m);
  writer.real(at::tolerances + 8, tolerances.rotation_rad);
  writer.real(at::float_tolerances, tolerances.float_position_m);
  writer.real(at::float_tolerances + 4, tolerances.float_rotation_rad);
  write_provenance(writer, provenance);
  for (std::size_t i = 0; i < static_cast<std::size_t>(model.double_vector_count); ++i) {
    writer.vector(at::double_vectors + i * at::double_vector_size, model.double_vector[i]);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(model.float_vector_count); ++i) {
    writer.vector(at::float_vectors + i * at::float_vector_size, model.float_vector[i]);
  }
  writer.u32(at::algorithm, model.authentication.algorithm);
  writer.bytes(at::key_id, model.authentication.key_id, at::key_id_size);
  writer.bytes(at::signature, model.authentication.signature, at::signature_size);
  writer.u32(at::crc, crc32(blob.data(), at::crc));
  return blob;
}

}  // namespace mdhcal::offline
