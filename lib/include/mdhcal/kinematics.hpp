// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/arm.hpp"

namespace mdhcal {

/// Geometric Jacobian of the flange with respect to the readings, in the base frame: column j holds the velocity of
/// the flange origin [m/rad, or m/m if joint j slides] and the angular velocity [rad/rad, or rad/m].
template <class Real>
struct Jacobian {
  Real column[max_joints][6];
};

/// base_T_flange at the readings q[joint_count] ([rad] or [m]). Valid range: |reading| <= max_reading.
/// Returns ok, or bad_input (a reading is not finite or out of range; the output is untouched). (Li 2022, Eq. 1, 3)
Status forward(const Arm<double>& arm, const double* q, Pose<double>& base_T_flange) noexcept;
Status forward(const Arm<float>& arm, const float* q, Pose<float>& base_T_flange) noexcept;

/// forward() and the Jacobian in one pass. Same errors.
Status forward(const Arm<double>& arm, const double* q, Pose<double>& base_T_flange,
               Jacobian<double>& jacobian) noexcept;
Status forward(const Arm<float>& arm, const float* q, Pose<float>& base_T_flange, Jacobian<float>& jacobian) noexcept;

/// The frames along the arm: frames[i] = base_T_i = A_1 ... A_i for i = 0 (identity) ... joint_count, then
/// frames[joint_count + 1] = base_T_flange. `frames` has room for max_joints + 2. Same errors as forward(), which
/// computes the same bits. What identification differentiates around.
Status link_frames(const Arm<double>& arm, const double* q, Frame<double>* frames) noexcept;
Status link_frames(const Arm<float>& arm, const float* q, Frame<float>* frames) noexcept;

}  // namespace mdhcal
