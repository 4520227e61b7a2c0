// SPDX-License-Identifier: MIT
// calibrate and compare as a user runs them.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"

namespace {

using namespace mdhcal::tests;

const std::string example = std::string(MDHCAL_SOURCE_DIR) + "/offline/examples/li2022/";

std::vector<std::string> command(const std::string& name, const std::string& test, const std::string& folder) {
  return {name,   example + "robot.toml", example + "nine.csv", "--test", test, "--base", "given",
          "--tool", "given",              "-o",                 folder};
}

TEST(CalibrateCommand, WritesItsFiveFilesWithFiniteFigures) {
  TemporaryFolder folder;
  const auto run = run_mdhcal(command("calibrate", example + "eighteen.csv", folder / "out"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(names_in(folder / "out"), (std::vector<std::string>{"calibration.blob", "corrected.toml", "report.html",
                                                               "residuals.csv", "result.json"}));
  EXPECT_TRUE(run.out.empty());
  const std::string text = read_bytes(folder / "out/result.json");
  EXPECT_EQ(text.find("nan"), std::string::npos);
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["test"]["after"]["count"], 18);
  EXPECT_LE(json["test"]["after"]["median_mm"].get<double>(), 0.025);
  EXPECT_EQ(json["test"]["outliers"], (std::vector<std::string>{"2", "6", "7", "17"}));
  EXPECT_EQ(json["lambda"]["rule"], "reml");
  EXPECT_FALSE(json["lambda"]["curve"].empty());
}

TEST(CalibrateCommand, TheOrderOfTheTestRowsDoesNotReachTheBlob) {
  TemporaryFolder folder;
  std::istringstream rows(read_bytes(example + "eighteen.csv"));
  std::string header;
  std::getline(rows, header);
  while (header.rfind('#', 0) == 0) std::getline(rows, header);
  std::vector<std::string> lines;
  for (std::string line; std::getline(rows, line);) lines.push_back(line);
  std::reverse(lines.begin(), lines.end());
  std::string reversed = header + "\n";
  for (const std::string& line : lines) reversed += line + "\n";
  write_bytes(folder / "reversed.csv", reversed);
  ASSERT_EQ(run_mdhcal(command("calibrate", example + "eighteen.csv", folder / "a")).exit_code, 0);
  ASSERT_EQ(run_mdhcal(command("calibrate", folder / "reversed.csv", folder / "b")).exit_code, 0);
  EXPECT_EQ(read_bytes(folder / "a/calibration.blob"), read_bytes(folder / "b/calibration.blob"));
  EXPECT_EQ(read_bytes(folder / "a/corrected.toml"), read_bytes(folder / "b/corrected.toml"));
}

TEST(CalibrateCommand, LeavesAFolderOfSomethingElseAlone) {
  TemporaryFolder folder;
  write_bytes(folder / "mine.txt", "mine");
  const auto run = run_mdhcal(command("calibrate", example + "eighteen.csv", folder.path()));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"mine.txt"});
}

TEST(CalibrateCommand, AnAssessmentIsWrittenOnRequest) {
  TemporaryFolder folder;
  std::vector<std::string> arguments = command("calibrate", example + "eighteen.csv", folder / "out");
  for (const char* word : {"--bootstrap", "50", "--cross-validate", "0"}) arguments.emplace_back(word);
  const auto run = run_mdhcal(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(read_bytes(folder / "out/result.json"));
  EXPECT_EQ(json["cross_validation"]["folds"], 9);
  EXPECT_EQ(json["bootstrap"]["resamples"], 50);
}

TEST(CompareCommand, PrintsEveryMethodAndTheSource) {
  TemporaryFolder folder;
  const auto run = run_mdhcal(command("compare", example + "eighteen.csv", folder / "out"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* method : {"nc", "lsm", "gd", "gn", "lm", "ekf", "rpim", "RPIM", "published by the source"}) {
    EXPECT_NE(run.out.find(method), std::string::npos) << method;
  }
  const auto json = nlohmann::json::parse(read_bytes(folder / "out/compare.json"));
  EXPECT_EQ(json["methods"].size(), 8U);
}

}  // namespace
