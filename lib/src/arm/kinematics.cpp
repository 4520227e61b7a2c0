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

// A joint that others' readings move, too.
[[gnu::noinline]] Real coupled_coordinate(const Arm<Real>& arm, std::int32_t i, const Real* q) {
  Real sum = 0;
  for (std::int32_t j = 0; j < arm.joint_count; ++j) sum += arm.map[i][j] * q[j];
  return sum;
}

bool slides(const Arm<Real>& arm, std::int32_t i) {
  return ((arm.prismatic_mask >> static_cast<std::uint32_t>(i)) & 1U) != 0U;
}

// What one link does: sines and cosines of alpha and theta; beta's stay with the arm.
struct LinkTurn {
  Real sin_alpha, cos_alpha, sine, cosine, a, d;
};

[[gnu::always_inline]] inline void read_link(const Arm<Real>& arm, std::int32_t i, const Real* q, LinkTurn& t) {
  const ArmLink<Real>& link = arm.link[i];
  const Real coordinate = arm.coupled == 0 ? link.sign * q[i] : coupled_coordinate(arm, i, q);
  Real theta = link.theta_rad;
  t.d = link.d_m;
  if (slides(arm, i)) {
    t.d = coordinate + t.d;
  } else {
    theta = coordinate + theta;
  }
  sin_cos_inline(theta, t.sine, t.cosine);
  t.sin_alpha = link.sin_alpha;
  t.cos_alpha = link.cos_alpha;
  t.a = link.a_m;
}

// Rot_y(beta): the rotation's first and third column. Most links have none.
[[gnu::always_inline]] inline void tilt(const ArmLink<Real>& link, Real* r) {
  const Real sine = link.sin_beta;
  if (!(magnitude(sine) > Real{0})) return;
  const Real cosine = link.cos_beta;
  for (int row = 0; row < 3; ++row, r += 3) {
    const Real x = r[0];
    const Real z = r[2];
    r[0] = cosine * x - sine * z;
    r[2] = sine * x + cosine * z;
  }
}

// base_T_1 = A_1 but for beta: the same sums without the terms that are zero.
inline void first_turn(const LinkTurn& t, Frame<Real>& frame) {
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
}

// What one link but for beta does to one row of the rotation and to the position's coordinate of that row.
inline void turn_row(const LinkTurn& t, Real* r, Real& position) {
  const Real x = r[0];
  const Real y = t.cos_alpha * r[1] + t.sin_alpha * r[2];
  const Real z = t.cos_alpha * r[2] - t.sin_alpha * r[1];
  position += t.a * x + t.d * z;
  r[0] = t.cosine * x + t.sine * y;
  r[1] = t.cosine * y - t.sine * x;
  r[2] = z;
}

// The joint's axis [0] ... [2] and the origin, before beta.
inline void keep(const Frame<Real>& frame, Real* axis, Real* origin) {
  for (int k = 0; k < 3; ++k) {
    axis[k] = frame.rotation[3 * k + 2];
    origin[k] = frame.position_m[k];
  }
}

// base_T_i = base_T_{i-1} A_i, in place; of i = 0 base_T_1. Where a column of the Jacobian is asked for, it receives a point
// on the joint's axis and the axis in the base frame.
template <bool with_column>
[[gnu::always_inline]] inline void append_link(const Arm<Real>& arm, std::int32_t i, const Real* q, Frame<Real>& frame, Real* column) {
  LinkTurn t;
  read_link(arm, i, q, t);
  if (i == 0) {
    first_turn(t, frame);
  } else {
    turn_row(t, frame.rotation, frame.position_m[0]);
    turn_row(t, frame.rotation + 3, frame.position_m[1]);
    turn_row(t, frame.rotation + 6, frame.position_m[2]);
  }
  if constexpr (with_column) keep(frame, column + 3, column);
  tilt(arm.link[i], frame.rotation);
}

inline void append_flange(const Arm<Real>& arm, Frame<Real>& frame) {
  if (arm.has_flange != 0) multiply(frame, arm.last_T_flange, frame);
}

constexpr Frame<Real> identity{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

}  // namespace

bool readings_valid(const Arm<Real>& arm, const Real* q) noexcept {
  if (arm.mark != arm_mark<Real>) return false;
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    if (!__builtin_islessequal(magnitude(q[i]), reading_bound)) return false;  // as within() does, in one comparison
  }
  return true;
}

void evaluate(const Arm<Real>& arm, const Real* q, Frame<Real>& base_T_flange) noexcept {
  for (std::int32_t i = 0; i < arm.joint_count; ++i) append_link<false>(arm, i, q, base_T_flange, nullptr);
  append_flange(arm, base_T_flange);
}

void evaluate(const Arm<Real>& arm, const Real* q, Frame<Real>& base_T_flange, Jacobian<Real>& coordinates) noexcept {
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    append_link<true>(arm, i, q, base_T_flange, coordinates.column[i]);
  }
  append_flange(arm, base_T_flange);
  const Real* p = base_T_flange.position_m;
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    Real* column = coordinates.column[i];
    const Real x = column[3], y = column[4], z = column[5];
    if (slides(arm, i)) {
      column[0] = x;
      column[1] = y;
      column[2] = z;
      for (int k = 3; k < 6; ++k) column[k] = 0;
      continue;
    }
    const Real lever_x = p[0] - column[0], lever_y = p[1] - column[1], lever_z = p[2] - column[2];
    column[0] = y * lever_z - z * lever_y;
    column[1] = z * lever_x - x * lever_z;
    column[2] = x * lever_y - y * lever_x;
  }
}

void to_readings(const Arm<Real>& arm, Jacobian<Real>& jacobian) noexcept {
  if (arm.coupled == 0) {
    for (std::int32_t j = 0; j < arm.joint_count; ++j) {
      if (arm.link[j].sign > Real{0}) continue;
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
  frames[0] = identity;
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    frames[i + 1] = frames[i];
    append_link<false>(arm, i, q, frames[i + 1], nullptr);
  }
  frames[arm.joint_count + 1] = frames[arm.joint_count];
  append_flange(arm, frames[arm.joint_count + 1]);
  return Status::ok;
}

}  // namespace mdhcal
