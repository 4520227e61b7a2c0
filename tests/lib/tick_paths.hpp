// SPDX-License-Identifier: MIT
// Paths that a servo loop follows, and what came of it: for the tests of the tick and for the long sweeps.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "mdhcal/inverse.hpp"
#include "tests/lib/poses.hpp"

namespace mdhcal::test {

/// The limit of a tick at 1 kHz for joints of half a turn a second [rad].
inline constexpr double servo_step = 0.00314;

template <class Real>
TickOptions<Real> servo_options(const Arm<Real>& arm) {
  TickOptions<Real> options = default_tick_options(arm);
  if (sizeof(Real) == sizeof(double)) options.goal.position_tolerance_m = options.goal.rotation_tolerance_rad = Real(1e-6);
  std::fill(options.limits.max_step, options.limits.max_step + max_joints, static_cast<Real>(servo_step));
  return options;
}

/// Joints of ur5() or wrist_arm() whose flange points sideways, with joint 5 at 0 and its axis upright: turning joint 1
/// and joint 5 against each other then leaves the orientation as it is.
inline void level_wrist(bool parallel, Random& random, double* q) {
  q[0] = random.symmetric(pi);
  if (parallel) {
    q[1] = -random.uniform(0.6, 2.0);
    q[2] = random.uniform(0.6, 2.0);
    q[3] = -q[1] - q[2] + (random.symmetric(1.0) < 0 ? -pi : 0.0);
  } else {
    q[1] = random.symmetric(0.6);
    q[2] = -q[1];
    q[3] = pi / 2;
  }
  q[4] = 0;
  q[5] = random.symmetric(pi);
}

struct Crossing {
  double position_m = 0, rotation_rad = 0;  ///< largest errors of the flange along the path
  double path_rad = 0;                      ///< largest angle between the two arms' flanges at the same joints of the path
  double own_rad = 0;                       ///< the same over the whole workspace: the arm's own orientation error
  double step = 0;                          ///< largest |dq| of a tick [rad]
  double turned_rad = 0;                    ///< change of the nominal orientation along the path: 0
  bool met = false;                         ///< whether the last pose was met
};

/// Follows with `arm` the arc that `nominal` describes at constant orientation while joints 1 and 5 turn against each
/// other by 0.0004 rad a tick, from 0.3 rad before to 0.3 rad after joint 5 passes 0.
template <class Real>
Crossing cross_wrist(const Arm<double>& nominal, const Arm<double>& exact, const Arm<Real>& arm, bool parallel,
                     Random& random, double rate = 0.0004) {
  double level[6];
  level_wrist(parallel, random, level);
  const auto at = [&](double phi, double sign, double* q) {
    std::copy(level, level + 6, q);
    q[0] += phi;
    q[4] += sign * phi;
  };
  Crossing found;
  double sign = 1;
  double q[6];
  Pose<double> first{};
  Pose<double> pose{};
  // Which way joint 5 has to turn depends on the posture.
  at(-0.1, sign, q);
  EXPECT_EQ(forward(nominal, q, first), Status::ok);
  at(0.1, sign, q);
  EXPECT_EQ(forward(nominal, q, pose), Status::ok);
  if (small_angle(first, pose) > 0.1) sign = -1;
  TickOptions<Real> options = servo_options(arm);
  Real joints[6];
  const int half = static_cast<int>(0.3 / rate);
  for (int n = -half; n <= half; ++n) {
    at(rate * n, sign, q);
    EXPECT_EQ(forward(nominal, q, pose), Status::ok);
    if (n == -half) {
      first = pose;
      std::copy(q, q + 6, joints);
    }
    found.turned_rad = std::max(found.turned_rad, small_angle(first, pose));
    Pose<double> own{};
    EXPECT_EQ(forward(exact, q, own), Status::ok);
    found.path_rad = std::max(found.path_rad, small_angle(own, pose));
    Pose<Real> target{};
    std::copy(pose.quaternion, pose.quaternion + 4, target.quaternion);
    std::copy(pose.position_m, pose.position_m + 3, target.position_m);
    Real last[6];
    std::copy(joints, joints + 6, last);
    Status status = Status::ok;
    if (n == -half) {
      // On the path before the clock starts.
      TickOptions<Real> free = default_tick_options(arm);
      status = tick(arm, free, target, joints);
    } else {
      status = tick(arm, options, target, joints);
      for (int i = 0; i < 6; ++i) {
        found.step = std::max(found.step, std::fabs(static_cast<double>(joints[i]) - static_cast<double>(last[i])));
      }
    }
    found.met = status == Status::ok;
    double result[6];
    std::copy(joints, joints + 6, result);
    EXPECT_EQ(forward(exact, result, own), Status::ok);
    found.position_m = std::max(found.position_m, position_distance(own, pose));
    found.rotation_rad = std::max(found.rotation_rad, small_angle(own, pose));
  }
  for (int n = 0; n < 200; ++n) {
    Pose<double> a{};
    Pose<double> b{};
    for (double& joint : q) joint = random.symmetric(pi);
    EXPECT_EQ(forward(nominal, q, a), Status::ok);
    EXPECT_EQ(forward(exact, q, b), Status::ok);
    found.own_rad = std::max(found.own_rad, small_angle(a, b));
  }
  return found;
}

/// Singular values of the flange's Jacobian, lengths over the arm's reach, ascending: one-sided Jacobi rotations.
inline void singular_values(const Arm<double>& arm, const double* q, double (&s)[6]) {
  Pose<double> pose{};
  Jacobian<double> jacobian{};
  EXPECT_EQ(forward(arm, q, pose, jacobian), Status::ok);
  const auto product = [&](int a, int b) {
    double sum = 0;
    for (int k = 0; k < 6; ++k) {
      const double scale = k < 3 ? 1 / (arm.reach_m * arm.reach_m) : 1;
      sum += scale * jacobian.column[a][k] * jacobian.column[b][k];
    }
    return sum;
  };
  for (int sweep = 0; sweep < 12; ++sweep) {
    for (int a = 0; a < 6; ++a) {
      for (int b = a + 1; b < 6; ++b) {
        const double cross = product(a, b);
        if (!(std::fabs(cross) > 0)) continue;
        const double zeta = (product(b, b) - product(a, a)) / (2 * cross);
        const double tangent = (zeta < 0 ? -1 : 1) / (std::fabs(zeta) + std::sqrt(1 + zeta * zeta));
        const double cosine = 1 / std::sqrt(1 + tangent * tangent);
        for (int k = 0; k < 6; ++k) {
          const double x = jacobian.column[a][k];
          jacobian.column[a][k] = cosine * (x - tangent * jacobian.column[b][k]);
          jacobian.column[b][k] = cosine * (tangent * x + jacobian.column[b][k]);
        }
      }
    }
  }
  for (int k = 0; k < 6; ++k) s[k] = std::sqrt(product(k, k));
  std::sort(s, s + 6);
}

struct Excursion {
  bool unique = false;            ///< whether the way back is the only continuation, see there_and_back()
  double away_rad = 0;            ///< largest joint difference between start and end
  long ticks = 0;                 ///< that met the pose
  long unreachable = 0;           ///< that did not
  long evaluations = 0;           ///< of the unreachable ones
  std::int32_t most = 0;          ///< evaluations of one of them
  long wavering = 0;              ///< ticks after which the position is worse by four times what the target moved
  double step = 0;                ///< largest |dq| of a tick
};

/// A tick to come.
struct Due {
  double q[6];
  Pose<double> target;
};

/// Moves the target from the flange's pose at `start` straight away from the base to `far_m`, at constant orientation, by
/// `advance_m` a tick, and back, and waits there until the arm has caught up. The continuation is unique if the arm meets
/// no singularity but the border's: the smallest singular value stays above 0.03 on the way to 30 mm before the border,
/// the second smallest above 0.06 throughout. `unmet`, if given, receives the ticks that do not meet their pose.
inline Excursion there_and_back(const Arm<double>& arm, const double* start, double far_m, double advance_m,
                                double max_step, std::vector<Due>* unmet = nullptr) {
  TickOptions<double> options = servo_options(arm);
  std::fill(options.limits.max_step, options.limits.max_step + 6, max_step);
  Pose<double> home{};
  EXPECT_EQ(forward(arm, start, home), Status::ok);
  const double* p = home.position_m;
  const double distance = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
  const int out = static_cast<int>(std::ceil((far_m - distance) / advance_m));
  const int border = static_cast<int>(0.03 / advance_m);
  double q[6];
  std::copy(start, start + 6, q);
  Excursion found;
  found.unique = true;
  double error_m = 0;
  std::vector<double> recent(static_cast<std::size_t>(border / 4) + 1, 1.0);
  for (int n = 1; n <= 2 * out + 2000; ++n) {
    const int steps = std::max(0, n <= out ? n : 2 * out - n);
    Pose<double> target = home;
    for (double& x : target.position_m) x *= 1 + steps * advance_m / distance;
    double last[6];
    std::copy(q, q + 6, last);
    TickReport<double> report{};
    const Status status = tick(arm, options, target, q, &report);
    for (int i = 0; i < 6; ++i) found.step = std::max(found.step, std::fabs(q[i] - last[i]));
    if (report.position_error_m > error_m + 4 * advance_m) ++found.wavering;
    error_m = report.position_error_m;
    if (status == Status::ok) {
      ++found.ticks;
    } else {
      ++found.unreachable;
      found.evaluations += report.iterations;
      found.most = std::max(found.most, report.iterations);
      if (unmet != nullptr) {
        unmet->push_back({});
        std::copy(last, last + 6, unmet->back().q);
        unmet->back().target = target;
      }
    }
    if (n % 4 != 0) continue;
    double s[6];
    singular_values(arm, q, s);
    if (s[1] < 0.06) found.unique = false;
    if (status == Status::ok && n <= out) {
      // Judged once it is known that the border is further than 30 mm.
      double& slot = recent[static_cast<std::size_t>(n / 4) % recent.size()];
      if (slot < 0.03) found.unique = false;
      slot = s[0];
    }
    if (n > 2 * out && status == Status::ok && steps == 0) break;
  }
  for (int i = 0; i < 6; ++i) found.away_rad = std::max(found.away_rad, std::fabs(q[i] - start[i]));
  return found;
}

/// A posture away from singularities.
inline void random_posture(const Arm<double>& arm, Random& random, double* q) {
  double s[6];
  do {
    for (int i = 0; i < 6; ++i) q[i] = random.symmetric(pi);
    singular_values(arm, q, s);
  } while (s[0] < 0.03);
}

}  // namespace mdhcal::test
