// SPDX-License-Identifier: MIT
// Private to lib/src.
#pragma once

#include "mdhcal/status.hpp"

namespace mdhcal {

/// The largest angle whose sine and cosine are defined [rad]: beyond every joint coordinate that valid readings and
/// couplings can give (1000 rad, seven couplings of 100).
inline constexpr double max_sin_cos_rad = 1.0e6;

/// Sine and cosine of an angle [rad], the same bits on every machine: only + - * and one conversion to an integer.
/// At most 1 ulp for |angle| <= max_sin_cos_rad; beyond it, and for NaN, both are NaN.
void sin_cos(double angle_rad, double& sine, double& cosine) noexcept;
void sin_cos(float angle_rad, float& sine, float& cosine) noexcept;

/// The angle of the point (x, y) [rad] in [-pi, pi], with / besides; 0 for the origin, NaN if a coordinate is.
/// At most 1 ulp for coordinates that are 0 or between 1e-100 and 1e100 (float 1e-12 and 1e12) in size.
double arc_tangent(double y, double x) noexcept;
float arc_tangent(float y, float x) noexcept;

/// The angle in [0, pi] with the given cosine; arguments beyond +-1 count as +-1.
double arc_cosine(double cosine) noexcept;
float arc_cosine(float cosine) noexcept;

}  // namespace mdhcal
