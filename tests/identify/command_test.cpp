// SPDX-License-Identifier: MIT
// calibrate and compare as a user runs them.
#include <gtest/gtest.h>

#include <algorithm>
#include <iomanip>
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
  EXPECT_EQ(json["test"]["outliers"], (std::vector<std::string>{"6", "7"}));
  EXPECT_EQ(json["usable"], true);
  EXPECT_TRUE(json["reasons"].empty());
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

TEST(CalibrateCommand, JsonIsTheResultAndNothingElseOnStdout) {
  TemporaryFolder folder;
  std::vector<std::string> arguments = command("calibrate", example + "eighteen.csv", folder / "out");
  arguments.emplace_back("--json");
  const auto run = run_mdhcal(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, read_bytes(folder / "out/result.json"));
  EXPECT_NE(run.err.find("18 rows of 18 poses held out"), std::string::npos);
}

TEST(CalibrateCommand, QuietSaysNothingAndVerboseSaysWhy) {
  TemporaryFolder folder;
  const std::vector<std::string> plain = command("calibrate", example + "eighteen.csv", folder / "out");
  std::vector<std::string> quiet = plain;
  quiet.emplace_back("--quiet");
  std::vector<std::string> verbose = plain;
  verbose.emplace_back("--verbose");
  const auto silent = run_mdhcal(quiet);
  EXPECT_EQ(silent.exit_code, 0);
  EXPECT_EQ(silent.out + silent.err, "");
  const auto said = run_mdhcal(plain);
  const auto why = run_mdhcal(verbose);
  for (const char* detail : {"beta2 is estimated, d2 stays nominal", "theta5 and a6 are confounded",
                             "by the rule reml", "condition number", "O5"}) {
    EXPECT_EQ(said.err.find(detail), std::string::npos) << detail;
    EXPECT_NE(why.err.find(detail), std::string::npos) << detail;
  }
  // A terminal page, counts and the worst: the rest is in result.json.
  EXPECT_LE(std::count(said.err.begin(), said.err.end(), '\n'), 14);
  EXPECT_NE(said.err.find("3 lost, 5 weak"), std::string::npos) << said.err;
  const auto json = nlohmann::json::parse(read_bytes(folder / "out/result.json"));
  EXPECT_EQ(json["identifiability"]["weak_directions"].size(), 8U);
  EXPECT_EQ(json["details"].size(), 8U);
}

// The headline is over every row; a second line without the gross errors of the published table, on both sides.
TEST(CalibrateCommand, TheVerdictIsOverEveryRow) {
  TemporaryFolder folder;
  const auto run = run_mdhcal(command("calibrate", example + "eighteen.csv", folder / "out"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(read_bytes(folder / "out/result.json"));
  EXPECT_EQ(json["test"]["after"]["count"], 18);
  EXPECT_EQ(json["test"]["before_good"]["count"], 16);
  EXPECT_EQ(json["test"]["after_good"]["count"], 16);
  EXPECT_LT(json["test"]["before_good"]["max_mm"].get<double>(), 5.0);
  EXPECT_GT(json["test"]["before"]["max_mm"].get<double>(), 30.0);
  const std::string verdict = json["verdict"];
  EXPECT_EQ(verdict.find("2 rows of 18, more than a tenth"), 0U) << verdict;
  EXPECT_NE(verdict.find("18 rows of 18 poses held out: mean error 2.97 mm (95 % bounds"), std::string::npos) << verdict;
  EXPECT_NE(verdict.find("Without 2 gross rows (6 and 7): mean error 0.032 mm"), std::string::npos) << verdict;
}

// A result with a reason against it: report, result and residuals, but nothing that a controller could follow.
TEST(CalibrateCommand, AResultWithReasonsAgainstItHasNoBlob) {
  TemporaryFolder folder;
  auto arguments = command("calibrate", example + "eighteen.csv", folder / "out");
  arguments.insert(arguments.end(), {"--max-residual", "0.001"});
  const auto refused = run_mdhcal(arguments);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.err.find("The residual is not explained"), std::string::npos) << refused.err;
  EXPECT_EQ(names_in(folder / "out"), (std::vector<std::string>{"report.html", "residuals.csv", "result.json"}));
  const auto json = nlohmann::json::parse(read_bytes(folder / "out/result.json"));
  EXPECT_EQ(json["usable"], false);
  EXPECT_EQ(json["reasons"].size(), 1U);

  arguments.insert(arguments.end(), {"--accept", "a pilot run"});
  const auto accepted = run_mdhcal(arguments);
  EXPECT_EQ(accepted.exit_code, 0) << accepted.err;
  EXPECT_EQ(nlohmann::json::parse(read_bytes(folder / "out/result.json"))["accepted"], "a pilot run");
  EXPECT_NE(read_bytes(folder / "out/report.html").find("Accepted against these reasons"), std::string::npos);
  const auto shown = run_mdhcal({"show", folder / "out/calibration.blob"});
  EXPECT_NE(shown.out.find("a pilot run"), std::string::npos) << shown.out;
  const auto exported = run_mdhcal({"export", folder / "out/calibration.blob", "--format", "bin", "-o", folder / "blob.bin"});
  EXPECT_EQ(exported.exit_code, 0);
  EXPECT_NE(exported.err.find("a pilot run"), std::string::npos) << exported.err;
}

TEST(CompareCommand, PrintsEveryMethodAndTheSource) {
  TemporaryFolder folder;
  const auto run = run_mdhcal(command("compare", example + "eighteen.csv", folder / "out"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(names_in(folder / "out"), (std::vector<std::string>{"compare.json", "compare.txt", "report.html"}));
  for (const char* method : {"nc", "lsm", "gd", "gn", "lm", "ekf", "rpim", "published by the source"}) {
    EXPECT_NE(run.out.find(method), std::string::npos) << method;
  }
  const auto json = nlohmann::json::parse(read_bytes(folder / "out/compare.json"));
  EXPECT_EQ(json["methods"].size(), 8U);
  // What is published is what stands in the example's file.
  std::istringstream rows(read_bytes(example + "published.csv"));
  std::size_t published = 0;
  for (std::string row; std::getline(rows, row);) {
    if (row.empty() || row[0] == '#' || row.rfind("method", 0) == 0) continue;
    const auto& entry = json["published"].at(published++);
    std::ostringstream again;
    again << entry["method"].get<std::string>() << ',' << std::fixed << std::setprecision(3)
          << entry["max_mm"].get<double>() << ',' << entry["mean_mm"].get<double>() << ','
          << entry["sd_mm"].get<double>();
    EXPECT_EQ(again.str(), row);
  }
  EXPECT_EQ(published, json["published"].size());
  EXPECT_EQ(published, 5U);
  const std::string report = read_bytes(folder / "out/report.html");
  EXPECT_NE(report.find("Methods compared"), std::string::npos);
  EXPECT_NE(report.find("rpim, published"), std::string::npos);
}

TEST(CompareCommand, OfAnotherRobotHasNoPublishedRow) {
  TemporaryFolder folder;
  ASSERT_EQ(run_mdhcal({"simulate", "five-joint", "-o", folder / "s"}).exit_code, 0);
  const auto run = run_mdhcal({"compare", folder / "s/robot.toml", folder / "s/measurements.csv", "--test",
                               folder / "s/test.csv", "-o", folder / "out", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, read_bytes(folder / "out/compare.json"));
  EXPECT_TRUE(nlohmann::json::parse(run.out)["published"].empty());
}

}  // namespace
