// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. What the two halves of a servo tick share.
#pragma once

#include "chain.hpp"
#include "mdhcal/inverse.hpp"
#include "pose_error.hpp"
#include "real.hpp"
#include "rotation.hpp"

namespace mdhcal {
namespace {

/// A tick under way. Joints in readings [rad] or [m].
struct TickState {
  const Arm<Real>* arm;
  const TickOptions<Real>* options;
  Frame<Real> target;
  Real length_m;                         ///< what lengths are divided by
  Real low[max_joints], high[max_joints]; ///< where this tick may leave the joints; last joints are inside
  const Real* last;                      ///< last joints
  Real q[max_joints];                    ///< in: last joints; out: the result
  PoseError error;                       ///< of the result
  Real smallest_singular_value;          ///< a bound of it at the last joints from below; in the end, of the result
  std::int32_t evaluations;
  std::uint32_t step_mask, limit_mask;   ///< joints that push against a bound
};

inline bool met(const TickState& state, const PoseError& error) {
  return error.position_m <= state.options->position_tolerance_m &&
         error.rotation_rad <= state.options->rotation_tolerance_rad;
}

/// The unit that makes a joint's motion unit-free: 1 rad, or the arm's length.
inline Real joint_unit(const TickState& state, std::int32_t i) {
  return ((state.arm->prismatic_mask >> static_cast<std::uint32_t>(i)) & 1U) != 0U ? state.length_m : Real{1};
}

}  // namespace
}  // namespace mdhcal
