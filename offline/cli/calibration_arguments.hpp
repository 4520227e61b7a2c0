// SPDX-License-Identifier: MIT
// The arguments that `calibrate` and `compare` share, and `batch` but for the files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "offline/cli/commands.hpp"
#include "offline/identify/calibrate.hpp"

namespace mdhcal::offline {

struct CalibrationArguments {
  std::string robot, measurements, directory;
  std::string test;
  std::string rotation;
  std::string base = "fit", tool = "fit", joints = "better";
  std::optional<double> test_fraction;
  std::optional<std::string> date;
  double parallel_deg = 5.0, prior_length_mm = 1.0, prior_angle_mrad = 1.0;
  std::vector<std::string> fix, free;
  bool json = false;
  CalibrationOptions options;
};

/// Adds the options that decide what is fitted.
void add_identification_options(CLI::App& command, CalibrationArguments& arguments);

/// Adds ROBOT, MEASUREMENTS, what is tested on, and the options that decide what is fitted.
void add_calibration_arguments(CLI::App& command, CalibrationArguments& arguments);

/// The options as the arguments state them. Throws InputError if two of them contradict each other.
CalibrationOptions calibration_options(const CalibrationArguments& arguments);

}  // namespace mdhcal::offline
