// SPDX-License-Identifier: MIT
#include "blob/blob_fields.hpp"

#include <string.h>

namespace mdhcal {

namespace at = blob_layout;

namespace {

void load_pose(const std::uint8_t* p, Pose<double>& pose) {
  for (std::size_t i = 0; i < 4; ++i) pose.quaternion[i] = load_f64(p + 8 * i);
  for (std::size_t i = 0; i < 3; ++i) pose.position_m[i] = load_f64(p + 32 + 8 * i);
}

template <class Real>
void load_vector(const std::uint8_t* p, SelfTestVector<Real>& vector) {
  constexpr std::size_t step = sizeof(Real);
  const std::uint8_t* pose = p + max_joints * step;
  const std::uint8_t* inverse = pose + 7 * step;
  for (std::size_t i = 0; i < max_joints; ++i) {
    vector.q[i] = load_real<Real>(p + i * step);
    vector.inverse_q[i] = load_real<Real>(inverse + i * step);
  }
  for (std::size_t i = 0; i < 4; ++i) vector.base_T_flange.quaternion[i] = load_real<Real>(pose + i * step);
  for (std::size_t i = 0; i < 3; ++i) vector.base_T_flange.position_m[i] = load_real<Real>(pose + (4 + i) * step);
  vector.inverse_status = load_i32(inverse + max_joints * step);
}

void load_provenance(const std::uint8_t* bytes, BlobProvenance& out) {
  const std::uint32_t flags = load_u32(bytes + at::flags);
  memcpy(out.tool_version, bytes + at::tool_version, at::tool_version_size);
  memcpy(out.date, bytes + at::date, at::date_size);
  memcpy(out.method, bytes + at::method, at::method_size);
  memcpy(out.lambda_rule, bytes + at::lambda_rule, at::lambda_rule_size);
  memcpy(out.measurements_sha256, bytes + at::measurements_sha256, at::sha256_size);
  out.pose_count = load_u32(bytes + at::pose_count);
  out.held_out_count = load_u32(bytes + at::held_out_count);
  out.has_measurements = (flags & at::flag_calibrated) != 0U ? 1 : 0;
  out.has_lambda = (flags & at::flag_lambda) != 0U ? 1 : 0;
  out.has_held_out = (flags & at::flag_held_out) != 0U ? 1 : 0;
  out.lambda = load_f64(bytes + at::lambda);
  out.mean_before_m = load_f64(bytes + at::held_out);
  out.max_before_m = load_f64(bytes + at::held_out + 8);
  out.mean_after_m = load_f64(bytes + at::held_out + 16);
  out.max_after_m = load_f64(bytes + at::held_out + 24);
  out.has_region = (flags & at::flag_region) != 0U ? 1 : 0;
  for (std::size_t k = 0; k < 3; ++k) {
    out.region_min_m[k] = load_f64(bytes + at::region + 8 * k);
    out.region_max_m[k] = load_f64(bytes + at::region + 24 + 8 * k);
  }
  out.lean_min_m = load_f64(bytes + at::region + 48);
  out.lean_max_m = load_f64(bytes + at::region + 56);
}

// How many bytes follow the first one, which is not ASCII, in a well-formed UTF-8 character (RFC 3629: the shortest form, no
// surrogates, nothing above U+10FFFF). 4: it is not well-formed. `size`: bytes that may be read.
std::size_t continuation_bytes(const std::uint8_t* p, std::size_t size) noexcept {
  constexpr std::size_t malformed = 4;
  const std::uint8_t first = p[0];
  if (first < 0xC2 || first > 0xF4) return malformed;
  const std::size_t more = first < 0xE0 ? 1 : first < 0xF0 ? 2 : 3;
  if (more >= size) return malformed;
  for (std::size_t i = 1; i <= more; ++i) {
    if ((p[i] & 0xC0U) != 0x80U) return malformed;
  }
  const bool overlong = (first == 0xE0 && p[1] < 0xA0) || (first == 0xF0 && p[1] < 0x90);
  const bool outside = (first == 0xED && p[1] > 0x9F) || (first == 0xF4 && p[1] > 0x8F);
  return overlong || outside ? malformed : more;
}

}  // namespace

bool all_zero(const std::uint8_t* p, std::size_t size) noexcept {
  std::uint32_t any = 0;
  std::size_t i = 0;
  for (; size - i >= 4; i += 4) any |= load_u32(p + i);
  for (; i < size; ++i) any |= p[i];
  return any == 0U;
}

bool text_valid(const std::uint8_t* p, std::size_t size) noexcept {
  std::size_t length = 0;
  while (length < size && p[length] != 0) {
    if (p[length] < 0x20 || p[length] == 0x7F) return false;
    const std::size_t more = p[length] < 0x80 ? 0 : continuation_bytes(p + length, size - length);
    if (more > 3) return false;
    length += 1 + more;
  }
  return length < size && all_zero(p + length, size - length);
}

Link load_link(const std::uint8_t* bytes, std::size_t joint, std::size_t which) noexcept {
  const std::uint8_t* p = bytes + at::joints + joint * at::joint_size + which;
  return {load_f64(p), load_f64(p + 8), load_f64(p + 16), load_f64(p + 24), load_f64(p + 32)};
}

void load_geometry(const std::uint8_t* bytes, Geometry& geometry) noexcept {
  geometry = Geometry{};
  geometry.joint_count = load_i32(bytes + at::joint_count);
  for (std::size_t i = 0; i < static_cast<std::size_t>(geometry.joint_count); ++i) {
    const std::uint8_t* record = bytes + at::joints + i * at::joint_size;
    const std::uint32_t flags = load_u32(record + at::joint::flags);
    Joint& joint = geometry.joint[i];
    geometry.link[i] = load_link(bytes, i, at::joint::corrected);
    joint.kind = static_cast<JointKind>(load_i32(record + at::joint::kind));
    joint.sign = load_i32(record + at::joint::sign);
    joint.has_min = (flags & at::joint_has_min) != 0U ? 1 : 0;
    joint.has_max = (flags & at::joint_has_max) != 0U ? 1 : 0;
    joint.min = load_f64(record + at::joint::min);
    joint.max = load_f64(record + at::joint::max);
    for (std::size_t j = 0; j < max_joints; ++j) joint.coupling[j] = load_f64(record + at::joint::coupling + 8 * j);
  }
  load_pose(bytes + at::last_T_flange, geometry.last_T_flange);
}

void load_transmission(const std::uint8_t* bytes, Transmission& transmission) noexcept {
  for (std::size_t i = 0; i < max_joints; ++i) {
    const std::uint8_t* record = bytes + at::functions + i * at::function_size;
    JointFunction& f = transmission.function[i];
    f.order_count = load_i32(record + at::function::order_count);
    f.reserved = 0;
    f.seen_min_rad = load_f64(record + at::function::seen_min);
    f.seen_max_rad = load_f64(record + at::function::seen_max);
    for (std::size_t k = 0; k < max_orders; ++k) {
      f.cosine_rad[k] = load_f32(record + at::function::cosine + 4 * k);
      f.sine_rad[k] = load_f32(record + at::function::sine + 4 * k);
    }
  }
  Gravity& gravity = transmission.gravity;
  for (std::size_t k = 0; k < 3; ++k) {
    gravity.direction[k] = load_f64(bytes + at::gravity + 8 * k);
    gravity.payload_com_m[k] = load_f64(bytes + at::payload_com + 8 * k);
  }
  gravity.payload_kg = load_f64(bytes + at::payload);
  for (std::size_t i = 0; i < max_joints; ++i) {
    gravity.payload_compliance[i] = load_f64(bytes + at::payload_compliance + 8 * i);
    for (std::size_t j = 0; j < max_joints; ++j) {
      gravity.compliance[i][j] = load_f64(bytes + at::compliance + 8 * (max_joints * i + j));
    }
  }
}

void load_model(const std::uint8_t* bytes, BlobContent& model) noexcept {
  load_geometry(bytes, model.geometry);
  load_transmission(bytes, model.transmission);
  for (std::size_t i = 0; i < max_joints; ++i) model.nominal[i] = load_link(bytes, i, at::joint::nominal);
  memcpy(model.name, bytes + at::name, at::name_size);
  memcpy(model.serial, bytes + at::serial, at::serial_size);
  model.has_base = (load_u32(bytes + at::flags) & at::flag_base) != 0U ? 1 : 0;
  load_pose(bytes + at::tracker_T_base, model.tracker_T_base);
  if (model.has_base == 0) model.tracker_T_base.quaternion[0] = 1.0;
  model.target_count = load_i32(bytes + at::target_count);
  for (std::size_t i = 0; i < max_targets; ++i) {
    const std::uint8_t* record = bytes + at::targets + i * at::target_size;
    memcpy(model.target[i].name, record, at::target_name_size);
    for (std::size_t k = 0; k < 3; ++k) model.target[i].flange_p_m[k] = load_f64(record + at::target_point + 8 * k);
  }
  model.family = static_cast<ArmFamily>(load_i32(bytes + at::family));
  model.security_counter = load_u32(bytes + at::security_counter);
  model.tolerances = {load_f64(bytes + at::tolerances), load_f64(bytes + at::tolerances + 8),
                      load_f32(bytes + at::float_tolerances), load_f32(bytes + at::float_tolerances + 4)};
  for (std::size_t i = 0; i < max_joints; ++i) {
    model.max_velocity[i] = load_f64(bytes + at::joints + i * at::joint_size + at::joint::max_velocity);
  }
  load_provenance(bytes, model.provenance);
  model.arithmetic_id = load_u32(bytes + at::arithmetic_id);
  model.double_vector_count = load_i32(bytes + at::double_vector_count);
  model.float_vector_count = load_i32(bytes + at::float_vector_count);
  for (std::size_t i = 0; i < max_vectors; ++i) {
    load_vector(bytes + at::double_vectors + i * at::double_vector_size, model.double_vector[i]);
    load_vector(bytes + at::float_vectors + i * at::float_vector_size, model.float_vector[i]);
  }
  model.authentication.algorithm = load_u32(bytes + at::algorithm);
  memcpy(model.authentication.key_id, bytes + at::key_id, at::key_id_size);
  memcpy(model.authentication.signature, bytes + at::signature, at::signature_size);
}

}  // namespace mdhcal
