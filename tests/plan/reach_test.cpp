// SPDX-License-Identifier: MIT
#include "offline/plan/reach.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "offline/simulate/family.hpp"
#include "offline/simulate/simulate.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;

TEST(Reach, ASegmentMeetsABoxExactlyWhenSomePointOfItLiesInside) {
  Random random(1);
  int hits = 0;
  for (int k = 0; k < 2000; ++k) {
    Box box;
    Vector3 a, b;
    for (std::size_t i = 0; i < 3; ++i) {
      box.low_m[i] = random.uniform(-1, 0.5);
      box.high_m[i] = box.low_m[i] + random.uniform(0.05, 1);
      a[i] = random.uniform(-1.5, 1.5);
      b[i] = k % 5 == 0 && i == 1 ? a[i] : random.uniform(-1.5, 1.5);  // some parallel to a face
    }
    // Deepest penetration along a fine walk; near zero the walk cannot decide.
    double deepest = -HUGE_VAL;
    for (int step = 0; step <= 2000; ++step) {
      double inside = HUGE_VAL;
      for (std::size_t i = 0; i < 3; ++i) {
        const double x = a[i] + (b[i] - a[i]) * step / 2000.0;
        inside = std::min({inside, x - box.low_m[i], box.high_m[i] - x});
      }
      deepest = std::max(deepest, inside);
    }
    if (std::abs(deepest) < 2e-3) continue;
    EXPECT_EQ(meets(box, a, b), deepest > 0);
    hits += deepest > 0;
  }
  EXPECT_GT(hits, 100);
}

TEST(Reach, TheReflectorMustFaceTheTracker) {
  const Robot robot = family_robot("three-parallel");
  Arm<double> arm{};
  ASSERT_EQ(make_arm(robot.geometry, arm), Status::ok);
  Random random(2);
  int seen = 0;
  for (int k = 0; k < 500; ++k) {
    const auto q = random_readings(robot.geometry, random);
    Pose<double> pose{};
    ASSERT_EQ(forward(arm, q.data(), pose), Status::ok);
    // The flange's z axis, from the quaternion.
    const double* w = pose.quaternion;
    const Vector3 z{2 * (w[1] * w[3] + w[0] * w[2]), 2 * (w[2] * w[3] - w[0] * w[1]), 1 - 2 * (w[1] * w[1] + w[2] * w[2])};
    Reach reach;
    reach.tracker_p_m = Vector3{1e6, 0, 0};  // so far that the direction is x
    reach.cone_rad = 0.7;
    const bool facing = std::acos(z[0]) < 0.7;
    if (std::abs(std::acos(z[0]) - 0.7) < 1e-5) continue;
    EXPECT_EQ(reachable(robot, arm, reach, q), facing);
    seen += facing;
  }
  EXPECT_GT(seen, 30);
}

TEST(Reach, LimitsAndKeepOutBoxesHold) {
  const Robot robot = family_robot("three-parallel");
  Arm<double> arm{};
  ASSERT_EQ(make_arm(robot.geometry, arm), Status::ok);
  Reach reach;
  Joints q{};
  EXPECT_TRUE(reachable(robot, arm, reach, q));
  q[1] = robot.geometry.joint[1].max + 1e-6;
  EXPECT_FALSE(reachable(robot, arm, reach, q));
  q[1] = 0;
  // Stretched along x at zero: a thin wall across the upper arm is crossed, one beside it is not.
  reach.keep_out = {{{0.2, -1, -1}, {0.21, 1, 1}}};
  EXPECT_FALSE(reachable(robot, arm, reach, q));
  reach.keep_out = {{{0.2, 0.5, -1}, {0.21, 1, 1}}};
  EXPECT_TRUE(reachable(robot, arm, reach, q));
  // The wall now stands between the target and the tracker.
  reach.tracker_p_m = Vector3{0.9, 5, 0};
  reach.cone_rad = 3.15;
  reach.keep_out = {{{0, 2, -1}, {2, 2.1, 1}}};
  EXPECT_FALSE(reachable(robot, arm, reach, q));
}

}  // namespace
