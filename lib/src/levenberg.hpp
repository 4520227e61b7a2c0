// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. From starting joints, which may be far, to joints that meet a pose.
#pragma once

#include "chain.hpp"
#include "pose_error.hpp"
#include "real.hpp"
#include "rotation.hpp"

namespace mdhcal {
namespace {

/// Evaluations of the arm that one refinement may take.
constexpr int max_evaluations = 64;

struct Refinement {
  const Arm<Real>* arm;
  const TickOptions<Real>* options;  ///< tolerances and task
  Frame<Real> target;
  Real length_m;                     ///< what lengths are divided by
};

/// The Jacobian over sqrt(damping) times the identity, and what is wanted beside it, column by column.
struct Stacked {
  Real column[max_joints + 1][6 + max_joints];
};

inline Real joint_unit(const Refinement& how, std::int32_t j) {
  return ((how.arm->prismatic_mask >> static_cast<std::uint32_t>(j)) & 1U) != 0U ? how.length_m : Real{1};
}

/// Fills the stack: what one unit of each joint (1 rad, or the arm's length) does to what the task asks for, lengths over
/// the arm's; then the damping; then the error.
inline void stack(const Refinement& how, const Frame<Real>& frame, const Jacobian<Real>& jacobian, const Real* wanted,
                  Real damping, Stacked& a) {
  const std::int32_t joints = how.arm->joint_count;
  const Task task = how.options->task;
  const Real z[3] = {frame.rotation[2], frame.rotation[5], frame.rotation[8]};
  for (std::int32_t j = 0; j <= joints; ++j) {
    Real* c = a.column[j];
    const Real* from = j < joints ? jacobian.column[j] : wanted;
    const Real unit = j < joints ? joint_unit(how, j) : Real{1};
    for (int k = 0; k < 6; ++k) c[k] = from[k] * unit / (k < 3 ? how.length_m : Real{1});
    if (task == Task::position) c[3] = c[4] = c[5] = 0;
    if (task == Task::planar) c[2] = c[3] = c[4] = 0;
    if (task == Task::position_axis) {
      const Real along = dot(c + 3, z);
      for (int k = 0; k < 3; ++k) c[3 + k] -= along * z[k];
    }
    for (std::int32_t i = 0; i < joints; ++i) c[6 + i] = 0;
    if (j < joints) c[6 + j] = square_root(damping);
  }
}

/// The least-squares solution of the stack, which has full rank, by Householder reflections. Column j holds something in
/// rows j ... 6 + j only: the damping below has not been reached yet.
inline void solve(Stacked& a, std::int32_t joints, Real* step) {
  for (std::int32_t j = 0; j < joints; ++j) {
    Real* v = a.column[j] + j;
    Real square = 0;
    for (int k = 0; k < 7; ++k) square += v[k] * v[k];
    const Real norm = v[0] > Real{0} ? -square_root(square) : square_root(square);
    const Real scale = Real{1} / (norm * (norm - v[0]));
    v[0] -= norm;
    for (std::int32_t i = j + 1; i <= joints; ++i) {
      Real* c = a.column[i] + j;
      Real sum = 0;
      for (int k = 0; k < 7; ++k) sum += v[k] * c[k];
      sum *= scale;
      for (int k = 0; k < 7; ++k) c[k] -= sum * v[k];
    }
    v[0] = norm;
  }
  for (std::int32_t j = joints - 1; j >= 0; --j) {
    Real sum = a.column[joints][j];
    for (std::int32_t i = j + 1; i < joints; ++i) sum -= a.column[i][j] * step[i];
    step[j] = sum / a.column[j][j];
  }
}

/// The squared error, lengths over the arm's. `met` receives whether the tolerances hold.
inline Real squared_error(const Refinement& how, const Frame<Real>& frame, PoseError& error, bool& met) {
  pose_error(how.target, frame, how.options->task, error);
  met = error.position_m <= how.options->position_tolerance_m &&
        error.rotation_rad <= how.options->rotation_tolerance_rad;
  const Real position = error.position_m / how.length_m;
  return position * position + error.rotation_rad * error.rotation_rad;
}

/// Levenberg-Marquardt from q until the target is met, its damping in proportion to the squared error, so that the end is
/// Newton's method also where the Jacobian is singular (Yamashita, Fukushima 2001). No joint limits; bounded by
/// max_evaluations. Returns whether the target is met; q is then what meets it, else anything.
inline bool refine(const Refinement& how, Real* q) {
  const Arm<Real>& arm = *how.arm;
  constexpr Real longest_step = Real(0.3);  // [rad, or lengths of the arm]
  // Below this the damping is lost against the rounding of the Jacobian.
  constexpr Real least_damping = sizeof(Real) == sizeof(double) ? Real(1e-24) : Real(1e-12);
  // Starting values without a solution end where the error is least: it no longer falls by this part.
  constexpr Real falls = Real(1e-5);
  Frame<Real> frame;
  Jacobian<Real> jacobian;
  PoseError error;
  bool met = false;
  evaluate(arm, q, frame, jacobian);
  Real cost = squared_error(how, frame, error, met);
  Real share = 1;
  int slow = 0;
  bool moved = true;
  for (int n = 1; n < max_evaluations && !met && slow < 8; ++n) {
    if (moved) to_readings(arm, jacobian);
    const Real damping = share * cost > least_damping ? share * cost : least_damping;
    Stacked a;
    stack(how, frame, jacobian, error.vector, damping, a);
    Real step[max_joints];
    solve(a, arm.joint_count, step);
    Real trial[max_joints];
    for (std::int32_t j = 0; j < arm.joint_count; ++j) {
      const Real size = magnitude(step[j]) > longest_step ? (step[j] < Real{0} ? -longest_step : longest_step) : step[j];
      trial[j] = q[j] + size * joint_unit(how, j);
    }
    Frame<Real> there;
    Jacobian<Real> slope;
    PoseError left;
    evaluate(arm, trial, there, slope);
    const Real trial_cost = squared_error(how, there, left, met);
    moved = met || trial_cost < cost;
    if (moved) {
      slow = cost - trial_cost > falls * cost ? 0 : slow + 1;
      for (std::int32_t j = 0; j < arm.joint_count; ++j) q[j] = trial[j];
      frame = there;
      jacobian = slope;
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
