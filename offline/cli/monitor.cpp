// SPDX-License-Identifier: MIT
#include <cstdio>
#include <memory>
#include <optional>

#include <nlohmann/json.hpp>

#include "offline/assess/monitor.hpp"
#include "offline/base/error.hpp"
#include "offline/base/text.hpp"
#include "offline/cli/blob_command.hpp"
#include "offline/cli/blob_registration.hpp"
#include "offline/cli/commands.hpp"
#include "offline/cli/messages.hpp"
#include "offline/cli/rotation_option.hpp"
#include "offline/output/blob_file.hpp"

namespace mdhcal::offline {

namespace {

struct MonitorArguments {
  std::string blob, measurements, rotation;
  std::optional<double> expected_mean_mm;
  std::size_t expected_count = 50;
  double alpha = 0.01;
  bool json = false;
};

void run_monitor(const MonitorArguments& arguments) {
  const BlobArm blob = read_blob_arm(arguments.blob, PoseOptions{});
  const Robot robot = robot_of(blob.model, arguments.blob);
  const Dataset data = read_measurements(arguments.measurements, robot, arguments.rotation);
  const BlobProvenance& provenance = blob.model.provenance;
  if (!arguments.expected_mean_mm && provenance.has_held_out == 0) {
    throw InputError(arguments.blob, 0, 0,
                     "The blob records no held-out error; expected a calibration with --test, or --expected-mean.");
  }
  const double expected_mm = arguments.expected_mean_mm.value_or(1e3 * provenance.mean_after_m);
  const std::size_t count = arguments.expected_mean_mm ? arguments.expected_count : provenance.held_out_count;
  if (!(expected_mm > 0) || count == 0) {
    throw InputError(arguments.blob, 0, 0, "The error at calibration is 0 mm; expected one above 0 to compare with.");
  }
  const Registration r = registration(robot, data, false, false);
  std::vector<Vector3> expected, measured;
  for (const Measurement& row : data.rows) {
    if (row.kind != MeasurementKind::position && row.kind != MeasurementKind::pose) continue;
    expected.push_back(predicted(blob.arm, r, data, row));
    measured.push_back({row.position_m[0], row.position_m[1], row.position_m[2]});
  }
  if (expected.empty()) throw InputError(data.path, 0, 0, "No row measures a position; expected x, y and z.");
  const MonitorResult result = monitor(expected, measured, expected_mm, count, arguments.alpha);
  if (arguments.json) {
    const char* conditions[] = {"good", "frame_moved", "recalibrate"};
    nlohmann::ordered_json json;
    json["condition"] = conditions[static_cast<std::size_t>(result.condition)];
    json["count"] = result.count;
    json["mean_mm"] = result.mean_mm;
    json["max_mm"] = result.max_mm;
    json["expected_mean_mm"] = result.expected_mean_mm;
    json["ratio"] = result.ratio;
    json["p_value"] = result.p_value;
    json["refitted_mean_mm"] = result.refitted_mean_mm;
    json["refitted_ratio"] = result.refitted_ratio;
    json["refitted_p_value"] = result.refitted_p_value;
    json["shift_mm"] = result.shift_mm;
    json["turn_deg"] = result.turn_deg;
    json["sentence"] = result.sentence;
    std::fputs((json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n').c_str(), stdout);
  } else {
    std::printf("%s\n", printable(result.sentence).c_str());
  }
  std::fflush(stdout);
  if (result.condition != Condition::good) throw Refusal("The check series does not hold the accuracy of the calibration.");
}

}  // namespace

void add_monitor(CLI::App& app) {
  auto arguments = std::make_shared<MonitorArguments>();
  CLI::App* command = app.add_subcommand("monitor", "Say from a short check series whether a recalibration is due");
  command->add_option("BLOB", arguments->blob, "Parameter blob")->required();
  command->add_option("MEASUREMENTS", arguments->measurements, "Check series (CSV), some ten poses")->required();
  command->add_option("--alpha", arguments->alpha, "Chance of a false alarm")->check(CLI::Range(1e-6, 0.5))->capture_default_str();
  command->add_option("--expected-mean", arguments->expected_mean_mm,
                      "Mean error at calibration [mm] (default: the held-out one that the blob records)")
      ->check(CLI::PositiveNumber);
  command->add_option("--expected-count", arguments->expected_count, "Poses behind --expected-mean")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "Print the figures as JSON");
  add_rotation_option(*command, arguments->rotation);
  command->footer("Example:\n  mdhcal monitor result/calibration.blob check.csv");
  command->callback([arguments] { run_monitor(*arguments); });
}

}  // namespace mdhcal::offline
