// SPDX-License-Identifier: MIT
// How near float comes to double, on arms of 1 m reach.
#include <gtest/gtest.h>

#include <algorithm>

#include "mdhcal/inverse.hpp"
#include "mdhcal/solutions.hpp"
#include "tests/lib/factors.hpp"
#include "tests/lib/poses.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

constexpr double forward_bound_m = 1e-6;
constexpr double inverse_bound = 1e-5;

// With errors of 5 mm and 0.5 degrees in every parameter, beta among them; lengths scaled to a reach of 1 m; in every
// fourth the parallel axes are parallel but for a microradian, as a nominal table with rounded twists leaves them.
Geometry arm_of_one_metre(int n, Random& random) {
  const Geometry kinds[] = {ur5(), wrist_arm(), published_robot(), puma560()};
  Geometry g = n % 4 == 3 ? with_errors(kinds[(n / 4) % 4], random, 5e-3, 1e-6)
                          : with_errors(kinds[n % 4], random, 5e-3, 0.5 * deg);
  Arm<double> arm{};
  EXPECT_EQ(make_arm(g, arm), Status::ok);
  for (Link& link : g.link) {
    link.a_m /= arm.reach_m;
    link.d_m /= arm.reach_m;
  }
  return g;
}

void random_joints(Random& random, float* q) {
  for (int i = 0; i < 6; ++i) q[i] = static_cast<float>(random.symmetric(pi));
}

TEST(Float, ForwardIsWithinAMicrometreOfTheTruth) {
  Random random(71);
  double worst_m = 0;
  double worst_rad = 0;
  for (int n = 0; n < cases(1000); ++n) {
    const Geometry g = arm_of_one_metre(n, random);
    Arm<float> arm{};
    Arm<double> reference{};
    ASSERT_EQ(make_arm(g, arm), Status::ok);
    ASSERT_EQ(make_arm(g, reference), Status::ok);
    EXPECT_NEAR(reference.reach_m, 1.0, 1e-12);
    for (int k = 0; k < 20; ++k) {
      float q[6];
      random_joints(random, q);
      const double in_double[6] = {static_cast<double>(q[0]), static_cast<double>(q[1]), static_cast<double>(q[2]),
                                   static_cast<double>(q[3]), static_cast<double>(q[4]), static_cast<double>(q[5])};
      Pose<float> pose{};
      Pose<double> truth{};
      ASSERT_EQ(forward(arm, q, pose), Status::ok);
      ASSERT_EQ(forward(reference, in_double, truth), Status::ok);
      Pose<double> widened{};
      std::copy(pose.position_m, pose.position_m + 3, widened.position_m);
      std::copy(pose.quaternion, pose.quaternion + 4, widened.quaternion);
      worst_m = std::max(worst_m, position_distance(widened, truth));
      worst_rad = std::max(worst_rad, small_angle(widened, truth));
    }
  }
  RecordProperty("worst_m", std::to_string(worst_m * 1e6) + " um");
  RecordProperty("worst_rad", std::to_string(worst_rad * 1e6) + " urad");
  EXPECT_LT(worst_m, forward_bound_m);
  EXPECT_LT(worst_rad, 2e-6);
}

// Judged by the product of the factors in long double at the float joints, not by the float forward model.
TEST(Float, InverseComesToWithinTenMicrometres) {
  Random random(72);
  double worst_m = 0;
  double worst_rad = 0;
  for (int n = 0; n < cases(1000); ++n) {
    const Geometry g = arm_of_one_metre(n, random);
    Arm<float> arm{};
    ASSERT_EQ(make_arm(g, arm), Status::ok);
    float truth[6];
    float q[6];
    float far[6];
    random_joints(random, truth);
    random_joints(random, far);
    Pose<float> target{};
    ASSERT_EQ(forward(arm, truth, target), Status::ok);
    for (int i = 0; i < 6; ++i) q[i] = truth[i] + static_cast<float>(random.symmetric(0.003));
    ASSERT_EQ(tick(arm, default_tick_options(arm), target, q), Status::ok) << n;
    ASSERT_EQ(cold_start(arm, default_solution_options(arm), target, far), Status::ok) << n;
    for (const float* joints : {q, far}) {
      const Distance missed = distance(product_of_factors(g, joints), target);
      worst_m = std::max(worst_m, missed.position_m);
      worst_rad = std::max(worst_rad, missed.rotation_rad);
    }
  }
  RecordProperty("worst_m", std::to_string(worst_m * 1e6) + " um");
  RecordProperty("worst_rad", std::to_string(worst_rad * 1e6) + " urad");
  EXPECT_LT(worst_m, inverse_bound);
  EXPECT_LT(worst_rad, inverse_bound);
}

}  // namespace
