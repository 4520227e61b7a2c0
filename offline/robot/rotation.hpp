// SPDX-License-Identifier: MIT
// Rotations as files and people write them, and as the library keeps them.
#pragma once

#include <array>

#include "mdhcal/arm.hpp"

namespace mdhcal::offline {

/// The unit quaternion w, x, y, z, w >= 0, of a rotation vector [rad] of any finite length.
std::array<double, 4> quaternion_of(const std::array<double, 3>& rotation_vector_rad);

/// The rotation vector [rad], of length at most pi, of a unit quaternion w, x, y, z.
std::array<double, 3> rotation_vector_of(const std::array<double, 4>& quaternion);

/// The frame of a pose.
Frame<double> frame_of(const Pose<double>& pose);

/// The pose of a frame, w >= 0.
Pose<double> pose_of(const Frame<double>& frame);

/// a_T_c = a_T_b b_T_c
Frame<double> compose(const Frame<double>& a_T_b, const Frame<double>& b_T_c);

/// The inverse of a rigid transform.
Frame<double> inverted(const Frame<double>& a_T_b);

/// A point given in b, in a.
std::array<double, 3> transform(const Frame<double>& a_T_b, const std::array<double, 3>& b_p);

}  // namespace mdhcal::offline
