// SPDX-License-Identifier: MIT
// Text of others' files reaches neither a terminal, a page nor a spreadsheet as a command.
#include <gtest/gtest.h>

#include "tests/cli/cli.hpp"

namespace {

using namespace mdhcal::tests;

const std::vector<std::string> given = {"--base", "given", "--tool", "given"};

Outcome calibrate(const std::string& robot, const std::string& rows, const std::string& result) {
  std::vector<std::string> arguments = {"calibrate", robot, rows, "-o", result};
  arguments.insert(arguments.end(), given.begin(), given.end());
  return run_mdhcal(arguments);
}

// The published rows with ids of our own.
std::string with_ids(const std::vector<std::string>& ids) {
  const CsvTable table(read_bytes(example("nine.csv")));
  std::string text = "id,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,x_mm,y_mm,z_mm\n";
  for (std::size_t row = 0; row < table.rows(); ++row) {
    text += ids[row % ids.size()];
    for (const char* column : {"q1_deg", "q2_deg", "q3_deg", "q4_deg", "q5_deg", "q6_deg", "x_mm", "y_mm", "z_mm"}) text += ',' + table.text(row, column);
    text += '\n';
  }
  return text;
}

TEST(ForeignText, ALatin1ByteIsNamedWithItsPlace) {
  const TemporaryFolder folder;
  write_bytes(folder / "m.csv", with_ids({"one", "caf\xE9"}));
  const Outcome run = calibrate(example("robot.toml"), folder / "m.csv", folder / "r");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("m.csv:3:4: Found the byte 0xE9, which is not UTF-8"), std::string::npos) << run.err;
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"m.csv"});

  std::string robot = read_bytes(example("robot.toml"));
  robot.replace(robot.find("name = \"") + 8, 1, "\xFC");
  write_bytes(folder / "robot.toml", robot);
  const Outcome pack = run_mdhcal({"pack", folder / "robot.toml", "-o", folder / "b"});
  EXPECT_EQ(pack.exit_code, 2);
  EXPECT_NE(pack.err.find("0xFC"), std::string::npos) << pack.err;
}

TEST(ForeignText, FormulasBecomeTextInTables) {
  const TemporaryFolder folder;
  write_bytes(folder / "m.csv", with_ids({"=1+1", "+cmd|x", "-2+3", "@SUM(A1)", "-1.5", "+7", "\"=HYPERLINK(\"\"x\"\",\"\"y\"\")\"", "plain"}));
  const Outcome run = calibrate(example("robot.toml"), folder / "m.csv", folder / "r");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string residuals = read_bytes(folder / "r/residuals.csv");
  for (const char* shown : {"\n'=1+1,", "\n'+cmd|x,", "\n'-2+3,", "\n'@SUM(A1),", "\n-1.5,", "\n+7,", "\n\"'=HYPERLINK(", "\nplain,"}) {
    EXPECT_NE(residuals.find(shown), std::string::npos) << shown << residuals;
  }
}

TEST(ForeignText, EscapeBytesReachNeitherTerminalNorPage) {
  const TemporaryFolder folder;
  // TOML can write any character as an escape.
  std::string robot = read_bytes(example("robot.toml"));
  robot.replace(robot.find("name = \"") + 8, 1, "\\u001B[31m\\u009B2J");
  write_bytes(folder / "robot.toml", robot);
  const Outcome run = calibrate(folder / "robot.toml", example("nine.csv"), folder / "r");
  for (const std::string& name : run.exit_code == 0 ? names_in(folder / "r") : std::vector<std::string>()) {
    if (name == "calibration.blob") continue;
    const std::string text = read_bytes(folder / ("r/" + name));
    EXPECT_EQ(text.find('\x1B'), std::string::npos) << name;
  }
  EXPECT_EQ((run.out + run.err).find('\x1B'), std::string::npos);
  EXPECT_EQ((run.out + run.err).find("\xC2\x9B"), std::string::npos);
  // A name on the command line is text of others too.
  const Outcome missing = run_mdhcal({"pack", "no\x1B[2J\xE9.toml", "-o", folder / "b"});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_NE(missing.err.find("no\\x1B[2J\\xE9.toml"), std::string::npos) << missing.err;
}

// A robot without a name is called by its file.
TEST(ForeignText, AFileNameThatIsNoUtf8DoesNotReachTheBlob) {
  const TemporaryFolder folder;
  std::string robot = read_bytes(example("robot.toml"));
  const std::size_t at = robot.find("name = \"");
  robot.erase(at, robot.find('\n', at) - at);
  const std::string path = folder / "caf\xE9.toml";
  write_bytes(path, robot);
  ASSERT_EQ(run_mdhcal({"pack", path, "-o", folder / "b"}).exit_code, 0);
  const Outcome shown = run_mdhcal({"show", "--json", folder / "b"});
  EXPECT_EQ(shown.exit_code, 0);
  EXPECT_NE(shown.out.find("\"caf\\\\xE9\""), std::string::npos) << shown.out;
}

}  // namespace
