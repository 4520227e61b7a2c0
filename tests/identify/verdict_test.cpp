// SPDX-License-Identifier: MIT
// What the verdict says, against truths that the identification never sees. The long form is verdict_sweep.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "offline/base/random.hpp"
#include "offline/identify/copies.hpp"
#include "offline/identify/judging.hpp"
#include "offline/simulate/family.hpp"
#include "tests/identify/simulated.hpp"
#include "tests/identify/verdict_jobs.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using namespace mdhcal::tests;

// Norms of three normal numbers, as position errors are: the bounds of their mean hold it in 95 of 100 draws. 4000 draws:
// the share has a standard deviation of 0.35 %.
TEST(BoundsOfTheMean, HoldTheMeanOfSkewedErrors) {
  Random random(5);
  for (const std::size_t count : {5UL, 15UL, 60UL}) {
    std::size_t inside = 0;
    for (int draw = 0; draw < 4000; ++draw) {
      std::vector<double> errors;
      std::vector<std::uint32_t> pose;
      for (std::uint32_t i = 0; i < count; ++i) {
        errors.push_back(std::hypot(random.normal(), random.normal(), random.normal()));
        pose.push_back(i);
      }
      const Bounds bounds = bounds_of_mean(errors, pose);
      const double truth = std::sqrt(8.0 / 3.14159265358979323846);
      inside += bounds.low <= truth && truth <= bounds.high ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(inside) / 4000, 0.95, 0.02) << count;
  }
}

// Three rows of one pose that share their error tell no more than one.
TEST(BoundsOfTheMean, RowsOfOnePoseCountAsOne) {
  const std::vector<double> one = {1, 2, 3, 4};
  const std::vector<double> three = {1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4};
  const Bounds a = bounds_of_mean(one, {0, 1, 2, 3});
  const Bounds b = bounds_of_mean(three, {0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3});
  EXPECT_NEAR(a.low, b.low, 1e-12);
  EXPECT_NEAR(a.high, b.high, 1e-12);
  EXPECT_FALSE(std::isfinite(bounds_of_mean({1.0}, {0}).high));
}

TEST(Verdict, ItsMeanIsTheTruthAndItsBoundsHoldIt) {
  for (const bool held_out : {true, false}) {
    double said = 0;
    double truth = 0;
    std::size_t held = 0;
    std::size_t jobs = 0;
    for (std::uint64_t seed = 2001; seed <= 2040; ++seed) {
      const VerdictJob job = verdict_job(seed);
      if (!held_out && job.poses < 12) continue;
      const VerdictOutcome o = outcome_of(job, seed, held_out);
      said += std::log(o.mean);
      truth += std::log(o.truth);
      held += o.low <= o.truth && o.truth <= o.high ? 1 : 0;
      ++jobs;
      EXPECT_GE(o.mean, 0.5 * o.truth) << seed;
      EXPECT_EQ(o.verdict.find(" 0 mm"), std::string::npos) << o.verdict;
    }
    EXPECT_NEAR(std::exp((said - truth) / static_cast<double>(jobs)), 1.0, held_out ? 0.1 : 0.2) << held_out;
    EXPECT_GE(static_cast<double>(held), 0.85 * static_cast<double>(jobs)) << held_out;
  }
}

// Bit-equal copies of rows, and of a whole target, change neither the result nor its intervals.
TEST(Copies, CountOnce) {
  SimulationOptions options = arm_options(7);
  options.configurations = 30;
  const Simulation s = simulate(family_robot("three-parallel"), options);
  const Calibration once = calibrate(s.nominal, s.train, {});
  Dataset twice = s.train;
  for (const Measurement& m : s.train.rows) {
    Measurement copy = m;
    copy.id += "b";
    copy.group = static_cast<std::uint32_t>(twice.groups.size());
    twice.groups.push_back(copy.id);
    twice.rows.push_back(copy);
  }
  Dataset two_targets = s.train;
  two_targets.targets.push_back("again");
  for (const Measurement& m : s.train.rows) {
    Measurement copy = m;
    copy.target = static_cast<std::uint32_t>(two_targets.targets.size() - 1);
    two_targets.rows.push_back(copy);
  }
  for (const Dataset& data : {twice, two_targets}) {
    const Calibration c = calibrate(s.nominal, data, {});
    EXPECT_TRUE(noted(c, "bit-equal copies"));
    ASSERT_EQ(c.parameters.size(), once.parameters.size());
    for (std::size_t i = 0; i < c.parameters.size(); ++i) {
      EXPECT_EQ(c.parameters[i].low, once.parameters[i].low);
      EXPECT_EQ(c.parameters[i].high, once.parameters[i].high);
    }
  }
  EXPECT_EQ(calibrate(s.nominal, two_targets, {}).corrected.targets.back().name, "again");
}

// A zero that is degrees off is mastering: said in degrees, and moved on request; the rest is then a deviation like any.
TEST(Rezero, MovesALargeZeroIntoTheNominalGeometry) {
  SimulationOptions options = arm_options(9);
  Simulation s = simulate(family_robot("spherical-wrist"), options);
  constexpr double off_rad = 5.0 * 3.14159265358979323846 / 180.0;
  for (Measurement& m : s.train.rows) m.q[2] -= off_rad;
  CalibrationOptions plain;
  const Calibration refused = calibrate(s.nominal, s.train, plain);
  ASSERT_FALSE(refused.usable());
  EXPECT_NE(refused.reasons.back().find("Joint 3's zero is "), std::string::npos) << refused.reasons.back();
  EXPECT_NE(refused.reasons.back().find("--rezero"), std::string::npos);
  plain.rezero = true;
  const Calibration c = calibrate(s.nominal, s.train, plain);
  EXPECT_TRUE(c.usable()) << c.verdict;
  ASSERT_EQ(c.zeros.size(), 1U);
  EXPECT_EQ(c.zeros.front().link, 2);
  // What is left is what the arm was made with.
  const double all = c.corrected.geometry.link[2].theta_rad - s.nominal.geometry.link[2].theta_rad;
  EXPECT_NEAR(all, off_rad + s.truth.geometry.link[2].theta_rad - s.nominal.geometry.link[2].theta_rad, 1e-4);
  EXPECT_NEAR(c.corrected.nominal[2].theta_rad - s.nominal.nominal[2].theta_rad, c.zeros.front().offset, 1e-15);
  EXPECT_LT(std::fabs(c.corrected.geometry.link[2].theta_rad - c.corrected.nominal[2].theta_rad), 1e-2);
}

// Points on one line leave the base free to turn about it.
TEST(Usable, NotWhereTheBaseIsFreeToTurn) {
  const Simulation s = simulate(family_robot("three-parallel"), arm_options(4));
  const MeasurementModel truth = truth_model(s);
  Dataset line = s.train;
  line.rows.clear();
  // Only joint 2 moves, with the arm stretched and a target on the line... of one joint's turn: a circle's points lie in one
  // plane, and one orientation of the flange follows each point.
  Random random(3);
  for (std::size_t i = 0; i < 20; ++i) {
    Measurement m = s.train.rows[i];
    m.q = Joints{};
    m.q[1] = 0.001 * static_cast<double>(i);
    m.position_m = truth.target_position(m.q.data(), 0);
    for (double& c : m.position_m) c += 0.02e-3 * random.normal();
    line.rows.push_back(m);
  }
  CalibrationOptions options;
  options.fit_tool = false;
  const Calibration c = calibrate(s.nominal, line, options);
  EXPECT_FALSE(c.usable()) << c.verdict;
  EXPECT_NE(c.verdict.find("Do not use this result"), std::string::npos);
  options.accept = "a test";
  const Calibration accepted = calibrate(s.nominal, line, options);
  EXPECT_FALSE(accepted.usable());
  EXPECT_TRUE(accepted.released());
}

// Named rows that lie where the model is wrong are said to be that; gross errors are not.
TEST(NamedRows, ThatLieTogetherAreAnErrorOfTheModel) {
  Simulation s = simulate(family_robot("three-parallel"), arm_options(13));
  std::size_t changed = 0;
  for (Measurement& m : s.train.rows) {
    if (m.q[1] < 2.0) continue;
    m.position_m[2] -= 2e-3;
    ++changed;
  }
  ASSERT_GE(changed, 4U);
  const Calibration c = calibrate(s.nominal, s.train, {});
  EXPECT_TRUE(noted(c, "joint 2")) << changed;
  EXPECT_TRUE(noted(c, "error of the model"));
  Simulation gross = simulate(family_robot("three-parallel"), arm_options(13));
  add_gross_errors(gross.train, 0.1, 2);
  const Calibration g = calibrate(gross.nominal, gross.train, {});
  EXPECT_FALSE(noted(g, "error of the model"));
}

}  // namespace
