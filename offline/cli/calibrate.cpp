// SPDX-License-Identifier: MIT
#include <cstdio>
#include <memory>
#include <optional>

#include "offline/base/error.hpp"
#include "offline/base/folder.hpp"
#include "offline/base/progress.hpp"
#include "offline/base/text_table.hpp"
#include "offline/cli/calibration_arguments.hpp"
#include "offline/cli/import_arguments.hpp"
#include "offline/cli/messages.hpp"
#include "offline/cli/robot_argument.hpp"
#include "offline/identify/mistakes/diagnose.hpp"
#include "offline/output/result_files.hpp"
#include "offline/report/write_result.hpp"

namespace mdhcal::offline {

namespace {

struct CalibrateArguments : CalibrationArguments {
  std::size_t resamples = 0;
  std::optional<std::size_t> folds;
  ImportArguments import;  // --tracker and what belongs to it
  bool diagnose = false;
};

std::optional<Diagnosis> searched(const Robot& robot, const Dataset& data, const CalibrationOptions& options, bool always,
                                  Calibration& c) {
  Progress progress("search for mistakes", verbosity() != Verbosity::quiet);
  return explain_by_mistakes({robot, data, options}, always, c, progress.callback());
}

// The calibration; where the measurements do not carry one, the mistake without which they would is said.
Calibration calibrated(const Robot& robot, const Dataset& data, const CalibrationOptions& options, const Dataset* test) {
  try {
    return calibrate(robot, data, options, test);
  } catch (const Refusal&) {
    Progress progress("search for mistakes", verbosity() != Verbosity::quiet);
    const Diagnosis diagnosis = diagnose({robot, data, options}, std::nullopt, progress.callback());
    if (!diagnosis.named()) throw;
    throw Refusal(diagnosis.sentence);
  }
}

Assessment assess(const CalibrateArguments& arguments, const CalibrationOptions& options, const Robot& robot,
                  const Dataset& data, const Calibration& c) {
  Assessment out;
  const bool shown = verbosity() != Verbosity::quiet;
  if (arguments.resamples > 0) {
    Progress progress("bootstrap", shown);
    out.bootstrap = bootstrap(c, arguments.resamples, options.seed, 0, progress.callback());
  }
  if (arguments.folds) {
    Progress progress("cross-validation", shown);
    out.cross_validation = cross_validate(robot, data, options, *arguments.folds, progress.callback());
  }
  return out;
}

void tell(const Calibration& c, const Assessment& assessment) {
  inform(estimated_text(c));
  for (const std::string& decision : c.decisions) detail(decision);
  for (const std::string& note : c.notes) inform(note);
  for (const std::string& each : c.details) detail(each);
  detail(choice_text(c));
  if (assessment.cross_validation) {
    const RepeatedCrossValidation& cv = *assessment.cross_validation;
    inform("Cross-validation in " + std::to_string(cv.folds) + " folds of whole groups: mean error " +
           fixed(cv.after.mean, 4) + " mm, maximum " + fixed(cv.after.max, 4) + " mm (nominal " +
           fixed(cv.before.mean, 4) + " and " + fixed(cv.before.max, 4) + " mm).");
  }
  // The reasons against it are what the program ends with.
  inform(figures_text(c) + (c.released() ? c.verdict : c.verdict.substr(c.verdict.find('\n') + 1)));
}

void run_calibrate(const CalibrateArguments& arguments) {
  if (arguments.measurements.empty() == arguments.import.exports.empty()) {
    throw InputError("Found neither MEASUREMENTS nor --tracker, or both; expected one of them.");
  }
  const CalibrationOptions options = calibration_options(arguments);
  const std::string date = blob_date(arguments.date);
  const Robot robot = robot_of_argument(arguments.robot);
  const Dataset data = arguments.import.exports.empty() ? read_dataset(arguments.measurements, robot, arguments.rotation)
                                                        : read_imported(arguments.import, robot);
  Dataset test;
  if (!arguments.test.empty()) test = read_dataset(arguments.test, robot, arguments.rotation);
  OutputFolder folder(arguments.directory, result_names);
  // What the blob cannot hold is a reason too, and the search looks for the mistake behind it.
  Calibration c = concluded(calibrated(robot, data, options, arguments.test.empty() ? nullptr : &test));
  const std::optional<Diagnosis> diagnosis = searched(robot, data, options, arguments.diagnose, c);
  Assessment assessment = assess(arguments, options, robot, data, c);
  assessment.diagnosis = diagnosis;
  write_result(folder, c, date, true, assessment);
  folder.commit();

  if (arguments.json) std::fputs(result_json(c, assessment).c_str(), stdout);
  for (const std::string& note : data.notes) inform(note);
  for (const std::string& note : test.notes) inform(note);
  tell(c, assessment);
  inform("Written to " + arguments.directory + ".");
  if (!c.released()) {
    std::string said = "Not usable, so neither calibration.blob nor corrected.toml is written:";
    for (const std::string& reason : c.reasons) said += " " + reason;
    throw Refusal(said + " With --accept \"why\" it is written all the same.");
  }
}

}  // namespace

void add_calibrate(CLI::App& app) {
  auto arguments = std::make_shared<CalibrateArguments>();
  CLI::App* command = app.add_subcommand("calibrate", "Identify a robot's geometry from measurements");
  add_calibration_arguments(*command, *arguments);
  command->get_option("MEASUREMENTS")->required(false);
  command->add_option("--tracker", arguments->import.exports, "Files of the tracker in place of MEASUREMENTS, read as `mdhcal import` does");
  // One option for both kinds of measurements, wherever it is added.
  CLI::Option* rotation = command->get_option_no_throw("--rotation");
  if (rotation == nullptr) rotation = command->add_option("--rotation", arguments->import.rotation, "Convention of a rotation in three angles, or none to leave it out");
  add_import_options(*command, arguments->import);
  CalibrationOptions& options = arguments->options;
  command->add_option("--method", options.method, "rpim (regularized), or one of those it is compared with")
      ->check(CLI::IsMember({"rpim", "rpim-train", "nc", "lsm", "gd", "gn", "lm", "ekf"}))
      ->capture_default_str();
  auto* rule = command->add_option("--lambda-rule", options.lambda_rule, "How lambda is chosen")
                   ->check(CLI::IsMember({"reml", "rpim", "rpim-train", "l-curve", "gcv", "cv", "discrepancy",
                                          "quasi-optimality"}))
                   ->capture_default_str();
  command->add_option("--lambda", options.lambda, "Lambda itself, instead of a rule")->excludes(rule);
  command->add_option("--bootstrap", arguments->resamples, "Resamples of whole groups for result.json, such as 1000");
  command->add_option("--cross-validate", arguments->folds,
                      "Repeat the calibration in this many folds of whole groups; 0: one group at a time");
  command->add_flag("--diagnose", arguments->diagnose,
                    "Search for mistakes in files and options (units, signs, zeros, order, coupling, ...) in any case");
  command->add_option("--date", arguments->date, "Date in the blob, YYYY-MM-DD");
  command->footer(
      "Example:\n  mdhcal calibrate robot.toml nine_poses.csv --test eighteen_poses.csv --base given --tool given -o result");
  command->callback([arguments, rotation] {
    if (rotation->count() > 0) arguments->import.rotation = rotation->as<std::string>();
    run_calibrate(*arguments);
  });
}

}  // namespace mdhcal::offline
