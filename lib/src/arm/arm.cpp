// SPDX-License-Identifier: MIT
#include "mdhcal/arm.hpp"

#include "number/compare.hpp"
#include "number/convert.hpp"
#include "number/trigonometry.hpp"

namespace mdhcal {

void convert(double from, double& to) noexcept { to = from; }
void convert(float from, double& to) noexcept { to = static_cast<double>(from); }
void convert(double from, float& to) noexcept { to = static_cast<float>(from); }

namespace {

bool valid(const Link& link) {
  return within_bound(link.alpha_rad, max_angle_rad) && within_bound(link.a_m, max_length_m) &&
         within_bound(link.theta_rad, max_angle_rad) && within_bound(link.d_m, max_length_m) &&
         within_bound(link.beta_rad, max_angle_rad);
}

bool valid(const Joint& joint, std::int32_t own, std::int32_t count) {
  if (joint.kind != JointKind::revolute && joint.kind != JointKind::prismatic) return false;
  if (joint.sign != 1 && joint.sign != -1) return false;
  if (joint.has_min != 0 && joint.has_min != 1) return false;
  if (joint.has_max != 0 && joint.has_max != 1) return false;
  if (joint.has_min == 1 && !within_bound(joint.min, max_reading)) return false;
  if (joint.has_max == 1 && !within_bound(joint.max, max_reading)) return false;
  if (joint.has_min == 1 && joint.has_max == 1 && !(joint.min <= joint.max)) return false;
  for (std::int32_t j = 0; j < static_cast<std::int32_t>(max_joints); ++j) {
    const bool zero = within_bound(joint.coupling[j], 0.0);
    if ((j == own || j >= count) ? !zero : !within_bound(joint.coupling[j], max_coupling)) return false;
  }
  return true;
}

bool valid(const Pose<double>& pose) {
  double norm2 = 0.0;
  for (double c : pose.quaternion) {
    if (!within_bound(c, 2.0)) return false;
    norm2 += c * c;
  }
  if (!(norm2 >= 1.0 - 1e-9 && norm2 <= 1.0 + 1e-9)) return false;
  for (double p : pose.position_m) {
    if (!within_bound(p, max_length_m)) return false;
  }
  return true;
}

// Exactly: a flange that is off by a rounding is one.
bool is_identity(const Pose<double>& pose) {
  for (int k = 0; k < 3; ++k) {
    if (!within_bound(pose.position_m[k], 0.0) || !within_bound(pose.quaternion[k + 1], 0.0)) return false;
  }
  return true;
}

template <class Real>
void to_matrix(const double (&q)[4], Real (&r)[9]) {
  const double w = q[0];
  const double x = q[1];
  const double y = q[2];
  const double z = q[3];
  r[0] = static_cast<Real>(1.0 - 2.0 * (y * y + z * z));
  r[1] = static_cast<Real>(2.0 * (x * y - w * z));
  r[2] = static_cast<Real>(2.0 * (x * z + w * y));
  r[3] = static_cast<Real>(2.0 * (x * y + w * z));
  r[4] = static_cast<Real>(1.0 - 2.0 * (x * x + z * z));
  r[5] = static_cast<Real>(2.0 * (y * z - w * x));
  r[6] = static_cast<Real>(2.0 * (x * z - w * y));
  r[7] = static_cast<Real>(2.0 * (y * z + w * x));
  r[8] = static_cast<Real>(1.0 - 2.0 * (x * x + y * y));
}

template <class Real>
Status prepare(const Geometry& geometry, Arm<Real>& arm) {
  const Status status = check_geometry(geometry);
  if (status != Status::ok) return status;
  arm = Arm<Real>{};
  arm.mark = arm_mark<Real>;
  arm.joint_count = geometry.joint_count;
  double reach = 0.0;
  for (double p : geometry.last_T_flange.position_m) reach += magnitude(p);
  for (std::int32_t i = 0; i < geometry.joint_count; ++i) {
    const Link& link = geometry.link[i];
    const Joint& joint = geometry.joint[i];
    const std::uint32_t bit = 1U << static_cast<std::uint32_t>(i);
    ArmLink<Real>& out = arm.link[i];
    double sine = 0.0;
    double cosine = 1.0;
    sin_cos(link.alpha_rad, sine, cosine);
    out.sin_alpha = static_cast<Real>(sine);
    out.cos_alpha = static_cast<Real>(cosine);
    sin_cos(link.beta_rad, sine, cosine);
    out.sin_beta = static_cast<Real>(sine);
    out.cos_beta = static_cast<Real>(cosine);
    out.a_m = static_cast<Real>(link.a_m);
    out.d_m = static_cast<Real>(link.d_m);
    out.theta_rad = static_cast<Real>(link.theta_rad);
    out.sign = static_cast<Real>(joint.sign);
    if (joint.kind == JointKind::prismatic) arm.prismatic_mask |= bit;
    if (joint.has_min == 1) arm.min_mask |= bit;
    if (joint.has_max == 1) arm.max_mask |= bit;
    arm.min[i] = static_cast<Real>(joint.min);
    arm.max[i] = static_cast<Real>(joint.max);
    for (std::int32_t j = 0; j < geometry.joint_count; ++j) {
      const double ratio = i == j ? static_cast<double>(joint.sign) : joint.coupling[j];
      arm.map[i][j] = static_cast<Real>(ratio);
      if (i != j && (ratio > 0.0 || ratio < 0.0)) arm.coupled = 1;
    }
    reach += magnitude(link.a_m) + magnitude(link.d_m);
    if (joint.kind == JointKind::prismatic) {
      double travel = joint.has_min == 1 ? magnitude(joint.min) : 0.0;
      if (joint.has_max == 1 && magnitude(joint.max) > travel) travel = magnitude(joint.max);
      reach += travel;
    }
  }
  arm.has_flange = is_identity(geometry.last_T_flange) ? 0 : 1;
  to_matrix(geometry.last_T_flange.quaternion, arm.last_T_flange.rotation);
  for (int k = 0; k < 3; ++k) {
    arm.last_T_flange.position_m[k] = static_cast<Real>(geometry.last_T_flange.position_m[k]);
  }
  arm.reach_m = static_cast<Real>(reach);
  return Status::ok;
}

}  // namespace

Status check_geometry(const Geometry& geometry) noexcept {
  if (geometry.joint_count < 1 || geometry.joint_count > static_cast<std::int32_t>(max_joints)) {
    return Status::bad_input;
  }
  for (std::int32_t i = 0; i < geometry.joint_count; ++i) {
    if (!valid(geometry.link[i]) || !valid(geometry.joint[i], i, geometry.joint_count)) return Status::bad_input;
  }
  return valid(geometry.last_T_flange) ? Status::ok : Status::bad_input;
}

Status make_arm(const Geometry& geometry, Arm<double>& arm) noexcept { return prepare(geometry, arm); }
Status make_arm(const Geometry& geometry, Arm<float>& arm) noexcept { return prepare(geometry, arm); }

}  // namespace mdhcal
