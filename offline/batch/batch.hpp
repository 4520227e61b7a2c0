// SPDX-License-Identifier: MIT
// Many robots: each calibrated into a folder of its own, independent of all others, and one table of what came out.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "offline/identify/calibrate.hpp"

namespace mdhcal::offline {

/// One robot of a manifest. Paths are as the manifest gives them, relative ones to its folder.
struct BatchEntry {
  std::string name;          ///< of its folder; unique
  std::string robot, measurements;
  std::string test;          ///< empty: none
};

/// Reads a manifest: a CSV table with the columns `name`, `robot`, `measurements` and optionally `test`.
/// Throws InputError naming line and column: a missing or repeated name, or one that is no plain file name.
std::vector<BatchEntry> read_manifest(const std::string& path);

/// The entries with index = slice - 1 modulo `slices`; slice in 1 ... slices.
std::vector<BatchEntry> slice_of(const std::vector<BatchEntry>& entries, std::size_t slice, std::size_t slices);

struct BatchOptions {
  CalibrationOptions calibration;
  std::string rotation;      ///< convention of the measurements' rotations (read_dataset())
  std::string date;          ///< for the blobs
  bool report = false;       ///< also write report.html
  bool redo = false;         ///< also those that are done
  unsigned jobs = 1;         ///< threads
};

/// What became of one robot.
struct BatchOutcome {
  std::string name;
  bool done = false;         ///< its folder is there and complete
  bool earlier = false;      ///< and was there before
  bool usable = false;       ///< and holds a blob
  std::string message;       ///< why it was refused or is not usable; empty if usable
};

/// Calibrates the entries into DIRECTORY/NAME, skipping those whose folder is there. A robot that is refused does not stop
/// the others. Each folder appears whole or not at all, so that a killed batch is continued by starting it again, and
/// several processes may work on parts of one manifest at a time. Outcomes are in the order of the entries.
std::vector<BatchOutcome> run_batch(const std::vector<BatchEntry>& entries, const std::string& directory,
                                    const BatchOptions& options,
                                    const std::function<void(std::size_t, std::size_t)>& progress = {});

/// One line a robot: its state and the figures of its result.json, read from DIRECTORY/NAME. mm.
std::string summary_csv(const std::vector<BatchOutcome>& outcomes, const std::string& directory);
/// The same as a page.
std::string summary_html(const std::vector<BatchOutcome>& outcomes, const std::string& directory);

}  // namespace mdhcal::offline
