// SPDX-License-Identifier: MIT
#include "trigonometry.hpp"

#include <cmath>

#include "real.hpp"

namespace mdhcal {

void sin_cos(Real angle_rad, Real& sine, Real& cosine) noexcept {
  sine = std::sin(angle_rad);
  cosine = std::cos(angle_rad);
}

Real arc_tangent(Real y, Real x) noexcept { return std::atan2(y, x); }

}  // namespace mdhcal
