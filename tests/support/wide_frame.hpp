// SPDX-License-Identifier: MIT
// The plain 4x4 product in long double: the truth that forward kinematics is held against, derived apart from the library.
#pragma once

#include <array>
#include <cmath>

#include "mdhcal/arm.hpp"

namespace mdhcal::tests {

/// A homogeneous matrix in long double.
struct WideFrame {
  std::array<std::array<long double, 4>, 4> m{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
};

inline WideFrame operator*(const WideFrame& a, const WideFrame& b) {
  WideFrame c;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      c.m[i][j] = 0;
      for (std::size_t k = 0; k < 4; ++k) c.m[i][j] += a.m[i][k] * b.m[k][j];
    }
  }
  return c;
}

inline WideFrame wide_rot_x(long double angle) {
  WideFrame t;
  t.m[1][1] = t.m[2][2] = std::cos(angle);
  t.m[2][1] = std::sin(angle);
  t.m[1][2] = -t.m[2][1];
  return t;
}

inline WideFrame wide_rot_y(long double angle) {
  WideFrame t;
  t.m[0][0] = t.m[2][2] = std::cos(angle);
  t.m[0][2] = std::sin(angle);
  t.m[2][0] = -t.m[0][2];
  return t;
}

inline WideFrame wide_rot_z(long double angle) {
  WideFrame t;
  t.m[0][0] = t.m[1][1] = std::cos(angle);
  t.m[1][0] = std::sin(angle);
  t.m[0][1] = -t.m[1][0];
  return t;
}

inline WideFrame wide_translation(long double x, long double y, long double z) {
  WideFrame t;
  t.m[0][3] = x;
  t.m[1][3] = y;
  t.m[2][3] = z;
  return t;
}

/// The rotation of a quaternion w, x, y, z, divided by its norm.
inline WideFrame wide(const Pose<double>& pose) {
  const long double w = pose.quaternion[0], x = pose.quaternion[1], y = pose.quaternion[2], z = pose.quaternion[3];
  const long double s = 2 / (w * w + x * x + y * y + z * z);
  WideFrame t;
  t.m[0] = {1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y), pose.position_m[0]};
  t.m[1] = {s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x), pose.position_m[1]};
  t.m[2] = {s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y), pose.position_m[2]};
  return t;
}

inline WideFrame wide(const Frame<double>& frame) {
  WideFrame t;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) t.m[i][j] = static_cast<long double>(frame.rotation[3 * i + j]);
    t.m[i][3] = static_cast<long double>(frame.position_m[i]);
  }
  return t;
}

/// base_T_flange of a geometry at the readings q, factor by factor (Li 2022, Eq. 1 and 3).
inline WideFrame wide_forward(const Geometry& g, const double* q) {
  WideFrame t;
  const auto count = static_cast<std::size_t>(g.joint_count);
  for (std::size_t i = 0; i < count; ++i) {
    const Link& link = g.link[i];
    long double coordinate = static_cast<long double>(g.joint[i].sign) * static_cast<long double>(q[i]);
    for (std::size_t j = 0; j < count; ++j) {
      coordinate += static_cast<long double>(g.joint[i].coupling[j]) * static_cast<long double>(q[j]);
    }
    const bool slides = g.joint[i].kind == JointKind::prismatic;
    t = t * wide_rot_x(static_cast<long double>(link.alpha_rad)) *
        wide_translation(static_cast<long double>(link.a_m), 0, 0) *
        wide_rot_z(static_cast<long double>(link.theta_rad) + (slides ? 0.0L : coordinate)) *
        wide_translation(0, 0, static_cast<long double>(link.d_m) + (slides ? coordinate : 0.0L)) *
        wide_rot_y(static_cast<long double>(link.beta_rad));
  }
  return t * wide(g.last_T_flange);
}

/// Distance between the origins [m].
inline double position_difference(const WideFrame& truth, const Pose<double>& pose) {
  long double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const long double d = truth.m[i][3] - static_cast<long double>(pose.position_m[i]);
    sum += d * d;
  }
  return static_cast<double>(std::sqrt(sum));
}

/// The largest difference of the rotation matrices' entries [1].
inline double rotation_difference(const WideFrame& truth, const Pose<double>& pose) {
  const WideFrame other = wide(pose);
  long double worst = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) worst = std::max(worst, std::abs(truth.m[i][j] - other.m[i][j]));
  }
  return static_cast<double>(worst);
}

}  // namespace mdhcal::tests
