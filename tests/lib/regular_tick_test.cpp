// SPDX-License-Identifier: MIT
// The regular tick from the inside: its linear algebra and its second derivative against independent truth, and its promises
// on random arms of six joints: turning, sliding, coupled, reversed.
#define MDHCAL_REAL double
#include "lib/src/inverse/regular_tick.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mdhcal/kinematics.hpp"
#include "tests/lib/arms.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

double norm(const double* x) { return std::sqrt(tail_product<0>(x, x)); }

// Six joints: three parallel axes, a spherical wrist, no family, a gantry with a wrist; readings reversed; couplings, also
// of a slide to a turn.
Geometry six_joints(Random& random, int kind) {
  Geometry g = kind % 4 == 0 ? ur5() : kind % 4 == 1 ? wrist_arm() : random_arm(random);
  if (kind % 4 == 3) {
    for (int i = 0; i < 3; ++i) {
      g.joint[i].kind = JointKind::prismatic;
      g.link[i].alpha_rad = (i == 0 ? 0 : 90) * deg;
      g.link[i].theta_rad = 90 * deg;
    }
  }
  g = with_errors(g, random, 1e-3, 0.1 * deg);
  for (int i = 0; i < 6; ++i) g.joint[i].sign = random.symmetric(1) < 0 ? -1 : 1;
  if (kind % 3 == 1) g.joint[2].coupling[1] = random.symmetric(1);
  if (kind % 5 == 2) g.joint[5].coupling[0] = random.symmetric(1);
  return g;
}

TEST(RegularTick, SolvesItsEquationsAndBoundsTheSmallestSingularValue) {
  Random random(11);
  for (int n = 0; n < cases(1000); ++n) {
    double a[6][6];  // by columns
    Factors f;
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 6; ++i) f.column[j][i] = a[j][i] = random.symmetric(1) * (i < 3 ? 1 : 1e-3) + (i == j ? 0.1 : 0);
    }
    ASSERT_TRUE(factor(f)) << n;
    double x[6], b[6] = {};
    for (double& entry : x) entry = random.symmetric(1);
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 6; ++i) b[i] += a[j][i] * x[j];
    }
    solve(f, b);
    const double bound = singular_bound(f);
    for (int j = 0; j < 6; ++j) ASSERT_NEAR(b[j], x[j], 1e-14 / bound) << n;
    // Power iteration for the largest singular value of the inverse, with A^T by the transpose's own factors.
    Factors transpose;
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 6; ++i) transpose.column[j][i] = a[i][j];
    }
    ASSERT_TRUE(factor(transpose)) << n;
    double v[6] = {1, 1, 1, 1, 1, 1};
    double largest = 0;
    for (int k = 0; k < 200; ++k) {
      const double length = norm(v);
      for (double& entry : v) entry /= length;
      solve(f, v);
      largest = norm(v);
      solve(transpose, v);
    }
    ASSERT_LE(bound, 1.001 / largest) << n;
    ASSERT_GE(bound * std::sqrt(6.0), 0.999 / largest) << n;
  }
}

TEST(RegularTick, RefusesASingularMatrix) {
  Factors f{};
  for (int j = 0; j < 6; ++j) f.column[j][j] = j == 3 ? 0 : 1;
  EXPECT_FALSE(factor(f));
}

// Against central differences of the Jacobian by coordinate. Their error is of the square of the difference.
TEST(RegularTick, KnowsHowTheJacobianChanges) {
  Random random(12);
  for (int n = 0; n < cases(2000); ++n) {
    Geometry g = six_joints(random, n);
    for (Joint& joint : g.joint) {
      joint.sign = joint.sign == 0 ? 0 : 1;
      for (double& ratio : joint.coupling) ratio = 0;
    }
    Arm<double> arm{};
    ASSERT_EQ(make_arm(g, arm), Status::ok);
    double q[6], a[6], b[6];
    for (int j = 0; j < 6; ++j) {
      q[j] = random.symmetric(3);
      a[j] = random.symmetric(1);
      b[j] = random.symmetric(1);
    }
    Look look;
    evaluate(arm, q, look.frame, look.coordinates);
    double change[6];
    change_of_motion(look.coordinates, 6, a, b, change);
    constexpr double h = 1e-5;
    double difference[6] = {};
    for (const double side : {1.0, -1.0}) {
      double there[6];
      for (int j = 0; j < 6; ++j) there[j] = q[j] + side * h * a[j];
      Look moved;
      evaluate(arm, there, moved.frame, moved.coordinates);
      for (int j = 0; j < 6; ++j) {
        for (int k = 0; k < 6; ++k) difference[k] += side / (2 * h) * moved.coordinates.column[j][k] * b[j];
      }
    }
    for (int k = 0; k < 6; ++k) ASSERT_NEAR(change[k], difference[k], 1e-7) << n << " " << k;
  }
}

struct Prepared {
  Arm<double> arm;
  TickOptions<double> options;
  TickState state;
  double last[6];
};

// A tick without limits from `last` to the pose of the joints `goal`.
void prepare(const Geometry& g, const double* last, const double* goal, Prepared& p) {
  ASSERT_EQ(make_arm(g, p.arm), Status::ok);
  p.options = default_tick_options(p.arm);
  p.state.arm = &p.arm;
  p.state.options = &p.options.goal;
  p.state.tick = &p.options;
  p.state.length_m = length_unit(p.arm);
  evaluate(p.arm, goal, p.state.target);
  for (int j = 0; j < 6; ++j) {
    p.last[j] = p.state.q[j] = last[j];
    p.state.low[j] = -max_reading;
    p.state.high[j] = max_reading;
  }
  p.state.last = p.last;
  p.state.evaluations = 0;
}

// Whatever the arm: where it says so the pose is met, by the forward model, within the bounds; and it says so on nearly every
// arm that is regular. Seeds to 0.02 rad and 0.02 m.
TEST(RegularTick, MeetsThePoseOfSixJointsOfEveryKind) {
  Random random(13);
  int regular = 0;
  int met = 0;
  for (int n = 0; n < cases(8000); ++n) {
    const Geometry g = six_joints(random, n);
    double last[6], goal[6];
    for (int j = 0; j < 6; ++j) {
      last[j] = random.symmetric(3);
      goal[j] = last[j] + random.symmetric(0.02);
    }
    Prepared p;
    prepare(g, last, goal, p);
    const int narrow = n % 12;
    if (narrow < 6) p.state.high[narrow] = last[narrow] + random.uniform(0, 0.02);
    Look look;
    const bool said = regular_tick(p.state, look);
    if (p.state.smallest_singular_value > 0.05 && narrow >= 6) {
      ++regular;
      met += said ? 1 : 0;
    }
    if (!said) continue;
    for (int j = 0; j < 6; ++j) {
      ASSERT_LE(p.state.q[j], p.state.high[j]) << n;
      ASSERT_GE(p.state.q[j], p.state.low[j]) << n;
    }
    Frame<double> reached;
    evaluate(p.arm, p.state.q, reached);
    PoseError error;
    pose_error(p.state.target, reached, Task::pose, error);
    ASSERT_LE(error.position_m, p.options.goal.position_tolerance_m) << n;
    ASSERT_LE(error.rotation_rad, p.options.goal.rotation_tolerance_rad) << n;
  }
  EXPECT_GT(regular, cases(500));
  EXPECT_GE(met, regular - regular / 100);
}

// No dead band: a pose that is met within the tolerance is still gone to.
TEST(RegularTick, MakesAStepHoweverWideTheTolerance) {
  Random random(14);
  for (int n = 0; n < cases(2000); ++n) {
    const Geometry g = six_joints(random, n);
    double last[6], goal[6];
    for (int j = 0; j < 6; ++j) {
      last[j] = random.symmetric(3);
      goal[j] = last[j] + random.symmetric(1e-6);
    }
    Prepared p;
    prepare(g, last, goal, p);
    p.options.goal.position_tolerance_m = p.options.goal.rotation_tolerance_rad = 1e-3;
    Look look;
    const bool met = regular_tick(p.state, look);
    if (!(p.state.smallest_singular_value > 0.02)) continue;
    ASSERT_TRUE(met) << n;
    // Third order in a step of 1e-6 times the inverse's size: below the rounding.
    ASSERT_LT(p.state.error.position_m, 1e-13) << n;
    ASSERT_LT(p.state.error.rotation_rad, 1e-13) << n;
  }
}

}  // namespace
