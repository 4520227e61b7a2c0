// SPDX-License-Identifier: MIT
#include <memory>

#include "offline/cli/calibration_arguments.hpp"
#include "offline/cli/messages.hpp"
#include "offline/output/folder.hpp"
#include "offline/output/residuals_csv.hpp"
#include "offline/output/result_files.hpp"
#include "offline/output/result_json.hpp"

namespace mdhcal::offline {

namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (char c : text) {
    if (c == '<') out += "&lt;";
    else if (c == '&') out += "&amp;";
    else out += c;
  }
  return out;
}

std::string plain_report(const Calibration& c) {
  std::string out = "<!DOCTYPE html><html lang=\"en\"><meta charset=\"utf-8\"><title>" + escaped(c.robot.name) +
                    "</title><h1>Calibration of " + escaped(c.robot.name) + "</h1><p>" + escaped(c.verdict) +
                    "</p><pre>" + escaped(figures_text(c)) + "</pre><ul>";
  for (const std::string& note : c.notes) out += "<li>" + escaped(note) + "</li>";
  return out + "</ul></html>\n";
}

void run(const CalibrationArguments& arguments) {
  const CalibrationOptions options = calibration_options(arguments);
  const std::string date = blob_date(arguments.date);
  const Robot robot = read_robot(arguments.robot);
  const Dataset data = read_dataset(arguments.measurements, robot);
  Dataset test;
  if (!arguments.test.empty()) test = read_dataset(arguments.test, robot);
  OutputFolder folder(arguments.directory, result_names);
  const Calibration c = calibrate(robot, data, options, arguments.test.empty() ? nullptr : &test);

  const Blob blob = calibration_blob(c, date);
  folder.write("calibration.blob", {reinterpret_cast<const char*>(blob.data()), blob.size()});
  folder.write("corrected.toml", corrected_toml(c));
  folder.write("result.json", result_json(c));
  folder.write("residuals.csv", residuals_csv(c));
  folder.write("report.html", plain_report(c));
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
