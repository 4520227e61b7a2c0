// SPDX-License-Identifier: MIT
// No command writes over a file that it has read.
#include <gtest/gtest.h>

#include "tests/cli/cli.hpp"

namespace {

using namespace mdhcal::tests;

class Outputs : public ::testing::Test {
 protected:
  void SetUp() override {
    write_bytes(folder / "robot.toml", read_bytes(example("robot.toml")));
    write_bytes(folder / "nine.csv", read_bytes(example("nine.csv")));
    ASSERT_EQ(run({"pack", "robot.toml", "-o", "nominal.blob"}).exit_code, 0);
    ASSERT_EQ(run({"keygen", "-o", "room"}).exit_code, 0);
    ASSERT_EQ(run({"convert", "robot.toml", "-o", "arm.urdf"}).exit_code, 0);
  }

  Outcome run(const std::vector<std::string>& arguments) const {
    RunOptions options;
    options.folder = folder.path();
    return run_mdhcal(arguments, options);
  }

  const TemporaryFolder folder;
};

TEST_F(Outputs, NoCommandWritesOverItsInput) {
  write_bytes(folder / "candidates.csv", "q1,q2,q3,q4,q5,q6\n1,2,3,4,5,6\n");
  ASSERT_EQ(run({"pack", "robot.toml", "-o", "copy.toml"}).exit_code, 0);
  ASSERT_EQ(run_program("ln", {folder / "robot.toml", folder / "link.toml"}).exit_code, 0);
  struct OutputCase {
    std::vector<std::string> arguments;
    std::string input;
  };
  const std::vector<OutputCase> cases = {
      {{"sign", "nominal.blob", "--key", "room.key", "-o", "room.key"}, "room.key"},
      {{"sign", "nominal.blob", "--key", "room.key", "-o", "nominal.blob"}, "nominal.blob"},
      {{"sign", "nominal.blob", "--key", "room.key", "-o", "./nominal.blob"}, "nominal.blob"},
      {{"pack", "robot.toml", "-o", "robot.toml"}, "robot.toml"},
      {{"pack", "robot.toml", "-o", "link.toml"}, "robot.toml"},
      {{"export", "nominal.blob", "--format", "bin", "-o", "nominal.blob"}, "nominal.blob"},
      {{"convert", "robot.toml", "-o", "robot.toml"}, "robot.toml"},
      {{"convert", "arm.urdf", "-o", "arm.urdf"}, "arm.urdf"},
      {{"convert", "robot.toml", "--urdf", "arm.urdf", "-o", "arm.urdf"}, "arm.urdf"},
      {{"plan", "robot.toml", "--count", "1", "-o", "robot.toml"}, "robot.toml"},
      {{"plan", "robot.toml", "--count", "1", "--candidates", "candidates.csv", "-o", "candidates.csv"}, "candidates.csv"}};
  for (const OutputCase& c : cases) {
    const std::string before = read_bytes(folder / c.input);
    const auto names = names_in(folder.path());
    const Outcome outcome = run(c.arguments);
    EXPECT_EQ(outcome.exit_code, 2) << c.arguments[0] << ' ' << c.arguments.back() << ": " << outcome.err;
    EXPECT_NE(outcome.err.find("take away"), std::string::npos) << outcome.err;
    EXPECT_EQ(read_bytes(folder / c.input), before) << c.arguments[0];
    EXPECT_EQ(names_in(folder.path()), names) << "nothing is left beside it";
  }
}

TEST_F(Outputs, NoResultTakesTheFolderOfItsInputs) {
  ASSERT_EQ(run({"calibrate", "robot.toml", "nine.csv", "--base", "given", "--tool", "given", "-o", "r"}).exit_code, 0);
  const std::string corrected = read_bytes(folder / "r/corrected.toml");
  const Outcome again = run({"calibrate", "r/corrected.toml", "nine.csv", "--base", "given", "--tool", "given", "-o", "r"});
  EXPECT_EQ(again.exit_code, 2) << again.err;
  EXPECT_NE(again.err.find("r/corrected.toml"), std::string::npos) << again.err;
  EXPECT_EQ(read_bytes(folder / "r/corrected.toml"), corrected);

  ASSERT_EQ(run({"simulate", "robot.toml", "--poses", "5", "-o", "s"}).exit_code, 0);
  const std::string robot = read_bytes(folder / "s/robot.toml");
  EXPECT_EQ(run({"simulate", "s/robot.toml", "--poses", "5", "-o", "s"}).exit_code, 2);
  EXPECT_EQ(read_bytes(folder / "s/robot.toml"), robot);
}

}  // namespace
