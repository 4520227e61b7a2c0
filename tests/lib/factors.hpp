// SPDX-License-Identifier: MIT
// The truth of forward kinematics: the product of Li 2022, Eq. 1 written factor by factor as 4 x 4 matrices in long double.
#pragma once

#include <cmath>

#include "mdhcal/geometry.hpp"

namespace mdhcal::test {

struct Matrix {
  long double m[4][4];
};

inline Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < 4; ++k) c.m[i][j] += a.m[i][k] * b.m[k][j];
    }
  }
  return c;
}

inline Matrix shift(long double x, long double z) { return {{{1, 0, 0, x}, {0, 1, 0, 0}, {0, 0, 1, z}, {0, 0, 0, 1}}}; }

/// About x (0), y (1) or z (2).
inline Matrix turn(int axis, long double angle) {
  Matrix t = shift(0, 0);
  const int a = (axis + 1) % 3;
  const int b = (axis + 2) % 3;
  t.m[a][a] = t.m[b][b] = std::cos(angle);
  t.m[b][a] = std::sin(angle);
  t.m[a][b] = -t.m[b][a];
  return t;
}

/// base_T_flange of a geometry whose last_T_flange is the identity.
template <class Real>
Matrix product_of_factors(const Geometry& g, const Real* q) {
  Matrix truth = shift(0, 0);
  for (int i = 0; i < g.joint_count; ++i) {
    long double coordinate = static_cast<long double>(g.joint[i].sign) * static_cast<long double>(q[i]);
    for (int j = 0; j < g.joint_count; ++j) {
      coordinate += static_cast<long double>(g.joint[i].coupling[j]) * static_cast<long double>(q[j]);
    }
    const bool slides = g.joint[i].kind == JointKind::prismatic;
    const Link& l = g.link[i];
    truth = product(truth, turn(0, static_cast<long double>(l.alpha_rad)));
    truth = product(truth, shift(static_cast<long double>(l.a_m), 0));
    truth = product(truth, turn(2, static_cast<long double>(l.theta_rad) + (slides ? 0 : coordinate)));
    truth = product(truth, shift(0, static_cast<long double>(l.d_m) + (slides ? coordinate : 0)));
    truth = product(truth, turn(1, static_cast<long double>(l.beta_rad)));
  }
  return truth;
}

/// How far a pose is from a matrix: the position [m], and the angle, from the Frobenius norm of the difference of the
/// rotations (2 sqrt(2) sin(angle / 2)) [rad].
struct Distance {
  double position_m, rotation_rad;
};

template <class Real>
Distance distance(const Matrix& truth, const Pose<Real>& pose) {
  long double c[4];
  long double norm = 0;
  for (int k = 0; k < 4; ++k) {
    c[k] = static_cast<long double>(pose.quaternion[k]);
    norm += c[k] * c[k];
  }
  const long double w = c[0], x = c[1], y = c[2], z = c[3];
  const long double r[3][3] = {{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
                               {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
                               {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}};
  long double position = 0;
  long double rotation = 0;
  for (int i = 0; i < 3; ++i) {
    const long double p = truth.m[i][3] - static_cast<long double>(pose.position_m[i]);
    position += p * p;
    for (int j = 0; j < 3; ++j) rotation += (truth.m[i][j] - r[i][j] / norm) * (truth.m[i][j] - r[i][j] / norm);
  }
  return {static_cast<double>(std::sqrt(position)), static_cast<double>(std::sqrt(rotation / 2))};
}

}  // namespace mdhcal::test
