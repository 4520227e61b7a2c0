// SPDX-License-Identifier: MIT
#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "offline/measure/joint_file.hpp"
#include "offline/plan/reach.hpp"
#include "offline/simulate/family.hpp"
#include "tests/support/program.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using namespace mdhcal::tests;

TEST(PlanCommand, PlansPosesThatCanBeMeasured) {
  const TemporaryFolder folder;
  const Robot robot = family_robot("three-parallel");
  write_bytes(folder / "robot.toml", write_robot(robot));
  const auto run = run_mdhcal({"plan", folder / "robot.toml", "--count", "12", "--draw", "300", "--tracker", "2500", "0", "800",
                               "--cone", "60", "--keep-out", "-2000", "-2000", "-2000", "2000", "2000", "-50", "--keep-out",
                               "-2000", "600", "-2000", "2000", "700", "2000", "-o", folder / "poses.csv", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["poses"], 12);
  EXPECT_EQ(json["candidates"], 300);
  EXPECT_GT(json["unreachable"], 0);
  EXPECT_LT(json["expected"]["rms_mm"], json["random_median"]["rms_mm"]);
  EXPECT_LT(json["with_ten_more"]["rms_mm"], json["expected"]["rms_mm"]);
  EXPECT_EQ(json["parameters"].size(), 18u);
  const auto table = read_joint_file(folder / "poses.csv", robot.geometry);
  ASSERT_EQ(table.rows.size(), 12u);
  Arm<double> arm{};
  ASSERT_EQ(make_arm(robot.geometry, arm), Status::ok);
  Reach reach;
  reach.tracker_p_m = Vector3{2.5, 0, 0.8};
  reach.cone_rad = 60.01 * 3.14159265358979 / 180;  // the table is rounded
  reach.keep_out = {{{-2, -2, -2}, {2, 2, -0.05001}}, {{-2, 0.60001, -2}, {2, 0.69999, 2}}};
  for (const auto& row : table.rows) EXPECT_TRUE(reachable(robot, arm, reach, row.q)) << row.id;
}

TEST(PlanCommand, ChoosesFromGivenCandidates) {
  const TemporaryFolder folder;
  write_bytes(folder / "robot.toml", write_robot(family_robot("five-joint")));
  std::string text = "id,q1,q2,q3,q4,q5\n";
  for (int i = 0; i < 30; ++i) {
    text += std::to_string(i);
    for (int j = 0; j < 5; ++j) text += ',' + std::to_string((i * (17 + 12 * j) + 31 * j) % 160 - 80);
    text += '\n';
  }
  write_bytes(folder / "c.csv", text);
  const auto run = run_mdhcal({"plan", folder / "robot.toml", "--count", "8", "--candidates", folder / "c.csv", "-o",
                               folder / "p.csv", "--criterion", "e"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("8 poses of 30 candidates"), std::string::npos) << run.out;
  const auto few = run_mdhcal({"plan", folder / "robot.toml", "--count", "31", "--candidates", folder / "c.csv", "-o",
                               folder / "q.csv"});
  EXPECT_EQ(few.exit_code, 2);
  EXPECT_NE(few.err.find("expected at least 31"), std::string::npos) << few.err;
  const auto walled = run_mdhcal({"plan", folder / "robot.toml", "--count", "5", "--keep-out", "-9000", "-9000", "-9000",
                                  "9000", "9000", "9000", "-o", folder / "q.csv"});
  EXPECT_EQ(walled.exit_code, 2);
  EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"c.csv", "p.csv", "robot.toml"}));
}

}  // namespace
