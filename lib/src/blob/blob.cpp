// SPDX-License-Identifier: MIT
#include "mdhcal/blob.hpp"

#include "blob/blob_fields.hpp"
#include "mdhcal/arm.hpp"
#include "mdhcal/crc32.hpp"
#include "number/compare.hpp"

// How far the corrected geometry may be from its nominal. A calibration moves an arm's parameters by millimetres; a
// blob that moves them by more is a mistake or a trap. An integrator may compile other bounds.
#ifndef MDHCAL_MAX_DEVIATION_M
#define MDHCAL_MAX_DEVIATION_M default_max_deviation_m
#endif
#ifndef MDHCAL_MAX_DEVIATION_RAD
#define MDHCAL_MAX_DEVIATION_RAD default_max_deviation_rad
#endif

namespace mdhcal {

namespace at = blob_layout;

double max_deviation_m() noexcept { return MDHCAL_MAX_DEVIATION_M; }
double max_deviation_rad() noexcept { return MDHCAL_MAX_DEVIATION_RAD; }

namespace {

constexpr double max_lambda = 1e30;
constexpr double max_vector_position_m = 1e7;  // the longest valid arm with its longest couplings stays below

// The bytes are a whole, undamaged blob of a version that this library reads.
Status check_frame(const std::uint8_t* bytes, std::size_t size) {
  if (bytes == nullptr || size != at::size) return Status::blob_size;
  if (load_u32(bytes + at::magic) != at::magic_value) return Status::blob_magic;
  if (load_u16(bytes + at::major) != at::major_value) return Status::blob_version;
  if (load_u32(bytes + at::stated_size) != at::size) return Status::blob_size;
  if (load_u32(bytes + at::layout_id) != at::layout_id_value) return Status::blob_layout;
  if (load_u32(bytes + at::crc) != crc32(bytes, at::crc)) return Status::blob_crc;
  return Status::ok;
}

Status check_authentication(const std::uint8_t* bytes, const DecodeOptions& options) {
  const std::uint32_t algorithm = load_u32(bytes + at::algorithm);
  if (options.verifier.verify != nullptr) {
    if (algorithm == at::algorithm_none) return Status::blob_unsigned;
    if (algorithm != at::algorithm_ed25519 ||
        !options.verifier.verify(bytes, at::authentication, bytes + at::signature, options.verifier.context)) {
      return Status::blob_signature;
    }
  }
  if (load_u32(bytes + at::security_counter) < options.minimum_counter) return Status::blob_counter;
  return Status::ok;
}

Status check_counts(const std::uint8_t* bytes) {
  const std::uint32_t joints = load_u32(bytes + at::joint_count);
  const bool valid = joints >= 1U && joints <= max_joints && load_u32(bytes + at::target_count) <= max_targets &&
                     load_u32(bytes + at::family) <= 2U && load_u32(bytes + at::double_vector_count) <= max_vectors &&
                     load_u32(bytes + at::float_vector_count) <= max_vectors &&
                     load_u32(bytes + at::algorithm) <= at::algorithm_ed25519;
  return valid ? Status::ok : Status::blob_value;
}

// What nobody has given a meaning is zero. The critical room is zero in every minor version that this library may
// read; the ancillary room may be used by a newer minor (docs/blob.md, Versions).
Status check_reserved(const std::uint8_t* bytes) {
  const bool own_minor = load_u16(bytes + at::minor) <= at::minor_value;
  const std::uint32_t unknown = load_u32(bytes + at::flags) & ~at::known_flags;
  if ((unknown & (own_minor ? 0xFFFFFFFFU : at::critical_flags)) != 0U) return Status::blob_reserved;
  const std::size_t joints = load_u32(bytes + at::joint_count);
  bool zero = all_zero(bytes + at::model_room, at::model_room_size) &&
              all_zero(bytes + at::last_T_flange + at::pose_reserved, at::pose_size - at::pose_reserved) &&
              all_zero(bytes + at::tracker_T_base + at::pose_reserved, at::pose_size - at::pose_reserved) &&
              all_zero(bytes + at::joints + joints * at::joint_size, (at::joint_slots - joints) * at::joint_size) &&
              all_zero(bytes + at::functions + joints * at::function_size, (at::joint_slots - joints) * at::function_size) &&
              all_zero(bytes + at::gravity_reserved, at::payload_compliance - at::gravity_reserved);
  for (std::size_t i = 0; i < joints; ++i) {
    const std::uint8_t* record = bytes + at::joints + i * at::joint_size;
    const std::uint8_t* function = bytes + at::functions + i * at::function_size;
    zero = zero && all_zero(record + at::joint::reserved, at::joint::reserved_size) &&
           all_zero(record + at::joint::reserved_end, at::joint::reserved_end_size) &&
           all_zero(function + at::function::reserved, 4) && all_zero(function + at::function::reserved_middle, 8) &&
           (load_u32(record + at::joint::flags) & ~(at::joint_has_min | at::joint_has_max)) == 0U;
  }
  if (own_minor) {
    zero = zero && all_zero(bytes + at::header_reserved, at::header_reserved_size) &&
           all_zero(bytes + at::tolerances_reserved, at::tolerances_reserved_size) &&
           all_zero(bytes + at::provenance_reserved, at::provenance_reserved_size) &&
           all_zero(bytes + at::algorithm_reserved, at::key_id - at::algorithm_reserved) &&
           all_zero(bytes + at::key_reserved, at::signature - at::key_reserved) &&
           all_zero(bytes + at::end_reserved, at::crc - at::end_reserved);
    for (std::size_t i = 0; i < at::vector_slots; ++i) {
      zero = zero && all_zero(bytes + at::double_vectors + i * at::double_vector_size + at::double_vector_reserved, 4);
    }
  }
  return zero ? Status::ok : Status::blob_reserved;
}

// What the counts and flags declare absent is zero.
Status check_absent(const std::uint8_t* bytes) {
  const std::uint32_t flags = load_u32(bytes + at::flags);
  const std::size_t targets = load_u32(bytes + at::target_count);
  const std::size_t doubles = load_u32(bytes + at::double_vector_count);
  const std::size_t floats = load_u32(bytes + at::float_vector_count);
  bool zero =
      all_zero(bytes + at::targets + targets * at::target_size, (at::target_slots - targets) * at::target_size) &&
      all_zero(bytes + at::double_vectors + doubles * at::double_vector_size,
               (at::vector_slots - doubles) * at::double_vector_size) &&
      all_zero(bytes + at::float_vectors + floats * at::float_vector_size,
               (at::vector_slots - floats) * at::float_vector_size);
  if ((flags & at::flag_base) == 0U) zero = zero && all_zero(bytes + at::tracker_T_base, at::pose_size);
  if ((flags & at::flag_calibrated) == 0U) {
    zero = zero && all_zero(bytes + at::measurements_sha256, at::sha256_size) && all_zero(bytes + at::pose_count, 4);
  }
  if ((flags & at::flag_region) == 0U) zero = zero && all_zero(bytes + at::region, at::region_size);
  if ((flags & at::flag_lambda) == 0U) zero = zero && all_zero(bytes + at::lambda, 8);
  if ((flags & at::flag_held_out) == 0U) {
    zero = zero && all_zero(bytes + at::held_out, 32) && all_zero(bytes + at::held_out_count, 4);
  }
  if (load_u32(bytes + at::algorithm) == at::algorithm_none) {
    zero = zero && all_zero(bytes + at::key_id, at::key_id_size) && all_zero(bytes + at::signature, at::signature_size);
  }
  for (std::size_t i = 0; i < load_u32(bytes + at::joint_count); ++i) {
    const std::uint8_t* record = bytes + at::joints + i * at::joint_size;
    const std::uint32_t limits = load_u32(record + at::joint::flags);
    if ((limits & at::joint_has_min) == 0U) zero = zero && all_zero(record + at::joint::min, 8);
    if ((limits & at::joint_has_max) == 0U) zero = zero && all_zero(record + at::joint::max, 8);
  }
  return zero ? Status::ok : Status::blob_reserved;
}

template <class Real>
bool vector_valid(const std::uint8_t* record, std::size_t joints) {
  constexpr std::size_t step = sizeof(Real);
  constexpr Real reading = static_cast<Real>(max_reading);
  const std::uint8_t* pose = record + max_joints * step;
  const std::uint8_t* inverse = pose + 7 * step;
  Real norm2 = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Real c = load_real<Real>(pose + i * step);
    if (!within_bound(c, Real{2})) return false;
    norm2 += c * c;
  }
  bool valid = norm2 >= static_cast<Real>(0.9999) && norm2 <= static_cast<Real>(1.0001);
  for (std::size_t i = 4; i < 7; ++i) {
    valid = valid && within_bound(load_real<Real>(pose + i * step), static_cast<Real>(max_vector_position_m));
  }
  for (std::size_t i = 0; i < max_joints; ++i) {
    const Real bound = i < joints ? reading : Real{0};
    valid = valid && within_bound(load_real<Real>(record + i * step), bound) &&
            within_bound(load_real<Real>(inverse + i * step), bound);
  }
  const std::int32_t status = load_i32(inverse + max_joints * step);
  return valid && status >= 0 && status <= static_cast<std::int32_t>(Status::not_converged);
}

bool pose_valid(const std::uint8_t* p) {
  double norm2 = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double c = load_f64(p + 8 * i);
    if (!within_bound(c, 2.0)) return false;
    norm2 += c * c;
  }
  bool valid = norm2 >= 1.0 - 1e-9 && norm2 <= 1.0 + 1e-9 && load_f64(p) >= 0.0;
  for (std::size_t i = 4; i < 7; ++i) valid = valid && within_bound(load_f64(p + 8 * i), max_length_m);
  return valid;
}

// Everything but the geometry.
Status check_values(const std::uint8_t* bytes) {
  bool valid = text_valid(bytes + at::name, at::name_size) && text_valid(bytes + at::serial, at::serial_size) &&
               text_valid(bytes + at::tool_version, at::tool_version_size) &&
               text_valid(bytes + at::date, at::date_size) && text_valid(bytes + at::method, at::method_size) &&
               text_valid(bytes + at::lambda_rule, at::lambda_rule_size) && pose_valid(bytes + at::last_T_flange);
  if ((load_u32(bytes + at::flags) & at::flag_base) != 0U) valid = valid && pose_valid(bytes + at::tracker_T_base);
  for (std::size_t i = 0; i < load_u32(bytes + at::target_count); ++i) {
    const std::uint8_t* record = bytes + at::targets + i * at::target_size;
    valid = valid && text_valid(record, at::target_name_size);
    for (std::size_t k = 0; k < 3; ++k) {
      valid = valid && within_bound(load_f64(record + at::target_point + 8 * k), max_length_m);
    }
  }
  for (std::size_t k = 0; k < 2; ++k) {
    const double tolerance = load_f64(bytes + at::tolerances + 8 * k);
    const float float_tolerance = load_f32(bytes + at::float_tolerances + 4 * k);
    valid = valid && tolerance > 0.0 && tolerance <= 1.0 && float_tolerance > 0.0F && float_tolerance <= 1.0F;
  }
  for (std::size_t k = 0; k < 4; ++k) {
    const double error_m = load_f64(bytes + at::held_out + 8 * k);
    valid = valid && error_m >= 0.0 && error_m <= max_length_m;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const double low = load_f64(bytes + at::region + 8 * k);
    const double high = load_f64(bytes + at::region + 24 + 8 * k);
    valid = valid && within_bound(low, max_length_m) && within_bound(high, max_length_m) && low <= high;
  }
  const double least_lean = load_f64(bytes + at::region + 48);
  const double most_lean = load_f64(bytes + at::region + 56);
  valid = valid && within_bound(most_lean, max_length_m) && within(0.0, least_lean, most_lean);
  for (std::size_t i = 0; i < load_u32(bytes + at::joint_count); ++i) {
    valid = valid && within(0.0, load_f64(bytes + at::joints + i * at::joint_size + at::joint::max_velocity), max_reading);
  }
  const double lambda = load_f64(bytes + at::lambda);
  valid = valid && lambda >= 0.0 && lambda <= max_lambda;
  const std::size_t joints = load_u32(bytes + at::joint_count);
  for (std::size_t i = 0; i < load_u32(bytes + at::double_vector_count); ++i) {
    valid = valid && vector_valid<double>(bytes + at::double_vectors + i * at::double_vector_size, joints);
  }
  for (std::size_t i = 0; i < load_u32(bytes + at::float_vector_count); ++i) {
    valid = valid && vector_valid<float>(bytes + at::float_vectors + i * at::float_vector_size, joints);
  }
  return valid ? Status::ok : Status::blob_value;
}

bool near(const Link& corrected, const Link& nominal) {
  return within_bound(corrected.alpha_rad - nominal.alpha_rad, max_deviation_rad()) &&
         within_bound(corrected.a_m - nominal.a_m, max_deviation_m()) &&
         within_bound(corrected.theta_rad - nominal.theta_rad, max_deviation_rad()) &&
         within_bound(corrected.d_m - nominal.d_m, max_deviation_m()) &&
         within_bound(corrected.beta_rad - nominal.beta_rad, max_deviation_rad());
}

Status check_geometry(const std::uint8_t* bytes) {
  Geometry geometry;
  load_geometry(bytes, geometry);
  if (check_geometry(geometry) != Status::ok) return Status::blob_value;
  bool close = true;
  for (std::int32_t i = 0; i < geometry.joint_count; ++i) {
    const Link corrected = geometry.link[i];
    geometry.link[i] = load_link(bytes, static_cast<std::size_t>(i), at::joint::nominal);
    close = close && near(corrected, geometry.link[i]);
  }
  if (check_geometry(geometry) != Status::ok) return Status::blob_value;
  return close ? Status::ok : Status::blob_deviation;
}

Status check_transmission(const std::uint8_t* bytes) {
  Geometry geometry;
  Transmission transmission;
  load_geometry(bytes, geometry);
  load_transmission(bytes, transmission);
  const Status status = check_transmission(geometry, transmission);
  return status == Status::bad_input ? Status::blob_value : status;
}

bool serial_is(const std::uint8_t* bytes, const char* serial) {
  for (std::size_t i = 0; i < at::serial_size; ++i) {
    if (bytes[at::serial + i] != static_cast<std::uint8_t>(serial[i])) return false;
    if (serial[i] == '\0') return true;
  }
  return false;
}

}  // namespace

Status decode(const std::uint8_t* bytes, std::size_t size, const DecodeOptions& options, BlobContent& model) noexcept {
  Status status = check_frame(bytes, size);
  if (status == Status::ok) status = check_authentication(bytes, options);
  if (status == Status::ok) status = check_counts(bytes);
  if (status == Status::ok) status = check_reserved(bytes);
  if (status == Status::ok) status = check_absent(bytes);
  if (status == Status::ok) status = check_values(bytes);
  if (status == Status::ok) status = check_geometry(bytes);
  if (status == Status::ok) status = check_transmission(bytes);
  if (status == Status::ok && options.serial != nullptr && !serial_is(bytes, options.serial)) {
    status = Status::blob_serial;
  }
  if (status == Status::ok) load_model(bytes, model);
  return status;
}

}  // namespace mdhcal
