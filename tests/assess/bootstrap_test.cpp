// SPDX-License-Identifier: MIT
#include "offline/assess/bootstrap.hpp"

#include <gtest/gtest.h>

#include <atomic>

#include "offline/assess/cross_validation.hpp"
#include "offline/simulate/family.hpp"
#include "offline/simulate/simulate.hpp"

namespace {

using namespace mdhcal::offline;

Simulation simulated(std::size_t repeats) {
  SimulationOptions options;
  options.configurations = 80;
  options.repeats = repeats;
  options.seed = 4;
  options.length_error_m = 1e-3;
  options.angle_error_rad = 1e-3;
  return simulate(family_robot("five-joint"), options);
}

TEST(Bootstrap, DoesNotDependOnTheThreads) {
  const Simulation s = simulated(1);
  const Calibration c = calibrate(s.nominal, s.train, {});
  const Bootstrap one = bootstrap(c, 50, 7, 1);
  const Bootstrap three = bootstrap(c, 50, 7, 3);
  EXPECT_EQ(one.standard_deviation, three.standard_deviation);
  EXPECT_EQ(one.low, three.low);
  EXPECT_NE(one.low, bootstrap(c, 50, 8, 1).low);
}

// Two independent ways to the same uncertainty where noise is all there is.
TEST(Bootstrap, AgreesWithTheCovariance) {
  const Simulation s = simulated(1);
  const Calibration c = calibrate(s.nominal, s.train, {});
  const Bootstrap b = bootstrap(c, 400, 1);
  for (std::size_t p = 0; p < c.parameters.size(); ++p) {
    const double ratio = b.standard_deviation[p] / c.parameters[p].standard_deviation;
    EXPECT_GT(ratio, 0.6) << name(c.parameters[p].id);
    EXPECT_LT(ratio, 1.6) << name(c.parameters[p].id);
    EXPECT_LE(b.low[p], c.parameters[p].deviation);
    EXPECT_GE(b.high[p], c.parameters[p].deviation);
  }
}

TEST(Bootstrap, CountsWhatIsDone) {
  const Simulation s = simulated(1);
  const Calibration c = calibrate(s.nominal, s.train, {});
  std::atomic<std::size_t> calls = 0;
  std::atomic<std::size_t> most = 0;
  (void)bootstrap(c, 40, 7, 3, [&](std::size_t done, std::size_t total) {
    ++calls;
    if (done > most) most = done;
    EXPECT_EQ(total, 40U);
  });
  EXPECT_EQ(calls, 40U);
  EXPECT_EQ(most, 40U);
}

TEST(CrossValidation, LeavesWholeGroupsOut) {
  const Simulation s = simulated(3);
  std::vector<std::size_t> told;
  const RepeatedCrossValidation k = cross_validate(s.nominal, s.train, {}, 4, [&](std::size_t done, std::size_t total) {
    EXPECT_EQ(total, 4U);
    told.push_back(done);
  });
  EXPECT_EQ(told, (std::vector<std::size_t>{1, 2, 3, 4}));
  EXPECT_EQ(k.folds, 4U);
  EXPECT_EQ(k.after.count, s.train.rows.size());
  EXPECT_LT(k.after.mean, 0.06);
  EXPECT_GT(k.before.mean, 0.5);
}

TEST(CrossValidation, OneGroupAtATime) {
  Simulation s = simulated(1);
  s.train.rows.resize(24);
  s.train.groups.resize(24);
  const RepeatedCrossValidation k = cross_validate(s.nominal, s.train, {}, 0);
  EXPECT_EQ(k.folds, 24U);
  EXPECT_EQ(k.after.count, 24U);
}

}  // namespace
