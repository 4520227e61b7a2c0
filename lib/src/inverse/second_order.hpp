// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. The second derivative of the flange's pose by the readings.
#pragma once

#include "arm/vector.hpp"
#include "inverse/task.hpp"

namespace mdhcal {
namespace {

/// What an uncoupled joint coordinate moves by a unit of its unit-free reading.
inline Real reading_unit(const Goal& goal, std::int32_t i) { return goal.arm->link[i].sign * joint_unit(goal, i); }

/// A step's motion of each joint coordinate from the unit-free readings d.
inline void coordinate_motion(const Goal& goal, const Real* d, Real* motion) {
  const Arm<Real>& arm = *goal.arm;
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    if (arm.coupled == 0) {
      motion[i] = reading_unit(goal, i) * d[i];
      continue;
    }
    motion[i] = 0;
    for (std::int32_t j = 0; j < arm.joint_count; ++j) motion[i] += arm.map[i][j] * joint_unit(goal, j) * d[j];
  }
}

/// What the Jacobian's change along the coordinates' motion a does to their motion b: the displacement of the flange is
/// J d + change(d, d) / 2 but for the third order, and after d it moves by J b + change(d, b). Columns: those at the
/// beginning, c_j the shift and z_j the turn of the flange by coordinate j; two turns about z_i, z_j are one about their sum and
/// half of z_i x z_j (Baker, Campbell, Hausdorff):
/// shift  sum_j (sum_{i<j} a_i z_i x c_j) b_j + (sum_{i<=j} b_i z_i x c_j) a_j,  turn  sum_j (sum_{i<j} a_i z_i) x z_j b_j.
[[gnu::noinline]] void change_of_motion(const Jacobian<Real>& coordinates, std::int32_t joints, const Real* a, const Real* b,
                                        Real* change) {
  Vector shift{0, 0, 0}, turn{0, 0, 0}, turned_a{0, 0, 0}, turned_b{0, 0, 0};
  for (std::int32_t j = 0; j < joints; ++j) {
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

/// x(d, d), the components of the task: the flange moves by J d + x(d, d) / 2 + O(d^3).
[[maybe_unused, gnu::noinline]] void second_order(const Goal& goal, const Look& look, Real rotation_weight, const Real* d, Real* x) {
  Real motion[max_joints], change[6];
  coordinate_motion(goal, d, motion);
  change_of_motion(look.coordinates, goal.arm->joint_count, motion, motion, change);
  to_task(goal, look.frame, rotation_weight, change, x);
}

/// Adds - r . x''_ij by the unit-free readings that may move, in their order, to the lower triangle of `sum`, row i of it
/// sum[i][0] ... sum[i][i - 1] and sum[i][7]; place[j] < 0: reading j may not. r in components of the task. With
/// g_j = c_j x f + z_j x m / 2 of the force f and moment m that r is, the entry of coordinates i < j is - z_i . g_j.
[[maybe_unused, gnu::noinline]] void add_residual_curvature(const Goal& goal, const Look& look, Real rotation_weight, const Real* r,
                                     const std::int8_t* place, Real (*sum)[max_joints]) {
  const Arm<Real>& arm = *goal.arm;
  const std::int32_t joints = arm.joint_count;
  Real weighted[6], f[6];
  const std::int32_t turn = first_turn(goal.options->task);
  for (std::int32_t i = 0; i < 6; ++i) weighted[i] = i < turn ? r[i] : rotation_weight * r[i];
  from_task(goal, look.frame, weighted, f);
  const Vector force{f[0], f[1], f[2]}, moment{Real(0.5) * f[3], Real(0.5) * f[4], Real(0.5) * f[5]};
  for (std::int32_t j = 0; j < joints; ++j) {
    const Real* c = look.coordinates.column[j];
    const Vector g = cross(Vector{c[0], c[1], c[2]}, force) + cross(Vector{c[3], c[4], c[5]}, moment);
    for (std::int32_t i = 0; i <= j; ++i) {
      const Real* z = look.coordinates.column[i] + 3;
      const Real entry = -inner(Vector{z[0], z[1], z[2]}, g);
      if (arm.coupled == 0) {
        if (place[i] < 0 || place[j] < 0) continue;
        const auto row = static_cast<std::size_t>(place[j]);
        sum[row][i == j ? max_joints - 1 : static_cast<std::size_t>(place[i])] += entry * reading_unit(goal, i) * reading_unit(goal, j);
        continue;
      }
      for (std::int32_t l = 0; l < joints; ++l) {
        for (std::int32_t k = 0; k <= l; ++k) {
          if (place[k] < 0 || place[l] < 0) continue;
          const Real both =
              i == j ? arm.map[i][k] * arm.map[i][l] : arm.map[i][k] * arm.map[j][l] + arm.map[j][k] * arm.map[i][l];
          const auto row = static_cast<std::size_t>(place[l]);
          sum[row][k == l ? max_joints - 1 : static_cast<std::size_t>(place[k])] += entry * both * joint_unit(goal, k) * joint_unit(goal, l);
        }
      }
    }
  }
}

}  // namespace
}  // namespace mdhcal
