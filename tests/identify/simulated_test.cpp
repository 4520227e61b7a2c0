// SPDX-License-Identifier: MIT
// Thinned versions of the sweeps of sweep.cpp, with fixed seeds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "offline/base/random.hpp"
#include "offline/robot/vectors.hpp"
#include "offline/simulate/family.hpp"
#include "tests/identify/simulated.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using namespace mdhcal::tests;

TEST(SimulatedArms, AreFoundToTwentyFiveMicrometres) {
  for (const std::string& family : family_names()) {
    double mean = 0;
    constexpr std::uint64_t count = 6;
    for (std::uint64_t seed = 1; seed <= count; ++seed) {
      const Simulation s = simulate(family_robot(family), arm_options(seed));
      const double distance = distance_from_truth_mm(s, calibrate(s.nominal, s.train, {}), 1000, 5000 + seed);
      EXPECT_LE(distance, 0.025) << family << " seed " << seed;
      mean += distance / count;
    }
    EXPECT_LE(mean, 0.017) << family;
  }
}

TEST(SimulatedArms, GrossErrorsAreNamedAndDoNoHarm) {
  for (const std::string& family : family_names()) {
    double clean = 0;
    double gross = 0;
    std::size_t good_named = 0;
    std::size_t good = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      Simulation s = simulate(family_robot(family), arm_options(seed));
      clean += distance_from_truth_mm(s, calibrate(s.nominal, s.train, {}), 1000, 5000 + seed);
      const std::vector<std::size_t> bad = add_gross_errors(s.train, 0.05, 1000 + seed);
      const Calibration c = calibrate(s.nominal, s.train, {});
      gross += distance_from_truth_mm(s, c, 1000, 5000 + seed);
      for (const RowResult& r : c.rows) {
        if (std::binary_search(bad.begin(), bad.end(), r.row)) {
          EXPECT_TRUE(r.outlier) << family << " seed " << seed << " row " << r.row;
        } else {
          good_named += r.outlier ? 1 : 0;
          ++good;
        }
      }
    }
    EXPECT_LE(gross, 1.2 * clean) << family;
    EXPECT_LE(static_cast<double>(good_named), 0.01 * static_cast<double>(good)) << family;
  }
}

TEST(SimulatedArms, EveryMethodConvergesOrSaysThatItDidNot) {
  for (const std::string& family : family_names()) {
    const Simulation s = simulate(family_robot(family), arm_options(3));
    CalibrationOptions options;
    options.method = "nc";
    const double nominal = calibrate(s.nominal, s.train, options).train.after.rms;
    for (const char* method : {"lsm", "gd", "gn", "lm", "ekf", "rpim", "rpim-train"}) {
      options.method = method;
      const Calibration c = calibrate(s.nominal, s.train, options);
      if (c.converged) {
        EXPECT_LE(c.train.after.rms, 0.05 * nominal) << family << ' ' << method;
      } else {
        EXPECT_FALSE(c.notes.empty()) << family << ' ' << method;
        EXPECT_FALSE(c.usable());
        EXPECT_NE(c.verdict.find("Do not use this result: The fit did not converge."), std::string::npos) << family << ' ' << method;
      }
    }
  }
}

// 40 calibrations of one arm, truths from the prior: 27 or so parameters each, so the pooled share of intervals that
// hold the truth has a standard deviation of about 1 %. The 1000 of the issue are in sweep.cpp.
TEST(Uncertainty, IntervalsCoverTheTruth) {
  std::size_t inside = 0;
  std::size_t count = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SimulationOptions so = arm_options(seed);
    so.angle_error_rad = 1e-3;
    const Simulation s = simulate(family_robot("three-parallel"), so);
    const Coverage one = coverage(s, calibrate(s.nominal, s.train, {}));
    inside += one.inside;
    count += one.count;
  }
  const double share = static_cast<double>(inside) / static_cast<double>(count);
  EXPECT_GE(share, 0.92);
  EXPECT_LE(share, 0.98);
}

// Three reflectors a pose share the pose's error: three times as many rows are not three times as much told.
TEST(Uncertainty, IntervalsReckonWithWhatRowsOfAPoseShare) {
  std::size_t inside = 0;
  std::size_t count = 0;
  double by_pose = 0.0;
  for (std::uint64_t seed = 1; seed <= 48; ++seed) {
    SimulationOptions so = arm_options(seed);
    so.angle_error_rad = 1e-3;
    so.configurations = 40;
    so.targets = 3;
    Simulation s = simulate(family_robot(family_names()[seed % 4]), so);
    add_shared_error(s.train, 0.1e-3, seed);
    CalibrationOptions options;
    options.cross_validate = false;
    const Calibration c = calibrate(s.nominal, s.train, options);
    const Coverage one = coverage(s, c);
    inside += one.inside;
    count += one.count;
    by_pose += c.shared.by_pose / 48.0;
  }
  const double share = static_cast<double>(inside) / static_cast<double>(count);
  EXPECT_GE(share, 0.93);
  EXPECT_LE(share, 0.97);
  // 0.1 mm shared, 0.02 mm of each row's own.
  EXPECT_NEAR(by_pose, 1.0 / 1.04, 0.01);
}

// At single joint vectors, within the measured poses and far from them: the same arm measured 200 times.
TEST(Uncertainty, PredictedPositionErrorAtAnyPoseIsThatOfRepeatedCalibrations) {
  SimulationOptions quiet = arm_options(7);
  quiet.noise_m = 0;
  quiet.configurations = 40;
  const Simulation s = simulate(family_robot("five-joint"), quiet);
  const MeasurementModel truth = truth_model(s);
  Random random(12);
  std::vector<std::array<double, mdhcal::max_joints>> poses;
  for (int i = 0; i < 6; ++i) poses.push_back(random_readings(s.truth.geometry, random));
  std::vector<double> predicted(poses.size(), 0.0);
  std::vector<double> made(poses.size(), 0.0);
  constexpr int repeats = 200;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    Dataset noisy = s.train;
    for (Measurement& m : noisy.rows) {
      for (double& x : m.position_m) x += 0.02e-3 * random.normal();
    }
    const Calibration c = calibrate(s.nominal, noisy, {});
    const MeasurementModel corrected(c.estimate);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const double sd = predicted_position_sd_mm(corrected, c.layout, c.covariance, poses[i].data(), 0);
      const double error =
          1e3 * norm(minus(corrected.target_position(poses[i].data(), 0), truth.target_position(poses[i].data(), 0)));
      predicted[i] += sd * sd / repeats;
      made[i] += error * error / repeats;
    }
  }
  // The scatter of a root mean square of 200 is some 4 %; of the arm's one truth, the penalty's bias is one draw.
  for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_NEAR(std::sqrt(predicted[i] / made[i]), 1.0, 0.15) << i;
}

// The predicted standard deviation of the position is that of the error actually made.
TEST(Uncertainty, PredictedPositionErrorIsTheErrorMade) {
  double predicted = 0;
  double made = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Simulation s = simulate(family_robot("spherical-wrist"), arm_options(seed));
    const Calibration c = calibrate(s.nominal, s.train, {});
    const MeasurementModel corrected(c.estimate);
    for (const Measurement& m : s.train.rows) {
      const double sd = predicted_position_sd_mm(corrected, c.layout, c.covariance, m.q.data(), 0);
      predicted += sd * sd;
    }
    // Test rows carry the same noise as the training rows; distance_from_truth_mm() is without it.
    const double d = distance_from_truth_mm(s, c, 200, seed);
    made += d * d * static_cast<double>(s.train.rows.size());
  }
  // The mean distance squared is somewhat below the mean squared distance, the training poses are better known than
  // others: the two agree within 40 %.
  EXPECT_NEAR(std::sqrt(predicted / made), 1.0, 0.4);
}

TEST(Calibrate, TheSameInputGivesTheSameBits) {
  const Simulation s = simulate(family_robot("seven-joint"), arm_options(2));
  const Calibration a = calibrate(s.nominal, s.train, {});
  const Calibration b = calibrate(s.nominal, s.train, {});
  EXPECT_EQ(write_robot(a.corrected), write_robot(b.corrected));
  EXPECT_EQ(a.covariance.value, b.covariance.value);
}

}  // namespace
