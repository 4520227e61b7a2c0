// SPDX-License-Identifier: MIT
#include "offline/robot/rotation.hpp"

#include <cmath>
#include <cstddef>

namespace mdhcal::offline {

std::array<double, 4> quaternion_of(const std::array<double, 3>& rotation_vector_rad) {
  const auto& v = rotation_vector_rad;
  const double angle = std::hypot(v[0], v[1], v[2]);
  // sin(angle / 2) / angle; below 1e-8 the next term of the series is beyond double precision.
  const double scale = angle < 1e-8 ? 0.5 : std::sin(0.5 * angle) / angle;
  std::array<double, 4> q{std::cos(0.5 * angle), scale * v[0], scale * v[1], scale * v[2]};
  if (q[0] < 0) {
    for (double& c : q) c = -c;
  }
  return q;
}

std::array<double, 3> rotation_vector_of(const std::array<double, 4>& quaternion) {
  const double sign = quaternion[0] < 0 ? -1.0 : 1.0;
  const double sine = std::hypot(quaternion[1], quaternion[2], quaternion[3]);
  // angle / sin(angle / 2); near zero the limit is 2.
  const double scale = sine < 1e-12 ? 2.0 : 2.0 * std::atan2(sine, sign * quaternion[0]) / sine;
  return {sign * scale * quaternion[1], sign * scale * quaternion[2], sign * scale * quaternion[3]};
}

Frame<double> frame_of(const Pose<double>& pose) {
  const auto& q = pose.quaternion;
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  return {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
           2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
           2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)},
          {pose.position_m[0], pose.position_m[1], pose.position_m[2]}};
}

Pose<double> pose_of(const Frame<double>& frame) {
  const auto& r = frame.rotation;
  // The largest of the four squared components leads, so that nothing cancels (Shepperd 1978).
  const std::array<double, 4> square{1 + r[0] + r[4] + r[8], 1 + r[0] - r[4] - r[8], 1 - r[0] + r[4] - r[8],
                                     1 - r[0] - r[4] + r[8]};
  std::size_t lead = 0;
  for (std::size_t k = 1; k < 4; ++k) {
    if (square[k] > square[lead]) lead = k;
  }
  std::array<double, 4> q{};
  const double wx = r[7] - r[5], wy = r[2] - r[6], wz = r[3] - r[1];
  const double xy = r[1] + r[3], xz = r[2] + r[6], yz = r[5] + r[7];
  switch (lead) {
    case 0: q = {square[0], wx, wy, wz}; break;
    case 1: q = {wx, square[1], xy, xz}; break;
    case 2: q = {wy, xy, square[2], yz}; break;
    default: q = {wz, xz, yz, square[3]}; break;
  }
  double norm = 0;
  for (const double c : q) norm += c * c;
  norm = std::sqrt(norm);
  if (q[0] < 0) norm = -norm;
  Pose<double> pose{};
  for (std::size_t k = 0; k < 4; ++k) pose.quaternion[k] = q[k] / norm;
  for (std::size_t k = 0; k < 3; ++k) pose.position_m[k] = frame.position_m[k];
  return pose;
}

Frame<double> compose(const Frame<double>& a_T_b, const Frame<double>& b_T_c) {
  Frame<double> c{};
  for (std::size_t row = 0; row < 3; ++row) {
    const double* r = a_T_b.rotation + 3 * row;
    for (std::size_t col = 0; col < 3; ++col) {
      c.rotation[3 * row + col] =
          r[0] * b_T_c.rotation[col] + r[1] * b_T_c.rotation[3 + col] + r[2] * b_T_c.rotation[6 + col];
    }
    c.position_m[row] = a_T_b.position_m[row] + r[0] * b_T_c.position_m[0] + r[1] * b_T_c.position_m[1] +
                        r[2] * b_T_c.position_m[2];
  }
  return c;
}

Frame<double> inverted(const Frame<double>& a_T_b) {
  Frame<double> b{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t col = 0; col < 3; ++col) {
      b.rotation[3 * row + col] = a_T_b.rotation[3 * col + row];
      b.position_m[row] -= a_T_b.rotation[3 * col + row] * a_T_b.position_m[col];
    }
  }
  return b;
}

std::array<double, 3> transform(const Frame<double>& a_T_b, const std::array<double, 3>& b_p) {
  std::array<double, 3> a_p{};
  for (std::size_t row = 0; row < 3; ++row) {
    const double* r = a_T_b.rotation + 3 * row;
    a_p[row] = a_T_b.position_m[row] + r[0] * b_p[0] + r[1] * b_p[1] + r[2] * b_p[2];
  }
  return a_p;
}

}  // namespace mdhcal::offline
