// SPDX-License-Identifier: MIT
// Every solution of a pose by another way than the library's: Levenberg-Marquardt from many random joints. Shares
// nothing with the library but forward().
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "tests/lib/poses.hpp"

namespace mdhcal::test {

/// Two solutions nearer than this in every joint, modulo full turns, count as one [rad]. A solution is polished to
/// 1e-12; at a fold of the arm that still leaves its joints uncertain by about 1e-6 rad.
inline constexpr double distinct_rad = 1e-3;

using Joints = std::array<double, 6>;

/// The 6 x 6 Jacobian, lengths over the reach, column by column.
using Columns = std::array<Joints, 6>;

inline Columns scaled_columns(const Arm<double>& arm, const Jacobian<double>& jacobian) {
  Columns columns;
  for (std::size_t j = 0; j < 6; ++j) {
    for (std::size_t k = 0; k < 6; ++k) columns[j][k] = jacobian.column[j][k] / (k < 3 ? arm.reach_m : 1.0);
  }
  return columns;
}

/// The singular values by one-sided Jacobi rotations (Hestenes 1958), largest first.
inline Joints singular_values(Columns a) {
  const auto inner = [](const Joints& x, const Joints& y) {
    double sum = 0;
    for (std::size_t k = 0; k < 6; ++k) sum += x[k] * y[k];
    return sum;
  };
  for (int sweep = 0; sweep < 12; ++sweep) {
    for (std::size_t i = 0; i < 5; ++i) {
      for (std::size_t j = i + 1; j < 6; ++j) {
        const double angle = 0.5 * std::atan2(2 * inner(a[i], a[j]), inner(a[i], a[i]) - inner(a[j], a[j]));
        const double c = std::cos(angle);
        const double s = std::sin(angle);
        for (std::size_t k = 0; k < 6; ++k) {
          const double x = a[i][k];
          const double y = a[j][k];
          a[i][k] = c * x + s * y;
          a[j][k] = c * y - s * x;
        }
      }
    }
  }
  Joints values{};
  for (std::size_t j = 0; j < 6; ++j) values[j] = std::sqrt(inner(a[j], a[j]));
  std::sort(values.rbegin(), values.rend());
  return values;
}

inline double smallest_singular_value(const Arm<double>& arm, const double* q) {
  Pose<double> pose{};
  Jacobian<double> jacobian{};
  if (forward(arm, q, pose, jacobian) != Status::ok) return 0;
  return singular_values(scaled_columns(arm, jacobian))[5];
}

/// The least-squares step of the columns over sqrt(damping) 1, by Householder reflections. The product of the diagonal
/// of R, whose sign is that of the determinant, is returned besides.
inline double damped_step(const Columns& columns, double damping, const Joints& wanted, Joints& step) {
  double a[7][12] = {};
  const double root = std::sqrt(damping);
  for (std::size_t j = 0; j < 6; ++j) {
    for (std::size_t k = 0; k < 6; ++k) a[j][k] = columns[j][k];
    a[j][6 + j] = root;
    a[6][j] = wanted[j];
  }
  double determinant = 1;
  for (std::size_t j = 0; j < 6; ++j) {
    double square = 0;
    for (std::size_t k = j; k < 12; ++k) square += a[j][k] * a[j][k];
    const double norm = a[j][j] > 0 ? -std::sqrt(square) : std::sqrt(square);
    determinant *= -norm;
    double v[12];
    for (std::size_t k = j; k < 12; ++k) v[k] = a[j][k];
    v[j] -= norm;
    const double scale = norm < 0 || norm > 0 ? 1 / (norm * (norm - a[j][j])) : 0;
    for (std::size_t c = j; c < 7; ++c) {
      double sum = 0;
      for (std::size_t k = j; k < 12; ++k) sum += v[k] * a[c][k];
      for (std::size_t k = j; k < 12; ++k) a[c][k] -= scale * sum * v[k];
    }
  }
  for (std::size_t j = 6; j-- > 0;) {
    double sum = a[6][j];
    for (std::size_t c = j + 1; c < 6; ++c) sum -= a[c][j] * step[c];
    step[j] = a[j][j] < 0 || a[j][j] > 0 ? sum / a[j][j] : 0;
  }
  return determinant;
}

inline double determinant_sign(const Arm<double>& arm, const double* q) {
  Pose<double> pose{};
  Jacobian<double> jacobian{};
  if (forward(arm, q, pose, jacobian) != Status::ok) return 0;
  Joints step{};
  return damped_step(scaled_columns(arm, jacobian), 0, Joints{}, step);
}

/// Position over the reach, then the rotation vector from the pose to the target, from quaternions.
inline Joints pose_difference(const Arm<double>& arm, const Pose<double>& target, const Pose<double>& pose) {
  const double* a = target.quaternion;
  const double* b = pose.quaternion;
  const double w = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  const double v[3] = {-a[0] * b[1] + a[1] * b[0] - a[2] * b[3] + a[3] * b[2],
                       -a[0] * b[2] + a[2] * b[0] - a[3] * b[1] + a[1] * b[3],
                       -a[0] * b[3] + a[3] * b[0] - a[1] * b[2] + a[2] * b[1]};
  const double norm = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  const double sign = w < 0 ? -1 : 1;
  const double factor = norm > 1e-12 ? 2 * std::atan2(norm, sign * w) / norm : 2;
  Joints e{};
  for (std::size_t k = 0; k < 3; ++k) {
    e[k] = (target.position_m[k] - pose.position_m[k]) / arm.reach_m;
    e[3 + k] = sign * factor * v[k];
  }
  return e;
}

/// Moves the joints until they meet the target to 1e-12 (lengths over the reach). Returns whether they do.
inline bool meet(const Arm<double>& arm, const Pose<double>& target, Joints& q) {
  const auto square_of = [](const Joints& e) {
    double sum = 0;
    for (const double x : e) sum += x * x;
    return sum;
  };
  double damping = 1e-3;
  Pose<double> pose{};
  Jacobian<double> jacobian{};
  if (forward(arm, q.data(), pose, jacobian) != Status::ok) return false;
  Joints e = pose_difference(arm, target, pose);
  double square = square_of(e);
  for (int iteration = 0; iteration < 80 && square > 1e-24; ++iteration) {
    Joints step{};
    damped_step(scaled_columns(arm, jacobian), damping, e, step);
    Joints next = q;
    for (std::size_t j = 0; j < 6; ++j) next[j] += std::clamp(step[j], -1.0, 1.0);
    Pose<double> there{};
    Jacobian<double> slope{};
    if (forward(arm, next.data(), there, slope) != Status::ok) return false;
    const Joints left = pose_difference(arm, target, there);
    if (square_of(left) < square) {
      q = next;
      e = left;
      square = square_of(left);
      jacobian = slope;
      damping = std::max(0.1 * damping, 1e-16);
    } else {
      damping *= 8;
      if (damping > 1e6) break;
    }
  }
  return square <= 1e-24;
}

inline bool holds(const std::vector<Joints>& solutions, const double* q) {
  return std::any_of(solutions.begin(), solutions.end(),
                     [&](const Joints& s) { return turn_distance(s.data(), q, 6) < distinct_rad; });
}

/// What `restarts` random joints lead to, each once.
inline std::vector<Joints> every_solution(const Arm<double>& arm, const Pose<double>& target, int restarts,
                                          Random& random) {
  std::vector<Joints> found;
  for (int n = 0; n < restarts; ++n) {
    Joints q;
    for (double& joint : q) joint = random.symmetric(pi);
    if (meet(arm, target, q) && !holds(found, q.data())) found.push_back(q);
  }
  return found;
}

}  // namespace mdhcal::test
