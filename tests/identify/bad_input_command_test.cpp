// SPDX-License-Identifier: MIT
// Bad input as a user brings it: the program names what is wrong and what to do about it, leaves no result, and does
// not crash.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include <nlohmann/json.hpp>

#include "tests/cli/cli.hpp"

namespace {

using namespace mdhcal::tests;

using Row = std::map<std::string, std::string>;

// A simulated arm's measurements, each row changed, read back by the program.
class BadInputCommand : public testing::Test {
 protected:
  static constexpr int joints = 6;

  void simulate(const std::string& robot, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"simulate", robot, "-o", folder_ / "s", "--poses", "60", "--seed", "11"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome run = run_mdhcal(arguments);
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }

  Outcome calibrate(const std::function<void(std::size_t, Row&)>& change, const std::string& joint_unit = "_deg",
                    const std::vector<std::string>& more = {}) {
    const CsvTable table(read_bytes(folder_ / "s/measurements.csv"));
    std::string text = "id";
    for (int j = 1; j <= joints; ++j) text += ",q" + std::to_string(j) + joint_unit;
    text += ",x_mm,y_mm,z_mm\n";
    for (std::size_t i = 0; i < table.rows(); ++i) {
      Row row;
      for (const char* axis : {"id", "x_mm", "y_mm", "z_mm"}) row[axis] = table.text(i, axis);
      for (int j = 1; j <= joints; ++j) row["q" + std::to_string(j)] = table.text(i, "q" + std::to_string(j) + "_deg");
      change(i, row);
      text += row["id"];
      for (int j = 1; j <= joints; ++j) text += ',' + row["q" + std::to_string(j)];
      text += ',' + row["x_mm"] + ',' + row["y_mm"] + ',' + row["z_mm"] + '\n';
    }
    write_bytes(folder_ / "bad.csv", text);
    std::vector<std::string> arguments{"calibrate", folder_ / "s/robot.toml", folder_ / "bad.csv", "-o", folder_ / "r"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_mdhcal(arguments);
  }

  // Exit status, diagnosis, advice, and no result beside it.
  void expect_stop(const Outcome& run, int exit_code, const std::string& diagnosis, const std::string& advice) {
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_NE(run.err.find(diagnosis), std::string::npos) << run.err;
    EXPECT_NE(run.err.find(advice), std::string::npos) << run.err;
    // Either nothing at all, or what says why: never a blob or a corrected robot.
    const auto names = names_in(folder_.path());
    if (names == std::vector<std::string>{"bad.csv", "s"}) return;
    EXPECT_EQ(names, (std::vector<std::string>{"bad.csv", "r", "s"}));
    EXPECT_EQ(exit_code, 1);
    EXPECT_EQ(names_in(folder_ / "r"), (std::vector<std::string>{"report.html", "residuals.csv", "result.json"}));
  }

  // Exit status 1, diagnosis and cure, a report, and nothing that a controller could use.
  void expect_unusable(const Outcome& run, const std::string& diagnosis, const std::string& cure) {
    EXPECT_EQ(run.exit_code, 1) << run.err;
    EXPECT_NE(run.err.find(diagnosis), std::string::npos) << run.err;
    EXPECT_NE(run.err.find(cure), std::string::npos) << run.err;
    const std::vector<std::string> names = names_in(folder_ / "r");
    EXPECT_EQ(std::count(names.begin(), names.end(), "result.json"), 1);
    EXPECT_EQ(std::count(names.begin(), names.end(), "calibration.blob"), 0);
    EXPECT_EQ(std::count(names.begin(), names.end(), "corrected.toml"), 0);
  }

  TemporaryFolder folder_;
};

double number(const std::string& text) { return std::strtod(text.c_str(), nullptr); }

TEST_F(BadInputCommand, AllPosesEqual) {
  simulate("three-parallel");
  expect_stop(calibrate([](std::size_t, Row& row) {
                for (int j = 1; j <= joints; ++j) row["q" + std::to_string(j)] = std::to_string(10 * j);
              }),
              2, "All 60 poses have the same joint readings", "Move every joint between the measurements");
}

TEST_F(BadInputCommand, OneOrientationThroughout) {
  simulate("three-parallel");
  // Axes 2, 3 and 4 are parallel: joint 4 takes back what 2 and 3 turn.
  const Outcome run = calibrate([](std::size_t, Row& row) {
    row["q1"] = "20", row["q5"] = "40", row["q6"] = "-25";
    row["q4"] = std::to_string(15 - number(row["q2"]) - number(row["q3"]));
  });
  expect_unusable(run, "Base frame and targets are", "the flange turns by at most 0.00 degrees");
  const nlohmann::json result = nlohmann::json::parse(read_bytes(folder_ / "r/result.json"));
  EXPECT_FALSE(result["usable"]);
}

TEST_F(BadInputCommand, AllMeasurementsAtZero) {
  simulate("three-parallel");
  expect_stop(calibrate([](std::size_t, Row& row) { row["x_mm"] = row["y_mm"] = row["z_mm"] = "0"; }), 2,
              "Found no measured point in any of the 60 rows (all are 0, 0, 0 or empty)", "expected at least one");
}

TEST_F(BadInputCommand, AllMeasurementsAtOnePoint) {
  simulate("three-parallel");
  expect_stop(calibrate([](std::size_t, Row& row) { row["x_mm"] = row["y_mm"] = row["z_mm"] = "100"; }), 2,
              "All measured positions are the same point although the joints move", "The tracker recorded nothing new");
}

TEST_F(BadInputCommand, JointsInRadiansReadAsDegrees) {
  simulate("three-parallel");
  const auto in_radians = [](std::size_t, Row& row) {
    for (int j = 1; j <= joints; ++j) {
      std::string& q = row["q" + std::to_string(j)];
      q = std::to_string(number(q) / 57.29577951308232);
    }
  };
  expect_unusable(calibrate(in_radians, ""), "With the joint angles in radians the residual is", "name the columns q1_rad, q2_rad, ...");
  // A header that states its unit is believed.
  const Outcome stated = calibrate(in_radians);
  EXPECT_EQ(stated.exit_code, 1) << stated.err;
  EXPECT_EQ(stated.err.find("name the columns"), std::string::npos) << stated.err;
}

// Of a spherical wrist three lengths are told: a wrong unit is taken up by them, and only the blob's bounds refuse it.
TEST_F(BadInputCommand, AUnitThatTheGeometryTakesUp) {
  simulate("spherical-wrist");
  std::string robot = read_bytes(folder_ / "s/robot.toml");
  const std::string unit = "length_unit = \"mm\"";
  const std::size_t at = robot.find(unit);
  ASSERT_NE(at, std::string::npos);
  write_bytes(folder_ / "s/robot.toml", robot.replace(at, unit.size(), "length_unit = \"m\""));
  expect_unusable(calibrate([](std::size_t, Row&) {}), "With the robot file's lengths in millimetres the residual is", "set length_unit = \"mm\"");
}

TEST_F(BadInputCommand, TwoJointsSwapped) {
  simulate("three-parallel");
  expect_unusable(calibrate([](std::size_t, Row& row) { std::swap(row["q2"], row["q5"]); }), "With q2_deg and q5_deg swapped",
                  "swap the columns q2_deg and q5_deg");
}

TEST_F(BadInputCommand, TwoJointsReversed) {
  simulate("spherical-wrist");
  const Outcome run = calibrate([](std::size_t, Row& row) {
    for (const char* q : {"q4", "q6"}) row[q] = std::to_string(-number(row[q]));
  });
  expect_unusable(run, "With q4_deg and q6_deg reversed the residual is", "set sign = -1 in links 4 and 6");
  const nlohmann::json result = nlohmann::json::parse(read_bytes(folder_ / "r/result.json"));
  EXPECT_TRUE(result["diagnosis"]["named"]);
  EXPECT_LT(result["diagnosis"]["hypotheses"][0]["residual"]["scale_mm"], 0.05);
  EXPECT_GT(result["diagnosis"]["as_given"]["scale_mm"], 10.0);
}

TEST_F(BadInputCommand, TrackerMovedBetweenTwoSeries) {
  simulate("three-parallel");
  const Outcome run = calibrate([](std::size_t i, Row& row) {
    if (i >= 30) row["x_mm"] = std::to_string(number(row["x_mm"]) + 3.0);
  });
  expect_unusable(run, "the tracker, or the robot's foot, moved before row 31", "calibrate from one series");
}

TEST_F(BadInputCommand, ASoundJobIsNotAccused) {
  simulate("three-parallel");
  const Outcome run = calibrate([](std::size_t, Row&) {}, "_deg", {"--diagnose"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("hypotheses on units, signs, zeros"), std::string::npos) << run.err;
}

TEST_F(BadInputCommand, ReflectorOnTheLastAxis) {
  // The flange's fixed transform has the target on the axis of joint 6, and simulated errors of the target are off.
  const std::string robot = folder_ / "axis.toml";
  simulate("three-parallel", {"--length-error", "0"});
  std::string text = read_bytes(folder_ / "s/robot.toml");
  const std::size_t tool = text.find("[tool]");
  ASSERT_NE(tool, std::string::npos);
  const std::size_t end = text.find('\n', text.find("xyz", tool));
  text = text.substr(0, tool) + "[tool]\nxyz = [0.0, 0.0, 80.0]" + text.substr(end);
  write_bytes(robot, text);
  simulate(robot, {"--length-error", "0"});
  const Outcome run = calibrate([](std::size_t, Row&) {});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("mm from the axis of joint 6"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("Put the reflector off the axis"), std::string::npos) << run.err;
  const std::string result = read_bytes(folder_ / "r/result.json");
  EXPECT_EQ(result.find("nan"), std::string::npos);
  const auto json = nlohmann::json::parse(result);
  EXPECT_FALSE(json["identifiability"]["weak_directions"].empty());
  EXPECT_LT(json["train"]["after"]["mean_mm"].get<double>(), 0.05);
}

}  // namespace
