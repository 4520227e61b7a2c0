// SPDX-License-Identifier: MIT
// The yardsticks: a warm inverse of six turning joints as a plain loop writes it, in fixed-size arrays, without limits,
// statuses or inputs that could be wrong, with the library's sine and cosine. Newton's method by an LU of the Jacobian, a
// fresh one each iteration; and Levenberg-Marquardt by a Cholesky factorization of the normal equations, the damping by
// Nielsen's rule (Madsen, Nielsen, Tingleff 2004, Algorithm 3.16).
#pragma once

#include <cmath>
#include <utility>

#include "lib/src/number/trigonometry.hpp"
#include "mdhcal/geometry.hpp"

namespace mdhcal::bench {

class PlainLoops {
 public:
  struct Frame34 {
    double r[9], p[3];
  };

  explicit PlainLoops(const Geometry& g) : geometry_(g) {
    for (int i = 0; i < 6; ++i) {
      sin_cos(g.link[i].alpha_rad, sin_alpha_[i], cos_alpha_[i]);
      sin_cos(g.link[i].beta_rad, sin_beta_[i], cos_beta_[i]);
    }
  }

  void forward(const double* q, Frame34& t, double (*column)[6]) const {
    double axis[6][3], point[6][3];
    t = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    for (int i = 0; i < 6; ++i) {
      const Link& l = geometry_.link[i];
      double s = 0;
      double c = 1;
      sin_cos(q[i] + l.theta_rad, s, c);
      for (int k = 0; k < 3; ++k) {
        double* r = t.r + 3 * k;
        const double x = r[0];
        const double y = cos_alpha_[i] * r[1] + sin_alpha_[i] * r[2];
        const double z = cos_alpha_[i] * r[2] - sin_alpha_[i] * r[1];
        t.p[k] += l.a_m * x + l.d_m * z;
        const double turned = c * x + s * y;
        r[0] = cos_beta_[i] * turned - sin_beta_[i] * z;
        r[1] = c * y - s * x;
        r[2] = sin_beta_[i] * turned + cos_beta_[i] * z;
        axis[i][k] = z;
        point[i][k] = t.p[k];
      }
    }
    for (int i = 0; i < 6; ++i) {
      const double x = t.p[0] - point[i][0], y = t.p[1] - point[i][1], z = t.p[2] - point[i][2];
      const double* a = axis[i];
      column[i][0] = a[1] * z - a[2] * y;
      column[i][1] = a[2] * x - a[0] * z;
      column[i][2] = a[0] * y - a[1] * x;
      for (int k = 0; k < 3; ++k) column[i][3 + k] = a[k];
    }
  }

  /// Position, and the vector of half the differences across the diagonal of target R^T, whose length is the sine.
  static void error_of(const Frame34& target, const Frame34& t, double* e) {
    for (int k = 0; k < 3; ++k) {
      e[k] = target.p[k] - t.p[k];
      e[3 + k] = 0;
    }
    for (int k = 0; k < 3; ++k) {
      const double a[3] = {t.r[k], t.r[3 + k], t.r[6 + k]};
      const double b[3] = {target.r[k], target.r[3 + k], target.r[6 + k]};
      e[3] += 0.5 * (a[1] * b[2] - a[2] * b[1]);
      e[4] += 0.5 * (a[2] * b[0] - a[0] * b[2]);
      e[5] += 0.5 * (a[0] * b[1] - a[1] * b[0]);
    }
  }

  static bool met(const double* e, double tolerance) {
    return e[0] * e[0] + e[1] * e[1] + e[2] * e[2] <= tolerance * tolerance &&
           e[3] * e[3] + e[4] * e[4] + e[5] * e[5] <= tolerance * tolerance;
  }

  bool newton(const Frame34& target, double* q, double tolerance) const {
    for (int iteration = 0; iteration < 20; ++iteration) {
      Frame34 t;
      double column[6][6], e[6];
      forward(q, t, column);
      error_of(target, t, e);
      if (met(e, tolerance)) return true;
      if (!solve_lu(column, e)) return false;
      for (int i = 0; i < 6; ++i) q[i] += e[i];
    }
    return false;
  }

  bool levenberg(const Frame34& target, double* q, double tolerance) const {
    Frame34 t;
    double column[6][6], e[6];
    forward(q, t, column);
    error_of(target, t, e);
    double cost = square(e);
    double damping = 1e-3 * cost;
    double growth = 2;
    for (int iteration = 0; iteration < 40 && !met(e, tolerance); ++iteration) {
      double step[6], slope[6], trial[6], trial_e[6], trial_column[6][6];
      normal_step(column, e, damping, slope, step);
      for (int i = 0; i < 6; ++i) trial[i] = q[i] + step[i];
      forward(trial, t, trial_column);
      error_of(target, t, trial_e);
      const double trial_cost = square(trial_e);
      double promise = 0;
      for (int i = 0; i < 6; ++i) promise += step[i] * (damping * step[i] + slope[i]);
      if (trial_cost < cost) {
        const double gain = 2 * (cost - trial_cost) / promise - 1;
        damping *= std::fmax(1.0 / 3.0, 1 - gain * gain * gain);
        growth = 2;
        cost = trial_cost;
        for (int i = 0; i < 6; ++i) {
          q[i] = trial[i];
          e[i] = trial_e[i];
          for (int k = 0; k < 6; ++k) column[i][k] = trial_column[i][k];
        }
        damping = std::fmin(damping, 1e-3 * cost);
      } else {
        damping = std::fmax(damping, 1e-16) * growth;
        growth *= 2;
      }
    }
    return met(e, tolerance);
  }

 private:
  static double square(const double* e) {
    double sum = 0;
    for (int i = 0; i < 6; ++i) sum += e[i] * e[i];
    return sum;
  }

  /// A x = e by Gaussian elimination with row exchanges, A given by columns; x in the place of e.
  static bool solve_lu(const double (&column)[6][6], double* e) {
    double a[6][7];
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
#pragma GCC unroll 6
      for (int j = 0; j < 6; ++j) a[i][j] = column[j][i];
      a[i][6] = e[i];
    }
#pragma GCC unroll 6
    for (int k = 0; k < 6; ++k) {
      int pivot = k;
#pragma GCC unroll 6
      for (int i = k + 1; i < 6; ++i) {
        if (std::fabs(a[i][k]) > std::fabs(a[pivot][k])) pivot = i;
      }
      if (!(std::fabs(a[pivot][k]) > 0)) return false;
      if (pivot != k) {
#pragma GCC unroll 7
        for (int j = k; j < 7; ++j) std::swap(a[k][j], a[pivot][j]);
      }
      const double inverse = 1 / a[k][k];
#pragma GCC unroll 6
      for (int i = k + 1; i < 6; ++i) {
        const double factor = a[i][k] * inverse;
#pragma GCC unroll 7
        for (int j = k + 1; j < 7; ++j) a[i][j] -= factor * a[k][j];
      }
      a[k][k] = inverse;
    }
#pragma GCC unroll 6
    for (int i = 5; i >= 0; --i) {
      double sum = a[i][6];
#pragma GCC unroll 6
      for (int j = i + 1; j < 6; ++j) sum -= a[i][j] * e[j];
      e[i] = sum * a[i][i];
    }
    return true;
  }

  /// (J^T J + damping) step = J^T e = slope.
  static void normal_step(const double (&column)[6][6], const double* e, double damping, double* slope, double* step) {
    double l[6][6];
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
#pragma GCC unroll 6
      for (int j = 0; j <= i; ++j) {
        double sum = i == j ? damping + 1e-18 : 0;
#pragma GCC unroll 6
        for (int k = 0; k < 6; ++k) sum += column[i][k] * column[j][k];
        l[i][j] = sum;
      }
      double sum = 0;
#pragma GCC unroll 6
      for (int k = 0; k < 6; ++k) sum += column[i][k] * e[k];
      slope[i] = sum;
    }
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
#pragma GCC unroll 6
      for (int j = 0; j <= i; ++j) {
        double sum = l[i][j];
#pragma GCC unroll 6
        for (int k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
        l[i][j] = i == j ? 1 / std::sqrt(sum > 1e-300 ? sum : 1e-300) : sum * l[j][j];
      }
    }
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
      double sum = slope[i];
#pragma GCC unroll 6
      for (int k = 0; k < i; ++k) sum -= l[i][k] * step[k];
      step[i] = sum * l[i][i];
    }
#pragma GCC unroll 6
    for (int i = 5; i >= 0; --i) {
      double sum = step[i];
#pragma GCC unroll 6
      for (int k = i + 1; k < 6; ++k) sum -= l[k][i] * step[k];
      step[i] = sum * l[i][i];
    }
  }

  Geometry geometry_;
  double sin_alpha_[6], cos_alpha_[6], sin_beta_[6], cos_beta_[6];
};

}  // namespace mdhcal::bench
