// SPDX-License-Identifier: MIT
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "offline/assess/distributions.hpp"
#include "offline/assess/iso9283.hpp"
#include "offline/assess/monitor.hpp"
#include "offline/simulate/random.hpp"

namespace {

using namespace mdhcal::offline;

// Quantiles from printed tables of F, and closed forms.
TEST(Distributions, TheUpperTailOfFIsThatOfTheTables) {
  EXPECT_NEAR(f_upper_tail(3.4928, 2, 20), 0.05, 2e-6);
  EXPECT_NEAR(f_upper_tail(4.9646, 1, 10), 0.05, 2e-6);
  EXPECT_NEAR(f_upper_tail(2.9782, 10, 10), 0.05, 2e-6);
  EXPECT_NEAR(f_upper_tail(161.4476, 1, 1), 0.05, 1e-8);
  EXPECT_NEAR(f_upper_tail(2.5487, 20, 30), 0.01, 2e-6);
  for (const double f : {0.1, 1.0, 3.0, 30.0}) {  // two numerator degrees: (1 + 2 f / d)^(-d / 2)
    EXPECT_NEAR(f_upper_tail(f, 2, 7), std::pow(1 + 2 * f / 7, -3.5), 1e-13);
    EXPECT_NEAR(f_upper_tail(f, 5, 9), 1 - f_upper_tail(1 / f, 9, 5), 1e-13);
  }
  EXPECT_EQ(f_upper_tail(0, 3, 3), 1);
  EXPECT_NEAR(f_upper_tail(1, 30000, 30000), 0.5, 1e-9);
}

TEST(Iso9283, FiguresOfASquareOfPoints) {
  // Four points at (+-1, +-2) about (3, 0, 4): AP 5; all distances sqrt(5), so RP = sqrt(5).
  std::vector<Visit> visits;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-2.0, 2.0}) visits.push_back({"P1", {3 + x, y, 4}});
  }
  visits.push_back({"P2", {0, 0, 0.5}});
  // On a line about 0 at distances 1.5, 0.5 and 1: their mean is 1, their standard deviation 0.5, so RP = 2.5.
  for (const double z : {-1.5, 0.5, 1.0}) visits.push_back({"P3", {0, 0, z}});
  const Iso9283 result = iso9283(visits);
  ASSERT_EQ(result.poses.size(), 3u);
  EXPECT_NEAR(result.poses[0].accuracy_mm, 5, 1e-15);
  EXPECT_NEAR(result.poses[0].repeatability_mm, std::sqrt(5.0), 1e-14);
  EXPECT_EQ(result.poses[1].repeatability_mm, 0);
  EXPECT_NEAR(result.poses[2].repeatability_mm, 1 + 3 * 0.5, 1e-14);
  EXPECT_EQ(result.repeated, 2u);
  EXPECT_EQ(result.fewest_visits, 3u);
  EXPECT_NEAR(result.largest_repeatability_mm, 2.5, 1e-14);
}

// Check series of `count` rows whose axes have standard deviation `sd_mm`.
MonitorResult series(Random& random, std::size_t count, double sd_mm, const Eigen::Isometry3d& motion, double alpha) {
  std::vector<Vector3> predicted, measured;
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector3d p;
    for (double& c : p) c = random.uniform(-1, 1);
    Eigen::Vector3d m = motion * p;
    for (double& c : m) c += 1e-3 * sd_mm * random.normal();
    predicted.push_back({p.x(), p.y(), p.z()});
    measured.push_back({m.x(), m.y(), m.z()});
  }
  // The mean of the norm of three numbers of standard deviation 0.05 mm.
  return monitor(predicted, measured, 0.05 * std::sqrt(8 / 3.14159265358979), 100, alpha);
}

TEST(Monitor, FalseAlarmsComeAsOftenAsAsked) {
  Random random(1);
  int alarms = 0;
  constexpr int runs = 4000;
  for (int k = 0; k < runs; ++k) {
    alarms += series(random, 10, 0.05, Eigen::Isometry3d::Identity(), 0.05).condition != Condition::good;
  }
  // The reference here is exact, so the test is a little shy: 3.3 % by numerical integration; four sigma about it.
  EXPECT_NEAR(static_cast<double>(alarms) / runs, 0.034, 0.013);
}

TEST(Monitor, TellsAMovedTrackerFromAChangedArm) {
  Random random(2);
  Eigen::Isometry3d moved(Eigen::AngleAxisd(3e-4, Eigen::Vector3d(1, 2, 3).normalized()));
  moved.translation() << 2e-4, -1e-4, 3e-4;
  int frame = 0, arm = 0;
  for (int k = 0; k < 200; ++k) {
    const MonitorResult a = series(random, 12, 0.05, moved, 0.01);
    frame += a.condition == Condition::frame_moved;
    EXPECT_GT(a.shift_mm, 0.2);
    arm += series(random, 12, 0.15, Eigen::Isometry3d::Identity(), 0.01).condition == Condition::recalibrate;
  }
  EXPECT_GT(frame, 190);
  EXPECT_GT(arm, 190);
}

}  // namespace
