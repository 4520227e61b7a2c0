// SPDX-License-Identifier: MIT
#include "mdhcal/calibrated_arm.hpp"

#include "mdhcal/environment.hpp"
#include "mdhcal/self_test.hpp"
#include "number/compare.hpp"
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

Status make_arms(const Geometry& nominal, const Geometry& corrected, CalibratedArm<Real>& arm) {
  Status status = check_environment();
  if (status == Status::ok) status = make_arm(nominal, arm.nominal);
  if (status == Status::ok) status = make_arm(corrected, arm.corrected);
  if (status != Status::ok) return status;
  return same_joints(arm.nominal, arm.corrected) ? Status::ok : Status::bad_input;
}

}  // namespace

Status make_calibrated_arm(const Geometry& nominal, const Geometry& corrected, CalibratedArm<Real>& arm) noexcept {
  CalibratedArm<Real> made;
  const Status status = make_arms(nominal, corrected, made);
  if (status != Status::ok) return status;
  made.description = BlobDescription{};
  made.description.tracker_T_base.quaternion[0] = 1.0;
  made.description.tolerances = {1e-10, 1e-10, 5e-6F, 5e-6F};
  arm = made;
  return Status::ok;
}

Status load(const std::uint8_t* bytes, std::size_t size, const DecodeOptions& demands, CalibratedArm<Real>& arm) noexcept {
  if (bytes == nullptr) return Status::bad_input;
  BlobContent content;
  Status status = decode(bytes, size, demands, content);
  if (status != Status::ok) return status;
  Geometry nominal = content.geometry;
  for (std::size_t i = 0; i < max_joints; ++i) nominal.link[i] = content.nominal[i];
  CalibratedArm<Real> made;
  status = make_arms(nominal, content.geometry, made);
  if (status == Status::ok) status = self_test(content, made.corrected);
  if (!usable(status)) return status;
  made.description = content;
  arm = made;
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
    options.limits.max_step[j] =
        period * static_cast<Real>(slides ? default_max_velocity_m_s : default_max_velocity_rad_s);
  }
  return options;
}

}  // namespace mdhcal
