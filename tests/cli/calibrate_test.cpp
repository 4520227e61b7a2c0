// SPDX-License-Identifier: MIT
// The main job, end to end, with the built program: the published robot is calibrated, the blob is written, and the
// real-time library, reading nothing but that blob, predicts the held-out measurements.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <set>

#include <nlohmann/json.hpp>

#include "tests/cli/cli.hpp"

namespace {

using namespace mdhcal::tests;

struct Figures {
  double mean = 0, median = 0, max = 0;
  std::size_t count = 0;
};

Figures figures(std::vector<double> errors) {
  Figures f;
  std::sort(errors.begin(), errors.end());
  f.count = errors.size();
  for (const double e : errors) f.mean += e / static_cast<double>(errors.size());
  f.max = errors.back();
  f.median = 0.5 * (errors[(errors.size() - 1) / 2] + errors[errors.size() / 2]);
  return f;
}

// Errors of the rows that `wanted` takes: what `forward` prints from the blob against the measured points, worked out
// here and not by the program.
Figures blob_against(const std::string& blob, const std::string& measurements, const std::function<bool(int)>& wanted) {
  const Outcome run = run_mdhcal({"forward", blob, measurements, "--quiet"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const CsvTable predicted(run.out), measured(read_bytes(measurements));
  std::vector<double> errors;
  for (std::size_t row = 0; row < measured.rows(); ++row) {
    if (!wanted(static_cast<int>(row) + 1)) continue;
    double sum = 0;
    for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
      sum += std::pow(predicted.number(row, axis) - measured.number(row, axis), 2);
    }
    errors.push_back(std::sqrt(sum));
  }
  return figures(errors);
}

bool good(int row) { return row != 6 && row != 7; }
bool every(int) { return true; }

std::vector<std::string> outliers(const nlohmann::json& result, const char* split) {
  std::vector<std::string> ids;
  for (const auto& entry : result["outliers"]) {
    if (entry.is_object() ? entry.value("split", split) == split : true) {
      ids.push_back(entry.is_object() ? entry["id"].get<std::string>() : entry.get<std::string>());
    }
  }
  return ids;
}

bool holds(const std::vector<std::string>& ids, const std::string& id) {
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

TEST(Calibrate, NineToEighteen) {
  const TemporaryFolder folder;
  const Outcome run = run_mdhcal({"calibrate", example("robot.toml"), example("nine.csv"), "--test", example("eighteen.csv"),
                                  "--base", "given", "--tool", "given", "-o", folder / "r"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(names_in(folder / "r"),
            (std::vector<std::string>{"calibration.blob", "corrected.toml", "report.html", "residuals.csv", "result.json"}));
  const Figures f = blob_against(folder / "r/calibration.blob", example("eighteen.csv"), good);
  ASSERT_EQ(f.count, 16U);
  EXPECT_LE(f.mean, 0.033);
  EXPECT_LE(f.median, 0.019);
  EXPECT_LE(f.max, 0.16);
  std::printf("nine -> 16 of the eighteen: mean %.4f median %.4f max %.4f mm\n", f.mean, f.median, f.max);
  RecordProperty("mean_um", static_cast<int>(std::lround(1e3 * f.mean)));

  // What result.json and residuals.csv say is what the blob does.
  const auto result = nlohmann::json::parse(read_bytes(folder / "r/result.json"));
  const Figures all = blob_against(folder / "r/calibration.blob", example("eighteen.csv"), every);
  EXPECT_NEAR(result["test"]["after"]["mean_mm"].get<double>(), all.mean, 1e-6);
  EXPECT_NEAR(result["test"]["after"]["max_mm"].get<double>(), all.max, 1e-6);
  const CsvTable residuals(read_bytes(folder / "r/residuals.csv"));
  EXPECT_EQ(residuals.rows(), 27U);
  double worst = 0;
  for (std::size_t row = 9; row < 27; ++row) {
    EXPECT_EQ(residuals.text(row, "split"), "test");
    worst = std::max(worst, std::hypot(residuals.number(row, "after_x_mm"), residuals.number(row, "after_y_mm"),
                                       residuals.number(row, "after_z_mm")));
  }
  EXPECT_NEAR(worst, all.max, 1e-6);

  // The same through `verify`.
  const Outcome verified = run_mdhcal({"verify", folder / "r/calibration.blob", example("eighteen.csv"), "--json"});
  EXPECT_EQ(verified.exit_code, 0) << verified.err;
  const auto checked = nlohmann::json::parse(verified.out);
  EXPECT_NEAR(checked["mean_mm"].get<double>(), all.mean, 1e-9);
  // With the bounds of the verdict: what differs is the rounding in the blob's way from unknowns to bytes.
  EXPECT_EQ(checked["poses"], result["test"]["poses"]);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(checked["mean_95_mm"][k].get<double>(), result["test"]["after_mean_95_mm"][k].get<double>(), 1e-6);
  }
  EXPECT_LT(checked["mean_95_mm"][0].get<double>(), all.mean);
}

TEST(Calibrate, SaysWhichBetasItFreed) {
  const TemporaryFolder folder;
  const Outcome run = run_mdhcal({"calibrate", example("robot.toml"), example("nine.csv"), "--base", "given", "--tool", "given",
                                  "-o", folder / "r"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("beta2"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("beta3"), std::string::npos) << run.err;
  EXPECT_EQ(run.err.find("beta1"), std::string::npos) << run.err;
  // Nine poses hold 27 numbers: few for the parameters, which is said.
  const auto result = nlohmann::json::parse(read_bytes(folder / "r/result.json"));
  EXPECT_TRUE(result["test"].is_null());
  // Without a test file the verdict rests on rows left out of folds.
  EXPECT_NE(result["verdict"].get<std::string>().find("Cross-validated (no rows were held out): 9 rows of 9 poses in 9 folds"),
            std::string::npos) << result["verdict"];
  EXPECT_EQ(result["cross_validation"]["after"]["count"], 9);
}

TEST(Calibrate, GrossErrorsOfTheEighteenAreNamed) {
  const TemporaryFolder folder;
  const Outcome run = run_mdhcal({"calibrate", example("robot.toml"), example("eighteen.csv"), "--base", "given", "--tool",
                                  "given", "-o", folder / "r"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto named = outliers(nlohmann::json::parse(read_bytes(folder / "r/result.json")), "train");
  EXPECT_TRUE(holds(named, "6"));
  EXPECT_TRUE(holds(named, "7"));
  const Figures f = blob_against(folder / "r/calibration.blob", example("nine.csv"), every);
  EXPECT_LE(f.mean, 0.025);
  std::printf("eighteen -> nine: mean %.4f max %.4f mm\n", f.mean, f.max);
}

TEST(Calibrate, GrossErrorsOfAllTwentySevenAreNamed) {
  const TemporaryFolder folder;
  // One file, with ids that tell the two tables apart.
  std::string text = "id,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,x_mm,y_mm,z_mm\n";
  for (const char* name : {"nine", "eighteen"}) {
    const CsvTable table(read_bytes(example(std::string(name) + ".csv")));
    for (std::size_t row = 0; row < table.rows(); ++row) {
      text += std::string(name) + '-' + table.text(row, "id");
      for (const char* column : {"q1_deg", "q2_deg", "q3_deg", "q4_deg", "q5_deg", "q6_deg", "x_mm", "y_mm", "z_mm"}) {
        text += ',' + table.text(row, column);
      }
      text += '\n';
    }
  }
  write_bytes(folder / "all.csv", text);
  const Outcome run = run_mdhcal({"calibrate", example("robot.toml"), folder / "all.csv", "--base", "given", "--tool", "given",
                                  "-o", folder / "r"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto named = outliers(nlohmann::json::parse(read_bytes(folder / "r/result.json")), "train");
  EXPECT_TRUE(holds(named, "eighteen-6"));
  EXPECT_TRUE(holds(named, "eighteen-7"));
  const Figures f = blob_against(folder / "r/calibration.blob", example("nine.csv"), every);
  EXPECT_LE(f.mean, 0.025);
  std::printf("all 27 -> nine: mean %.4f max %.4f mm\n", f.mean, f.max);
}

TEST(Calibrate, SameInputSameBytes) {
  const TemporaryFolder folder;
  for (const char* name : {"a", "b"}) {
    ASSERT_EQ(run_mdhcal({"calibrate", example("robot.toml"), example("nine.csv"), "--test", example("eighteen.csv"), "--base",
                          "given", "--tool", "given", "-o", folder / name})
                  .exit_code,
              0);
  }
  for (const char* file : {"calibration.blob", "corrected.toml", "result.json", "residuals.csv"}) {
    EXPECT_EQ(read_bytes(folder / (std::string("a/") + file)), read_bytes(folder / (std::string("b/") + file))) << file;
  }
}

TEST(Calibrate, PackingTheCorrectedRobotGivesTheSameModel) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_mdhcal({"calibrate", example("robot.toml"), example("eighteen.csv"), "--base", "given", "--tool", "given", "-o", folder / "r"}).exit_code, 0);
  ASSERT_EQ(run_mdhcal({"pack", folder / "r/corrected.toml", "-o", folder / "again.blob"}).exit_code, 0);
  const Outcome a = run_mdhcal({"forward", folder / "r/calibration.blob", example("nine.csv"), "--quiet", "--frame", "tracker"});
  const Outcome b = run_mdhcal({"forward", folder / "again.blob", example("nine.csv"), "--quiet", "--frame", "tracker"});
  EXPECT_EQ(a.exit_code, 0) << a.err;
  EXPECT_EQ(a.out, b.out);
}

TEST(Calibrate, RowsOfATestFileEnterNothingButTheFigures) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_mdhcal({"calibrate", example("robot.toml"), example("nine.csv"), "--base", "given", "--tool", "given", "-o",
                        folder / "without"})
                .exit_code,
            0);
  ASSERT_EQ(run_mdhcal({"calibrate", example("robot.toml"), example("nine.csv"), "--test", example("eighteen.csv"), "--base",
                        "given", "--tool", "given", "-o", folder / "with"})
                .exit_code,
            0);
  EXPECT_EQ(read_bytes(folder / "without/corrected.toml"), read_bytes(folder / "with/corrected.toml"));
}

}  // namespace
