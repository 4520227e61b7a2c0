// SPDX-License-Identifier: MIT
// From what instruments and controllers write to a measurement file.
#pragma once

#include <string>
#include <vector>

#include "offline/import/join.hpp"
#include "offline/import/profile.hpp"

namespace mdhcal::offline {

struct ImportOptions {
  std::vector<std::string> exports;      ///< files of the tracker
  std::string log;                       ///< file of the robot; empty if the exports state the joints
  Profile profile, log_profile;          ///< of the exports, of the log; see read_source()
  JoinOptions join;
  std::vector<double> pulses_per_unit;   ///< of the log
};

struct Imported {
  std::string text;                      ///< a measurement file: docs/file-formats.md
  std::size_t rows = 0;
  std::vector<std::string> notes;        ///< how each file was read, what was left out
};

/// Reads, joins and writes. Throws InputError as read_source() and join() do.
Imported import_measurements(const ImportOptions& options, const Robot& robot);

}  // namespace mdhcal::offline
