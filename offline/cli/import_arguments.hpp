// SPDX-License-Identifier: MIT
// The options that say how exports and logs are read and joined: `import` has them, and `calibrate` beside --tracker.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "offline/cli/commands.hpp"
#include "offline/import/import.hpp"
#include "offline/measure/dataset.hpp"

namespace mdhcal::offline {

struct ImportArguments {
  std::vector<std::string> exports;
  std::string log, profile, log_profile, join = "told", columns, log_columns, rotation;
  std::string encoding, decimal, length_unit, angle_unit, joint_unit;
  std::vector<std::string> targets;
  std::vector<double> pulses_per_degree;
  double clock_offset_s = 0, max_gap_s = 0.5, still_deg = 0.01;
  double coverage = 0;
};

/// Adds the options; not the files of the tracker nor --rotation, which a command has under a name of its own.
void add_import_options(CLI::App& command, ImportArguments& arguments);

/// What the arguments say. Throws InputError for an unknown profile or a bad list.
ImportOptions import_options(const ImportArguments& arguments);

/// The measurements that `calibrate --tracker` names, with the notes of how they were read.
Dataset read_imported(const ImportArguments& arguments, const Robot& robot);

}  // namespace mdhcal::offline
