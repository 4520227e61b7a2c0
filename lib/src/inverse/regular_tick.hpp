// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. The regular case of a servo tick of a six-joint arm.
#pragma once

#include "inverse/newton.hpp"
#include "inverse/tick.hpp"

namespace mdhcal {
namespace {

/// Below this bound of the smallest singular value the constrained step takes over: there Newton's step can leave the
/// neighbourhood although its error contracts.
constexpr Real regular_bound = Real(0.004);
/// The longest regular step [rad, or lengths of the arm].
constexpr Real regular_step = Real(0.3);

/// The unit-free Jacobian by reading, factored.
inline bool factor_jacobian(const TickState& state, const Jacobian<Real>& coordinates, Factors& factors) {
  const Arm<Real>& arm = *state.arm;
  const Real per_length = Real{1} / state.length_m;
  for (std::int32_t j = 0; j < 6; ++j) {
    const Real* from = coordinates.column[j];
    Real* to = factors.column[j];
    Real sign = arm.map[j][j] > Real{0} ? Real{1} : Real{-1};
    if (arm.coupled != 0) {
      reading_column(arm, coordinates, j, Real{1}, to);
      from = to;
      sign = 1;
    }
    if (((arm.prismatic_mask >> static_cast<std::uint32_t>(j)) & 1U) != 0U) {
      // A slide moves by lengths of the arm; through a coupling it may turn as well.
      for (int k = 0; k < 3; ++k) to[k] = sign * from[k];
      for (int k = 3; k < 6; ++k) to[k] = sign * state.length_m * from[k];
    } else {
      const Real scale = sign * per_length;
      for (int k = 0; k < 3; ++k) to[k] = scale * from[k];
      for (int k = 3; k < 6; ++k) to[k] = sign * from[k];
    }
  }
  return factor(factors);
}

/// Newton's method without a safeguard, given up when a step leaves the bounds or does not contract. Returns whether
/// the pose is met. A Jacobian is used again for a step that is short enough for the error after it, its length times the
/// Jacobian's age, to be below the tolerance. `look` receives the newest, the first being at the last joints.
[[gnu::noinline]] bool regular_tick(TickState& state, Look& look) {
  const Real per_length = Real{1} / state.length_m;
  const Real tolerance_rad = state.options->rotation_tolerance_rad;
  const Real tolerance_length = state.options->position_tolerance_m * per_length;
  const Real tolerance = tolerance_rad < tolerance_length ? tolerance_rad : tolerance_length;
  Real* q = state.q;
  Factors factors;
  Real last_size = 0;
  Real longest_allowed = regular_step;
  bool fresh = true;
  for (std::int32_t round = 0; round < 8 && state.evaluations < state.tick->max_iterations; ++round) {
    PoseError& error = state.error;
    ++state.evaluations;
    if (fresh) {
      evaluate(*state.arm, q, look.frame, look.coordinates);
      pose_error(state.target, look.frame, Task::pose, error);
      if (round == 0 || !met(state, error)) {
        const bool full_rank = factor_jacobian(state, look.coordinates, factors);
        // The steps are bounded by what the first one was, so one look is enough.
        if (round == 0) state.smallest_singular_value = full_rank ? singular_bound(factors) : Real{0};
        if (!full_rank || !(state.smallest_singular_value > regular_bound)) return false;
      }
    } else {
      evaluate(*state.arm, q, look.frame);
      pose_error(state.target, look.frame, Task::pose, error);
    }
    if (met(state, error)) return true;
    const Real length = error.position_m * per_length;
    const Real size = length > error.rotation_rad ? length : error.rotation_rad;
    if (round > 0 && !(size < Real(0.5) * last_size)) return false;
    last_size = size;
    Real b[6];
    Real x[6];
    for (int k = 0; k < 3; ++k) b[k] = error.vector[k] * per_length;
    for (int k = 3; k < 6; ++k) b[k] = error.vector[k];
    solve(factors, b, x);
    Real longest = 0;
    for (int j = 0; j < 6; ++j) {
      const Real step = magnitude(x[j]);
      if (step > longest) longest = step;
      q[j] += x[j] * joint_unit(state, j);
      if (!(q[j] >= state.low[j] && q[j] <= state.high[j])) return false;
    }
    // Steps that halve at least stay within twice the first one.
    if (!(longest <= longest_allowed)) return false;
    longest_allowed = Real(0.5) * longest;
    fresh = longest * longest * longest > tolerance;
  }
  return false;
}

}  // namespace
}  // namespace mdhcal
