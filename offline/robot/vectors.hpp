// SPDX-License-Identifier: MIT
// What identification needs of small vectors and rotations beyond robot/rotation.hpp. Lengths [m], angles [rad].
#pragma once

#include <array>

#include "mdhcal/arm.hpp"
#include "offline/robot/robot.hpp"
#include "offline/robot/rotation.hpp"

namespace mdhcal::offline {

Vector3 minus(const Vector3& a, const Vector3& b);
Vector3 plus(const Vector3& a, const Vector3& b);
Vector3 cross(const Vector3& a, const Vector3& b);
double dot(const Vector3& a, const Vector3& b);
double norm(const Vector3& a);

Vector3 rotate(const Frame<double>& frame, const Vector3& v);  ///< rotation only

/// From a quaternion w, x, y, z (normalised here) and a position.
Frame<double> frame_of(const std::array<double, 4>& quaternion, const Vector3& position_m);

/// The rotation by the rotation vector that leaves `point_m` in place (Rodrigues).
Frame<double> rotation_about(const Vector3& rotation_rad, const Vector3& point_m);
/// The rotation vector of a frame's rotation, of length in [0, pi].
Vector3 log_of_rotation(const Frame<double>& frame);
/// d log(exp(w) R)/dw at w = 0, applied to `turn`, where log R = rotation_rad.
Vector3 inverse_left_jacobian(const Vector3& rotation_rad, const Vector3& turn);
/// The frame with its rotation's rounding drift removed (Gram-Schmidt on the rows).
Frame<double> orthonormal(const Frame<double>& frame);

}  // namespace mdhcal::offline
