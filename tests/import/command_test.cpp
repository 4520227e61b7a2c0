// SPDX-License-Identifier: MIT
// `mdhcal import`, and `calibrate` on the same sources, as a user runs them.
#include <gtest/gtest.h>

#include "tests/cli/cli.hpp"

namespace {

using namespace mdhcal::tests;

const std::string own = std::string(MDHCAL_SOURCE_DIR) + "/offline/examples/own-robot/";

// The same sources by way of a file and directly: one result.
TEST(ImportCommand, CalibrateTakesTheSameSources) {
  const TemporaryFolder folder;
  const auto import = run_mdhcal({"import", own + "tracker.txt", "--robot-log", own + "calib.dat", "--robot", "kr210-r2700", "-o", folder / "m.csv"});
  ASSERT_EQ(import.exit_code, 0) << import.err;
  EXPECT_NE(import.err.find("Wrote 60 rows"), std::string::npos) << import.err;
  const CsvTable table(read_bytes(folder / "m.csv"));
  EXPECT_EQ(table.rows(), 60u);
  EXPECT_EQ(table.text(0, "id"), "P1");
  const auto from_file = run_mdhcal({"calibrate", "kr210-r2700", folder / "m.csv", "-o", folder / "a"});
  ASSERT_EQ(from_file.exit_code, 0) << from_file.err;
  const auto direct = run_mdhcal({"calibrate", "kr210-r2700", "--tracker", own + "tracker.txt", "--robot-log", own + "calib.dat", "-o", folder / "b"});
  ASSERT_EQ(direct.exit_code, 0) << direct.err;
  EXPECT_EQ(read_bytes(folder / "a/corrected.toml"), read_bytes(folder / "b/corrected.toml"));
  EXPECT_EQ(run_mdhcal({"verify", folder / "b/calibration.blob", folder / "m.csv", "--max-mean", "0.1"}).exit_code, 0);
}

TEST(ImportCommand, WithoutARobotTheJointsAreCounted) {
  const TemporaryFolder folder;
  write_bytes(folder / "t.csv", "point,x,y,z\nP1,1500.5,2,3\nP2,4.5,5,6\n");
  write_bytes(folder / "j.csv", "name,A1,A2,A3,A4,A5,A6,A7\nP2,10,20,30,40,50,60,70\nP1,11,21,31,41,51,61,71\n");
  const auto run = run_mdhcal({"import", folder / "t.csv", "--robot-log", folder / "j.csv", "-o", folder / "m.csv"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("7 revolute joints"), std::string::npos) << run.err;
  const CsvTable table(read_bytes(folder / "m.csv"));
  EXPECT_EQ(table.number(0, "q7_deg"), 71.0);
  EXPECT_EQ(table.number(0, "x_mm"), 1500.5);
}

TEST(ImportCommand, DoesNotWriteWhatItCannotRead) {
  const TemporaryFolder folder;
  write_bytes(folder / "t.csv", "P1,1.5,-2.5,3.5\n");
  const std::vector<std::vector<std::string>> cases{
      {folder / "t.csv"},                                        // no joints
      {folder / "none.csv"},                                     // no file
      {folder / "t.csv", "--profile", "nonsense"},               // no profile
      {folder / "t.csv", "--columns", "id,x,y,what"},            // no meaning
      {folder / "t.csv", "--rotation", "nonsense"},              // no convention
      {folder / "t.csv", "--robot-log", folder / "t.csv"}};      // points for joints
  for (const auto& arguments : cases) {
    std::vector<std::string> all{"import", "-o", folder / "m.csv"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const auto run = run_mdhcal(all);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_NE(run.err.find("xpected"), std::string::npos) << run.err;
    EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"t.csv"}));
  }
}

TEST(ImportCommand, CalibrateTakesMeasurementsOrATrackersFiles) {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& sources : {std::vector<std::string>{}, std::vector<std::string>{example("nine.csv"), "--tracker", own + "tracker.txt"}}) {
    std::vector<std::string> all{"calibrate", example("robot.toml")};
    all.insert(all.end(), sources.begin(), sources.end());
    all.insert(all.end(), {"-o", folder / "out"});
    const auto run = run_mdhcal(all);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_NE(run.err.find("expected one of them"), std::string::npos) << run.err;
  }
}

}  // namespace
