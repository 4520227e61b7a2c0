// SPDX-License-Identifier: MIT
// Held-out accuracy on every measured set: the figures that docs/method.md records.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "offline/identify/calibrate.hpp"
#include "tests/identify/published_data.hpp"
#include "tests/support/shared_data.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using mdhcal::tests::shared_data;

CalibrationOptions given_frames() {
  CalibrationOptions options;
  options.fit_base = false;
  options.fit_tool = false;
  return options;
}

double largest_deviation(const Calibration& c) {
  double most = 0.0;
  for (const EstimatedParameter& p : c.parameters) most = std::max(most, std::fabs(p.deviation) * 1e3);
  return most;  // [mm] or [mrad]
}

Statistics of_rows(const Calibration& c, const std::set<std::string>& left_out) {
  std::vector<double> errors;
  for (const RowResult& r : c.rows) {
    if (!r.test || left_out.count(c.testing.rows[r.row].id) > 0) continue;
    errors.push_back(std::hypot(r.after_mm[0], r.after_mm[1], r.after_mm[2]));
  }
  return statistics(errors);
}

MDHCAL_SHARED_DATA_TEST(Published, NinePosesPredictTheSixteen) {
  const Dataset test = tests::li2022_eighteen();
  const Calibration c = calibrate(tests::li2022_robot(), tests::li2022_nine(), given_frames(), &test);
  const Statistics s = of_rows(c, {"6", "7"});
  EXPECT_EQ(s.count, 16U);
  EXPECT_LE(s.mean, 0.033);
  EXPECT_LE(s.median, 0.019);
  EXPECT_LE(s.max, 0.155);
  const std::set<std::string> named(c.test->outliers.begin(), c.test->outliers.end());
  EXPECT_TRUE(named.count("6") == 1 && named.count("7") == 1);
}

MDHCAL_SHARED_DATA_TEST(Published, NinePosesByTheFoldsOfRpim) {
  const Dataset test = tests::li2022_eighteen();
  CalibrationOptions options = given_frames();
  options.lambda_rule = "rpim";
  const Statistics s = of_rows(calibrate(tests::li2022_robot(), tests::li2022_nine(), options, &test), {"6", "7"});
  EXPECT_LE(s.mean, 0.033);
  EXPECT_LE(s.median, 0.019);
  EXPECT_LE(s.max, 0.155);
}

MDHCAL_SHARED_DATA_TEST(Published, GrossErrorsOfTheEighteenAreFound) {
  const Dataset test = tests::li2022_nine();
  const Calibration c = calibrate(tests::li2022_robot(), tests::li2022_eighteen(), given_frames(), &test);
  EXPECT_EQ(c.train.outliers, (std::vector<std::string>{"2", "6", "7", "17"}));
  EXPECT_LE(c.test->after.mean, 0.025);
}

MDHCAL_SHARED_DATA_TEST(Published, GrossErrorsOfAllTwentySevenAreFound) {
  const Calibration c = calibrate(tests::li2022_robot(), tests::li2022_all(), given_frames());
  EXPECT_EQ(c.train.outliers, (std::vector<std::string>{"t8-2", "t8-6", "t8-7", "t8-17"}));
}

Statistics ur5(bool (*trains)(std::size_t), double& deviation) {
  const Robot robot = read_robot(shared_data("ur5_grid/robot.toml"));
  const Dataset all = read_dataset(shared_data("ur5_grid/measurements.csv"), robot);
  const Dataset train = tests::rows_where(all, trains);
  const Dataset test = tests::rows_where(all, [&](std::size_t i) { return !trains(i); });
  const Calibration c = calibrate(robot, train, {}, &test);
  deviation = largest_deviation(c);
  return c.test->after;
}

MDHCAL_SHARED_DATA_TEST(Published, Ur5EvenRowsPredictTheOdd) {
  double deviation = 0;
  const Statistics s = ur5([](std::size_t i) { return i % 2 == 0; }, deviation);
  EXPECT_LE(s.mean, 0.105);
  EXPECT_LE(s.max, 0.28);
  EXPECT_LE(deviation, 15.0);
}

MDHCAL_SHARED_DATA_TEST(Published, Ur5TwentyRowsPredictTheRest) {
  double deviation = 0;
  EXPECT_LE(ur5([](std::size_t i) { return i % 50 == 25; }, deviation).mean, 0.146);
  EXPECT_LE(deviation, 15.0);
}

MDHCAL_SHARED_DATA_TEST(Published, Ur5ThirtyRowsPredictTheRest) {
  double deviation = 0;
  EXPECT_LE(ur5([](std::size_t i) { return i % 33 == 16 && i < 990; }, deviation).mean, 0.117);
  EXPECT_LE(deviation, 15.0);
}

MDHCAL_SHARED_DATA_TEST(Published, FanucLeavingOneConfigurationOut) {
  const Robot robot = read_robot(shared_data("fanuc_r2000ic/robot.toml"));
  const Dataset all = read_dataset(shared_data("fanuc_r2000ic/measurements.csv"), robot);
  std::vector<double> errors;
  for (std::uint32_t group = 0; group < all.groups.size(); ++group) {
    const Dataset train = tests::rows_where(all, [&](std::size_t i) { return all.rows[i].group != group; });
    const Dataset test = tests::rows_where(all, [&](std::size_t i) { return all.rows[i].group == group; });
    const Calibration c = calibrate(robot, train, {}, &test);
    for (const RowResult& r : c.rows) {
      if (r.test) errors.push_back(std::hypot(r.after_mm[0], r.after_mm[1], r.after_mm[2]));
    }
  }
  const Statistics s = statistics(errors);
  EXPECT_EQ(s.count, 720U);
  EXPECT_LE(s.mean, 0.200);
  EXPECT_LE(s.max, 0.59);
}

MDHCAL_SHARED_DATA_TEST(Published, TestRowsEnterNothingButTheFigures) {
  Dataset test = tests::li2022_eighteen();
  const Calibration a = calibrate(tests::li2022_robot(), tests::li2022_nine(), given_frames(), &test);
  for (std::size_t i = 0; i + 1 < test.rows.size(); ++i) {
    std::swap(test.rows[i].position_m, test.rows[i + 1].position_m);
  }
  const Calibration b = calibrate(tests::li2022_robot(), tests::li2022_nine(), given_frames(), &test);
  EXPECT_EQ(write_robot(a.corrected), write_robot(b.corrected));
  EXPECT_NE(a.test->after.mean, b.test->after.mean);
}

}  // namespace
