// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/arm.hpp"

namespace mdhcal {

/// Which part of a pose an inverse has to meet. The rest is free.
enum class Task : std::int32_t {
  pose = 0,           ///< position and orientation
  position = 1,       ///< position only
  position_axis = 2,  ///< position and the direction of the flange's z axis
  planar = 3,         ///< x and y of the base frame, and the turn about its z axis
};

/// When an inverse is done, and what matters where not all of its pose can be met.
template <class Real>
struct GoalOptions {
  Real position_tolerance_m;    ///< met if the position error is no larger; > 0 [m]
  Real rotation_tolerance_rad;  ///< and the rotation error likewise; > 0 [rad]
  Real position_weight;         ///< weight of the position error over the reach where not all can be met; > 0 [1]
  Real rotation_weight;         ///< weight of the rotation error there; > 0 [1]
  Task task;
};

/// How far one tick may move the joints.
template <class Real>
struct StepLimits {
  Real max_step[max_joints];    ///< bound of |result - last joints|, each joint, for the whole tick; > 0 [rad] or [m]
};

/// Where joints that the task leaves free should go.
template <class Real>
struct PostureOptions {
  Real q[max_joints];           ///< [rad] or [m]
  Real gain;                    ///< part of the way to it in one tick, 0 (off) ... 1
};

/// What one servo tick may do. Take default_tick_options() and change what matters.
template <class Real>
struct TickOptions {
  GoalOptions<Real> goal;
  StepLimits<Real> limits;
  PostureOptions<Real> posture;
  std::int32_t max_iterations;  ///< evaluations of the arm that the search for the goal may take where Newton's method does not
                                ///< do, each with a step of its model, 1 ... max_tick_iterations; what comes before and after
                                ///< takes up to 25 more (8 more than that where joints or components of the task are not six)
};

inline constexpr std::int32_t max_tick_iterations = 64;

/// What one tick did. Written whenever the tick does not return bad_input.
template <class Real>
struct TickReport {
  Real position_error_m;        ///< of the result, from the forward model [m]
  Real rotation_error_rad;      ///< likewise, of the part that the task asks for [rad]
  Real smallest_singular_value; ///< of the Jacobian of the task, lengths over the links after the first turning joint; where Newton's method met
                                ///< the pose, a lower bound within a factor of sqrt(6)
  std::int32_t iterations;      ///< evaluations of the arm
  std::uint32_t step_mask;      ///< bit i: joint i's goal is further off than its step
  std::uint32_t limit_mask;     ///< bit i: joint i rests on a joint limit, or is outside it
  std::uint32_t unseen_mask;    ///< bit i: the calibration did not see this reading of joint i: its joint function has faded
};

/// Tolerances 1e-10 m and rad (float 5e-6), no step limit, position weighted 1000 times over rotation, 4 iterations,
/// the whole pose, no posture.
TickOptions<double> default_tick_options(const Arm<double>& arm) noexcept;
TickOptions<float> default_tick_options(const Arm<float>& arm) noexcept;

/// One servo tick: moves the joints q[joint_count] ([rad] or [m]; in: last joints, out: new ones) towards joints whose flange
/// meets base_T_flange, without passing a step limit or a joint limit and without leaving the branch that the joints are on. A
/// last joint outside its limit only moves inwards.
///
/// First the goal is found: where the joints should be without the step limit. In the regular case by Newton's method with a
/// first step of second order (Chebyshev's), at least one step however wide the tolerance; near a singularity a step also solves
/// the quadratic equation that the arm bends by along its weakest direction, and the sign of the Jacobian's determinant tells
/// that no fold was passed. Else by the exact second-order model of the error, a scalar quartic along the direction in which that
/// is weakest, damped by the error (Levenberg 1944, Marquardt 1963; Yamashita, Fukushima 2001). Beyond a fold (a straight elbow)
/// it is the solution on this side. Where no joints meet the pose it is the least of the error, lengths over the links after the
/// first turning joint and angles alike; where joints are missing, or at a limit, the caller's weights place what is left. A goal
/// within the step is the result. Towards one that is further off the tick holds the position by the caller's weights, as long as
/// that can be held within the step, else errors count alike; a wrist's singularity is passed, a fold is not.
///
/// `branch`, if given, are readings that say which branch and which turn is meant (the nominal joints that belong to the pose):
/// the goal is sought from there instead of from the last joints.
///
/// Returns ok (met, confirmed by forward()); step_limited (the goal is further off than the step; step_mask names the
/// joints); joint_limited (the error pushes against a joint limit, or a joint is outside one); out_of_reach (the error is at
/// its least on this branch); not_converged (the search was cut; the next tick goes on); bad_input (q untouched): an option
/// out of its range, a joint that is not finite or beyond max_reading, a target that is not finite, further than
/// max_target_m, or whose quaternion is not a unit one to 1e-6 (float 1e-5).
Status tick(const Arm<double>& arm, const TickOptions<double>& options, const Pose<double>& base_T_flange, double* q,
            TickReport<double>* report = nullptr, const double* branch = nullptr) noexcept;
Status tick(const Arm<float>& arm, const TickOptions<float>& options, const Pose<float>& base_T_flange, float* q,
            TickReport<float>* report = nullptr, const float* branch = nullptr) noexcept;

/// Bound of each coordinate of a target's position [m].
inline constexpr double max_target_m = 100000.0;

}  // namespace mdhcal
