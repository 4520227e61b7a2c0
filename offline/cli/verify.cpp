// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include <nlohmann/json.hpp>

#include "offline/base/error.hpp"
#include "offline/base/statistics.hpp"
#include "offline/base/text.hpp"
#include "offline/cli/acceptance.hpp"
#include "offline/cli/blob_command.hpp"
#include "offline/cli/blob_registration.hpp"
#include "offline/cli/commands.hpp"
#include "offline/cli/messages.hpp"
#include "offline/cli/rotation_option.hpp"
#include "offline/identify/folds.hpp"
#include "offline/identify/judging.hpp"
#include "offline/output/blob_file.hpp"

namespace mdhcal::offline {

namespace {

struct VerifyArguments {
  std::string blob, measurements, rotation;
  bool refit_base = false, refit_tool = false, json = false;
  std::optional<double> max_mean_mm, max_max_mm;
  AcceptanceOptions acceptance;
};

double distance(const Vector3& a, const Vector3& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

// Error of a row [mm]: of the position, or of the distance; nothing for a row that measures nothing.
std::optional<double> error_mm(const Arm<double>& arm, const Registration& r, const Dataset& data, const Measurement& row) {
  if (row.kind == MeasurementKind::joints) return std::nullopt;
  const Vector3 here = predicted(arm, r, data, row);
  if (row.kind != MeasurementKind::distance) return 1e3 * distance(here, row.position_m);
  const Vector3 there = row.other_row < 0
                            ? row.position_m
                            : predicted(arm, r, data, data.rows[static_cast<std::size_t>(row.other_row)]);
  return 1e3 * std::abs(distance(here, there) - row.distance_m);
}

nlohmann::ordered_json figures_json(const Statistics& s) {
  return {{"count", s.count}, {"mean_mm", s.mean}, {"median_mm", s.median}, {"max_mm", s.max},
          {"sd_mm", s.sd},    {"rms_mm", s.rms},   {"p95_mm", s.p95}};
}

void print_line(const std::string& name, const Statistics& s) {
  std::printf("%-16s %7zu %9.4f %9.4f %9.4f %9.4f %9.4f %9.4f\n", printable(name).c_str(), s.count, s.mean, s.median, s.max, s.sd,
              s.rms, s.p95);
}

void run_verify(const VerifyArguments& arguments) {
  const BlobArm blob = read_blob_arm(arguments.blob, PoseOptions{});
  const Robot robot = robot_of(blob.model, arguments.blob);
  const Dataset data = read_measurements(arguments.measurements, robot, arguments.rotation);
  if (!robot.tracker_T_base && !arguments.refit_base) {
    detail("The blob has no base frame: the measurements are taken to be in the robot's base frame.");
  }
  const Registration r = registration(robot, data, arguments.refit_base, arguments.refit_tool);
  std::vector<double> all;
  std::vector<std::size_t> rows;
  std::vector<std::vector<double>> by_target(data.targets.size());
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const Measurement& row = data.rows[i];
    if (const auto error = error_mm(blob.arm, r, data, row)) {
      all.push_back(*error);
      rows.push_back(i);
      by_target[row.target].push_back(*error);
    }
  }
  const Statistics total = statistics(all);
  const std::vector<std::uint32_t> pose = poses_of(data, rows);
  const std::size_t poses = pose.empty() ? 0 : *std::max_element(pose.begin(), pose.end()) + std::size_t{1};
  const Bounds mean = bounds_of_mean(all, pose);
  const Statistics rotations = statistics(rotation_errors_deg(blob.arm, r, data));

  std::string broken;
  const Acceptance acceptance = accept(arguments.acceptance, blob.arm, r, data, arguments.refit_base, arguments.refit_tool);
  const auto hold = [&](const char* what, double value, const std::optional<double>& limit) {
    if (!limit || value <= *limit) return;
    char text[120];
    std::snprintf(text, sizeof text, "The %s error is %.4f mm, over the limit of %.4f mm. ", what, value, *limit);
    broken += text;
  };
  hold("mean", total.mean, arguments.max_mean_mm);
  hold("largest", total.max, arguments.max_max_mm);

  broken += acceptance.broken;

  if (arguments.json) {
    nlohmann::ordered_json json = figures_json(total);
    json["poses"] = poses;
    if (std::isfinite(mean.high)) json["mean_95_mm"] = {mean.low, mean.high};
    else json["mean_95_mm"] = nullptr;
    if (rotations.count > 0) {
      json["rotation_count"] = rotations.count;
      json["rotation_mean_deg"] = rotations.mean;
      json["rotation_max_deg"] = rotations.max;
    }
    json["targets"] = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < by_target.size(); ++k) {
      nlohmann::ordered_json target{{"name", data.targets[k]}};
      target.update(figures_json(statistics(by_target[k])));
      json["targets"].push_back(target);
    }
    json["base"] = arguments.refit_base ? "refitted" : "blob";
    json["tool"] = arguments.refit_tool ? "refitted" : "blob";
    json.update(acceptance.json);
    json["passed"] = broken.empty();
    std::fputs((json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n').c_str(), stdout);
  } else {
    std::printf("%-16s %7s %9s %9s %9s %9s %9s %9s\n", "error, mm", "count", "mean", "median", "max", "sd", "rms", "p95");
    print_line("all", total);
    for (std::size_t k = 0; data.targets.size() > 1 && k < by_target.size(); ++k) {
      print_line("target " + data.targets[k], statistics(by_target[k]));
    }
    if (std::isfinite(mean.high)) std::printf("95 %% bounds of the mean over %zu poses: %.4f to %.4f mm\n", poses, mean.low, mean.high);
  }
  if (!arguments.json && rotations.count > 0) {
    std::printf("rotations of %zu full poses: mean %.4f, maximum %.4f degrees\n", rotations.count, rotations.mean, rotations.max);
  }
  if (!arguments.json) std::fputs(acceptance.text.c_str(), stdout);
  std::fflush(stdout);
  if (!broken.empty()) throw Refusal(broken.substr(0, broken.size() - 1));
}

}  // namespace

void add_verify(CLI::App& app) {
  auto arguments = std::make_shared<VerifyArguments>();
  CLI::App* command = app.add_subcommand("verify", "Compare a blob's predictions with measurements");
  command->add_option("BLOB", arguments->blob, "Parameter blob")->required();
  command->add_option("MEASUREMENTS", arguments->measurements, "Measurement file (CSV)")->required();
  command->add_flag("--refit-base", arguments->refit_base, "Fit the base frame to these measurements (the tracker moved)");
  command->add_flag("--refit-tool", arguments->refit_tool, "Fit the target points to these measurements (new reflectors)");
  command->add_option("--max-mean", arguments->max_mean_mm, "Exit status 1 if the mean error is larger [mm]")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--max-max", arguments->max_max_mm, "Exit status 1 if the largest error is larger [mm]")
      ->check(CLI::NonNegativeNumber);
  arguments->acceptance.add_to(*command);
  command->add_flag("--json", arguments->json, "Print the figures as JSON");
  add_rotation_option(*command, arguments->rotation);
  command->footer("Example:\n  mdhcal verify result/calibration.blob check.csv --max-mean 0.1 --max-max 0.3");
  command->callback([arguments] { run_verify(*arguments); });
}

}  // namespace mdhcal::offline
