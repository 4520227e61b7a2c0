// SPDX-License-Identifier: MIT
#include <memory>

#include "offline/cli/calibration_arguments.hpp"
#include "offline/cli/messages.hpp"
#include "offline/output/folder.hpp"
#include "offline/output/result_files.hpp"
#include "offline/report/write_result.hpp"

namespace mdhcal::offline {

namespace {

void run(const CalibrationArguments& arguments) {
  const CalibrationOptions options = calibration_options(arguments);
  const std::string date = blob_date(arguments.date);
  const Robot robot = read_robot(arguments.robot);
  const Dataset data = read_dataset(arguments.measurements, robot);
  Dataset test;
  if (!arguments.test.empty()) test = read_dataset(arguments.test, robot);
  OutputFolder folder(arguments.directory, result_names);
  const Calibration c = calibrate(robot, data, options, arguments.test.empty() ? nullptr : &test);

  write_result(folder, c, date, true);
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
  command->add_option("--date", arguments->date, "Date in the blob, YYYY-MM-DD");
  command->footer(
      "Example:\n  mdhcal calibrate robot.toml nine_poses.csv --test eighteen_poses.csv --base given --tool given -o result");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace mdhcal::offline
