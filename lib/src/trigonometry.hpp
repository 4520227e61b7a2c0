// SPDX-License-Identifier: MIT
// Private to lib/src.
#pragma once

#include "mdhcal/status.hpp"

namespace mdhcal {

/// Sine and cosine of an angle [rad], the same bits on every machine. Defined in both precisions.
void sin_cos(double angle_rad, double& sine, double& cosine) noexcept;
void sin_cos(float angle_rad, float& sine, float& cosine) noexcept;

}  // namespace mdhcal
