// SPDX-License-Identifier: MIT
#include "offline/cli/acceptance.hpp"

#include <cmath>
#include <cstdio>

#include "offline/assess/iso9283.hpp"
#include "offline/base/error.hpp"
#include "offline/base/statistics.hpp"
#include "offline/cli/blob_command.hpp"
#include "offline/output/blob_file.hpp"

namespace mdhcal::offline {

namespace {

bool has_position(const Measurement& row) {
  return row.kind == MeasurementKind::position || row.kind == MeasurementKind::pose;
}

template <class... Values>
std::string formatted(const char* format, Values... values) {
  char text[240];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

void hold(Acceptance& acceptance, const char* what, double value, const std::optional<double>& limit) {
  if (!limit || value <= *limit) return;
  acceptance.broken += formatted("The %s is %.4f mm, over the limit of %.4f mm. ", what, value, *limit);
}

void add_iso9283(Acceptance& acceptance, const AcceptanceOptions& options, const Arm<double>& arm, const Registration& r,
                 const Dataset& data) {
  std::vector<Visit> visits;
  for (const Measurement& row : data.rows) {
    if (!has_position(row)) continue;
    const Vector3 commanded = predicted(arm, r, data, row);
    Visit visit;
    visit.pose = data.groups[row.group];
    if (data.targets.size() > 1) visit.pose += '/' + data.targets[row.target];
    for (std::size_t k = 0; k < 3; ++k) visit.error_mm[k] = 1e3 * (row.position_m[k] - commanded[k]);
    visits.push_back(visit);
  }
  const Iso9283 result = iso9283(visits);
  if (result.repeated == 0) {
    throw InputError(data.path, 0, 0, "No pose is visited twice; expected a column \"group\" with repeated poses for ISO 9283.");
  }
  acceptance.text += "\nISO 9283        visits    AP, mm    RP, mm\n";
  auto poses = nlohmann::ordered_json::array();
  for (const PoseTest& pose : result.poses) {
    acceptance.text += formatted("%-14s %7zu %9.4f ", pose.pose.c_str(), pose.visits, pose.accuracy_mm);
    acceptance.text += pose.visits < 2 ? "        -\n" : formatted("%9.4f\n", pose.repeatability_mm);
    poses.push_back({{"pose", pose.pose}, {"visits", pose.visits}, {"ap_mm", pose.accuracy_mm}});
    poses.back()["rp_mm"] = pose.visits < 2 ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(pose.repeatability_mm);
  }
  acceptance.text += formatted("largest                %9.4f %9.4f\n", result.largest_accuracy_mm, result.largest_repeatability_mm);
  if (result.fewest_visits < 30) {
    acceptance.text += formatted("(the standard asks for 30 visits of each pose; the fewest here are %zu)\n", result.fewest_visits);
  }
  acceptance.json["iso9283"] = {{"ap_mm", result.largest_accuracy_mm},
                                {"rp_mm", result.largest_repeatability_mm},
                                {"fewest_visits", result.fewest_visits},
                                {"poses", poses}};
  hold(acceptance, "largest pose accuracy AP", result.largest_accuracy_mm, options.max_ap_mm);
  hold(acceptance, "largest pose repeatability RP", result.largest_repeatability_mm, options.max_rp_mm);
}

double norm_mm(const Vector3& a, const Vector3& b) { return 1e3 * std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

void add_drift(Acceptance& acceptance, const AcceptanceOptions& options, const Arm<double>& arm, const Registration& r,
               const Dataset& data, bool refit_base, bool refit_tool) {
  const BlobArm earlier = read_blob_arm(options.against, PoseOptions{});
  if (earlier.arm.joint_count != arm.joint_count) {
    throw InputError(options.against, 0, 0, "The earlier blob has another number of joints.");
  }
  const Registration before = registration(robot_of(earlier.model, options.against), data, refit_base, refit_tool);
  std::vector<double> errors, differences;
  for (const Measurement& row : data.rows) {
    if (!has_position(row)) continue;
    const Vector3 then = predicted(earlier.arm, before, data, row), now = predicted(arm, r, data, row);
    errors.push_back(norm_mm(then, row.position_m));
    differences.push_back(norm_mm(then, now));
  }
  const Statistics error = statistics(errors), difference = statistics(differences);
  acceptance.text += formatted("\nearlier blob on these rows: mean error %.4f mm, max %.4f mm\n", error.mean, error.max);
  acceptance.text += formatted("drift of the prediction:    mean %.4f mm, max %.4f mm\n", difference.mean, difference.max);
  acceptance.json["drift"] = {{"against", options.against},
                              {"mean_mm", difference.mean},
                              {"max_mm", difference.max},
                              {"earlier_mean_mm", error.mean},
                              {"earlier_max_mm", error.max}};
  hold(acceptance, "largest drift against the earlier blob", difference.max, options.max_drift_mm);
}

}  // namespace

void AcceptanceOptions::add_to(CLI::App& command) {
  command.add_flag("--iso9283", iso9283, "Also pose accuracy AP and repeatability RP of poses visited repeatedly (ISO 9283)");
  command.add_option("--max-ap", max_ap_mm, "Exit status 1 if a pose accuracy is larger [mm]")->check(CLI::NonNegativeNumber);
  command.add_option("--max-rp", max_rp_mm, "Exit status 1 if a pose repeatability is larger [mm]")
      ->check(CLI::NonNegativeNumber);
  command.add_option("--against", against, "An earlier blob: how far the prediction has drifted");
  command.add_option("--max-drift", max_drift_mm, "Exit status 1 if the largest drift is larger [mm]")
      ->check(CLI::NonNegativeNumber);
}

Acceptance accept(const AcceptanceOptions& options, const Arm<double>& arm, const Registration& r, const Dataset& data,
                  bool refit_base, bool refit_tool) {
  Acceptance acceptance;
  acceptance.json = nlohmann::ordered_json::object();
  if (options.iso9283 || options.max_ap_mm || options.max_rp_mm) add_iso9283(acceptance, options, arm, r, data);
  if (options.max_drift_mm && options.against.empty()) {
    throw InputError("Found --max-drift without --against; expected the earlier blob to compare with.");
  }
  if (!options.against.empty()) add_drift(acceptance, options, arm, r, data, refit_base, refit_tool);
  return acceptance;
}

}  // namespace mdhcal::offline
