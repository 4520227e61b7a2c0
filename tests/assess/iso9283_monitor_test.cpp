// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdio>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "offline/assess/iso9283.hpp"
#include "offline/assess/monitor.hpp"
#include "offline/identify/calibrate.hpp"
#include "offline/robot/rotation.hpp"
#include "offline/simulate/family.hpp"
#include "offline/simulate/simulate.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;

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

// In the limit of many visits with equal normal errors in all axes the distances are Maxwell distributed: mean
// sigma sqrt(8 / pi), standard deviation sigma sqrt(3 - 8 / pi); AP goes to the bias.
TEST(Iso9283, FiguresOfNormalScatterAreThoseOfMaxwell) {
  Random random(3);
  const double sigma = 0.05, pi = std::numbers::pi;
  std::vector<Visit> visits;
  for (int k = 0; k < 40000; ++k) {
    visits.push_back({"P", {0.3 + sigma * random.normal(), -0.4 + sigma * random.normal(), sigma * random.normal()}});
  }
  const PoseTest pose = iso9283(visits).poses.at(0);
  EXPECT_NEAR(pose.accuracy_mm, 0.5, 4 * sigma / 200);
  EXPECT_NEAR(pose.repeatability_mm, sigma * (std::sqrt(8 / pi) + 3 * std::sqrt(3 - 8 / pi)), 0.01 * sigma * 3.6);
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

// Whole calibrations of simulated arms, judged on 100 held-out poses, then checked on ten more: unchanged arms raise an alarm
// as often as alpha says, and one joint's zero point lost by a tenth of a degree is found.
TEST(Monitor, UnchangedCalibratedArmsPassAndAChangedOneIsFound) {
  constexpr int arms = 300;
  constexpr std::size_t reference = 100;
  constexpr double alpha = 0.05, change_rad = 0.1 * std::numbers::pi / 180;
  int alarms = 0, found = 0, called_frame = 0;
  for (int arm = 0; arm < arms; ++arm) {
    SimulationOptions options;
    options.seed = 500 + static_cast<std::uint64_t>(arm);
    options.test_configurations = reference + 10;
    const Simulation s = simulate(family_robot(family_names()[static_cast<std::size_t>(arm) % 4]), options);
    const Calibration c = calibrate(s.nominal, s.train, {}, &s.test);
    Estimate changed;
    changed.geometry = s.truth.geometry;
    changed.geometry.link[2].theta_rad += change_rad;
    changed.tracker_T_base = frame_of(*s.truth.tracker_T_base);
    changed.flange_p_m = {s.truth.targets[0].flange_p_m};
    const MeasurementModel identified(c.estimate), now(changed);
    Random noise(options.seed);
    double mean_mm = 0;
    std::vector<Vector3> predicted, measured, measured_now;
    for (std::size_t i = 0; i < s.test.rows.size(); ++i) {
      const Measurement& row = s.test.rows[i];
      const Vector3 p = identified.target_position(row.q.data(), 0), m = row.position_m;
      if (i < reference) {
        mean_mm += 1e3 * std::hypot(p[0] - m[0], p[1] - m[1], p[2] - m[2]) / reference;
        continue;
      }
      predicted.push_back(p);
      measured.push_back(m);
      measured_now.push_back(now.target_position(row.q.data(), 0));
      for (double& x : measured_now.back()) x += options.noise_m * noise.normal();
    }
    alarms += monitor(predicted, measured, mean_mm, reference, alpha).condition != Condition::good;
    const Condition after = monitor(predicted, measured_now, mean_mm, reference, alpha).condition;
    found += after == Condition::recalibrate;
    called_frame += after == Condition::frame_moved;
  }
  std::printf("%d false alarms of %d at alpha %.2f; %d of the changed arms found, %d taken for a moved frame\n", alarms, arms,
              alpha, found, called_frame);
  EXPECT_NEAR(alarms, alpha * arms, 4 * std::sqrt(alpha * (1 - alpha) * arms));
  EXPECT_GT(found, arms * 98 / 100);
}

}  // namespace
