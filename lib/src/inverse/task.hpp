// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. The part of a pose that a task asks for, and its Jacobian.
#pragma once

#include "inverse/box_least_squares.hpp"
#include "inverse/tick.hpp"

namespace mdhcal {
namespace {

/// How many components the error of a task has.
inline std::int32_t task_rank(Task task) {
  switch (task) {
    case Task::pose: return 6;
    case Task::position_axis: return 5;
    case Task::position:
    case Task::planar: return 3;
  }
  return 6;
}

/// The first component that is an angle.
inline std::int32_t first_turn(Task task) { return task == Task::planar ? 2 : 3; }

/// What turns about the base's x and y axes do to the direction, seen from above, of the flange's x axis: that of a
/// tilted axis turns by w_z - tilt . (w_x, w_y).
inline void tilt_of_x(const Frame<Real>& frame, Real* tilt) {
  const Real* r = frame.rotation;
  const Real flat = r[0] * r[0] + r[3] * r[3];
  // An upright axis has no direction; any tilt will do.
  const Real scale = flat > Real(1e-6) ? r[6] / flat : Real{0};
  tilt[0] = scale * r[0];
  tilt[1] = scale * r[3];
}

/// The components that the task asks for of a displacement of the flange: lengths over the arm's, angles times
/// `rotation_weight`; zeros up to six.
inline void to_task(const Goal& goal, const Frame<Real>& frame, Real rotation_weight, const Real* displacement,
                    Real* component) {
  const Real per_length = Real{1} / goal.length_m;
  const Real* turn = displacement + 3;
  component[0] = displacement[0] * per_length;
  component[1] = displacement[1] * per_length;
  component[2] = displacement[2] * per_length;
  switch (goal.options->task) {
    case Task::pose:
      for (int k = 0; k < 3; ++k) component[3 + k] = turn[k] * rotation_weight;
      return;
    case Task::position_axis:
      component[5] = 0;
      // The z axis turns about the flange's x and y axes.
      for (int k = 0; k < 2; ++k) {
        const Real* r = frame.rotation + k;
        component[3 + k] = (r[0] * turn[0] + r[3] * turn[1] + r[6] * turn[2]) * rotation_weight;
      }
      return;
    case Task::planar: {
      Real tilt[2];
      tilt_of_x(frame, tilt);
      component[2] = (turn[2] - (tilt[0] * turn[0] + tilt[1] * turn[1])) * rotation_weight;
      for (int k = 3; k < 6; ++k) component[k] = 0;
      return;
    }
    case Task::position:
      for (int k = 3; k < 6; ++k) component[k] = 0;
      return;
  }
}

/// The linear functional of displacements that takes the even components' product with u: the transpose of to_task().
inline void from_task(const Goal& goal, const Frame<Real>& frame, const Real* u, Real* functional) {
  const Real per_length = Real{1} / goal.length_m;
  for (int k = 0; k < 3; ++k) functional[k] = u[k] * per_length;
  for (int k = 3; k < 6; ++k) functional[k] = 0;
  switch (goal.options->task) {
    case Task::pose:
      for (int k = 3; k < 6; ++k) functional[k] = u[k];
      return;
    case Task::position_axis:
      for (int k = 0; k < 3; ++k) {
        functional[3 + k] = frame.rotation[3 * k] * u[3] + frame.rotation[3 * k + 1] * u[4];
      }
      return;
    case Task::planar:
      tilt_of_x(frame, functional + 3);
      functional[2] = 0;
      functional[3] *= -u[2];
      functional[4] *= -u[2];
      functional[5] = u[2];
      return;
    case Task::position: return;
  }
}

/// The task's Jacobian by unit-free readings, from the one by joint coordinate.
inline void linearise(const Goal& goal, const Frame<Real>& frame, const Jacobian<Real>& coordinates,
                      Real rotation_weight, BoxProblem& problem) {
  const Arm<Real>& arm = *goal.arm;
  for (std::int32_t j = 0; j < arm.joint_count; ++j) {
    Real column[6];
    reading_column(arm, coordinates, j, joint_unit(goal, j), column);
    to_task(goal, frame, rotation_weight, column, problem.column[j]);
  }
}

}  // namespace
}  // namespace mdhcal
