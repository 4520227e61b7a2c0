// SPDX-License-Identifier: MIT
// Malformed inputs of many kinds (tests/cli/malformed): each gets one message that names file, line, column, what was
// found and what was expected; exit status 2; nothing written.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/cli/cli.hpp"

namespace {

using namespace mdhcal::tests;

struct Case {
  const char* file;
  const char* place;     // ":LINE:COLUMN: "
  const char* found;     // words of what was found
  const char* expected;  // words behind "expected" or before it
};

std::string malformed(const std::string& name) { return std::string(MDHCAL_SOURCE_DIR) + "/tests/cli/malformed/" + name; }

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      // Robot files.
      {"unknown-key.toml", ":10:1: ", "Unknown key \"thetta\" in [[link]] 1", "expected joint, alpha, a, d, theta"},
      {"wrong-unit-word.toml", ":4:15: ", "found the text \"inch\"", "expected \"mm\" or \"m\""},
      {"missing-length.toml", ":11:1: ", "[[link]] 2 has no key \"d\"", "expected a number"},
      {"text-in-number.toml", ":18:5: ", "found the text \"428.052\"", "expected a number"},
      {"not-a-number.toml", ":29:5: ", "found nan", "expected a finite number"},
      {"degrees-called-radians.toml", ":12:9: ", "found 90.0 rad", "expected at most 12.566370614359172 rad"},
      {"repeated-key.toml", ":24:5: ", "'a'", "expected a robot file in TOML"},
      {"unclosed-text.toml", ":2:19: ", "Not valid TOML", "expected a robot file in TOML"},
      {"nine-links.toml", ":44:1: ", "more than 8 sections [[link]]", "expected at most 8"},
      {"beta-in-standard.toml", ":36:8: ", "the key \"beta\" in [[link]] 6", "expected it only with"},
      {"coupling-of-itself.toml", ":38:6: ", "couples a joint to itself", "expected two different joints"},
      {"sign-of-two.toml", ":36:8: ", "found 2", "expected 1 or -1"},
      {"point-of-two.toml", ":37:7: ", "found an array of 2", "expected an array of 3 numbers"},
      {"limits-crossed.toml", ":36:7: ", "found 90.0, which is more than max", "expected min <= max"},
      {"prior-of-a-missing-link.toml", ":37:1: ", "Unknown key \"d7\"", "a link, 1 to 6"},
      {"no-links.toml", ":1:1: ", "Found no section [[link]]", "expected one a joint"},
      // Measurement files.
      {"missing-column.csv", ":2:1: ", "The column \"y\" is missing", "expected all of x, y, z"},
      {"repeated-column.csv", ":2:51: ", "found \"x\" a second time", "expected each column once"},
      {"source-names.csv", ":2:1: ", "The column \"x\" is missing", "found the columns id, q1_deg"},
      {"seven-joints.csv", ":2:61: ", "found a reading of joint 7", "expected as many as the robot has joints, 6"},
      {"five-joints.csv", ":2:1: ", "The column \"q6\" is missing", "expected it because the robot has 6 joints"},
      {"text-in-number.csv", ":5:10: ", "found \"-220.O48\"", "expected a number"},
      {"not-a-number.csv", ":6:70: ", "found \"nan\"", "expected a finite number"},
      {"infinite.csv", ":7:70: ", "found \"inf\"", "expected a finite number"},
      {"empty-joint.csv", ":9:10: ", "Column \"q2_deg\": found nothing", "expected a number"},
      {"short-row.csv", ":10:64: ", "Found 9 fields", "expected 10 as in the header"},
      {"long-row.csv", ":10:81: ", "Found 11 fields", "expected 10 as in the header"},
      {"decimal-commas.csv", ":3:42: ", "Found 19 fields", "expected 10 as in the header (decimal commas need semicolons"},
      {"thousands-separators.csv", ":3:55: ", "found \"1.228,695\"", "expected a number"},
      {"unclosed-quote.csv", ":7:1: ", "Found a quote that is never closed", "expected another quote"},
      {"empty.csv", ":1:1: ", "Found an empty file", "expected a measurement file with a header"},
      {"header-only.csv", ":2:1: ", "Found no row under the header", "expected a row"},
      {"all-points-lost.csv", ":11:1: ", "Found no measured point in any of the 9 rows", "expected at least one"},
      {"utf-16.csv", ":1:1: ", "Found text in UTF-16", "expected a measurement file in UTF-8"},
      {"zero-byte.csv", ":11:1: ", "Found a zero byte", "expected a measurement file (CSV text)"},
      {"negative-sigma.csv", ":7:78: ", "found -0.02", "expected a standard deviation, not below 0"},
      {"half-a-quaternion.csv", ":2:1: ", "The column \"qz\" is missing", "expected all of qw, qx, qy, qz"},
      {"quaternion-not-unit.csv", ":3:79: ", "found a quaternion of norm 1.414", "expected a norm of 1"},
      {"distance-to-nowhere.csv", ":3:59: ", "found \"77\", which names no row", "expected the id of one other row"},
  };
  return all;
}

TEST(Malformed, EachInputGetsOneMessageThatNamesItsPlace) {
  ASSERT_GE(cases().size(), 25U);
  for (const Case& c : cases()) {
    const TemporaryFolder folder;
    const std::string file = malformed(c.file);
    const bool robot = file.ends_with(".toml");
    const Outcome run = run_mdhcal({"calibrate", robot ? file : example("robot.toml"), robot ? example("nine.csv") : file,
                                    "--base", "given", "--tool", "given", "-o", folder / "result"});
    EXPECT_EQ(run.exit_code, 2) << c.file;
    EXPECT_EQ(run.out, "") << c.file;
    EXPECT_EQ(run.err.rfind("mdhcal: " + file + c.place, 0), 0U) << run.err << "  wanted " << c.place;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_NE(run.err.find(c.found), std::string::npos) << run.err << "  wanted " << c.found;
    EXPECT_NE(run.err.find(c.expected), std::string::npos) << run.err << "  wanted " << c.expected;
    EXPECT_TRUE(names_in(folder.path()).empty()) << c.file;
  }
}

TEST(Malformed, EveryFileOfTheFolderIsTried) {
  std::vector<std::string> tried;
  for (const Case& c : cases()) tried.emplace_back(c.file);
  std::sort(tried.begin(), tried.end());
  EXPECT_EQ(names_in(malformed("")), tried);
}

TEST(Malformed, AnEarlierResultSurvivesABadInput) {
  const TemporaryFolder folder;
  const std::vector<std::string> good = {"calibrate", example("robot.toml"), example("nine.csv"), "--base", "given",
                                         "--tool",    "given",               "-o",                folder / "result"};
  ASSERT_EQ(run_mdhcal(good).exit_code, 0);
  const std::string before = read_bytes(folder / "result/calibration.blob");
  auto bad = good;
  bad[2] = malformed("text-in-number.csv");
  EXPECT_EQ(run_mdhcal(bad).exit_code, 2);
  EXPECT_EQ(read_bytes(folder / "result/calibration.blob"), before);
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"result"});
}

void expect_input_error(const std::vector<std::string>& arguments, const std::string& words) {
  const Outcome run = run_mdhcal(arguments);
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  EXPECT_NE(run.err.find(words), std::string::npos) << run.err << "  wanted " << words;
}

TEST(Malformed, FilesThatAreNotThereOrCannotBeWritten) {
  const TemporaryFolder folder;
  const std::string robot = example("robot.toml"), nine = example("nine.csv");
  expect_input_error({"pack", folder / "none.toml", "-o", folder / "a.blob"}, "none.toml: The file cannot be read: No such");
  expect_input_error({"pack", folder.path(), "-o", folder / "a.blob"}, "Found a folder; expected a robot file");
  expect_input_error({"pack", robot, "-o", folder / "none/a.blob"}, "none/a.blob");
  expect_input_error({"calibrate", robot, folder / "none.csv", "-o", folder / "r"}, "none.csv: The file cannot be read");
  expect_input_error({"calibrate", robot, nine, "--test", folder / "no.csv", "-o", folder / "r"}, "no.csv: The file cannot");
  write_bytes(folder / "file", "x");
  expect_input_error({"calibrate", robot, nine, "-o", folder / "file"}, folder / "file");
  expect_input_error({"calibrate", robot, nine, "-o", folder / "file/r"}, folder / "file");
  std::filesystem::create_directory(folder / "mine");
  write_bytes(folder / "mine/notes.txt", "x");
  expect_input_error({"calibrate", robot, nine, "-o", folder / "mine"}, "notes.txt");
  expect_input_error({"forward", folder / "file", nine}, "The blob is refused: wrong size; found 1 bytes");
  EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"file", "mine"}));
  EXPECT_EQ(names_in(folder / "mine"), std::vector<std::string>{"notes.txt"});
}

TEST(Malformed, FewerMeasurementsThanBaseAndTargetUnknowns) {
  const TemporaryFolder folder;
  const std::string text = read_bytes(example("nine.csv"));
  std::size_t end = 0;
  for (int line = 0; line < 4; ++line) end = text.find('\n', end) + 1;
  write_bytes(folder / "two.csv", text.substr(0, end));
  // Two points are six numbers; base and target have nine unknowns.
  expect_input_error({"calibrate", example("robot.toml"), folder / "two.csv", "-o", folder / "r"}, "expected");
  // With both given, two points are few for the geometry, which is said, but no error.
  const Outcome run = run_mdhcal({"calibrate", example("robot.toml"), folder / "two.csv", "--base", "given", "--tool", "given",
                                  "-o", folder / "r"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("fewer"), std::string::npos) << run.err;
}

}  // namespace
