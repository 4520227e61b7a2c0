// SPDX-License-Identifier: MIT
// Comparing poses and joints in the tests of lib.
#pragma once

#include <algorithm>

#include "mdhcal/kinematics.hpp"
#include "tests/lib/arms.hpp"

namespace mdhcal::test {

/// Distance of two poses' positions [m].
template <class Real>
Real position_distance(const Pose<Real>& a, const Pose<Real>& b) {
  Real square = 0;
  for (int k = 0; k < 3; ++k) square += (a.position_m[k] - b.position_m[k]) * (a.position_m[k] - b.position_m[k]);
  return std::sqrt(square);
}

/// Angle between two poses, for small angles [rad]: twice the difference of the quaternions, whose signs may differ.
template <class Real>
Real small_angle(const Pose<Real>& a, const Pose<Real>& b) {
  Real same = 0;
  Real opposite = 0;
  for (int k = 0; k < 4; ++k) {
    same += (a.quaternion[k] - b.quaternion[k]) * (a.quaternion[k] - b.quaternion[k]);
    opposite += (a.quaternion[k] + b.quaternion[k]) * (a.quaternion[k] + b.quaternion[k]);
  }
  return Real{2} * std::sqrt(std::min(same, opposite));
}

/// Largest joint difference, modulo full turns [rad].
inline double turn_distance(const double* a, const double* b, int joints) {
  double largest = 0;
  for (int i = 0; i < joints; ++i) largest = std::max(largest, std::fabs(std::remainder(a[i] - b[i], 2 * pi)));
  return largest;
}

}  // namespace mdhcal::test
