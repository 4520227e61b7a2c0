// SPDX-License-Identifier: MIT
#include "mdhcal/kinematics.hpp"

#include "chain.hpp"
#include "real.hpp"
#include "rotation.hpp"
#include "trigonometry.hpp"

namespace mdhcal {

namespace {

constexpr Real reading_bound = static_cast<Real>(max_reading);

Real joint_coordinate(const Arm<Real>& arm, std::int32_t i, const Real* q) {
  if (arm.coupled == 0) return arm.map[i][i] * q[i];
  Real sum = 0;
  for (std::int32_t j = 0; j < arm.joint_count; ++j) sum += arm.map[i][j] * q[j];
  return sum;
}

bool slides(const Arm<Real>& arm, std::int32_t i) {
  return ((arm.prismatic_mask >> static_cast<std::uint32_t>(i)) & 1U) != 0U;
}

// base_T_i = base_T_{i-1} A_i. `axis` receives the joint's axis in the base frame (third column before Rot_y).
void append_link(const Arm<Real>& arm, std::int32_t i, const Real* q, Frame<Real>& frame, Real* axis) {
  const ArmLink<Real>& link = arm.link[i];
  const Real coordinate = joint_coordinate(arm, i, q);
  const Real theta = slides(arm, i) ? link.theta_rad : coordinate + link.theta_rad;
  const Real d = slides(arm, i) ? coordinate + link.d_m : link.d_m;
  Real sine = 0;
  Real cosine = 1;
  sin_cos(theta, sine, cosine);
  for (int row = 0; row < 3; ++row) {
    Real* r = frame.rotation + 3 * row;
    const Real x = r[0];
    const Real y = link.cos_alpha * r[1] + link.sin_alpha * r[2];
    const Real z = link.cos_alpha * r[2] - link.sin_alpha * r[1];
    const Real turned_x = cosine * x + sine * y;
    const Real turned_y = cosine * y - sine * x;
    frame.position_m[row] += link.a_m * x + d * z;
    r[0] = link.cos_beta * turned_x - link.sin_beta * z;
    r[1] = turned_y;
    r[2] = link.sin_beta * turned_x + link.cos_beta * z;
    axis[row] = z;
  }
}

constexpr Frame<Real> identity{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

}  // namespace

bool readings_valid(const Arm<Real>& arm, const Real* q) noexcept {
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    if (!(q[i] >= -reading_bound && q[i] <= reading_bound)) return false;
  }
  return true;
}

void evaluate(const Arm<Real>& arm, const Real* q, Frame<Real>& base_T_flange) noexcept {
  Frame<Real> frame = identity;
  Real axis[3];
  for (std::int32_t i = 0; i < arm.joint_count; ++i) append_link(arm, i, q, frame, axis);
  base_T_flange = multiply(frame, arm.last_T_flange);
}

void evaluate(const Arm<Real>& arm, const Real* q, Frame<Real>& base_T_flange, Jacobian<Real>& coordinates) noexcept {
  Frame<Real> frame = identity;
  // Each column first holds the axis and a point on it.
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    Real* column = coordinates.column[i];
    append_link(arm, i, q, frame, column + 3);
    for (int k = 0; k < 3; ++k) column[k] = frame.position_m[k];
  }
  base_T_flange = multiply(frame, arm.last_T_flange);
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    Real* column = coordinates.column[i];
    Real* z = column + 3;
    if (slides(arm, i)) {
      for (int k = 0; k < 3; ++k) {
        column[k] = z[k];
        z[k] = 0;
      }
    } else {
      Real lever[3];
      for (int k = 0; k < 3; ++k) lever[k] = base_T_flange.position_m[k] - column[k];
      column[0] = z[1] * lever[2] - z[2] * lever[1];
      column[1] = z[2] * lever[0] - z[0] * lever[2];
      column[2] = z[0] * lever[1] - z[1] * lever[0];
    }
  }
}

void to_readings(const Arm<Real>& arm, Jacobian<Real>& jacobian) noexcept {
  if (arm.coupled == 0) {
    for (std::int32_t j = 0; j < arm.joint_count; ++j) {
      for (int k = 0; k < 6; ++k) jacobian.column[j][k] *= arm.map[j][j];
    }
    return;
  }
  for (int k = 0; k < 6; ++k) {
    Real row[max_joints];
    for (std::int32_t j = 0; j < arm.joint_count; ++j) {
      Real sum = 0;
      for (std::int32_t i = 0; i < arm.joint_count; ++i) sum += arm.map[i][j] * jacobian.column[i][k];
      row[j] = sum;
    }
    for (std::int32_t j = 0; j < arm.joint_count; ++j) jacobian.column[j][k] = row[j];
  }
}

Status forward(const Arm<Real>& arm, const Real* q, Pose<Real>& base_T_flange) noexcept {
  if (!readings_valid(arm, q)) return Status::bad_input;
  Frame<Real> frame;
  evaluate(arm, q, frame);
  to_pose(frame, base_T_flange);
  return Status::ok;
}

Status forward(const Arm<Real>& arm, const Real* q, Pose<Real>& base_T_flange, Jacobian<Real>& jacobian) noexcept {
  if (!readings_valid(arm, q)) return Status::bad_input;
  Frame<Real> frame;
  jacobian = Jacobian<Real>{};
  evaluate(arm, q, frame, jacobian);
  to_readings(arm, jacobian);
  to_pose(frame, base_T_flange);
  return Status::ok;
}

Status link_frames(const Arm<Real>& arm, const Real* q, Frame<Real>* frames) noexcept {
  if (!readings_valid(arm, q)) return Status::bad_input;
  Real axis[3];
  frames[0] = identity;
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    frames[i + 1] = frames[i];
    append_link(arm, i, q, frames[i + 1], axis);
  }
  frames[arm.joint_count + 1] = multiply(frames[arm.joint_count], arm.last_T_flange);
  return Status::ok;
}

}  // namespace mdhcal
