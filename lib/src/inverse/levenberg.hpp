// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. From starting joints, which may be far, to joints that meet a pose.
#pragma once

#include "inverse/task.hpp"

namespace mdhcal {
namespace {

/// Evaluations of the arm that one refinement may take.
constexpr int max_evaluations = 64;

/// The squared error, lengths over the arm's. `met` receives whether the tolerances hold.
inline Real squared_error(const Goal& goal, const Frame<Real>& frame, PoseError& error, bool& met) {
  pose_error(goal.target, frame, goal.options->task, error);
  met = mdhcal::met(goal, error);
  const Real position = error.position_m / goal.length_m;
  return position * position + error.rotation_rad * error.rotation_rad;
}

/// Levenberg-Marquardt from q until the target is met, its damping in proportion to the error, so that the end is Newton's
/// method also where the Jacobian is singular (Yamashita, Fukushima 2001). No joint limits; bounded by max_evaluations.
/// Returns whether the target is met; q is then what meets it, else anything.
inline bool refine(const Goal& goal, Real* q) {
  const Arm<Real>& arm = *goal.arm;
  constexpr Real longest_step = Real(0.3);  // [rad, or lengths of the arm]
  // Below this the damping is lost against the rounding of the Jacobian.
  constexpr Real least_damping = sizeof(Real) == sizeof(double) ? Real(1e-12) : Real(1e-6);
  // Starting values without a solution end where the error is least: it no longer falls by this part.
  constexpr Real falls = Real(1e-5);
  BoxProblem problem;
  problem.rows = task_rank(goal.options->task);
  problem.columns = arm.joint_count;
  problem.budget = 0;  // of no account here
  Frame<Real> frame;
  Jacobian<Real> coordinates;
  PoseError error;
  bool met = false;
  evaluate(arm, q, frame, coordinates);
  Real cost = squared_error(goal, frame, error, met);
  Real share = 1;
  int slow = 0;
  bool moved = true;
  for (int n = 1; n < max_evaluations && !met && slow < 8; ++n) {
    if (moved) {
      linearise(goal, frame, coordinates, Real{1}, problem);
      to_task(goal, frame, Real{1}, error.vector, problem.b);
    }
    const Real damping = square_root(share * cost);
    problem.damping = damping > least_damping ? damping : least_damping;
    Real step[max_joints];
    solve_free(problem, step);
    Real trial[max_joints];
    for (std::int32_t j = 0; j < arm.joint_count; ++j) {
      const Real size = magnitude(step[j]) > longest_step ? (step[j] < Real{0} ? -longest_step : longest_step) : step[j];
      trial[j] = q[j] + size * joint_unit(goal, j);
    }
    Frame<Real> there;
    Jacobian<Real> slope;
    PoseError left;
    evaluate(arm, trial, there, slope);
    const Real trial_cost = squared_error(goal, there, left, met);
    moved = met || trial_cost < cost;
    if (moved) {
      slow = cost - trial_cost > falls * cost ? 0 : slow + 1;
      for (std::int32_t j = 0; j < arm.joint_count; ++j) q[j] = trial[j];
      frame = there;
      coordinates = slope;
      error = left;
      cost = trial_cost;
      share *= Real(0.25);
    } else {
      share *= Real{8};
      if (share > Real(1e12)) break;
    }
  }
  return met;
}

}  // namespace
}  // namespace mdhcal
