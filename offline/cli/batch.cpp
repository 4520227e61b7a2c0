// SPDX-License-Identifier: MIT
#include <algorithm>
#include <charconv>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>

#include "offline/batch/batch.hpp"
#include "offline/cli/commands.hpp"
#include "offline/cli/messages.hpp"
#include "offline/cli/progress.hpp"
#include "offline/error.hpp"
#include "offline/output/blob_writer.hpp"
#include "offline/output/folder.hpp"

namespace mdhcal::offline {

namespace {

struct Arguments {
  std::string manifest, directory, slice;
  std::optional<std::string> date;
  BatchOptions options;
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

void run(Arguments& arguments) {
  std::vector<BatchEntry> entries = read_manifest(arguments.manifest);
  std::string suffix;
  if (!arguments.slice.empty()) {
    const auto [i, n] = parse_slice(arguments.slice);
    entries = slice_of(entries, i, n);
    suffix = "-" + std::to_string(i) + "-of-" + std::to_string(n);
  }
  arguments.options.date = blob_date(arguments.date);
  if (arguments.options.jobs == 0) arguments.options.jobs = std::max(1U, std::thread::hardware_concurrency());
  std::error_code error;
  std::filesystem::create_directories(arguments.directory, error);
  if (error) throw InputError(arguments.directory, 0, 0, "The folder cannot be made: " + error.message() + '.');

  std::vector<BatchOutcome> outcomes;
  {
    Progress progress("batch", verbosity() != Verbosity::quiet);
    outcomes = run_batch(entries, arguments.directory, arguments.options, progress.callback());
  }
  const std::filesystem::path directory = arguments.directory;
  write_file(directory / ("summary" + suffix + ".csv"), summary_csv(outcomes, arguments.directory));
  write_file(directory / ("summary" + suffix + ".html"), summary_html(outcomes, arguments.directory));

  const auto count = [&](auto&& holds) {
    return std::to_string(std::count_if(outcomes.begin(), outcomes.end(), holds));
  };
  for (const BatchOutcome& outcome : outcomes) {
    if (!outcome.done) warn(outcome.name + ": " + outcome.message);
  }
  const bool all = std::all_of(outcomes.begin(), outcomes.end(), [](const BatchOutcome& o) { return o.done; });
  const std::string said = count([](const BatchOutcome& o) { return o.done && !o.earlier; }) + " calibrated, " +
                           count([](const BatchOutcome& o) { return o.earlier; }) + " were done before, " +
                           count([](const BatchOutcome& o) { return !o.done; }) + " refused; summary" + suffix +
                           ".csv and .html are in " + arguments.directory + '.';
  if (!all) throw Refusal(said);
  inform(said);
}

}  // namespace

void add_batch(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  BatchOptions& options = arguments->options;
  CLI::App* command = app.add_subcommand("batch", "Calibrate many robots, a folder each and one summary");
  command->add_option("MANIFEST", arguments->manifest,
                      "Table (CSV) with the columns name, robot, measurements and optionally test; paths are relative to it")
      ->required();
  command->add_option("-o,--output", arguments->directory, "Folder for the robots' folders and the summary")->required();
  command->add_option("-j,--jobs", options.jobs, "Robots at a time; 0: as many as there are cores")->capture_default_str();
  command->add_option("--slice", arguments->slice, "Only every n-th robot from the i-th on: i/n");
  command->add_flag("--report", options.report, "Write each robot's report.html too");
  command->add_flag("--redo", options.redo, "Calibrate also the robots whose folder is there");
  command->add_option("--lambda-rule", options.calibration.lambda_rule, "How lambda is chosen, as in calibrate")
      ->capture_default_str();
  command->add_option("--test-fraction", options.calibration.test_fraction, "Share of the rows that is held out")
      ->check(CLI::Range(0.0, 0.9))
      ->capture_default_str();
  command->add_option("--seed", options.calibration.seed, "Seed of the random numbers")->capture_default_str();
  command->add_option("--date", arguments->date, "Date in the blobs, YYYY-MM-DD");
  command->footer(
      "Example:\n  mdhcal batch fleet.csv -o fleet -j 8\n"
      "  parallel mdhcal batch fleet.csv -o fleet --slice {}/4 ::: 1 2 3 4 && mdhcal batch fleet.csv -o fleet");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace mdhcal::offline
