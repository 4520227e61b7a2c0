// SPDX-License-Identifier: MIT
#include <random>

#include <gtest/gtest.h>

#include "offline/base/error.hpp"
#include "offline/import/join.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;

Robot two_joints() {
  Robot robot;
  robot.geometry.joint_count = 2;
  for (int j = 0; j < 2; ++j) robot.geometry.joint[j].sign = 1;
  return robot;
}

SourceRow point(const std::string& id, double x, std::size_t index) {
  SourceRow row;
  if (!id.empty()) row.parts["id"] = id;
  row.position_m = Vector3{x, 0, 0};
  row.index = index;
  row.line = static_cast<long>(index) + 1;
  return row;
}

SourceRow reading(const std::string& id, double q, std::size_t index) {
  SourceRow row;
  if (!id.empty()) row.parts["id"] = id;
  row.joints = Joints{q, -q};
  row.index = index;
  row.line = static_cast<long>(index) + 1;
  return row;
}

SourceTable table(const char* path, std::vector<SourceRow> rows, bool measures) {
  SourceTable out;
  out.path = path;
  out.row_count = rows.size();
  out.rows = std::move(rows);
  out.measures = measures;
  out.has_joints = !measures;
  return out;
}

std::string refused(const std::vector<SourceTable>& exports, const SourceTable& log, const JoinOptions& options) {
  try {
    (void)join(exports, &log, two_joints(), options, {});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Any order of both files: each point gets the joints of its name, and what is alone is said.
TEST(Join, ByNameIgnoresTheOrder) {
  std::mt19937_64 generator(9);
  for (int k = 0; k < 50; ++k) {
    std::vector<SourceRow> points, readings;
    for (std::size_t i = 0; i < 20; ++i) {
      if (i != 3) points.push_back(point("P" + std::to_string(i), 0.1 * static_cast<double>(i + 1), 0));
      if (i != 5) readings.push_back(reading("p" + std::to_string(i), static_cast<double>(i), 0));
    }
    std::shuffle(points.begin(), points.end(), generator);
    std::shuffle(readings.begin(), readings.end(), generator);
    const std::vector<SourceTable> exports{table("t", points, true)};
    const SourceTable log = table("l", readings, false);
    const Joined joined = join(exports, &log, two_joints(), {}, {});
    ASSERT_EQ(joined.rows.size(), 18u);
    for (const JoinedRow& row : joined.rows) EXPECT_NEAR((*row.measured->position_m)[0], 0.1 * (row.joints[0] + 1), 1e-12);
    std::string notes;
    for (const std::string& note : joined.notes) notes += note;
    EXPECT_NE(notes.find("without joints are left out: P5"), std::string::npos) << notes;
    EXPECT_NE(notes.find("without a point are left out: p3"), std::string::npos) << notes;
  }
}

TEST(Join, ByOrderAsksForAsManyRows) {
  const std::vector<SourceTable> exports{table("t", {point("", 1, 0), point("", 2, 1)}, true)};
  const SourceTable as_many = table("l", {reading("", 1, 0), reading("", 2, 1)}, false);
  const Joined joined = join(exports, &as_many, two_joints(), {}, {});
  ASSERT_EQ(joined.rows.size(), 2u);
  EXPECT_EQ(joined.rows[1].joints[0], 2.0);
  EXPECT_NE(joined.notes.front().find("by order"), std::string::npos);
  const SourceTable more = table("l", {reading("", 1, 0), reading("", 2, 1), reading("", 3, 2)}, false);
  EXPECT_NE(refused(exports, more, {}).find("--join"), std::string::npos);
  JoinOptions order;
  order.by = JoinBy::order;
  EXPECT_NE(refused(exports, more, order).find("Found 2 rows of points and 3 of joints"), std::string::npos);
}

TEST(Join, ANameTwiceWithOtherJointsIsRefused) {
  JoinOptions id;
  id.by = JoinBy::id;
  EXPECT_NE(refused({table("t", {point("P1", 1, 0)}, true)}, table("l", {reading("P1", 1, 0), reading("P1", 2, 1)}, false), id).find("l:2:1: Found the name \"P1\" a second time"),
            std::string::npos);
}

// A log of rests and moves with another clock: each point gets the nearest row, never one at which a joint moves.
TEST(Join, ByTimeTakesTheNearestRowAtRest) {
  std::mt19937_64 generator(4);
  std::uniform_real_distribution<double> any(0, 1);
  std::vector<SourceRow> readings;
  for (std::size_t i = 0; i < 400; ++i) {
    const double t = 0.5 * static_cast<double>(i);
    const bool rest = (i / 10) % 2 == 0;
    SourceRow row = reading("", rest ? static_cast<double>(i / 20) : static_cast<double>(i / 20) + 0.1 * static_cast<double>(i % 10 + 1), i);
    row.time_s = 1000 + t;
    readings.push_back(row);
  }
  const SourceTable log = table("l", readings, false);
  std::vector<SourceRow> points;
  for (std::size_t i = 0; i < 300; ++i) {
    SourceRow row = point("", 1, i);
    row.time_s = 1000.35 + 199.5 * any(generator);
    points.push_back(row);
  }
  const std::vector<SourceTable> exports{table("t", points, true)};
  JoinOptions options;
  options.by = JoinBy::time;
  options.clock_offset_s = 0.35;
  options.max_gap_s = 0.3;
  const Joined joined = join(exports, &log, two_joints(), options, {});
  EXPECT_GT(joined.rows.size(), 80u);
  EXPECT_LT(joined.rows.size(), 200u);
  for (const JoinedRow& row : joined.rows) {
    const double t = *row.measured->time_s - 0.35 - 1000;
    const auto nearest = static_cast<std::size_t>(std::lround(2 * t));
    EXPECT_EQ(row.joints, *log.rows[nearest].joints);
    EXPECT_EQ((nearest / 10) % 2, 0u) << "the robot moved";
  }
  std::string notes;
  for (const std::string& note : joined.notes) notes += note;
  EXPECT_NE(notes.find("robot moved are left out"), std::string::npos);
  // A clock that is wrong by an hour joins nothing, and says so.
  options.clock_offset_s = 3600;
  EXPECT_NE(refused(exports, log, options).find("--clock-offset"), std::string::npos);
}

TEST(Join, JointsInBothOrInNeitherAreRefused) {
  SourceTable both = table("t", {point("P1", 1, 0)}, true);
  both.has_joints = true;
  EXPECT_NE(refused({both}, table("l", {reading("P1", 1, 0)}, false), {}).find("in one of them"), std::string::npos);
  try {
    (void)join({table("t", {point("P1", 1, 0)}, true)}, nullptr, two_joints(), {}, {});
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("--robot-log"), std::string::npos);
  }
}

}  // namespace
