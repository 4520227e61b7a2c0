// SPDX-License-Identifier: MIT
// Joint limits, turns, tasks and bad input of the tick.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "tests/lib/tick_paths.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

Geometry limited(Geometry g, double bound) {
  for (std::int32_t i = 0; i < g.joint_count; ++i) {
    g.joint[i].has_min = g.joint[i].has_max = 1;
    g.joint[i].min = -bound;
    g.joint[i].max = bound;
  }
  return g;
}

TEST(TickLimits, KeepsJointLimitsWithinTheStep) {
  Random random(71);
  int held = 0;
  for (int n = 0; n < cases(3000); ++n) {
    Arm<double> arm{};
    ASSERT_EQ(make_arm(limited(with_errors(ur5(), random, 1e-3, 0.1 * deg), 1.5), arm), Status::ok);
    double q[6];
    double goal[6];
    for (int i = 0; i < 6; ++i) {
      goal[i] = random.symmetric(1.6);
      q[i] = std::max(-1.5, std::min(1.5, goal[i] + random.symmetric(0.05)));
    }
    Pose<double> target{};
    ASSERT_EQ(forward(arm, goal, target), Status::ok);
    TickReport<double> report{};
    const Status status = tick(arm, default_tick_options(arm), target, q, &report);
    for (const double joint : q) ASSERT_LE(std::fabs(joint), 1.5) << n;
    Pose<double> reached{};
    ASSERT_EQ(forward(arm, q, reached), Status::ok);
    const bool met = position_distance(reached, target) <= 1.1e-10 && small_angle(reached, target) <= 1.1e-10;
    ASSERT_EQ(status == Status::ok, met) << n;
    if (status == Status::joint_limited) {
      ++held;
      ASSERT_NE(report.limit_mask, 0U);
      for (int i = 0; i < 6; ++i) {
        if (((report.limit_mask >> i) & 1U) != 0U) {
          ASSERT_NEAR(std::fabs(q[i]), 1.5, 1e-5) << n;
        }
      }
    }
  }
  EXPECT_GT(held, cases(3000) / 20);
}

TEST(TickLimits, AJointOutsideItsLimitOnlyMovesInwards) {
  Random random(72);
  for (int n = 0; n < cases(2000); ++n) {
    Arm<double> arm{};
    ASSERT_EQ(make_arm(limited(ur5(), 1.5), arm), Status::ok);
    double q[6];
    double goal[6];
    for (int i = 0; i < 6; ++i) {
      q[i] = random.symmetric(1.4);
      goal[i] = q[i] + random.symmetric(0.2);
    }
    const int outside = n % 6;
    const double side = n % 2 == 0 ? 1 : -1;
    q[outside] = side * random.uniform(1.6, 2.0);
    goal[outside] = q[outside] + random.symmetric(0.3);
    Pose<double> target{};
    ASSERT_EQ(forward(arm, goal, target), Status::ok);
    const double last = q[outside];
    TickReport<double> report{};
    const Status status = tick(arm, default_tick_options(arm), target, q, &report);
    ASSERT_LE(side * q[outside], side * last) << n;
    if (side * q[outside] > 1.5) {
      ASSERT_EQ(status, Status::joint_limited) << n;
      ASSERT_NE((report.limit_mask >> outside) & 1U, 0U) << n;
    }
    for (int i = 0; i < 6; ++i) {
      if (i != outside) {
        ASSERT_LE(std::fabs(q[i]), 1.5) << n;
      }
    }
  }
}

TEST(TickLimits, TakesTheTurnNearestToTheLastJoints) {
  Arm<double> arm{};
  ASSERT_EQ(make_arm(limited(ur5(), 2 * pi), arm), Status::ok);
  Random random(73);
  for (int n = 0; n < cases(2000); ++n) {
    double q[6] = {random.symmetric(6.2), -1.2, 1.2, random.symmetric(6.2), 0.8, random.symmetric(6.2)};
    double goal[6];
    for (int i = 0; i < 6; ++i) goal[i] = std::max(-2 * pi, std::min(2 * pi, q[i] + random.symmetric(0.1)));
    Pose<double> target{};
    ASSERT_EQ(forward(arm, goal, target), Status::ok);
    ASSERT_EQ(tick(arm, default_tick_options(arm), target, q), Status::ok) << n;
    for (int i = 0; i < 6; ++i) ASSERT_NEAR(q[i], goal[i], 1e-8) << n;
  }
}

Geometry redundant(int joints) {
  Geometry g = seven_joint_arm();
  if (joints == 8) {
    g.joint_count = 8;
    g.link[7] = g.link[6];
    g.link[7].alpha_rad = pi / 2;
    g.link[7].a_m = 0.05;
    g.joint[7].sign = 1;
  }
  return g;
}

// The pose is met in every tick, and the joints come to where they are no further from the posture along the null
// space: a second run from there moves no more.
TEST(TickRedundant, MeetsThePoseAndGoesTowardsThePosture) {
  Random random(81);
  for (int n = 0; n < cases(200); ++n) {
    const int joints = 7 + n % 2;
    Arm<double> arm{};
    ASSERT_EQ(make_arm(with_errors(redundant(joints), random, 1e-3, 0.1 * deg), arm), Status::ok);
    double q[max_joints];
    TickOptions<double> options = default_tick_options(arm);
    for (int i = 0; i < joints; ++i) {
      q[i] = (i % 2 == 0 ? 1 : -1) * random.uniform(0.5, 1.2);
      options.posture.q[i] = q[i] + random.symmetric(0.4);
      options.limits.max_step[i] = 0.05;
    }
    options.posture.gain = 0.2;
    Pose<double> target{};
    ASSERT_EQ(forward(arm, q, target), Status::ok);
    const auto distance = [&] {
      double sum = 0;
      for (int i = 0; i < joints; ++i) sum += (q[i] - options.posture.q[i]) * (q[i] - options.posture.q[i]);
      return std::sqrt(sum);
    };
    const double start = distance();
    double before = start;
    for (int k = 0; k < 60; ++k) {
      double last[max_joints];
      std::copy(q, q + joints, last);
      ASSERT_EQ(tick(arm, options, target, q), Status::ok) << n << " " << k;
      for (int i = 0; i < joints; ++i) ASSERT_LE(std::fabs(q[i] - last[i]), 0.05);
      ASSERT_LE(distance(), before + 1e-6) << n << " " << k;
      before = distance();
    }
    EXPECT_LT(before, start) << n;
  }
}

// What each task asks for is met from a near seed, on arms that have just enough joints for it or more.
TEST(TickTasks, MeetsWhatTheTaskAsksFor) {
  Random random(82);
  const Geometry four = from_table({{0, 0, 0, 0.2}, {-90, 0.05, 0, 0}, {0, 0.3, 0, 0}, {0, 0.25, 0, 0}});
  const Geometry three = from_table({{0, 0, 0, 0.2}, {-90, 0.05, 0, 0}, {0, 0.3, 0, 0}});
  Geometry spatial = three;
  spatial.last_T_flange.position_m[0] = 0.25;
  const Geometry flat = from_table({{0, 0, 0, 0}, {0, 0.4, 0, 0}, {0, 0.3, 0, 0}});
  struct Case {
    Geometry geometry;
    Task task;
  };
  const Case all[] = {{five_joint_arm(), Task::position_axis}, {five_joint_arm(), Task::position}, {four, Task::position},
                      {spatial, Task::position},               {flat, Task::planar},               {ur5(), Task::position_axis},
                      {ur5(), Task::planar}};
  for (const Case& c : all) {
    for (int n = 0; n < cases(500); ++n) {
      Arm<double> arm{};
      ASSERT_EQ(make_arm(with_errors(c.geometry, random, 1e-3, 0.1 * deg), arm), Status::ok);
      double q[max_joints];
      double goal[max_joints];
      for (int i = 0; i < arm.joint_count; ++i) {
        goal[i] = (i % 2 == 0 ? 1 : -1) * random.uniform(0.3, 1.2);
        q[i] = goal[i] + random.symmetric(0.02);
      }
      Pose<double> target{};
      ASSERT_EQ(forward(arm, goal, target), Status::ok);
      TickOptions<double> options = default_tick_options(arm);
      options.goal.task = c.task;
      options.goal.position_tolerance_m = options.goal.rotation_tolerance_rad = 1e-9;
      ASSERT_EQ(tick(arm, options, target, q), Status::ok) << static_cast<int>(c.task) << " " << n;
      Pose<double> reached{};
      ASSERT_EQ(forward(arm, q, reached), Status::ok);
      for (int k = 0; k < (c.task == Task::planar ? 2 : 3); ++k) {
        ASSERT_NEAR(reached.position_m[k], target.position_m[k], 2e-9);
      }
      const auto axis = [](const Pose<double>& p, double* z) {
        const double* t = p.quaternion;
        z[0] = 2 * (t[1] * t[3] + t[0] * t[2]);
        z[1] = 2 * (t[2] * t[3] - t[0] * t[1]);
        z[2] = 1 - 2 * (t[1] * t[1] + t[2] * t[2]);
      };
      if (c.task == Task::position_axis) {
        double a[3];
        double b[3];
        axis(reached, a);
        axis(target, b);
        for (int k = 0; k < 3; ++k) ASSERT_NEAR(a[k], b[k], 3e-9);
      }
    }
  }
}

// One and two joints: a pose that the arm has is met from a near seed; one that it has not gets a status.
TEST(TickTasks, ServesArmsOfOneAndTwoJoints) {
  Random random(83);
  for (int n = 0; n < cases(2000); ++n) {
    Geometry g = ur5();
    g.joint_count = 1 + n % 2;
    Arm<double> arm{};
    ASSERT_EQ(make_arm(with_errors(g, random, 1e-3, 0.1 * deg), arm), Status::ok);
    double q[2];
    double goal[2];
    for (int i = 0; i < 2; ++i) {
      goal[i] = random.symmetric(pi);
      q[i] = goal[i] + random.symmetric(0.2);
    }
    Pose<double> target{};
    ASSERT_EQ(forward(arm, goal, target), Status::ok);
    ASSERT_EQ(tick(arm, default_tick_options(arm), target, q), Status::ok) << n;
    target.position_m[2] += 0.1;
    Status status = Status::not_converged;
    for (int k = 0; k < 3 && status == Status::not_converged; ++k) status = tick(arm, default_tick_options(arm), target, q);
    ASSERT_EQ(status, Status::out_of_reach) << n;
  }
}

template <class Real>
class TickInput : public ::testing::Test {};
using Reals = ::testing::Types<double, float>;
TYPED_TEST_SUITE(TickInput, Reals, );

// Every number that tick() is given, replaced by what it should not be: a status, no NaN in what comes out, and the
// outputs untouched if the status is bad_input.
TYPED_TEST(TickInput, AnswersWhateverItIsGiven) {
  using Real = TypeParam;
  Arm<Real> arm{};
  ASSERT_EQ(make_arm(limited(ur5(), 6), arm), Status::ok);
  const Real joints[6] = {Real(0.1), Real(-1.2), Real(1.4), Real(0.3), Real(0.7), Real(-0.2)};
  Pose<Real> target{};
  ASSERT_EQ(forward(arm, joints, target), Status::ok);
  using Limits = std::numeric_limits<Real>;
  const Real values[] = {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(), Limits::max(), -Limits::max(),
                         Limits::denorm_min(), -Limits::denorm_min(), Limits::min(), static_cast<Real>(1e30), Real(0),
                         Real(-1)};
  for (const Real value : values) {
    for (int slot = 0; slot < 31; ++slot) {
      Real q[6];
      for (int i = 0; i < 6; ++i) q[i] = joints[i] + Real(0.01);
      Pose<Real> pose = target;
      TickOptions<Real> options = default_tick_options(arm);
      if (slot < 6) {
        q[slot] = value;
      } else if (slot < 10) {
        pose.quaternion[slot - 6] = value;
      } else if (slot < 13) {
        pose.position_m[slot - 10] = value;
      } else if (slot < 19) {
        options.limits.max_step[slot - 13] = value;
      } else if (slot < 25) {
        options.posture.q[slot - 19] = value;
        options.posture.gain = Real(0.5);
      } else {
        Real* const scalar[] = {&options.goal.position_tolerance_m, &options.goal.rotation_tolerance_rad, &options.goal.position_weight,
                                &options.goal.rotation_weight, &options.posture.gain};
        if (slot < 30) *scalar[slot - 25] = value;
        if (slot == 30) options.max_iterations = value > Real(0) ? 1000 : -1;
      }
      Real before[6];
      std::copy(q, q + 6, before);
      TickReport<Real> report{};
      report.position_error_m = Real(-7);
      const Status status = tick(arm, options, pose, q, &report);
      for (int i = 0; i < 6; ++i) {
        if (status == Status::bad_input) {
          EXPECT_EQ(std::memcmp(&q[i], &before[i], sizeof(Real)), 0) << slot;
        } else {
          EXPECT_TRUE(std::isfinite(q[i])) << slot;
        }
      }
      if (status == Status::bad_input) {
        EXPECT_EQ(report.position_error_m, Real(-7)) << slot;
      } else {
        EXPECT_TRUE(std::isfinite(report.position_error_m) && std::isfinite(report.rotation_error_rad) &&
                    std::isfinite(report.smallest_singular_value))
            << slot;
      }
      const bool finite = std::isfinite(value) && std::fabs(value) < Real(1e30);
      if (!finite && slot < 30) {
        EXPECT_EQ(status, Status::bad_input) << slot << " " << value;
      }
    }
  }
  Pose<Real> none = target;
  for (Real& c : none.quaternion) c = 0;
  Real q[6] = {};
  EXPECT_EQ(tick(arm, default_tick_options(arm), none, q), Status::bad_input);
  TickOptions<Real> unknown = default_tick_options(arm);
  unknown.goal.task = static_cast<Task>(7);
  EXPECT_EQ(tick(arm, unknown, target, q), Status::bad_input);
}

// The smallest steps, weights and bounds that are allowed: still a status, still within the bounds.
TYPED_TEST(TickInput, BearsTheSmallestOptions) {
  using Real = TypeParam;
  Random random(91);
  Arm<Real> arm{};
  ASSERT_EQ(make_arm(with_errors(ur5(), random, 5e-3, 0.5 * deg), arm), Status::ok);
  for (int n = 0; n < cases(1000); ++n) {
    Real q[6];
    Real last[6];
    Pose<Real> target{};
    for (Real& joint : q) joint = static_cast<Real>(random.symmetric(pi));
    ASSERT_EQ(forward(arm, q, target), Status::ok);
    for (int i = 0; i < 6; ++i) last[i] = q[i] = static_cast<Real>(random.symmetric(pi));
    TickOptions<Real> options = default_tick_options(arm);
    const Real least = n % 2 == 0 ? std::numeric_limits<Real>::denorm_min() : static_cast<Real>(1e-6);
    options.limits.max_step[n % 6] = least;
    options.goal.rotation_weight = static_cast<Real>(n % 3 == 0 ? 1e-6 : 1e-3);
    options.goal.position_weight = static_cast<Real>(n % 5 == 0 ? 1e6 : 1);
    options.max_iterations = 1 + n % 9;
    TickReport<Real> report{};
    const Status status = tick(arm, options, target, q, &report);
    EXPECT_NE(status, Status::bad_input);
    EXPECT_LE(std::fabs(q[n % 6] - last[n % 6]), least) << n;
    EXPECT_LE(report.iterations, options.max_iterations + 25) << n;
    for (const Real joint : q) ASSERT_TRUE(std::isfinite(joint)) << n;
  }
}

}  // namespace
