// SPDX-License-Identifier: MIT
#include "mdhcal/calibrated_arm.hpp"

#include "mdhcal/environment.hpp"
#include "mdhcal/self_test.hpp"
#include "number/compare.hpp"
#include "number/convert.hpp"
#include "number/real.hpp"

namespace mdhcal {

namespace {

bool same_joints(const Arm<Real>& a, const Arm<Real>& b) {
  if (a.joint_count != b.joint_count || a.prismatic_mask != b.prismatic_mask) return false;
  for (std::int32_t i = 0; i < a.joint_count; ++i) {
    for (std::int32_t j = 0; j < a.joint_count; ++j) {
      if (magnitude(a.map[i][j] - b.map[i][j]) > Real{0}) return false;
    }
  }
  return true;
}

// Both arms; `corrected` refers to `table`, which is not looked at.
Status make_arms(const Geometry& nominal, const Geometry& corrected, const Transmission& transmission,
                 const JointFunctionTable& table, Arm<Real>& nominal_arm, Arm<Real>& corrected_arm) {
  Status status = check_environment();
  if (status == Status::ok) status = make_arm(nominal, nominal_arm);
  if (status == Status::ok) status = make_arm(corrected, transmission, table, corrected_arm);
  if (status != Status::ok) return status;
  return same_joints(nominal_arm, corrected_arm) ? Status::ok : Status::bad_input;
}

}  // namespace

Status make_calibrated_arm(const Geometry& nominal, const Geometry& corrected, const Transmission& transmission,
                           CalibratedArm<Real>& arm) noexcept {
  Arm<Real> nominal_arm, corrected_arm;
  const Status status = make_arms(nominal, corrected, transmission, arm.functions, nominal_arm, corrected_arm);
  if (status != Status::ok) return status;
  if (corrected_arm.terms.functions != nullptr) make_table(transmission, arm.functions);
  arm.nominal = nominal_arm;
  arm.corrected = corrected_arm;
  arm.description = BlobDescription{};
  arm.description.tracker_T_base.quaternion[0] = 1.0;
  arm.description.tolerances = {1e-10, 1e-10, 5e-6F, 5e-6F};  // what ticks of arms of metres reach: Tick/*
  return Status::ok;
}

Status make_calibrated_arm(const Geometry& nominal, const Geometry& corrected, CalibratedArm<Real>& arm) noexcept {
  const Transmission none{};
  return make_calibrated_arm(nominal, corrected, none, arm);
}

Status load(const std::uint8_t* bytes, std::size_t size, const DecodeOptions& demands, CalibratedArm<Real>& arm) noexcept {
  if (bytes == nullptr) return Status::bad_input;
  BlobContent content;
  Status status = decode(bytes, size, demands, content);
  if (status != Status::ok) return status;
  Geometry nominal = content.geometry;
  for (std::size_t i = 0; i < max_joints; ++i) nominal.link[i] = content.nominal[i];
  Arm<Real> nominal_arm, corrected_arm;
  status = make_arms(nominal, content.geometry, content.transmission, arm.functions, nominal_arm, corrected_arm);
  if (status != Status::ok) return status;
  if (corrected_arm.terms.functions != nullptr) {
    // The table is too large to be made elsewhere first: from here on the arm is no arm until all is well.
    arm.nominal.mark = 0;
    arm.corrected.mark = 0;
    make_table(content.transmission, arm.functions);
  }
  status = self_test(content, corrected_arm);
  if (!usable(status)) return status;
  arm.nominal = nominal_arm;
  arm.corrected = corrected_arm;
  arm.description = content;
  return status;
}

TickOptions<Real> default_tick_options(const CalibratedArm<Real>& arm, Real period_s) noexcept {
  TickOptions<Real> options = default_tick_options(arm.corrected);
  const Tolerances& tolerances = arm.description.tolerances;
  if constexpr (sizeof(Real) == sizeof(double)) {
    options.goal.position_tolerance_m = static_cast<Real>(tolerances.position_m);
    options.goal.rotation_tolerance_rad = static_cast<Real>(tolerances.rotation_rad);
  } else {
    options.goal.position_tolerance_m = static_cast<Real>(tolerances.float_position_m);
    options.goal.rotation_tolerance_rad = static_cast<Real>(tolerances.float_rotation_rad);
  }
  const Real period = within(Real{0}, period_s, Real(1e3)) ? period_s : Real{0};
  for (std::size_t j = 0; j < max_joints; ++j) {
    const bool slides = ((arm.corrected.prismatic_mask >> j) & 1U) != 0U;
    Real stated = 0;
    convert(arm.description.max_velocity[j], stated);
    const Real fallback = static_cast<Real>(slides ? default_max_velocity_m_s : default_max_velocity_rad_s);
    options.limits.max_step[j] = period * (stated > Real{0} ? stated : fallback);
  }
  return options;
}

}  // namespace mdhcal
