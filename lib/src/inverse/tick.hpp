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
  Real low[max_joints], high[max_joints]; ///< where this tick may leave the joints; last joints are inside
  const TickOptions<Real>* tick;
  const Real* last;                      ///< last joints
  Real q[max_joints];                    ///< in: last joints; out: the result
  PoseError error;                       ///< of the result
  Real smallest_singular_value;          ///< a bound of it at the last joints from below; in the end, of the result
  std::int32_t evaluations;
  std::uint32_t step_mask, limit_mask;   ///< joints that push against a bound
};

/// The unit of length. An arm without lengths turns only; any will do.
inline Real length_unit(const Arm<Real>& arm) { return arm.reach_m > Real(1e-6) ? arm.reach_m : Real{1}; }

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
