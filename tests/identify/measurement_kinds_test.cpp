// SPDX-License-Identifier: MIT
// Whole calibrations of simulated arms from every kind of measurement, read from files as a user writes them, judged
// against the truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "offline/base/random.hpp"
#include "offline/robot/vectors.hpp"
#include "offline/simulate/family.hpp"
#include "tests/identify/measured_table.hpp"
#include "tests/identify/simulated.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using namespace mdhcal::tests;

Simulation simulated(std::size_t poses, std::uint64_t seed, double noise_m = 0.02e-3, std::size_t targets = 1) {
  SimulationOptions options = arm_options(seed);
  options.configurations = poses;
  options.noise_m = noise_m;
  options.targets = targets;
  return simulate(family_robot("spherical-wrist"), options);
}

Calibration calibrated(const Simulation& s, const std::string& text, const CalibrationOptions& options = {}) {
  return calibrate(s.nominal, parse_dataset(text, "measured.csv", s.nominal), options);
}

// Mean error [mm] of the distance that an estimate predicts between the targets of two random poses.
double distance_error_mm(const Simulation& s, const Estimate& estimate) {
  const MeasurementModel real = truth_model(s);
  const MeasurementModel model(estimate);
  Random random(77);
  double sum = 0;
  constexpr int pairs = 500;
  for (int i = 0; i < pairs; ++i) {
    const auto a = random_readings(s.truth.geometry, random);
    const auto b = random_readings(s.truth.geometry, random);
    const auto length = [&](const MeasurementModel& m) {
      return norm(minus(m.target_position(a.data(), 0), m.target_position(b.data(), 0)));
    };
    sum += 1e3 * std::fabs(length(model) - length(real)) / pairs;
  }
  return sum;
}

// Rows 0, 2, 4, ... hold the length to the row behind, which states its joints only.
TableColumns ball_bar_columns(const Simulation& s, Random& random, double noise_m) {
  const MeasurementModel real = truth_model(s);
  std::vector<std::string> lengths(s.train.rows.size());
  for (std::size_t i = 0; i + 1 < lengths.size(); i += 2) {
    const Vector3 span = minus(real.target_position(s.train.rows[i].q.data(), 0),
                               real.target_position(s.train.rows[i + 1].q.data(), 0));
    lengths[i] = decimal(1e3 * (norm(span) + noise_m * random.normal()));
  }
  return {{"distance_mm", [lengths](std::size_t i) { return lengths[i]; }},
          {"to", [&s, lengths](std::size_t i) { return lengths[i].empty() ? "" : s.train.rows[i + 1].id; }}};
}

TEST(Distances, ABallBarAloneTellsTheArmButNotItsBase) {
  const Simulation s = simulated(600, 3);
  Random random(5);
  const Calibration c = calibrated(s, measured_table(s.train.rows.size(), TableColumns{id_column(s.train)} + joint_columns(s.train) +
                                                                              ball_bar_columns(s, random, 0.005e-3)));
  EXPECT_TRUE(c.converged);
  EXPECT_GT(distance_error_mm(s, c.start), 0.5);
  EXPECT_LT(distance_error_mm(s, c.estimate), 0.01);
  // Lengths say nothing about where the base stands.
  EXPECT_EQ(c.identifiability.frame_unknowns, 9U);
  EXPECT_EQ(c.identifiability.frame_rank, 3U);
  EXPECT_TRUE(noted(c, "Lengths tell 3 of the"));
}

TEST(Distances, DrawWiresToThreeFixedEndsFindTheBaseToo) {
  const Simulation s = simulated(240, 4);
  const MeasurementModel real = truth_model(s);
  Random random(6);
  const Vector3 foot = transform(truth_model(s).estimate().tracker_T_base, {0.0, 0.0, 0.0});
  const Vector3 ends[] = {plus(foot, {2.0, 0.3, 0.1}), plus(foot, {-0.7, 1.9, 0.4}), plus(foot, {0.2, -0.6, 2.5})};
  std::vector<std::string> lengths;
  for (std::size_t i = 0; i < s.train.rows.size(); ++i) {
    const Vector3 span = minus(real.target_position(s.train.rows[i].q.data(), 0), ends[i % 3]);
    lengths.push_back(decimal(1e3 * (norm(span) + 0.02e-3 * random.normal())));
  }
  TableColumns columns = TableColumns{id_column(s.train)} + joint_columns(s.train);
  columns.emplace_back("distance_mm", [&](std::size_t i) { return lengths[i]; });
  const char* const axes[] = {"x_mm", "y_mm", "z_mm"};
  for (std::size_t k = 0; k < 3; ++k) {
    columns.emplace_back(axes[k], [&ends, k](std::size_t i) { return decimal(1e3 * ends[i % 3][k]); });
  }
  const Calibration c = calibrated(s, measured_table(lengths.size(), columns));
  EXPECT_TRUE(c.converged);
  EXPECT_EQ(c.identifiability.frame_rank, 9U);
  EXPECT_LT(distance_from_truth_mm(s, c, 500, 9), 0.05);
}

TEST(Distances, ABallBarSharpensCoarsePositions) {
  // The bar is a hundred times as accurate as the tracker; sigma says so.
  double alone = 0;
  double mixed = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Simulation s = simulated(60, seed, 0.2e-3);
    Random random(seed);
    const Simulation more = simulated(200, seed, 0.2e-3);
    const TableColumns bar = ball_bar_columns(more, random, 0.002e-3);
    std::string text = measured_table(60, TableColumns{id_column(s.train)} + joint_columns(s.train) + position_columns(s.train) +
                                              TableColumns{{"sigma_mm", [](std::size_t) { return "0.2"; }},
                                                           {"distance_mm", [](std::size_t) { return ""; }},
                                                           {"to", [](std::size_t) { return ""; }}});
    alone += distance_from_truth_mm(s, calibrated(s, text), 300, seed);
    const TableColumn id{"id", [&](std::size_t i) { return "bar" + more.train.rows[i].id; }};
    const TableColumn to{"to", [&](std::size_t i) {
                           const std::string end = bar[1].second(i);
                           return end.empty() ? end : "bar" + end;
                         }};
    const auto none = [](std::size_t) { return ""; };
    const std::string bars =
        measured_table(200, TableColumns{id} + joint_columns(more.train) + TableColumns{{"x_mm", none}, {"y_mm", none}, {"z_mm", none}} +
                                TableColumns{{"sigma_mm", [](std::size_t) { return "0.002"; }}, bar[0], to});
    text += bars.substr(bars.find('\n') + 1);
    const Calibration c = calibrated(s, text);
    // The threshold is 2.0 standard deviations of a length: one good length in 23 lies beyond (docs/method.md).
    EXPECT_LE(c.train.outliers.size(), 16U) << seed;
    mixed += distance_from_truth_mm(s, c, 300, seed);
  }
  EXPECT_LT(mixed, 0.7 * alone);
}

TEST(Reflectors, EachIsFoundWhereItIs) {
  const Simulation s = simulated(60, 12, 0.02e-3, 3);
  const TableColumn target{"target", [&](std::size_t i) { return s.train.targets[s.train.rows[i].target]; }};
  const Calibration c = calibrated(
      s, measured_table(s.train.rows.size(),
                        TableColumns{id_column(s.train), target} + joint_columns(s.train) + position_columns(s.train)));
  ASSERT_EQ(c.estimate.flange_p_m.size(), 3U);
  ASSERT_EQ(s.truth.targets.size(), 3U);
  for (std::size_t t = 0; t < 3; ++t) {
    for (const TargetPoint& truth : s.truth.targets) {
      if (truth.name != c.training.targets[t]) continue;
      EXPECT_LT(1e3 * norm(minus(truth.flange_p_m, c.estimate.flange_p_m[t])), 0.05) << truth.name;
    }
  }
  EXPECT_EQ(c.corrected.targets.size(), 3U);
  EXPECT_LT(distance_from_truth_mm(s, c, 500, 3), 0.02);
}

TEST(JointColumns, TheToolSaysWhichReadingsFitBetter) {
  const Simulation s = simulated(60, 21);
  for (const bool read_is_noisy : {true, false}) {
    Random random(4);
    std::vector<double> off(s.train.rows.size() * s.train.joint_count);
    for (double& each : off) each = 0.3e-3 * random.normal();
    const auto noisy = [&](std::size_t row, std::size_t joint) { return off[row * s.train.joint_count + joint]; };
    const std::string text = measured_table(
        s.train.rows.size(),
        TableColumns{id_column(s.train)} + (read_is_noisy ? joint_columns(s.train, "_deg", noisy) : joint_columns(s.train)) +
            (read_is_noisy ? joint_columns(s.train, "_cmd_deg") : joint_columns(s.train, "_cmd_deg", noisy)) +
            position_columns(s.train));
    CalibrationOptions read;
    read.joints = JointReadings::read;
    CalibrationOptions commanded;
    commanded.joints = JointReadings::commanded;
    const Calibration with_read = calibrated(s, text, read);
    const Calibration with_commanded = calibrated(s, text, commanded);
    const std::string verdict = std::string("The ") + (read_is_noisy ? "commanded" : "read") + " joint angles fit better";
    EXPECT_TRUE(noted(with_read, verdict)) << read_is_noisy;
    EXPECT_TRUE(noted(with_commanded, verdict)) << read_is_noisy;
    // Unless told otherwise it takes the better ones, and says so.
    const Calibration better = calibrated(s, text);
    EXPECT_TRUE(noted(better, std::string("The ") + (read_is_noisy ? "commanded" : "read") + " ones are used."));
    EXPECT_EQ(better.scale_mm, (read_is_noisy ? with_commanded : with_read).scale_mm);
    // It is right: the better fitting one lies closer to the truth.
    EXPECT_EQ(distance_from_truth_mm(s, with_commanded, 300, 1) < distance_from_truth_mm(s, with_read, 300, 1),
              read_is_noisy);
  }
}

TEST(SigmaColumns, AnisotropicNoiseIsWeighted) {
  // A tracker: along its beam 0.01 mm, across 0.1 mm. Here the beam is the z axis of its frame.
  std::vector<double> ratio;
  for (std::uint64_t seed = 1; seed <= 11; ++seed) {
    Simulation s = simulated(60, seed, 0.0);
    Random random(100 + seed);
    for (Measurement& m : s.train.rows) {
      m.position_m[0] += 0.1e-3 * random.normal();
      m.position_m[1] += 0.1e-3 * random.normal();
      m.position_m[2] += 0.01e-3 * random.normal();
    }
    const TableColumns plain = TableColumns{id_column(s.train)} + joint_columns(s.train) + position_columns(s.train);
    const TableColumns sigma = {{"sx_mm", [](std::size_t) { return "0.1"; }},
                                {"sy_mm", [](std::size_t) { return "0.1"; }},
                                {"sz_mm", [](std::size_t) { return "0.01"; }}};
    const std::size_t n = s.train.rows.size();
    ratio.push_back(distance_from_truth_mm(s, calibrated(s, measured_table(n, plain + sigma)), 300, seed) /
                    distance_from_truth_mm(s, calibrated(s, measured_table(n, plain)), 300, seed));
  }
  std::sort(ratio.begin(), ratio.end());
  EXPECT_LT(ratio[ratio.size() / 2], 0.8);
}

}  // namespace
