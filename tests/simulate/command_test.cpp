// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "offline/measure/dataset.hpp"
#include "tests/support/program.hpp"

namespace {

using namespace mdhcal::offline;
using namespace mdhcal::tests;

TEST(SimulateCommand, WritesWhatTheToolReads) {
  const TemporaryFolder folder;
  const auto run = run_mdhcal({"simulate", "spherical-wrist", "-o", folder / "arm", "--poses", "30", "--test-poses", "7",
                              "--targets", "2", "--outliers", "0.1", "--sigma", "--full-pose", "--seed", "5"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  const std::vector<std::string> names{"measurements.csv", "robot.toml", "test.csv", "truth.json", "truth.toml"};
  EXPECT_EQ(names_in(folder / "arm"), names);
  const Robot robot = read_robot(folder / "arm/robot.toml"), truth = read_robot(folder / "arm/truth.toml");
  EXPECT_EQ(robot.geometry.joint_count, 6);
  EXPECT_EQ(truth.targets.size(), 2u);
  EXPECT_TRUE(truth.tracker_T_base.has_value());
  EXPECT_EQ(truth.nominal[1].a_m, robot.geometry.link[1].a_m);
  EXPECT_NE(truth.geometry.link[1].a_m, robot.geometry.link[1].a_m);
  const auto json = nlohmann::json::parse(read_bytes(folder / "arm/truth.json"));
  EXPECT_EQ(json["outliers"].size(), 6u);
  EXPECT_EQ(json["seed"], 5);
}

}  // namespace
