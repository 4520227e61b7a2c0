// SPDX-License-Identifier: MIT
// What the robot file and the options say about single parameters, and what a group is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "offline/assess/cross_validation.hpp"
#include "offline/base/random.hpp"
#include "offline/identify/folds.hpp"
#include "offline/identify/mistakes/diagnose.hpp"
#include "offline/simulate/family.hpp"
#include "tests/identify/simulated.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using namespace mdhcal::tests;

Simulation simulated(const Robot& robot, std::uint64_t seed = 6) { return simulate(robot, arm_options(seed)); }

const EstimatedParameter* find(const Calibration& c, const std::string& word) {
  const auto found = std::find_if(c.parameters.begin(), c.parameters.end(),
                                  [&](const EstimatedParameter& p) { return name(p.id) == word; });
  return found == c.parameters.end() ? nullptr : &*found;
}

// The robot file of a simulated arm with [prior] added, in the file's units.
Robot with_prior(Robot robot, const std::string& prior) {
  return parse_robot(write_robot(robot) + "[prior]\n" + prior, "robot.toml");
}

TEST(Prior, IsInTheFilesUnits) {
  const Simulation s = simulated(family_robot("three-parallel"));
  Robot robot = with_prior(s.nominal, "alpha4 = 0.25\na3 = 2.5\n");
  const Calibration c = calibrate(robot, s.train, {});
  EXPECT_DOUBLE_EQ(find(c, "alpha4")->prior, 0.25 * 3.14159265358979323846 / 180.0);
  EXPECT_DOUBLE_EQ(find(c, "a3")->prior, 2.5e-3);
  EXPECT_DOUBLE_EQ(find(c, "a4")->prior, 1e-3);

  robot = s.nominal;
  robot.length_in_mm = robot.angle_in_deg = false;
  const Calibration in_si = calibrate(with_prior(robot, "alpha4 = 0.002\na3 = 0.0025\n"), s.train, {});
  EXPECT_DOUBLE_EQ(find(in_si, "alpha4")->prior, 0.002);
  EXPECT_DOUBLE_EQ(find(in_si, "a3")->prior, 2.5e-3);
}

// With lambda set. A rule that estimates lambda estimates the scale common to all priors, so it would stretch one that
// the measurements contradict by far.
TEST(Prior, ATightOneKeepsItsParameterAndLeavesTheOthers) {
  const Simulation s = simulated(family_robot("three-parallel"));
  CalibrationOptions options;
  options.lambda = 0.0004;
  const double free = find(calibrate(s.nominal, s.train, {}), "a4")->deviation;
  ASSERT_GT(std::fabs(free), 0.1e-3);
  const Calibration c = calibrate(with_prior(s.nominal, "a4 = 1e-6\n"), s.train, options);
  EXPECT_LT(std::fabs(find(c, "a4")->deviation), 0.02 * std::fabs(free));
  double most = 0;
  for (const EstimatedParameter& p : c.parameters) {
    if (!is_angle(p.id)) most = std::max(most, std::fabs(p.deviation));
  }
  EXPECT_GT(most, 0.1e-3);
}

TEST(FixAndFree, AreObeyedAndSaid) {
  const Simulation s = simulated(family_robot("three-parallel"));
  CalibrationOptions options;
  options.parameters.fix = {"a3", "d5"};
  options.parameters.free = {"beta4"};
  const Calibration c = calibrate(s.nominal, s.train, options);
  EXPECT_EQ(find(c, "a3"), nullptr);
  EXPECT_EQ(find(c, "d5"), nullptr);
  ASSERT_NE(find(c, "beta4"), nullptr);
  EXPECT_EQ(c.corrected.geometry.link[2].a_m, s.nominal.geometry.link[2].a_m);
  EXPECT_EQ(c.corrected.geometry.link[4].d_m, s.nominal.geometry.link[4].d_m);
  for (const char* said : {"a3 is fixed on request.", "d5 is fixed on request.", "beta4 is freed on request."}) {
    EXPECT_EQ(std::count(c.decisions.begin(), c.decisions.end(), said), 1) << said;
  }
  // The truth has a3 and d5 off nominal: what is fixed wrongly is missed.
  EXPECT_GT(distance_from_truth_mm(s, c, 200, 1), 0.05);
}

TEST(FixAndFree, FixingWhatTheTruthLeavesNominalCostsNothing) {
  Simulation s = simulated(family_robot("spherical-wrist"));
  CalibrationOptions options;
  options.parameters.fix = {"alpha1", "beta3"};  // neither is free by default
  EXPECT_EQ(write_robot(calibrate(s.nominal, s.train, options).corrected),
            write_robot(calibrate(s.nominal, s.train, {}).corrected));
}

TEST(JointConvention, SignsAndCouplingsAreFollowed) {
  Robot robot = family_robot("spherical-wrist");
  robot.geometry.joint[1].sign = -1;
  robot.geometry.joint[4].sign = -1;
  robot.geometry.joint[2].coupling[1] = 1.0;
  const Simulation s = simulated(robot, 9);
  EXPECT_LT(distance_from_truth_mm(s, calibrate(s.nominal, s.train, {}), 500, 1), 0.025);
  // The same measurements without the coupling in the file: not fitted away, but recognised.
  Robot uncoupled = s.nominal;
  uncoupled.geometry.joint[2].coupling[1] = 0.0;
  Calibration c = calibrate(uncoupled, s.train, {});
  EXPECT_FALSE(c.usable());
  (void)explain_by_mistakes({uncoupled, s.train, {}}, false, c);
  ASSERT_FALSE(c.reasons.empty());
  EXPECT_NE(c.reasons.front().find("add +1 to the ratio of [[coupling]] of = 3, by = 2"), std::string::npos) << c.reasons.front();
}

Simulation grouped(std::size_t configurations) {
  SimulationOptions options = arm_options(5);
  options.configurations = configurations;
  options.repeats = 4;
  options.targets = 2;
  return simulate(family_robot("five-joint"), options);
}

TEST(Groups, NoFoldSplitsOne) {
  for (const std::size_t configurations : {8U, 15U, 40U, 137U}) {
    const Simulation s = grouped(configurations);
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < s.train.rows.size(); ++i) rows.push_back(i);
    const Folds folds = make_folds(s.train, rows, 3);
    std::vector<std::set<std::uint32_t>> seen(configurations);
    for (std::size_t i = 0; i < rows.size(); ++i) seen[s.train.rows[i].group].insert(folds.of_row[i]);
    for (const auto& folds_of_group : seen) EXPECT_EQ(folds_of_group.size(), 1U);
    EXPECT_EQ(folds.count, configurations < 20 ? configurations : 10U);
  }
}

TEST(Groups, NoTestFractionSplitsOne) {
  const Simulation s = grouped(40);
  CalibrationOptions options;
  options.test_fraction = 0.25;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    options.seed = seed;
    const Calibration c = calibrate(s.nominal, s.train, options);
    std::set<std::uint32_t> train;
    std::set<std::uint32_t> test;
    for (const RowResult& r : c.rows) (r.test ? test : train).insert(c.training.rows[r.row].group);
    EXPECT_EQ(test.size(), 10U);
    EXPECT_EQ(train.size(), 30U);
    for (const std::uint32_t group : test) EXPECT_EQ(train.count(group), 0U);
  }
}

TEST(Groups, ReflectorsOfOnePoseStayTogether) {
  // Without a group column, rows that share an id are one stand of the arm.
  const Robot robot = family_robot("five-joint");
  const Dataset data = parse_dataset(
      "id,target,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,x_mm,y_mm,z_mm\n"
      "1,A,0,0,0,0,0,1,2,3\n1,B,0,0,0,0,0,4,5,6\n2,A,1,0,0,0,0,1,2,4\n2,B,1,0,0,0,0,4,5,7\n",
      "two.csv", robot);
  EXPECT_EQ(data.groups.size(), 2U);
  EXPECT_EQ(data.rows[0].group, data.rows[1].group);
  EXPECT_NE(data.rows[1].group, data.rows[2].group);
}

// docs/method.md: the prior's centre is the geometry of the robot file.
TEST(CorrectedRobotAsInput, DeviationsCountFromItsGeometry) {
  const Simulation s = simulated(family_robot("three-parallel"));
  const Calibration first = calibrate(s.nominal, s.train, {});
  const Robot corrected = parse_robot(write_robot(first.corrected), "corrected.toml");
  const Simulation later = simulated(family_robot("three-parallel"));  // the same truth, measured once more
  const Calibration second = calibrate(corrected, later.train, {});
  EXPECT_TRUE(noted(second, "count from its geometry"));
  EXPECT_FALSE(noted(first, "count from its geometry"));
  for (const EstimatedParameter& p : second.parameters) {
    EXPECT_EQ(p.nominal, value(corrected.geometry, p.id)) << name(p.id);
    EXPECT_LT(std::fabs(p.deviation), 0.1e-3) << name(p.id);
  }
  EXPECT_LT(second.train.before.mean, 0.05);
  // The maker's nominal stays what it was: the blob corrects against that.
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(second.corrected.nominal[i].a_m, s.nominal.geometry.link[i].a_m);
    EXPECT_EQ(second.corrected.nominal[i].d_m, s.nominal.geometry.link[i].d_m);
  }
  EXPECT_LT(distance_from_truth_mm(s, second, 300, 1), 0.025);
}

// The sums are added in the rows' order, so only rounding may differ, and what is decided may not.
TEST(RowOrder, ChangesTheResultByRoundingOnly) {
  Simulation s = simulated(family_robot("seven-joint"));
  (void)add_gross_errors(s.train, 0.05, 2);
  const Calibration a = calibrate(s.nominal, s.train, {});
  Dataset shuffled = s.train;
  Random random(1);
  for (std::size_t i = shuffled.rows.size(); i > 1; --i) std::swap(shuffled.rows[i - 1], shuffled.rows[random.index(i)]);
  const Calibration b = calibrate(s.nominal, shuffled, {});
  ASSERT_EQ(a.parameters.size(), b.parameters.size());
  for (std::size_t i = 0; i < a.parameters.size(); ++i) {
    EXPECT_NEAR(a.parameters[i].deviation, b.parameters[i].deviation, 1e-10) << name(a.parameters[i].id);
  }
  std::vector<std::string> named_a = a.train.outliers;
  std::vector<std::string> named_b = b.train.outliers;
  std::sort(named_a.begin(), named_a.end());
  std::sort(named_b.begin(), named_b.end());
  EXPECT_EQ(named_a, named_b);
  EXPECT_NEAR(a.lambda.lambda, b.lambda.lambda, 1e-6 * a.lambda.lambda);
}

}  // namespace
