// SPDX-License-Identifier: MIT
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>

#include <nlohmann/json.hpp>

#include "offline/base/error.hpp"
#include "offline/base/folder.hpp"
#include "offline/base/progress.hpp"
#include "offline/batch/batch.hpp"
#include "offline/cli/calibration_arguments.hpp"
#include "offline/cli/commands.hpp"
#include "offline/cli/messages.hpp"
#include "offline/output/blob_writer.hpp"

namespace mdhcal::offline {

namespace {

struct BatchArguments {
  std::string manifest, slice;
  CalibrationArguments calibration;  // its robot and measurements are the manifest's
  BatchOptions options;
  bool json = false;
};

// "i/n" with 1 <= i <= n.
std::pair<std::size_t, std::size_t> parse_slice(const std::string& text) {
  std::size_t i = 0, n = 0;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, i);
  const bool slash = first.ec == std::errc{} && first.ptr != end && *first.ptr == '/';
  const auto second = slash ? std::from_chars(first.ptr + 1, end, n) : first;
  if (!slash || second.ec != std::errc{} || second.ptr != end || i < 1 || i > n) {
    throw InputError("Found --slice " + text + "; expected i/n with 1 <= i <= n, like 2/8.");
  }
  return {i, n};
}

void print_json(const std::vector<BatchOutcome>& outcomes, const std::string& summary) {
  nlohmann::ordered_json json{{"summary", summary}, {"robots", nlohmann::ordered_json::array()}};
  for (const BatchOutcome& outcome : outcomes) {
    json["robots"].push_back({{"name", outcome.name},
                              {"state", !outcome.done ? "refused" : !outcome.usable ? "not usable" : outcome.earlier ? "done before" : "calibrated"},
                              {"message", outcome.message}});
  }
  std::fputs((json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n').c_str(), stdout);
}

void run_batch(BatchArguments& arguments) {
  std::vector<BatchEntry> entries = read_manifest(arguments.manifest);
  std::string suffix;
  if (!arguments.slice.empty()) {
    const auto [i, n] = parse_slice(arguments.slice);
    entries = slice_of(entries, i, n);
    suffix = "-" + std::to_string(i) + "-of-" + std::to_string(n);
  }
  const std::string& directory_name = arguments.calibration.directory;
  arguments.options.calibration = calibration_options(arguments.calibration);
  arguments.options.rotation = arguments.calibration.rotation;
  arguments.options.date = blob_date(arguments.calibration.date);
  if (arguments.options.jobs == 0) arguments.options.jobs = std::max(1U, std::thread::hardware_concurrency());
  std::error_code error;
  std::filesystem::create_directories(directory_name, error);
  if (error) throw InputError(directory_name, 0, 0, "The folder cannot be made: " + error.message() + '.');

  std::vector<BatchOutcome> outcomes;
  {
    Progress progress("batch", verbosity() != Verbosity::quiet);
    outcomes = run_batch(entries, directory_name, arguments.options, progress.callback());
  }
  const std::filesystem::path directory = directory_name;
  write_file(directory / ("summary" + suffix + ".csv"), summary_csv(outcomes, directory_name));
  write_file(directory / ("summary" + suffix + ".html"), summary_html(outcomes, directory_name));

  const auto count = [&](auto&& holds) {
    return std::to_string(std::count_if(outcomes.begin(), outcomes.end(), holds));
  };
  if (arguments.json) print_json(outcomes, (directory / ("summary" + suffix + ".csv")).string());
  for (const BatchOutcome& outcome : outcomes) {
    if (!outcome.usable) warn(outcome.name + ": " + outcome.message);
  }
  const bool all = std::all_of(outcomes.begin(), outcomes.end(), [](const BatchOutcome& o) { return o.usable; });
  const std::string said = count([](const BatchOutcome& o) { return o.usable && !o.earlier; }) + " calibrated, " +
                           count([](const BatchOutcome& o) { return o.usable && o.earlier; }) + " were done before, " +
                           count([](const BatchOutcome& o) { return o.done && !o.usable; }) + " not usable, " +
                           count([](const BatchOutcome& o) { return !o.done; }) + " refused; summary" + suffix +
                           ".csv and .html are in " + directory_name + '.';
  if (!all) throw Refusal(said);
  inform(said);
}

}  // namespace

void add_batch(CLI::App& app) {
  auto arguments = std::make_shared<BatchArguments>();
  BatchOptions& options = arguments->options;
  CLI::App* command = app.add_subcommand("batch", "Calibrate many robots, a folder each and one summary");
  command->add_option("MANIFEST", arguments->manifest,
                      "Table (CSV) with the columns name, robot, measurements and optionally test; paths are relative to it")
      ->required();
  command->add_option("-o,--output", arguments->calibration.directory, "Folder for the robots' folders and the summary")->required();
  command->add_option("-j,--jobs", options.jobs, "Robots at a time; 0: as many as there are cores")->capture_default_str();
  command->add_option("--slice", arguments->slice, "Only every n-th robot from the i-th on: i/n");
  command->add_flag("--report", options.report, "Write each robot's report.html too");
  command->add_flag("--redo", options.redo, "Calibrate also the robots whose folder is there");
  command->add_option("--lambda-rule", arguments->calibration.options.lambda_rule, "How lambda is chosen, as in calibrate")
      ->capture_default_str();
  add_identification_options(*command, arguments->calibration);
  command->add_flag("--json", arguments->json, "Print what became of each robot as JSON on stdout");
  command->add_option("--date", arguments->calibration.date, "Date in the blobs, YYYY-MM-DD");
  command->footer(
      "Example:\n  mdhcal batch fleet.csv -o fleet -j 8\n"
      "  parallel mdhcal batch fleet.csv -o fleet --slice {}/4 ::: 1 2 3 4 && mdhcal batch fleet.csv -o fleet");
  command->callback([arguments] { run_batch(*arguments); });
}

}  // namespace mdhcal::offline
