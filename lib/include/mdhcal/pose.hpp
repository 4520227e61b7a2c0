// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/geometry.hpp"
#include "mdhcal/status.hpp"

namespace mdhcal {

/// No rotation, no translation.
template <class Real>
constexpr Pose<Real> identity_pose() noexcept {
  return {{1, 0, 0, 0}, {0, 0, 0}};
}

/// a_T_c = a_T_b b_T_c. Returns ok, or bad_input (a number is not finite, a coordinate is over 1e9 m, or a quaternion is not
/// a unit one to 1e-6, float 1e-5; a_T_c untouched). a_T_c may be one of the two.
Status multiply(const Pose<double>& a_T_b, const Pose<double>& b_T_c, Pose<double>& a_T_c) noexcept;
Status multiply(const Pose<float>& a_T_b, const Pose<float>& b_T_c, Pose<float>& a_T_c) noexcept;

/// b_T_a, the inverse of a_T_b. Errors as of multiply(). b_T_a may be a_T_b.
Status invert(const Pose<double>& a_T_b, Pose<double>& b_T_a) noexcept;
Status invert(const Pose<float>& a_T_b, Pose<float>& b_T_a) noexcept;

}  // namespace mdhcal
