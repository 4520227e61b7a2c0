// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. What a search for joints goes by, and a servo tick's state.
#pragma once

#include "arm/chain.hpp"
#include "mdhcal/inverse.hpp"
#include "inverse/pose_error.hpp"
#include "number/real.hpp"
#include "arm/rotation.hpp"

namespace mdhcal {
namespace {

/// What joints are searched for.
struct Goal {
  const Arm<Real>* arm;
  const GoalOptions<Real>* options;      ///< tolerances and task
  Frame<Real> target;
  Real length_m;                         ///< what lengths are divided by
};

/// What an evaluation of the arm shows. Large, hence on the stack only of what uses it.
struct Look {
  Frame<Real> frame;
  Jacobian<Real> coordinates;   ///< by joint coordinate
};

/// A tick under way. Joints in readings [rad] or [m].
struct TickState : Goal {
  const TickOptions<Real>* tick;
  Real low[max_joints], high[max_joints]; ///< joint limits; a last joint outside them only moves inwards
  const Real* last;                      ///< last joints
  const Real* from;                      ///< joints that the goal is searched from: the last ones, or those that name a branch
  Real q[max_joints];                    ///< in: from; out: the result
  PoseError error;                       ///< of the result
  Real smallest_singular_value;          ///< a bound of it at the last joints from below; in the end, of the result
  std::int32_t evaluations;
  std::uint32_t step_mask, limit_mask;   ///< joints that push against a bound
};

/// Where a tick may leave joint j. The rounding of the last joint plus the step must not add to the step, hence the margin.
inline Real step_reach(const TickState& state, std::int32_t j) {
  constexpr Real epsilon = sizeof(Real) == sizeof(double) ? Real(2.3e-16) : Real(1.2e-7);
  const Real max_step = state.tick->limits.max_step[j];
  const Real reach = max_step - epsilon * (magnitude(state.last[j]) + max_step);
  return reach > Real{0} ? reach : Real{0};
}
inline Real step_low(const TickState& state, std::int32_t j) {
  const Real low = state.last[j] - step_reach(state, j);
  return low < state.low[j] ? state.low[j] : low;
}
inline Real step_high(const TickState& state, std::int32_t j) {
  const Real high = state.last[j] + step_reach(state, j);
  return high > state.high[j] ? state.high[j] : high;
}

inline Real within_limits(const TickState& state, std::int32_t j, Real q) {
  return q < state.low[j] ? state.low[j] : (q > state.high[j] ? state.high[j] : q);
}

inline Real within_step(const TickState& state, std::int32_t j, Real q) {
  const Real low = step_low(state, j), high = step_high(state, j);
  return q < low ? low : (q > high ? high : q);
}

/// The unit of length: the links that a turning joint moves. What carries the first one (a base, a rail) is no part of it. An arm
/// without lengths turns only; any will do.
inline Real length_unit(const Arm<Real>& arm) {
  const Real* p = arm.last_T_flange.position_m;
  Real sum = square_root(dot(p, p));
  bool turned = false;
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    const bool slides = ((arm.prismatic_mask >> static_cast<std::uint32_t>(i)) & 1U) != 0U;
    const ArmLink<Real>& link = arm.link[i];
    if (turned) sum += square_root(link.a_m * link.a_m + (slides ? Real{0} : link.d_m * link.d_m));
    turned = turned || !slides;
  }
  return sum > Real(1e-6) ? sum : Real{1};
}

inline bool met(const Goal& goal, const PoseError& error) {
  return error.position_m <= goal.options->position_tolerance_m &&
         error.rotation_rad <= goal.options->rotation_tolerance_rad;
}

/// The unit that makes a joint's motion unit-free: 1 rad, or the arm's length.
inline Real joint_unit(const Goal& goal, std::int32_t i) {
  return ((goal.arm->prismatic_mask >> static_cast<std::uint32_t>(i)) & 1U) != 0U ? goal.length_m : Real{1};
}

/// `unit` times column j of the Jacobian by reading, from the one by joint coordinate.
inline void reading_column(const Arm<Real>& arm, const Jacobian<Real>& coordinates, std::int32_t j, Real unit,
                           Real* column) {
  const bool coupled = arm.coupled != 0;
  const std::int32_t first = coupled ? 0 : j;
  const std::int32_t last = coupled ? arm.joint_count - 1 : j;
  for (int k = 0; k < 6; ++k) column[k] = 0;
  for (std::int32_t i = first; i <= last; ++i) {
    const Real ratio = unit * arm.map[i][j];
    for (int k = 0; k < 6; ++k) column[k] += ratio * coordinates.column[i][k];
  }
}

}  // namespace
}  // namespace mdhcal
