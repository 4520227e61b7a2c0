// SPDX-License-Identifier: MIT
#include "mdhcal/solutions.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/lib/sampled_pose.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

struct Sample {
  Arm<double> arm{};
  double q[max_joints]{};
  double posture[max_joints]{};
  Pose<double> target{};
};

Sample sample(const Geometry& nominal, Random& random, double errors_mm, bool near_singular = false) {
  Sample s;
  EXPECT_EQ(make_arm(with_errors(nominal, random, errors_mm * 1e-3, errors_mm * 0.1 * deg), s.arm), Status::ok);
  for (;;) {
    for (int i = 0; i < nominal.joint_count; ++i) {
      s.q[i] = random.symmetric(pi);
      s.posture[i] = random.symmetric(pi);
    }
    if (near_singular) s.q[4] = random.symmetric(0.01);
    EXPECT_EQ(forward(s.arm, s.q, s.target), Status::ok);
    double q[max_joints];
    std::copy(s.q, s.q + max_joints, q);
    TickReport<double> report{};
    EXPECT_EQ(tick(s.arm, default_tick_options(s.arm), s.target, q, &report), Status::ok);
    if (near_singular || report.smallest_singular_value > 0.02) return s;
  }
}

// What every answer has to be, whatever was asked: met by the forward model, within limits, different, sorted.
void expect_sound(const Sample& s, const SolutionOptions<double>& options, const Solutions<double>& found) {
  const int joints = s.arm.joint_count;
  for (int k = 0; k < found.count; ++k) {
    Pose<double> reached{};
    ASSERT_EQ(forward(s.arm, found.q[k], reached), Status::ok);
    ASSERT_LE(position_distance(reached, s.target), 1.01 * options.goal.position_tolerance_m);
    if (options.goal.task == Task::pose) {
      ASSERT_LE(small_angle(reached, s.target), 1.01 * options.goal.rotation_tolerance_rad);
    }
    for (int i = 0; i < joints; ++i) {
      const std::uint32_t bit = 1U << static_cast<std::uint32_t>(i);
      if ((s.arm.min_mask & bit) != 0U) {
        ASSERT_GE(found.q[k][i], s.arm.min[i]);
      }
      if ((s.arm.max_mask & bit) != 0U) {
        ASSERT_LE(found.q[k][i], s.arm.max[i]);
      }
    }
    if (k > 0) {
      ASSERT_GE(found.distance[k], found.distance[k - 1]);
    }
    for (int other = 0; other < k; ++other) ASSERT_GT(turn_distance(found.q[k], found.q[other], joints), 1e-3);
  }
}

// How many of `count` poses lack a solution that Levenberg-Marquardt finds from 100 random joints (8 under emulation): what
// tests/bench/solutions_sweep.cpp does at length.
int incomplete(double errors_mm, Near near, int count) {
  Random random(21);
  const Geometry kinds[] = {ur5(), wrist_arm(), published_robot(), puma560()};
  int missed = 0;
  for (int n = 0; n < count; ++n) {
    Sample s;
    const Geometry geometry = with_errors(kinds[n % 4], random, errors_mm * 1e-3, errors_mm * 0.1 * deg);
    EXPECT_EQ(make_arm(geometry, s.arm), Status::ok);
    const Joints q = sampled_joints(s.arm, near, random);
    EXPECT_EQ(forward(s.arm, q.data(), s.target), Status::ok);
    for (double& joint : s.posture) joint = random.symmetric(pi);
    const SolutionOptions<double> options = default_solution_options(s.arm);
    EXPECT_EQ(options.restarts, 0);
    Solutions<double> found{};
    EXPECT_EQ(find_solutions(s.arm, options, s.target, s.posture, found), Status::ok);
    expect_sound(s, options, found);
    std::vector<Joints> truth = every_solution(s.arm, s.target, emulated ? 8 : 100, random);
    if (!holds(truth, q.data())) truth.push_back(q);
    const bool complete = std::all_of(truth.begin(), truth.end(), [&](const Joints& solution) {
      return std::any_of(found.q, found.q + found.count,
                         [&](const double* k) { return turn_distance(k, solution.data(), 6) < distinct_rad; });
    });
    if (!complete) ++missed;
  }
  return missed;
}

TEST(FindSolutions, FindsEveryRegularSolutionAtOneMillimetre) {
  EXPECT_EQ(incomplete(1.0, Near::nothing, cases(200)), 0);
}
TEST(FindSolutions, FindsNinetyNinePercentRegularAtFiveMillimetres) {
  const int count = cases(200);
  EXPECT_LE(100 * incomplete(5.0, Near::nothing, count), count);
}
TEST(FindSolutions, FindsNineOfTenNearEachSingularity) {
  for (const Near near : {Near::wrist, Near::elbow, Near::shoulder}) {
    const int count = emulated ? 1 : 100;
    EXPECT_LE(10 * incomplete(1.0, near, count), count) << static_cast<int>(near);
    if (emulated) break;
  }
}

TEST(FindSolutions, KnowsTheFamilies) {
  Arm<double> arm{};
  ASSERT_EQ(make_arm(ur5(), arm), Status::ok);
  EXPECT_EQ(family_of(arm), ArmFamily::parallel_axes);
  ASSERT_EQ(make_arm(wrist_arm(), arm), Status::ok);
  EXPECT_EQ(family_of(arm), ArmFamily::spherical_wrist);
  ASSERT_EQ(make_arm(seven_joint_arm(), arm), Status::ok);
  EXPECT_EQ(family_of(arm), ArmFamily::general);
  ASSERT_EQ(make_arm(published_robot(), arm), Status::ok);
  EXPECT_EQ(family_of(arm), ArmFamily::parallel_axes);
}

// A nominal arm of either family has exactly eight solutions of a pose well inside, and they come without refinement's
// help: the closed form is exact there.
TEST(FindSolutions, FindsAllEightOfANominalArm) {
  Arm<double> arm{};
  ASSERT_EQ(make_arm(ur5(), arm), Status::ok);
  const double q[6] = {0.3, -1.2, 1.5, 0.4, 1.1, -0.6};
  Pose<double> target{};
  ASSERT_EQ(forward(arm, q, target), Status::ok);
  Solutions<double> found{};
  ASSERT_EQ(find_solutions(arm, default_solution_options(arm), target, q, found), Status::ok);
  EXPECT_EQ(found.count, 8);
  EXPECT_LT(found.distance[0], 1e-9);
}

TEST(FindSolutions, TakesTheAllowedTurnNearestToThePosture) {
  Geometry g = ur5();
  for (int i = 0; i < 6; ++i) {
    g.joint[i].has_min = g.joint[i].has_max = 1;
    g.joint[i].min = -2 * pi;
    g.joint[i].max = 2 * pi;
  }
  Sample s;
  ASSERT_EQ(make_arm(g, s.arm), Status::ok);
  const double q[6] = {0.3, -1.2, 1.5, 0.4, 1.1, 6.0};
  std::copy(q, q + 6, s.q);
  std::copy(q, q + 6, s.posture);
  ASSERT_EQ(forward(s.arm, s.q, s.target), Status::ok);
  const auto options = default_solution_options(s.arm);
  Solutions<double> found{};
  ASSERT_EQ(find_solutions(s.arm, options, s.target, s.posture, found), Status::ok);
  expect_sound(s, options, found);
  EXPECT_NEAR(found.q[0][5], 6.0, 1e-9);
  // Narrow limits: the same turn is not allowed, the one before is.
  g.joint[5].max = 1.0;
  ASSERT_EQ(make_arm(g, s.arm), Status::ok);
  ASSERT_EQ(find_solutions(s.arm, options, s.target, s.posture, found), Status::ok);
  expect_sound(s, options, found);
  bool turned_back = false;
  for (int k = 0; k < found.count; ++k) turned_back = turned_back || std::fabs(found.q[k][5] - (6.0 - 2 * pi)) < 1e-9;
  EXPECT_TRUE(turned_back);
}

// Against the solutions without limits, turned by hand: each one that has an allowed turn is there, on the allowed turn
// nearest to the posture in each joint, none besides; the distance is the largest joint difference, and they are sorted.
TEST(FindSolutions, LimitsCountModuloFullTurns) {
  Random random(26);
  int within = 0;
  int without = 0;
  for (int n = 0; n < cases(300); ++n) {
    Geometry g = with_errors(n % 2 == 0 ? ur5() : wrist_arm(), random, 1e-3, 0.1 * deg);
    Sample s;
    Arm<double> unlimited{};
    ASSERT_EQ(make_arm(g, unlimited), Status::ok);
    for (int i = 0; i < 6; ++i) {
      g.joint[i].has_min = random.symmetric(1) < 0.5 ? 1 : 0;
      g.joint[i].has_max = random.symmetric(1) < 0.5 ? 1 : 0;
      const double middle = random.symmetric(6.0);
      const double half = random.uniform(1.0, 7.0);
      g.joint[i].min = g.joint[i].has_min == 1 ? middle - half : 0.0;
      g.joint[i].max = g.joint[i].has_max == 1 ? middle + half : 0.0;
    }
    ASSERT_EQ(make_arm(g, s.arm), Status::ok);
    for (int i = 0; i < 6; ++i) {
      s.q[i] = random.symmetric(pi);
      s.posture[i] = random.symmetric(8.0);
    }
    ASSERT_EQ(forward(s.arm, s.q, s.target), Status::ok);
    const SolutionOptions<double> options = default_solution_options(s.arm);
    Solutions<double> all{};
    Solutions<double> found{};
    ASSERT_EQ(find_solutions(unlimited, options, s.target, s.posture, all), Status::ok);
    const Status status = find_solutions(s.arm, options, s.target, s.posture, found);
    expect_sound(s, options, found);
    int expected = 0;
    for (int k = 0; k < all.count; ++k) {
      double turned[6];
      bool allowed = true;
      for (int i = 0; i < 6; ++i) {
        double nearest = std::numeric_limits<double>::infinity();
        for (int turns = -6; turns <= 6; ++turns) {
          const double q = std::remainder(all.q[k][i], 2 * pi) + 2 * pi * turns;
          if (g.joint[i].has_min == 1 && q < g.joint[i].min) continue;
          if (g.joint[i].has_max == 1 && q > g.joint[i].max) continue;
          if (std::fabs(q - s.posture[i]) < std::fabs(nearest - s.posture[i])) nearest = q;
        }
        allowed = allowed && std::isfinite(nearest);
        turned[i] = nearest;
      }
      ++(allowed ? within : without);
      if (!allowed) continue;
      ++expected;
      bool there = false;
      for (int m = 0; m < found.count; ++m) {
        double largest = 0;
        for (int i = 0; i < 6; ++i) largest = std::max(largest, std::fabs(found.q[m][i] - turned[i]));
        there = there || largest < 1e-6;
      }
      EXPECT_TRUE(there) << n << ", solution " << k;
    }
    EXPECT_EQ(found.count, expected) << n;
    EXPECT_EQ(status, expected > 0 ? Status::ok : Status::out_of_reach) << n;
    for (int m = 0; m < found.count; ++m) {
      double largest = 0;
      for (int i = 0; i < 6; ++i) largest = std::max(largest, std::fabs(found.q[m][i] - s.posture[i]));
      EXPECT_NEAR(found.distance[m], largest, 1e-12);
    }
  }
  EXPECT_GT(within, cases(300));
  EXPECT_GT(without, cases(300) / 3);
}

TEST(FindSolutions, SignsAndCouplingsAreReadings) {
  Geometry g = wrist_arm();
  g.joint[2].sign = -1;
  g.joint[2].coupling[1] = 1.0;
  g.joint[5].coupling[4] = -0.5;
  Sample s;
  ASSERT_EQ(make_arm(g, s.arm), Status::ok);
  const double q[6] = {0.3, -0.4, 0.5, 0.4, 1.1, -0.6};
  std::copy(q, q + 6, s.q);
  std::copy(q, q + 6, s.posture);
  ASSERT_EQ(forward(s.arm, s.q, s.target), Status::ok);
  const auto options = default_solution_options(s.arm);
  Solutions<double> found{};
  ASSERT_EQ(find_solutions(s.arm, options, s.target, s.posture, found), Status::ok);
  expect_sound(s, options, found);
  EXPECT_LT(found.distance[0], 1e-9);
  EXPECT_GE(found.count, 4);
}

TEST(ColdStart, SolvesEveryReachablePoseFromAnywhere) {
  Random random(23);
  for (int n = 0; n < cases(1000); ++n) {
    const Geometry nominal = n % 2 == 0 ? ur5() : wrist_arm();
    const Sample s = sample(nominal, random, n % 3 == 0 ? 5.0 : 1.0, n % 5 == 0);
    double q[max_joints];
    std::copy(s.posture, s.posture + max_joints, q);
    ASSERT_EQ(cold_start(s.arm, default_solution_options(s.arm), s.target, q), Status::ok) << n;
    Pose<double> reached{};
    ASSERT_EQ(forward(s.arm, q, reached), Status::ok);
    ASSERT_LE(position_distance(reached, s.target), 1.01e-10);
    ASSERT_LE(small_angle(reached, s.target), 1.01e-10);
  }
}

// No closed form: axes that are neither parallel nor meet; seven joints; five with a task; a slide.
TEST(ColdStart, SolvesArmsWithoutAClosedForm) {
  const Geometry six = from_table({{0, 0, 0, 0.3}, {-80, 0.1, -90, 0.05}, {10, 0.5, 0, 0.02}, {-70, 0.15, 0, 0.45},
                                   {75, 0.06, 0, 0.08}, {-85, 0.04, 0, 0.1}});
  Geometry slide = from_table({{0, 0, 0, 0}, {-90, 0, 0, 0.2}, {90, 0, 0, 0.4}, {0, 0, 0, 0}, {-90, 0, 0, 0}, {90, 0, 0, 0.1}});
  slide.joint[2].kind = JointKind::prismatic;
  slide.joint[2].has_min = slide.joint[2].has_max = 1;
  slide.joint[2].min = -0.3;
  slide.joint[2].max = 0.5;
  const struct {
    Geometry geometry;
    Task task;
  } arms[] = {{six, Task::pose},
              {slide, Task::pose},
              {seven_joint_arm(), Task::pose},
              {five_joint_arm(), Task::position_axis},
              {five_joint_arm(), Task::position}};
  Random random(24);
  for (const auto& a : arms) {
    for (int n = 0; n < cases(50); ++n) {
      Arm<double> arm{};
      ASSERT_EQ(make_arm(with_errors(a.geometry, random, 1e-3, 0.1 * deg), arm), Status::ok);
      double truth[max_joints];
      double q[max_joints];
      for (int i = 0; i < a.geometry.joint_count; ++i) {
        const bool slides = a.geometry.joint[i].kind == JointKind::prismatic;
        truth[i] = slides ? random.uniform(-0.3, 0.5) : random.symmetric(pi);
        q[i] = slides ? 0.0 : random.symmetric(pi);
      }
      Pose<double> target{};
      ASSERT_EQ(forward(arm, truth, target), Status::ok);
      SolutionOptions<double> options = default_solution_options(arm);
      options.goal.task = a.task;
      ASSERT_EQ(cold_start(arm, options, target, q), Status::ok) << n;
      Pose<double> reached{};
      ASSERT_EQ(forward(arm, q, reached), Status::ok);
      ASSERT_LE(position_distance(reached, target), 1.01e-10);
    }
  }
}

TEST(ColdStart, SaysOutOfReachAndRefusesBadInput) {
  Arm<double> arm{};
  ASSERT_EQ(make_arm(ur5(), arm), Status::ok);
  const double joints[6] = {0.3, -1.2, 1.5, 0.4, 1.1, -0.6};
  double q[6];
  std::copy(joints, joints + 6, q);
  const SolutionOptions<double> options = default_solution_options(arm);
  const Pose<double> far{{1, 0, 0, 0}, {3.0, 0, 0}};
  EXPECT_EQ(cold_start(arm, options, far, q), Status::out_of_reach);
  EXPECT_TRUE(std::equal(q, q + 6, joints));
  const Pose<double> no_rotation{{1, 1, 0, 0}, {0.3, 0, 0}};
  EXPECT_EQ(cold_start(arm, options, no_rotation, q), Status::bad_input);
  SolutionOptions<double> many = options;
  many.restarts = max_restarts + 1;
  EXPECT_EQ(cold_start(arm, many, far, q), Status::bad_input);
  q[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(cold_start(arm, options, far, q), Status::bad_input);
}

TEST(ColdStart, WorksInFloat) {
  Random random(25);
  for (int n = 0; n < cases(200); ++n) {
    Arm<float> arm{};
    ASSERT_EQ(make_arm(with_errors(n % 2 == 0 ? ur5() : wrist_arm(), random, 1e-3, 0.1 * deg), arm), Status::ok);
    float truth[6];
    float q[6];
    for (int i = 0; i < 6; ++i) {
      truth[i] = static_cast<float>(random.symmetric(pi));
      q[i] = static_cast<float>(random.symmetric(pi));
    }
    Pose<float> target{};
    ASSERT_EQ(forward(arm, truth, target), Status::ok);
    ASSERT_EQ(cold_start(arm, default_solution_options(arm), target, q), Status::ok) << n;
    Pose<float> reached{};
    ASSERT_EQ(forward(arm, q, reached), Status::ok);
    ASSERT_LE(position_distance(reached, target), 6e-6F);
  }
}

}  // namespace
