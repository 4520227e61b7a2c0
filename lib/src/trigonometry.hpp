// SPDX-License-Identifier: MIT
// Private to lib/src.
#pragma once

#include "mdhcal/status.hpp"

namespace mdhcal {

/// Sine and cosine of an angle [rad], the same bits on every machine. Defined in both precisions.
void sin_cos(double angle_rad, double& sine, double& cosine) noexcept;
void sin_cos(float angle_rad, float& sine, float& cosine) noexcept;

/// The angle of the point (x, y) [rad], in [-pi, pi]. Same machines, both precisions.
double arc_tangent(double y, double x) noexcept;
float arc_tangent(float y, float x) noexcept;

}  // namespace mdhcal
