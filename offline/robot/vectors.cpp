// SPDX-License-Identifier: MIT
#include "offline/robot/vectors.hpp"

#include <cmath>

namespace mdhcal::offline {

Vector3 minus(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector3 plus(const Vector3& a, const Vector3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double norm(const Vector3& a) { return std::sqrt(dot(a, a)); }

Vector3 rotate(const Frame<double>& frame, const Vector3& v) {
  const double* r = frame.rotation;
  return {r[0] * v[0] + r[1] * v[1] + r[2] * v[2], r[3] * v[0] + r[4] * v[1] + r[5] * v[2],
          r[6] * v[0] + r[7] * v[1] + r[8] * v[2]};
}

Frame<double> frame_of(const std::array<double, 4>& quaternion, const Vector3& position_m) {
  double length = 0.0;
  for (double c : quaternion) length += c * c;
  length = std::sqrt(length);
  const double w = quaternion[0] / length;
  const double x = quaternion[1] / length;
  const double y = quaternion[2] / length;
  const double z = quaternion[3] / length;
  return {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z),
           1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x),
           1 - 2 * (x * x + y * y)},
          {position_m[0], position_m[1], position_m[2]}};
}

Frame<double> rotation_about(const Vector3& rotation_rad, const Vector3& point_m) {
  const double angle = norm(rotation_rad);
  // Half-angle form: sin(angle/2)/angle stays accurate down to 0, where its limit is 1/2.
  const double half_sinc = angle > 0.0 ? std::sin(0.5 * angle) / angle : 0.5;
  Frame<double> frame = frame_of({std::cos(0.5 * angle), half_sinc * rotation_rad[0], half_sinc * rotation_rad[1],
                                  half_sinc * rotation_rad[2]},
                                 {0.0, 0.0, 0.0});
  const Vector3 turned = rotate(frame, point_m);
  for (std::size_t k = 0; k < 3; ++k) frame.position_m[k] = point_m[k] - turned[k];
  return frame;
}

Vector3 log_of_rotation(const Frame<double>& frame) {
  const Pose<double> pose = pose_of(frame);
  return rotation_vector_of({pose.quaternion[0], pose.quaternion[1], pose.quaternion[2], pose.quaternion[3]});
}

Vector3 inverse_left_jacobian(const Vector3& rotation_rad, const Vector3& turn) {
  const double angle = norm(rotation_rad);
  // 1/angle^2 - (1 + cos)/(2 angle sin), by its series where the terms cancel; the next term is angle^4/30240.
  const double c = angle < 1e-2 ? 1.0 / 12.0 + angle * angle / 720.0
                                : 1.0 / (angle * angle) - (1.0 + std::cos(angle)) / (2.0 * angle * std::sin(angle));
  const Vector3 once = cross(rotation_rad, turn);
  const Vector3 twice = cross(rotation_rad, once);
  Vector3 out{};
  for (std::size_t k = 0; k < 3; ++k) out[k] = turn[k] - 0.5 * once[k] + c * twice[k];
  return out;
}

Frame<double> orthonormal(const Frame<double>& frame) {
  Vector3 x{frame.rotation[0], frame.rotation[1], frame.rotation[2]};
  Vector3 y{frame.rotation[3], frame.rotation[4], frame.rotation[5]};
  const double length = norm(x);
  for (double& c : x) c /= length;
  const double overlap = dot(x, y);
  for (std::size_t k = 0; k < 3; ++k) y[k] -= overlap * x[k];
  const double y_length = norm(y);
  for (double& c : y) c /= y_length;
  const Vector3 z = cross(x, y);
  Frame<double> out = frame;
  for (std::size_t k = 0; k < 3; ++k) {
    out.rotation[k] = x[k];
    out.rotation[3 + k] = y[k];
    out.rotation[6 + k] = z[k];
  }
  return out;
}

}  // namespace mdhcal::offline
