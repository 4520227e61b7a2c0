// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/arm.hpp"

namespace mdhcal {

/// What the drives allow. Each 1e-6 ... 1e6.
template <class Real>
struct JointRateLimits {
  Real max_velocity[max_joints];      ///< [rad/s] or [m/s]
  Real max_acceleration[max_joints];  ///< [rad/s^2] or [m/s^2]
};

/// A joint that its velocity would bring to its limit within this time slows down in proportion to the way that is left [s].
inline constexpr double limit_approach_s = 0.1;

/// Joint velocities [rad/s or m/s] at the readings q for a velocity of the flange in the base frame: of its origin [m/s],
/// then the angular one [rad/s]. Continuous in q and in what is asked: damped least squares (Nakamura, Hanafusa 1986),
/// a direction with singular value s (lengths over Arm::reach_m) being answered by s / (s^2 + k^2), where k = 0 for
/// s^2 >= speed^2 / acceleration, with the speed of all that is asked and the least of the joints' accelerations: nearer to
/// a singularity than that, joints that follow it would have to be accelerated by more. k is a function of s alone, so that
/// directions that change places change nothing. Then all velocities are made smaller alike until none is over
/// max_velocity; then a joint near its limit is slowed down, and one at or beyond it only moves inwards.
/// Redundant joints get the smallest velocities. Returns ok (the flange's velocity is met to 1e-9 relative, float 1e-4);
/// joint_limited, near_singular (damped), step_limited (max_velocity), or out_of_reach (an arm with fewer joints than the
/// velocity needs), all usable and short of it; bad_input (an arm that make_arm() did not make, a number that is not
/// finite, |flange_velocity| over 1e6, a limit out of its range; `velocity` untouched).
Status joint_velocities(const Arm<double>& arm, const double* q, const double* flange_velocity,
                        const JointRateLimits<double>& limits, double* velocity) noexcept;
Status joint_velocities(const Arm<float>& arm, const float* q, const float* flange_velocity,
                        const JointRateLimits<float>& limits, float* velocity) noexcept;

/// Joint accelerations [rad/s^2 or m/s^2] at the readings q and joint velocities `velocity` for an acceleration of the
/// flange in the base frame: of its origin [m/s^2], then the angular one [rad/s^2]. Solves J a = flange_acceleration -
/// dJ/dt velocity with the damping that joint_velocities() has for the flange's velocity; made smaller alike until none is
/// over max_acceleration. Joint limits are not looked at. Returns and errors as joint_velocities(), without joint_limited.
Status joint_accelerations(const Arm<double>& arm, const double* q, const double* velocity,
                           const double* flange_acceleration, const JointRateLimits<double>& limits,
                           double* acceleration) noexcept;
Status joint_accelerations(const Arm<float>& arm, const float* q, const float* velocity, const float* flange_acceleration,
                           const JointRateLimits<float>& limits, float* acceleration) noexcept;

}  // namespace mdhcal
