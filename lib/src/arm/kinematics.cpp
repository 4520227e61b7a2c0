// SPDX-License-Identifier: MIT
#include "mdhcal/kinematics.hpp"

#include "arm/chain.hpp"
#include "number/real.hpp"
#include "arm/rotation.hpp"
#include "number/sin_cos.hpp"
#include "number/compare.hpp"

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

// What one link does to one row of the rotation and to the position's coordinate of that row. Returns the joint axis's
// coordinate (third column before Rot_y).
struct LinkTurn {
  Real sin_alpha, cos_alpha, sine, cosine, a, d, sin_beta, cos_beta;
};

template <bool tilted>
inline Real turn_row(const LinkTurn& t, Real* r, Real& position) {
  const Real x = r[0];
  const Real y = t.cos_alpha * r[1] + t.sin_alpha * r[2];
  const Real z = t.cos_alpha * r[2] - t.sin_alpha * r[1];
  const Real turned_x = t.cosine * x + t.sine * y;
  position += t.a * x + t.d * z;
  r[0] = tilted ? t.cos_beta * turned_x - t.sin_beta * z : turned_x;
  r[1] = t.cosine * y - t.sine * x;
  r[2] = tilted ? t.sin_beta * turned_x + t.cos_beta * z : z;
  return z;
}

template <bool tilted>
inline void turn_rows(const LinkTurn& t, Frame<Real>& frame, Real* axis) {
  axis[0] = turn_row<tilted>(t, frame.rotation, frame.position_m[0]);
  axis[1] = turn_row<tilted>(t, frame.rotation + 3, frame.position_m[1]);
  axis[2] = turn_row<tilted>(t, frame.rotation + 6, frame.position_m[2]);
}

inline bool tilts(const LinkTurn& t) { return t.sin_beta > Real{0} || t.sin_beta < Real{0}; }

inline void read_link(const Arm<Real>& arm, std::int32_t i, const Real* q, LinkTurn& t) {
  const ArmLink<Real>& link = arm.link[i];
  const Real coordinate = joint_coordinate(arm, i, q);
  const bool sliding = slides(arm, i);
  const Real theta = sliding ? link.theta_rad : coordinate + link.theta_rad;
  t.d = sliding ? coordinate + link.d_m : link.d_m;
  sin_cos_inline(theta, t.sine, t.cosine);
  t.sin_alpha = link.sin_alpha;
  t.cos_alpha = link.cos_alpha;
  t.a = link.a_m;
  t.sin_beta = link.sin_beta;
  t.cos_beta = link.cos_beta;
}

// base_T_1 = A_1: the same sums without the terms that are zero.
inline void first_link(const Arm<Real>& arm, const Real* q, Frame<Real>& frame, Real* axis) {
  LinkTurn t;
  read_link(arm, 0, q, t);
  Real* r = frame.rotation;
  r[0] = t.cosine;
  r[1] = -t.sine;
  r[2] = 0;
  r[3] = t.sine * t.cos_alpha;
  r[4] = t.cosine * t.cos_alpha;
  r[5] = -t.sin_alpha;
  r[6] = t.sine * t.sin_alpha;
  r[7] = t.cosine * t.sin_alpha;
  r[8] = t.cos_alpha;
  frame.position_m[0] = t.a;
  frame.position_m[1] = -(t.d * t.sin_alpha);
  frame.position_m[2] = t.d * t.cos_alpha;
  for (int row = 0; row < 3; ++row) axis[row] = r[3 * row + 2];
  if (!tilts(t)) return;
  for (int row = 0; row < 3; ++row) {
    const Real x = r[3 * row];
    r[3 * row] = t.cos_beta * x - t.sin_beta * axis[row];
    r[3 * row + 2] = t.sin_beta * x + t.cos_beta * axis[row];
  }
}

// base_T_i = base_T_{i-1} A_i. `axis` receives the joint's axis in the base frame. Most links have no beta.
inline void append_link(const Arm<Real>& arm, std::int32_t i, const Real* q, Frame<Real>& frame, Real* axis) {
  LinkTurn t;
  read_link(arm, i, q, t);
  if (tilts(t)) {
    turn_rows<true>(t, frame, axis);
  } else {
    turn_rows<false>(t, frame, axis);
  }
}

constexpr Frame<Real> identity{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

}  // namespace

bool readings_valid(const Arm<Real>& arm, const Real* q) noexcept {
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    if (!within(-reading_bound, q[i], reading_bound)) return false;
  }
  return true;
}

void evaluate(const Arm<Real>& arm, const Real* q, Frame<Real>& base_T_flange) noexcept {
  Frame<Real> frame;
  Real axis[3];
  first_link(arm, q, frame, axis);
  for (std::int32_t i = 1; i < arm.joint_count; ++i) append_link(arm, i, q, frame, axis);
  multiply(frame, arm.last_T_flange, base_T_flange);
}

void evaluate(const Arm<Real>& arm, const Real* q, Frame<Real>& base_T_flange, Jacobian<Real>& coordinates) noexcept {
  Frame<Real> frame;
  // Each column first holds the axis and a point on it.
  first_link(arm, q, frame, coordinates.column[0] + 3);
  for (int k = 0; k < 3; ++k) coordinates.column[0][k] = frame.position_m[k];
  for (std::int32_t i = 1; i < arm.joint_count; ++i) {
    Real* column = coordinates.column[i];
    append_link(arm, i, q, frame, column + 3);
    for (int k = 0; k < 3; ++k) column[k] = frame.position_m[k];
  }
  multiply(frame, arm.last_T_flange, base_T_flange);
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
      if (arm.map[j][j] > Real{0}) continue;
      for (int k = 0; k < 6; ++k) jacobian.column[j][k] = -jacobian.column[j][k];
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
  evaluate(arm, q, frame, jacobian);
  for (std::size_t j = static_cast<std::size_t>(arm.joint_count); j < max_joints; ++j) {
    for (Real& entry : jacobian.column[j]) entry = 0;
  }
  to_readings(arm, jacobian);
  to_pose(frame, base_T_flange);
  return Status::ok;
}

Status link_frames(const Arm<Real>& arm, const Real* q, Frame<Real>* frames) noexcept {
  if (!readings_valid(arm, q)) return Status::bad_input;
  Real axis[3];
  frames[0] = identity;
  first_link(arm, q, frames[1], axis);
  for (std::int32_t i = 1; i < arm.joint_count; ++i) {
    frames[i + 1] = frames[i];
    append_link(arm, i, q, frames[i + 1], axis);
  }
  multiply(frames[arm.joint_count], arm.last_T_flange, frames[arm.joint_count + 1]);
  return Status::ok;
}

}  // namespace mdhcal
