// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

#include "offline/base/error.hpp"
#include "offline/base/random.hpp"
#include "offline/measure/dataset.hpp"
#include "offline/robot/rotation.hpp"
#include "tests/support/shared_data.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using mdhcal::offline::Random;

constexpr double deg = 3.14159265358979323846 / 180.0;

Robot arm(int joints, bool mm = true, bool degrees = true) {
  Robot robot;
  robot.geometry.joint_count = joints;
  for (int i = 0; i < joints; ++i) robot.geometry.joint[i].sign = 1;
  robot.geometry.last_T_flange.quaternion[0] = 1;
  robot.length_in_mm = mm;
  robot.angle_in_deg = degrees;
  return robot;
}

std::string message_of(const std::string& text, const Robot& robot = arm(2)) {
  try {
    (void)parse_dataset(text, "m.csv", robot);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Dataset, ReadsPositionsInTheRobotsUnits) {
  const Dataset data = parse_dataset("q1,q2,x,y,z\n10,-20,1000,2,3\n", "m.csv", arm(2));
  ASSERT_EQ(data.rows.size(), 1U);
  EXPECT_EQ(data.joint_count, 2U);
  EXPECT_DOUBLE_EQ(data.rows[0].q[0], 10 * deg);
  EXPECT_DOUBLE_EQ(data.rows[0].q[1], -20 * deg);
  EXPECT_DOUBLE_EQ(data.rows[0].position_m[0], 1.0);
  EXPECT_EQ(data.rows[0].id, "1");
  EXPECT_EQ(data.rows[0].line, 2);
  EXPECT_EQ(data.targets, std::vector<std::string>{""});
  const Dataset metres = parse_dataset("q1,q2,x,y,z\n1,-2,1,2,3\n", "m.csv", arm(2, false, false));
  EXPECT_DOUBLE_EQ(metres.rows[0].q[1], -2.0);
  EXPECT_DOUBLE_EQ(metres.rows[0].position_m[2], 3.0);
}

TEST(Dataset, ASuffixOverridesTheUnit) {
  Robot robot = arm(2);
  robot.geometry.joint[1].kind = JointKind::prismatic;
  const Dataset data =
      parse_dataset("q1_rad,q2_m,x_m,y_mm,z [mm],sigma_mm\n1,0.5,1,2,3,0.02\n", "m.csv", robot);
  EXPECT_DOUBLE_EQ(data.rows[0].q[0], 1.0);
  EXPECT_DOUBLE_EQ(data.rows[0].q[1], 0.5);
  EXPECT_DOUBLE_EQ(data.rows[0].position_m[0], 1.0);
  EXPECT_DOUBLE_EQ(data.rows[0].position_m[1], 0.002);
  EXPECT_DOUBLE_EQ(data.rows[0].position_m[2], 0.003);
  EXPECT_DOUBLE_EQ(data.rows[0].sigma_m[2], 2e-5);
}

TEST(Dataset, LeavesMissingPointsOutAndSaysSo) {
  const Dataset data = parse_dataset(
      "id,group,q1,q2,x,y,z\na,g,1,2,1,2,3\nb,h,1,2,0,0,0\nc,i,1,2,,,\nd,g,1,2,0.0,-0.0,1\n", "m.csv", arm(2));
  ASSERT_EQ(data.rows.size(), 2U);
  EXPECT_EQ(data.rows[1].id, "d");
  EXPECT_EQ(data.groups, std::vector<std::string>{"g"});
  ASSERT_EQ(data.notes.size(), 1U);
  EXPECT_NE(data.notes[0].find("2 rows without a measured point (0, 0, 0 or empty) left out: line 3, 4"),
            std::string::npos)
      << data.notes[0];
}

TEST(Dataset, KeepsGroupsAndTargets) {
  const Dataset data = parse_dataset(
      "id,group,target,q1,q2,x,y,z\n1,9,A,0,0,1,1,1\n1,9,B,0,0,1,1,1\n2,7,A,0,0,1,1,1\n3,9,B,0,0,1,1,1\n", "m.csv", arm(2));
  EXPECT_EQ(data.groups, (std::vector<std::string>{"9", "7"}));
  EXPECT_EQ(data.targets, (std::vector<std::string>{"A", "B"}));
  EXPECT_EQ(data.rows[3].group, 0U);
  EXPECT_EQ(data.rows[3].target, 1U);
  // Without a group the reflectors of one id belong together, and rows without a target stand each alone.
  EXPECT_EQ(parse_dataset("id,target,q1,q2,x,y,z\n1,A,0,0,1,1,1\n1,B,0,0,1,1,1\n2,A,0,0,1,1,1\n", "m.csv", arm(2)).groups,
            (std::vector<std::string>{"1", "2"}));
  EXPECT_EQ(parse_dataset("q1,q2,x,y,z\n0,0,1,1,1\n0,0,1,1,1\n", "m.csv", arm(2)).groups.size(), 2U);
}

TEST(Dataset, ReadsPosesBothWays) {
  const Dataset q = parse_dataset("q1,q2,x,y,z,qw,qx,qy,qz\n0,0,1,1,1,-0.7071,0,0,0.7071\n0,0,1,1,1,,,,\n", "m.csv", arm(2));
  EXPECT_EQ(q.rows[0].kind, MeasurementKind::pose);
  EXPECT_DOUBLE_EQ(q.rows[0].quaternion[0], std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(q.rows[0].quaternion[3], -std::sqrt(0.5));
  EXPECT_EQ(q.rows[1].kind, MeasurementKind::position);
  const Dataset v = parse_dataset("q1,q2,x,y,z,rx,ry,rz_rad\n0,0,1,1,1,90,0,0\n", "m.csv", arm(2));
  EXPECT_NEAR(v.rows[0].quaternion[1], std::sqrt(0.5), 1e-15);
}

// A socket that lies in the origin is a measurement where the file's other points are touched several times too.
TEST(Dataset, ATouchedPointAtTheOriginIsNoLostPoint) {
  const auto rows = [](const std::string& text) { return parse_dataset("q1,q2,x,y,z\n" + text, "m.csv", arm(2)).rows.size(); };
  EXPECT_EQ(rows("1,2,0,0,0\n3,4,0,0,0\n5,6,50,0,0\n7,8,50,0,0\n"), 4U);
  // A point that was measured once, or twice in the same pose, is a tracker's.
  EXPECT_EQ(rows("1,2,0,0,0\n3,4,0,0,0\n5,6,50,0,0\n7,8,50,0,0\n9,1,50,0,1\n"), 3U);
  EXPECT_EQ(rows("1,2,0,0,0\n1,2,0,0,0\n5,6,50,0,0\n5,6,50,0,0\n"), 2U);
  EXPECT_NE(message_of("q1,q2,x,y,z\n1,2,0,0,0\n3,4,0,0,0\n").find("no measured point"), std::string::npos);
}

TEST(Dataset, ReadsDistances) {
  const Dataset data = parse_dataset(
      "id,q1,q2,x,y,z,distance,to\na,1,2,,,,,\nlost,1,2,0,0,0,,\nb,3,4,,,,300.5,a\nc,5,6,0,0,0,100,\nd,5,6,7,8,9,,\n",
      "m.csv", arm(2));
  ASSERT_EQ(data.rows.size(), 4U);
  EXPECT_EQ(data.rows[0].kind, MeasurementKind::joints);
  EXPECT_EQ(data.rows[1].kind, MeasurementKind::distance);
  EXPECT_DOUBLE_EQ(data.rows[1].distance_m, 0.3005);
  EXPECT_EQ(data.rows[1].other_row, 0);
  EXPECT_EQ(data.rows[2].other_row, -1);
  EXPECT_EQ(data.rows[3].kind, MeasurementKind::position);
}

TEST(Dataset, ReadsTheOtherColumnsAndNotesUnknownOnes) {
  const Dataset data = parse_dataset(
      "q1,q2,q1_cmd,q2_cmd_rad,x,y,z,sx,sy,sz_m,temperature,direction,operator\n"
      "1,2,3,4,5,6,7,0.01,0.02,0.00003,21.5,+,me\n",
      "m.csv", arm(2));
  EXPECT_DOUBLE_EQ(data.commanded.at(0)[0], 3 * deg);
  EXPECT_DOUBLE_EQ(data.commanded.at(0)[1], 4.0);
  EXPECT_DOUBLE_EQ(data.rows[0].sigma_m[0], 1e-5);
  EXPECT_DOUBLE_EQ(data.rows[0].sigma_m[2], 3e-5);
  EXPECT_DOUBLE_EQ(data.temperature.at(0), 21.5);
  EXPECT_EQ(data.direction.at(0), "+");
  ASSERT_EQ(data.notes.size(), 1U);
  EXPECT_NE(data.notes[0].find("\"operator\""), std::string::npos);
}

TEST(Dataset, DigestIsSha256OfTheBytes) {
  const std::string text = "q1,q2,x,y,z\n1,2,3,4,5\n";
  // printf 'q1,q2,x,y,z\n1,2,3,4,5\n' | sha256sum
  EXPECT_EQ(parse_dataset(text, "m.csv", arm(2)).digest_sha256,
            "96a978eb555845c442b7f098085f1dd73e2e4218c91a5c7f8c3ddec984fc6909");
}

// One table in many dialects: the numbers that come out are the same bits.
TEST(Dataset, EveryDialectReadsTheSame) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    Random random(seed);
    const std::size_t joints = 1 + random.index(8), rows = 1 + random.index(20);
    const char separators[] = {',', ';', '\t'};
    const char separator = separators[random.index(3)];
    const bool comma = separator != ',' && random.index(2) == 0;
    const char* end = random.index(2) == 0 ? "\r\n" : "\n";
    const bool quotes = random.index(2) == 0;
    std::string plain, text = random.index(2) == 0 ? "\xEF\xBB\xBF" : "";
    std::vector<std::string> names;
    for (std::size_t j = 0; j < joints; ++j) names.push_back("q" + std::to_string(j + 1));
    for (const char* name : {"x", "y", "z"}) names.push_back(name);
    // Columns in any order.
    for (std::size_t k = names.size(); k > 1; --k) std::swap(names[k - 1], names[random.index(k)]);
    const auto field = [&](std::string value) {
      if (comma) std::replace(value.begin(), value.end(), '.', ',');
      if (quotes && random.index(2) == 0) value = '"' + value + '"';
      if (random.index(4) == 0) value = ' ' + value + ' ';
      if (random.index(8) == 0 && value[0] != '-' && value[0] != '"' && value[0] != ' ') value = '+' + value;
      return value;
    };
    const auto noise = [&] {
      if (random.index(3) == 0) text += "# a comment; with, separators\t\"" + std::string(end);
      if (random.index(3) == 0) text += end;
      if (random.index(5) == 0) text += std::string(names.size() - 1, separator) + end;
    };
    noise();
    for (std::size_t k = 0; k < names.size(); ++k) {
      plain += (k == 0 ? "" : ",") + names[k];
      std::string name = names[k];
      if (random.index(3) == 0) name[0] = static_cast<char>(std::toupper(name[0]));
      text += (k == 0 ? "" : std::string(1, separator)) + (quotes ? '"' + name + '"' : name);
    }
    plain += '\n';
    text += random.index(4) == 0 ? std::string(1, separator) + end : end;
    for (std::size_t r = 0; r < rows; ++r) {
      noise();
      for (std::size_t k = 0; k < names.size(); ++k) {
        char number[40];
        std::snprintf(number, sizeof number, random.index(6) == 0 ? "%.9e" : "%.6f", random.uniform(-350, 350));
        plain += (k == 0 ? "" : ",") + std::string(number);
        text += (k == 0 ? "" : std::string(1, separator)) + field(number);
      }
      plain += '\n';
      text += r + 1 < rows || random.index(2) == 0 ? end : "";
    }
    const Robot robot = arm(static_cast<int>(joints));
    const Dataset a = parse_dataset(plain, "plain.csv", robot);
    const Dataset b = parse_dataset(text, "m.csv", robot);
    ASSERT_EQ(a.rows.size(), rows);
    ASSERT_EQ(b.rows.size(), rows) << "seed " << seed << "\n" << text;
    for (std::size_t r = 0; r < rows; ++r) {
      ASSERT_EQ(a.rows[r].q, b.rows[r].q) << "seed " << seed << "\n" << text;
      ASSERT_EQ(a.rows[r].position_m, b.rows[r].position_m) << "seed " << seed << "\n" << text;
    }
  }
}

TEST(Dataset, MessagesNameThePlaceWhatWasFoundAndWhatWasExpected) {
  const std::string header = "q1,q2,x,y,z\n";
  const struct {
    std::string text, place, found, expected;
  } cases[] = {
      {"", "m.csv:1:1:", "empty file", "a measurement file with a header"},
      {"# only a comment\n\n", "m.csv:1:1:", "empty file", "a header"},
      {header, "m.csv:1:1:", "no row", "expected a row"},
      {"q1,x,y,z\n1,2,3,4\n", "m.csv:1:1:", "\"q2\" is missing", "the robot has 2 joints"},
      {"q1,q2,q3,x,y,z\n1,2,3,4,5,6\n", "m.csv:1:7:", "reading of joint 3", "as the robot has joints, 2"},
      {"q1,q2,q1,x,y,z\n1,2,3,4,5,6\n", "m.csv:1:7:", "\"q1\" a second time", "each column once"},
      {"q1,q2,x,y,z,x_m\n1,2,3,4,5,6\n", "m.csv:1:13:", "\"x\" a second time", "each column once"},
      {"q1,q2,x,z\n1,2,3,4\n", "m.csv:1:1:", "\"y\" is missing", "all of x, y, z"},
      {"q1,q2,x_meas_mm,y,z\n1,2,3,4,5\n", "m.csv:1:1:", "\"x\" is missing", "x_meas_mm"},
      {"q1,q2,a,b\n1,2,3,4\n", "m.csv:1:1:", "\"x\" is missing", "the measured point"},
      {header + "1,2,3,4,5\n1,abc,3,4,5\n", "m.csv:3:3: Column \"q2\":", "\"abc\"", "expected a number"},
      {header + "1,2,nan,4,5\n", "m.csv:2:5:", "\"nan\"", "expected a finite number"},
      {header + "1,2,3,inf,5\n", "m.csv:2:7:", "\"inf\"", "expected a finite number"},
      {header + "1,2,3,1e999,5\n", "m.csv:2:7:", "\"1e999\"", "expected a finite number"},
      {header + "1,,3,4,5\n", "m.csv:2:3:", "found nothing", "expected a number"},
      {header + "1,2,3,,5\n", "m.csv:2:7:", "found nothing", "expected a number"},
      {header + "1,2,3,4\n", "m.csv:2:7:", "4 fields", "expected 5"},
      {header + "1,5,2,5,3,0,4,0,5,0\n", "m.csv:2:11:", "10 fields", "decimal commas need"},
      {"q1;q2;x;y;z\n1,5;2;1.234,5;4;5\n", "m.csv:2:7:", "\"1.234,5\"", "expected a number"},
      {header + "1,2,3,4,0x10\n", "m.csv:2:9:", "\"0x10\"", "expected a number"},
      {header + "1,2,3,4,5 mm\n", "m.csv:2:9:", "\"5 mm\"", "expected a number"},
      {header + "1,\"2,3,4,5\n", "m.csv:2:3:", "never closed", "expected another quote"},
      {header + "1,\"2\"x,3,4,5\n", "m.csv:2:6:", "behind a closing quote", "expected a separator"},
      {header + "0,0,0,0,0\n", "m.csv:2:1:", "no measured point in any of the 1 rows", "at least one"},
      {header + "1,2,3e9,4,5\n", "m.csv:2:5:", "3e9", "expected at most 1e+09 mm"},
      {"q1_m,q2,x,y,z\n1,2,3,4,5\n", "m.csv:1:1:", "\"q1\" is missing", "q1_m"},
      {"q1,q2,x,y,z,sigma,sx,sy,sz\n1,2,3,4,5,1,1,1,1\n", "m.csv:1:13:", "beside sx, sy, sz", "one of the two"},
      {"q1,q2,x,y,z,sigma\n1,2,3,4,5,-1\n", "m.csv:2:11:", "found -1", "not below 0"},
      {"q1,q2,x,y,z,qw,qx,qy,qz\n1,2,3,4,5,1,1,0,0\n", "m.csv:2:11:", "norm 1.414", "a norm of 1"},
      {"q1,q2,x,y,z,distance\n1,2,,,,5\n", "m.csv:2:8:", "a distance to nothing", "the other row's id"},
      {"q1,q2,x,y,z,distance,to\n1,2,,,,5,7\n", "m.csv:2:10:", "\"7\", which names no row", "the id of one other row"},
      {"q1,q2,x,y,z,distance,to\n1,2,,,,5,1\n", "m.csv:2:10:", "the row itself", "the id of one other row"},
      {"q1,q2,x,y,z,target\n1,2,3,4,5,a-name-too-long-to-keep\n", "m.csv:2:11:", "23 bytes", "at most 15"},
      {std::string("q1,q2,x,y,z\n1,2,3,4,\0\n", 22), "m.csv:2:1:", "zero byte", "CSV text"},
      {"\xFF\xFEq", "m.csv:1:1:", "UTF-16", "UTF-8"},
  };
  for (const auto& c : cases) {
    const std::string message = message_of(c.text);
    EXPECT_NE(message.find(c.place), std::string::npos) << message << "\n  wanted " << c.place;
    EXPECT_NE(message.find(c.found), std::string::npos) << message << "\n  wanted " << c.found;
    EXPECT_NE(message.find(c.expected), std::string::npos) << message << "\n  wanted " << c.expected;
  }
}

// 200 000 columns in the header, in seconds of a minute if each looked back to the begin of the line.
TEST(Dataset, TimeIsLinearInColumns) {
  std::string header = "q1,q2,x,y,z", row = "1,2,3,4,5";
  for (int i = 0; i < 200000; ++i) {
    header += ",another column " + std::to_string(i);
    row += ",0";
  }
  const auto begin = std::clock();
  const Dataset data = parse_dataset(header + '\n' + row + '\n', "m.csv", arm(2));
  // Measured 0.15 s; the quadratic search took 90 s.
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 10.0);
  ASSERT_EQ(data.notes.size(), 1U);
  EXPECT_LT(data.notes[0].size(), 2000U) << "a message is for people";
  // Places in the header stay right, behind a quoted name of two lines too.
  const std::string message = message_of("q1,\"two\nlines\",q2,x,y,z,x\n1,2,3,4,5,6,7\n");
  EXPECT_NE(message.find("m.csv:1:"), std::string::npos) << message;
}

TEST(Dataset, AQuotedFieldMayHoldSeparatorsQuotesAndLines) {
  const std::string text = "id,q1,q2,x,y,z\n\"a, \"\"b\"\"\nc\",1,2,3,4,5\n";
  EXPECT_EQ(parse_dataset(text, "m.csv", arm(2)).rows.at(0).id, "a, \"b\"\nc");
  const std::string message = message_of(text + "d,1,2,3,4,oops\n");
  EXPECT_NE(message.find("m.csv:4:11:"), std::string::npos) << message;
}

MDHCAL_SHARED_DATA_TEST(Dataset, ReadsTheSharedTrackerFiles) {
  const Robot fanuc = read_robot(tests::shared_data("fanuc_r2000ic/robot.toml"));
  const Dataset data = read_dataset(tests::shared_data("fanuc_r2000ic/measurements.csv"), fanuc);
  EXPECT_EQ(data.rows.size(), 720U);
  EXPECT_EQ(data.groups.size(), 24U);
  EXPECT_EQ(data.targets, (std::vector<std::string>{"A", "B", "C"}));
  EXPECT_NEAR(data.rows[2].position_m[2], 1.394374, 1e-12);
  const Robot ur5 = read_robot(tests::shared_data("ur5_grid/robot.toml"));
  const Dataset grid = read_dataset(tests::shared_data("ur5_grid/measurements.csv"), ur5);
  EXPECT_EQ(grid.rows.size(), 1000U);
  EXPECT_EQ(grid.groups.size(), 1000U);
  EXPECT_TRUE(grid.notes.empty());
}

}  // namespace
