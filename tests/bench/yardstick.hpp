// SPDX-License-Identifier: MIT
// The yardstick: forward kinematics, Jacobian and warm inverse as a straightforward fixed-size Eigen loop writes them,
// with the library's sine and cosine. Damped least squares with a QR of the Jacobian, a fresh one each iteration.
#pragma once

#include <Eigen/Dense>

#include "lib/src/number/trigonometry.hpp"
#include "mdhcal/geometry.hpp"

namespace mdhcal::bench {

struct Yardstick {
  Geometry geometry;
  double sin_alpha[6], cos_alpha[6], sin_beta[6], cos_beta[6];

  explicit Yardstick(const Geometry& g) : geometry(g) {
    for (int i = 0; i < 6; ++i) {
      sin_cos(g.link[i].alpha_rad, sin_alpha[i], cos_alpha[i]);
      sin_cos(g.link[i].beta_rad, sin_beta[i], cos_beta[i]);
    }
  }

  Eigen::Matrix4d link(int i, double q) const {
    const Link& l = geometry.link[i];
    double s = 0;
    double c = 1;
    sin_cos(q + l.theta_rad, s, c);
    const double sa = sin_alpha[i], ca = cos_alpha[i], sb = sin_beta[i], cb = cos_beta[i];
    Eigen::Matrix4d a;
    a << c * cb, -s, c * sb, l.a_m,                                      //
        ca * s * cb + sa * sb, ca * c, ca * s * sb - sa * cb, -l.d_m * sa,  //
        sa * s * cb - ca * sb, sa * c, sa * s * sb + ca * cb, l.d_m * ca,   //
        0, 0, 0, 1;
    return a;
  }

  Eigen::Matrix4d forward(const double* q) const {
    Eigen::Matrix4d t = Eigen::Matrix4d::Identity();
    for (int i = 0; i < 6; ++i) t = t * link(i, q[i]);
    return t;
  }

  Eigen::Matrix4d forward(const double* q, Eigen::Matrix<double, 6, 6>& jacobian) const {
    Eigen::Matrix4d t = Eigen::Matrix4d::Identity();
    Eigen::Vector3d z[6];
    Eigen::Vector3d p[6];
    for (int i = 0; i < 6; ++i) {
      // The axis is the z axis before Rot_y.
      const Eigen::Vector3d fixed(0, -sin_alpha[i], cos_alpha[i]);
      z[i] = t.topLeftCorner<3, 3>() * fixed;
      t = t * link(i, q[i]);
      p[i] = t.topRightCorner<3, 1>();
    }
    for (int i = 0; i < 6; ++i) {
      jacobian.col(i).head<3>() = z[i].cross(t.topRightCorner<3, 1>() - p[i]);
      jacobian.col(i).tail<3>() = z[i];
    }
    return t;
  }

  /// Returns the number of iterations, or -1.
  int inverse(const Eigen::Matrix4d& target, double* q, double tolerance) const {
    for (int iteration = 0; iteration < 20; ++iteration) {
      Eigen::Matrix<double, 6, 6> jacobian;
      const Eigen::Matrix4d t = forward(q, jacobian);
      Eigen::Matrix<double, 6, 1> error;
      error.head<3>() = target.topRightCorner<3, 1>() - t.topRightCorner<3, 1>();
      const Eigen::Matrix3d turn = target.topLeftCorner<3, 3>() * t.topLeftCorner<3, 3>().transpose();
      error.tail<3>() = 0.5 * Eigen::Vector3d(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
      if (error.head<3>().norm() <= tolerance && error.tail<3>().norm() <= tolerance) return iteration;
      const Eigen::Matrix<double, 6, 1> step = jacobian.householderQr().solve(error);
      for (int i = 0; i < 6; ++i) q[i] += step[i];
    }
    return -1;
  }
};

}  // namespace mdhcal::bench
