// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. The damped least-squares step in the singular basis.
#pragma once

#include "svd.hpp"
#include "tick.hpp"

namespace mdhcal {
namespace {

/// How many rows of the error a task has that do not depend on each other.
inline std::int32_t task_rank(Task task) {
  switch (task) {
    case Task::pose: return 6;
    case Task::position_axis: return 5;
    case Task::position:
    case Task::planar: return 3;
  }
  return 6;
}

/// Applies what the task asks for, unit-free and weighted, to a velocity of the flange. `z` is the flange's z axis.
inline void to_task(const TickState& state, const Real* z, Real rotation_weight, Real* column) {
  const Task task = state.options->task;
  const Real position_scale = Real{1} / state.length_m;
  for (int k = 0; k < 3; ++k) column[k] *= position_scale;
  for (int k = 3; k < 6; ++k) column[k] *= rotation_weight;
  if (task == Task::position) {
    for (int k = 3; k < 6; ++k) column[k] = 0;
  } else if (task == Task::position_axis) {
    const Real along = dot(z, column + 3);
    for (int k = 0; k < 3; ++k) column[3 + k] -= along * z[k];
  } else if (task == Task::planar) {
    for (int k = 2; k < 5; ++k) column[k] = 0;
  }
}

/// The task's Jacobian by unit-free joint motion, in the columns that `free_mask` names; the others are zero.
inline void task_jacobian(const TickState& state, const Jacobian<Real>& coordinates, const Real* z,
                          Real rotation_weight, std::uint32_t free_mask, SingularBasis& basis) {
  const Arm<Real>& arm = *state.arm;
  for (std::int32_t j = 0; j < arm.joint_count; ++j) {
    Real* column = basis.us[j];
    for (int k = 0; k < 6; ++k) column[k] = 0;
    if (((free_mask >> static_cast<std::uint32_t>(j)) & 1U) == 0U) continue;
    const Real unit = joint_unit(state, j);
    for (std::int32_t i = 0; i < arm.joint_count; ++i) {
      if (arm.coupled == 0 && i != j) continue;
      const Real ratio = unit * arm.map[i][j];
      for (int k = 0; k < 6; ++k) column[k] += ratio * coordinates.column[i][k];
    }
    to_task(state, z, rotation_weight, column);
  }
}

/// Acceleration of the flange when the joints move steadily by the unit-free rates v: the second directional
/// derivative of the pose. From the axes alone, since d J_i / d q_j is z_min(i,j) x J_max(i,j).
inline void bend(const TickState& state, const Jacobian<Real>& coordinates, const Real* v, Real* acceleration) {
  const Arm<Real>& arm = *state.arm;
  Real spin[3] = {0, 0, 0};
  for (int k = 0; k < 6; ++k) acceleration[k] = 0;
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    Real rate = 0;
    for (std::int32_t j = 0; j < arm.joint_count; ++j) rate += arm.map[i][j] * joint_unit(state, j) * v[j];
    const Real* column = coordinates.column[i];
    add_cross(spin, column + 3, rate, acceleration + 3);
    add_cross(spin, column, rate, acceleration);
    for (int k = 0; k < 3; ++k) spin[k] += rate * column[3 + k];
    add_cross(spin, column, rate, acceleration);
  }
}

/// One step along the singular directions: t_k = s_k c_k / (s_k^2 + damping).
struct Directions {
  std::int32_t count;
  Real slope[max_joints];   ///< s_k; for the weakest direction the secant of the second-order model
  Real wanted[max_joints];  ///< s_k c_k, that is slope times what is asked for
  bool held;                ///< the weakest direction ends at a fold short of the target
  bool rests;               ///< the weakest direction waits for the singularity to pass; decided once an attempt
  bool decided;
  bool folds;               ///< the weakest direction ends at a fold, as a stretched elbow's does
};

/// How near to a fold the weakest direction may go while the target is beyond it, as a slope.
constexpr Real fold_margin = Real(0.005);
/// A direction that bends less than this does not fold [1 / rad].
constexpr Real fold_curvature = Real(0.05);

/// Below this slope a direction that no fold ends (a wrist's) rests while the arm approaches the singularity.
constexpr Real untracked_below = Real(0.01);

/// Lets the weakest direction rest if the strong ones take the arm towards its singularity. Following the pose there
/// as far as the limits go would leave the joints far from where they are needed on the other side; at rest the
/// error stays that of the miss, and is caught up on leaving.
[[gnu::noinline]] void decide_to_rest(const TickState& state, const Jacobian<Real>& coordinates, const Real* z,
                           Real rotation_weight, const SingularBasis& basis, const Real* u, Directions& directions) {
  const std::int32_t joints = state.arm->joint_count;
  const std::int32_t weakest = directions.count - 1;
  Real along[max_joints] = {};
  for (std::int32_t k = 0; k < weakest; ++k) {
    const Real square = basis.s[k] * basis.s[k];
    const Real t = square > Real{0} ? directions.wanted[k] / square : Real{0};
    for (std::int32_t j = 0; j < joints; ++j) along[j] += t * basis.v[k][j];
  }
  // The slope's change is u . H(along, v); H is had from squares: H(a + v, a + v) - H(a - v, a - v) = 4 H(a, v).
  Real slope_change = 0;
  for (int sign = 1; sign >= -1; sign -= 2) {
    Real sum[max_joints] = {};
    Real acceleration[6];
    for (std::int32_t j = 0; j < joints; ++j) sum[j] = along[j] + static_cast<Real>(sign) * basis.v[weakest][j];
    bend(state, coordinates, sum, acceleration);
    to_task(state, z, rotation_weight, acceleration);
    slope_change += static_cast<Real>(sign) * dot6(u, acceleration);
  }
  directions.rests = slope_change < Real{0};
}

/// Prepares the step for the weighted error. Along the weakest direction u the error behaves as s t + h t^2 / 2 with
/// h = u . acceleration; its root nearest to zero stays on this side of the fold, where the slope s + h t vanishes.
/// If the target is beyond the fold, the step ends short of it: a tenth of the way, or at the slope `margin`.
[[gnu::noinline]] void plan_step(const TickState& state, const Jacobian<Real>& coordinates, const Real* z, Real rotation_weight,
                      Real margin, Real least_curvature, const SingularBasis& basis, std::int32_t rank,
                      const Real* error, Directions& directions) {
  directions.count = rank;
  directions.held = false;
  for (std::int32_t k = 0; k < rank; ++k) {
    directions.slope[k] = basis.s[k];
    directions.wanted[k] = dot6(basis.us[k], error);
  }
  if (rank == 0) return;
  const std::int32_t weakest = rank - 1;
  const Real s = basis.s[weakest];
  Real u[6];
  if (s > Real(1e-6) * basis.s[0]) {
    for (int k = 0; k < 6; ++k) u[k] = basis.us[weakest][k] / s;
  } else {
    // The direction is lost in rounding: take what no other direction can do about the error.
    for (int k = 0; k < 6; ++k) u[k] = error[k];
    for (std::int32_t i = 0; i < weakest; ++i) {
      const Real square = basis.s[i] * basis.s[i];
      if (!(square > Real{0})) continue;
      const Real part = dot6(basis.us[i], u) / square;
      for (int k = 0; k < 6; ++k) u[k] -= part * basis.us[i][k];
    }
    const Real norm = square_root(dot6(u, u));
    if (!(norm > Real{0})) return;
    for (int k = 0; k < 6; ++k) u[k] /= norm;
  }
  const Real c = dot6(u, error);
  Real acceleration[6];
  bend(state, coordinates, basis.v[weakest], acceleration);
  to_task(state, z, rotation_weight, acceleration);
  const Real h = dot6(u, acceleration);
  const Real weight =
      square_root(dot(u, u) + rotation_weight * rotation_weight * dot(u + 3, u + 3));
  directions.folds = magnitude(h) > least_curvature * weight;
  if (!directions.folds) {
    if (margin > Real{0} && s < untracked_below * weight) {
      if (!directions.decided) decide_to_rest(state, coordinates, z, rotation_weight, basis, u, directions);
      directions.decided = true;
      if (directions.rests) directions.wanted[weakest] = 0;
    }
    return;
  }
  const Real discriminant = s * s + Real{2} * h * c;
  if (discriminant >= Real{0}) {
    const Real secant = Real(0.5) * (s + square_root(discriminant));
    directions.slope[weakest] = secant;
    directions.wanted[weakest] = secant * c;
    return;
  }
  directions.held = true;
  const Real least = Real(0.1) * s;
  const Real room = s - (margin * weight > least ? margin * weight : least);
  if (!(room > Real{0})) {
    directions.wanted[weakest] = 0;
    directions.slope[weakest] = 1;
    return;
  }
  // t = -room / h, written as a slope for the damping.
  const Real secant = -c * h / room;
  directions.slope[weakest] = secant;
  directions.wanted[weakest] = secant * c;
}

/// The joints' motion for a damping, in readings.
inline void joint_step(const TickState& state, const SingularBasis& basis, const Directions& directions, Real damping,
                       Real* step) {
  const std::int32_t joints = state.arm->joint_count;
  for (std::int32_t j = 0; j < joints; ++j) step[j] = 0;
  for (std::int32_t k = 0; k < directions.count; ++k) {
    const Real square = directions.slope[k] * directions.slope[k] + damping;
    const Real t = square > Real{0} ? directions.wanted[k] / square : Real{0};
    for (std::int32_t j = 0; j < joints; ++j) step[j] += t * basis.v[k][j];
  }
  for (std::int32_t j = 0; j < joints; ++j) step[j] *= joint_unit(state, j);
}

}  // namespace
}  // namespace mdhcal
