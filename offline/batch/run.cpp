// SPDX-License-Identifier: MIT
#include <atomic>
#include <filesystem>
#include <thread>

#include "offline/base/error.hpp"
#include "offline/base/folder.hpp"
#include "offline/batch/batch.hpp"
#include "offline/identify/mistakes/diagnose.hpp"
#include "offline/output/result_files.hpp"
#include "offline/report/write_result.hpp"

namespace mdhcal::offline {

namespace {

namespace fs = std::filesystem;

// A folder appears whole, so one file speaks for all.
bool is_done(const fs::path& folder, bool with_report) {
  std::error_code error;
  return fs::exists(folder / "result.json", error) && (!with_report || fs::exists(folder / "report.html", error));
}

// Why the result is not used; empty if it is.
std::string calibrate_one(const BatchEntry& entry, const fs::path& folder, const BatchOptions& options) {
  const Robot robot = read_robot(entry.robot);
  const Dataset data = read_dataset(entry.measurements, robot, options.rotation);
  Dataset test;
  if (!entry.test.empty()) test = read_dataset(entry.test, robot, options.rotation);
  OutputFolder out(folder, result_names);
  Calibration calibration = concluded(calibrate(robot, data, options.calibration, entry.test.empty() ? nullptr : &test));
  Assessment assessment;
  assessment.diagnosis = explain_by_mistakes({robot, data, options.calibration}, false, calibration);
  write_result(out, calibration, options.date, options.report, assessment);
  out.commit();
  std::string reasons;
  if (!calibration.released()) {
    for (const std::string& reason : calibration.reasons) reasons += (reasons.empty() ? "" : " ") + reason;
  }
  return reasons;
}

}  // namespace

std::vector<BatchOutcome> run_batch(const std::vector<BatchEntry>& entries, const std::string& directory,
                                    const BatchOptions& options,
                                    const std::function<void(std::size_t, std::size_t)>& progress) {
  std::vector<BatchOutcome> outcomes(entries.size());
  std::atomic<std::size_t> next = 0, finished = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < entries.size(); i = next++) {
      BatchOutcome& outcome = outcomes[i];
      outcome.name = entries[i].name;
      const fs::path folder = fs::path(directory) / entries[i].name;
      try {
        outcome.earlier = !options.redo && is_done(folder, options.report);
        if (!outcome.earlier) outcome.message = calibrate_one(entries[i], folder, options);
        else if (!fs::exists(folder / "calibration.blob")) outcome.message = "Not usable: see its result.json.";
        outcome.done = true;
        outcome.usable = outcome.message.empty();
      } catch (const std::exception& error) {
        outcome.message = error.what();
      }
      if (progress) progress(++finished, entries.size());
    }
  };
  std::vector<std::jthread> others;
  for (unsigned k = 1; k < options.jobs; ++k) others.emplace_back(work);
  work();
  others.clear();  // joins
  return outcomes;
}

}  // namespace mdhcal::offline
