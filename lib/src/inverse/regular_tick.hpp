// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. The regular case of a servo tick of a six-joint arm.
#pragma once

#include "arm/vector.hpp"
#include "inverse/newton.hpp"
#include "inverse/tick.hpp"

namespace mdhcal {
namespace {

/// The longest step [rad, or lengths of the arm]: its third order, which nothing here looks at, is then a hundredth of it.
constexpr Real regular_step = Real(0.3);
/// The most that the Jacobian's change along the way may do to a step, as a part of the step: along the first step this is
/// Kantorovich's h, and up to 1/2 Newton's method finds the solution that belongs to the last joints and no other
/// (Kantorovich, Akilov 1982, ch. XVIII). At 1/2 it halves its error, which is the least that a step has to do.
constexpr Real regular_change = Real(0.5);
constexpr Real regular_rest = Real(0.5);
/// Beyond this change the Jacobian is taken anew: its square, a hundredth, is about what a step leaves of the error.
constexpr Real renewed_change = Real(0.1);

/// The largest component.
inline Real largest_of(const Real* x) {
  Real largest = 0;
  for (int j = 0; j < 6; ++j) {
    if (magnitude(x[j]) > largest) largest = magnitude(x[j]);
  }
  return largest;
}

/// What the unknowns of the step are measured in: 1 rad, or for a slide the arm's length.
inline void units_of(const TickState& state, Real* unit) {
  for (std::int32_t j = 0; j < 6; ++j) unit[j] = joint_unit(state, j);
}

[[gnu::noinline]] void coupled_columns(const TickState& state, const Jacobian<Real>& coordinates, Real per_length,
                                       Factors& factors) {
  for (std::int32_t j = 0; j < 6; ++j) {
    reading_column(*state.arm, coordinates, j, joint_unit(state, j), factors.column[j]);
    for (int k = 0; k < 3; ++k) factors.column[j][k] *= per_length;
  }
}

/// The Jacobian, lengths over the arm's, by the unknowns: the joint coordinates, or the readings where joints are coupled.
/// Returns false if it is singular.
inline bool factor_jacobian(const TickState& state, const Jacobian<Real>& coordinates, const Real* unit, Real per_length,
                            Factors& factors) {
  if (state.arm->coupled != 0) {
    coupled_columns(state, coordinates, per_length, factors);
    return factor(factors);
  }
  for (int j = 0; j < 6; ++j) {
    const Real* from = coordinates.column[j];
    Real* to = factors.column[j];
    const Real scale = unit[j] * per_length;
    to[0] = scale * from[0];
    to[1] = scale * from[1];
    to[2] = scale * from[2];
    to[3] = from[3];  // of a slide: zero
    to[4] = from[4];
    to[5] = from[5];
  }
  return factor(factors);
}

[[gnu::noinline]] void coupled_rates(const Arm<Real>& arm, const Real* step, Real* rate) {
  for (int i = 0; i < 6; ++i) {
    rate[i] = 0;
    for (int j = 0; j < 6; ++j) rate[i] += arm.map[i][j] * step[j];
  }
}

/// How the joint coordinates move where the unknowns move by x.
inline void rates_of(const TickState& state, const Real* unit, const Real* x, Real* rate) {
  Real step[6];
  for (int j = 0; j < 6; ++j) step[j] = x[j] * unit[j];
  if (state.arm->coupled != 0) {
    coupled_rates(*state.arm, step, rate);
  } else {
    for (int j = 0; j < 6; ++j) rate[j] = step[j];
  }
}

/// What the Jacobian's change along the coordinates' motion a does to their motion b: the displacement of the flange is
/// J d + change(d, d) / 2 but for the third order, and after d it moves by J b + change(d, b). Columns: those at the
/// beginning, c_j the shift and z_j the turn of the flange by coordinate j:
/// shift  sum_j (sum_{i<j} a_i z_i x c_j) b_j + (sum_{i<=j} b_i z_i x c_j) a_j,  turn  sum_j (sum_{i<j} a_i z_i) x z_j b_j.
[[gnu::noinline]] void change_of_motion(const Jacobian<Real>& coordinates, const Real* a, const Real* b, Real* change) {
  Vector shift{0, 0, 0}, turn{0, 0, 0}, turned_a{0, 0, 0}, turned_b{0, 0, 0};
  for (int j = 0; j < 6; ++j) {
    const Real* column = coordinates.column[j];
    const Vector z{column[3], column[4], column[5]};
    turned_b = turned_b + b[j] * z;
    const Vector carried = b[j] * turned_a;
    shift = shift + cross(carried + a[j] * turned_b, {column[0], column[1], column[2]});
    turn = turn + cross(carried, z);
    turned_a = turned_a + a[j] * z;
  }
  change[0] = shift.x;
  change[1] = shift.y;
  change[2] = shift.z;
  change[3] = turn.x;
  change[4] = turn.y;
  change[5] = turn.z;
}

/// What the second derivatives of the joint functions add to that, as a motion of the unknowns but for a slope of some per
/// cent. Where joints are coupled the unknowns are others, and an evaluation more makes up for it.
inline void add_curvature(const Arm<Real>& arm, const Jacobian<Real>& coordinates, const Real* a, const Real* b, Real* bend) {
  if (arm.has_terms == 0 || arm.coupled != 0) return;
  for (int j = 0; j < 6; ++j) bend[j] += coordinates.column[curvature_column][j] * (a[j] * b[j]);
}

/// The unknowns' motion for a displacement of the flange, in its place.
inline void solve_displacement(const Factors& factors, Real per_length, Real* displacement) {
  for (int k = 0; k < 3; ++k) displacement[k] *= per_length;
  solve(factors, displacement);
}

/// Moves the tick's joints by the unknowns x. Returns whether they stay within the tick's bounds.
inline bool move(TickState& state, const Real* unit, const Real* x) {
  const Arm<Real>& arm = *state.arm;
  const bool coupled = arm.coupled != 0;
  for (int j = 0; j < 6; ++j) {
    const Real step = x[j] * unit[j];
    const Real q = state.q[j] + (coupled ? step : arm.link[j].sign * step);
    state.q[j] = q;
    if (!(q >= state.low[j] && q <= state.high[j])) return false;
  }
  return true;
}

/// The error, lengths over the arm's.
inline Real size_of(const PoseError& error, Real per_length) {
  const Real length = error.position_m * per_length;
  return length > error.rotation_rad ? length : error.rotation_rad;
}

/// Newton's method with what the Jacobian's change along the way does to a step taken into it: the first step is Chebyshev's,
/// of third order (Traub 1964, ch. 5), and one Jacobian does for the later ones. At least one step is made, whatever the
/// tolerance. Given up where that leaves the tick's bounds or the neighbourhood of the last joints. Returns whether the pose
/// is met. `look` is of the last joints as long as that is the only evaluation.
[[gnu::noinline]] bool regular_tick(TickState& state, Look& look) {
  const Real per_length = Real{1} / state.length_m;
  PoseError& error = state.error;
  Factors factors;
  Real unit[6], step[6], rate[6], way[6], bend[6];
  units_of(state, unit);
  Real size = 0;
  bool fresh = true;
  while (state.evaluations < state.tick->max_iterations) {
    ++state.evaluations;
    if (fresh) {
      evaluate(*state.arm, state.q, look.frame, look.coordinates);
    } else {
      evaluate(*state.arm, state.q, look.frame);
    }
    pose_error(state.target, look.frame, Task::pose, error);
    const Real left = size_of(error, per_length);
    const bool first = state.evaluations == 1;
    if (!first && met(state, error)) return true;
    if (!first && !(left <= regular_rest * size)) return false;
    size = left;
    if (fresh) {
      const bool full_rank = factor_jacobian(state, look.coordinates, unit, per_length, factors);
      if (first) state.smallest_singular_value = full_rank ? singular_bound(factors) : Real{0};
      if (!full_rank) return false;
    }
    for (int j = 0; j < 6; ++j) step[j] = error.vector[j];
    solve_displacement(factors, per_length, step);
    rates_of(state, unit, step, rate);
    change_of_motion(look.coordinates, fresh ? rate : way, rate, bend);
    solve_displacement(factors, per_length, bend);
    add_curvature(*state.arm, look.coordinates, fresh ? rate : way, rate, bend);
    const Real longest = largest_of(step);
    const Real change = largest_of(bend);
    if (!(longest <= regular_step) || !(change <= regular_change * longest)) return false;
    const Real part = fresh ? Real(0.5) : Real{1};
    for (int j = 0; j < 6; ++j) step[j] -= part * bend[j];
    if (!move(state, unit, step)) return false;
    rates_of(state, unit, step, rate);
    for (int j = 0; j < 6; ++j) way[j] = fresh ? rate[j] : way[j] + rate[j];
    fresh = change > renewed_change * longest;
  }
  return false;
}

}  // namespace
}  // namespace mdhcal
