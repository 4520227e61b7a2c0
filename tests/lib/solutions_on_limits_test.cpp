// SPDX-License-Identifier: MIT
// No solution is lost on a joint limit: neither where a joint stands on it exactly, nor where full turns meet it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mdhcal/kinematics.hpp"
#include "mdhcal/solutions.hpp"
#include "tests/lib/arms.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

void limit_all(Geometry& g, double bound) {
  for (int j = 0; j < g.joint_count; ++j) {
    g.joint[j].has_min = g.joint[j].has_max = 1;
    g.joint[j].min = -bound;
    g.joint[j].max = bound;
  }
}

/// Largest difference of the joints, modulo full turns.
template <class Real>
double apart(const Real* a, const double* b) {
  double worst = 0;
  for (int j = 0; j < 6; ++j) worst = std::max(worst, std::fabs(std::remainder(static_cast<double>(a[j]) - b[j], 2 * pi)));
  return worst;
}

/// Whether the joints `goal` are among the solutions of their own pose, and all of these keep the limits.
template <class Real>
testing::AssertionResult finds_its_own(const Geometry& g, const double* goal, const double* posture) {
  Arm<Real> arm{};
  if (make_arm(g, arm) != Status::ok) return testing::AssertionFailure() << "no arm";
  Real q[6], from[6];
  for (int j = 0; j < 6; ++j) {
    q[j] = static_cast<Real>(goal[j]);
    from[j] = static_cast<Real>(posture[j]);
  }
  Pose<Real> target{};
  Solutions<Real> found{};
  if (forward(arm, q, target) != Status::ok) return testing::AssertionFailure() << "no pose";
  if (find_solutions(arm, default_solution_options(arm), target, from, found) != Status::ok) {
    return testing::AssertionFailure() << "none found";
  }
  bool there = false;
  for (int k = 0; k < found.count; ++k) {
    for (int j = 0; j < 6; ++j) {
      if (found.q[k][j] < arm.min[j] || found.q[k][j] > arm.max[j]) return testing::AssertionFailure() << "outside";
    }
    there = there || apart(found.q[k], goal) < (sizeof(Real) == sizeof(double) ? 1e-6 : 5e-3);
  }
  return there ? testing::AssertionSuccess() : testing::AssertionFailure() << found.count << " others";
}

/// Joints away from the singularities of elbow, wrist and shoulder, on both sides.
void regular_joints(Random& random, double* q) {
  for (int j = 0; j < 6; ++j) q[j] = random.symmetric(1);
  q[2] = (random.symmetric(1) < 0 ? -1 : 1) * random.uniform(0.6, 1.6);
  q[4] = (random.symmetric(1) < 0 ? -1 : 1) * random.uniform(0.6, 1.6);
}

// Limits of half and of full turns; one joint at a limit or off it by a rounding, or by what a tolerance may hide.
template <class Real>
void turns_that_meet_a_limit(std::uint64_t seed) {
  Random random(seed);
  for (int n = 0; n < cases(600); ++n) {
    Geometry g = with_errors(n % 2 == 0 ? ur5() : wrist_arm(), random, 1e-3, 0.1 * deg);
    limit_all(g, n % 4 < 2 ? pi : 2 * pi);
    double goal[6], posture[6];
    regular_joints(random, goal);
    for (double& joint : posture) joint = random.symmetric(pi);
    const int joint = n % 3 == 0 ? 0 : (n % 3 == 1 ? 3 : 5);
    const double off[] = {0, 1e-15, 1e-12, 1e-9, 1e-6, 6e-6};
    const double inside = off[n % 6];
    const double at = n % 4 < 2 ? pi : (n % 8 < 4 ? 2 * pi : 0);
    goal[joint] = n % 5 < 3 ? -at + inside : at - inside;
    posture[joint] = random.symmetric(6.2);
    ASSERT_TRUE(finds_its_own<Real>(g, goal, posture)) << n;
  }
}

// A limit at the very reading.
template <class Real>
void joints_on_a_limit(std::uint64_t seed) {
  Random random(seed);
  for (int n = 0; n < cases(600); ++n) {
    Geometry g = with_errors(n % 2 == 0 ? ur5() : wrist_arm(), random, 1e-3, 0.1 * deg);
    limit_all(g, 2.9);
    double goal[6], posture[6];
    regular_joints(random, goal);
    for (int j = 0; j < 6; ++j) {
      goal[j] = static_cast<double>(static_cast<Real>(goal[j]));
      posture[j] = goal[j] + random.symmetric(0.01);
    }
    const int joint = n % 6;
    (n % 4 < 2 ? g.joint[joint].max : g.joint[joint].min) = goal[joint];
    ASSERT_TRUE(finds_its_own<Real>(g, goal, posture)) << n;
  }
}

TEST(SolutionsOnLimits, AreFoundWhereFullTurnsMeetALimitInDouble) { turns_that_meet_a_limit<double>(71); }
TEST(SolutionsOnLimits, AreFoundWhereFullTurnsMeetALimitInFloat) { turns_that_meet_a_limit<float>(72); }
TEST(SolutionsOnLimits, AreFoundWhereAJointStandsOnItInDouble) { joints_on_a_limit<double>(73); }
TEST(SolutionsOnLimits, AreFoundWhereAJointStandsOnItInFloat) { joints_on_a_limit<float>(74); }

}  // namespace
