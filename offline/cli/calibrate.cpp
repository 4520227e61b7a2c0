// SPDX-License-Identifier: MIT
#include <cstdio>
#include <memory>
#include <optional>

#include "offline/cli/calibration_arguments.hpp"
#include "offline/cli/messages.hpp"
#include "offline/output/folder.hpp"
#include "offline/output/result_files.hpp"
#include "offline/report/write_result.hpp"

namespace mdhcal::offline {

namespace {

void run(const CalibrationArguments& arguments, std::size_t resamples, const std::optional<std::size_t>& folds) {
  const CalibrationOptions options = calibration_options(arguments);
  const std::string date = blob_date(arguments.date);
  const Robot robot = read_robot(arguments.robot);
  const Dataset data = read_dataset(arguments.measurements, robot);
  Dataset test;
  if (!arguments.test.empty()) test = read_dataset(arguments.test, robot);
  OutputFolder folder(arguments.directory, result_names);
  const Calibration c = calibrate(robot, data, options, arguments.test.empty() ? nullptr : &test);

  Assessment assessment;
  if (resamples > 0) assessment.bootstrap = bootstrap(c, resamples, options.seed);
  if (folds) {
    assessment.cross_validation = cross_validate(robot, data, options, *folds);
    const Statistics& s = assessment.cross_validation->after;
    char text[128];
    std::snprintf(text, sizeof text, "Cross-validation in %zu folds of whole groups: mean error %.4f mm, maximum %.4f mm.",
                  assessment.cross_validation->folds, s.mean, s.max);
    inform(text);
  }
  write_result(folder, c, date, true, {}, assessment);
  folder.commit();

  for (const std::string& note : data.notes) inform(note);
  for (const std::string& note : test.notes) inform(note);
  for (const std::string& decision : c.decisions) inform(decision);
  for (const std::string& note : c.notes) inform(note);
  inform(figures_text(c) + c.verdict);
  inform("Written to " + arguments.directory + ".");
}

}  // namespace

void add_calibrate(CLI::App& app) {
  auto arguments = std::make_shared<CalibrationArguments>();
  CLI::App* command = app.add_subcommand("calibrate", "Identify a robot's geometry from measurements");
  add_calibration_arguments(*command, *arguments);
  CalibrationOptions& options = arguments->options;
  command->add_option("--method", options.method, "rpim (regularized), or one of those it is compared with")
      ->check(CLI::IsMember({"rpim", "rpim-train", "nc", "lsm", "gd", "gn", "lm", "ekf"}))
      ->capture_default_str();
  auto* rule = command->add_option("--lambda-rule", options.lambda_rule, "How lambda is chosen")
                   ->check(CLI::IsMember({"reml", "rpim", "rpim-train", "l-curve", "gcv", "cv", "discrepancy",
                                          "quasi-optimality"}))
                   ->capture_default_str();
  command->add_option("--lambda", options.lambda, "Lambda itself, instead of a rule")->excludes(rule);
  auto resamples = std::make_shared<std::size_t>(0);
  auto folds = std::make_shared<std::optional<std::size_t>>();
  command->add_option("--bootstrap", *resamples, "Resamples of whole groups for result.json, such as 1000");
  command->add_option("--cross-validate", *folds,
                      "Repeat the calibration in this many folds of whole groups; 0: one group at a time");
  command->add_option("--date", arguments->date, "Date in the blob, YYYY-MM-DD");
  command->footer(
      "Example:\n  mdhcal calibrate robot.toml nine_poses.csv --test eighteen_poses.csv --base given --tool given -o result");
  command->callback([arguments, resamples, folds] { run(*arguments, *resamples, *folds); });
}

}  // namespace mdhcal::offline
