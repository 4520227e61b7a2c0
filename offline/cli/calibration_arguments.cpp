// SPDX-License-Identifier: MIT
#include "offline/cli/calibration_arguments.hpp"

#include <cmath>

#include "offline/base/error.hpp"
#include "offline/cli/rotation_option.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

void add_calibration_arguments(CLI::App& command, CalibrationArguments& a) {
  command.add_option("ROBOT", a.robot, "Robot file (TOML), or a name of the catalogue")->required();
  command.add_option("MEASUREMENTS", a.measurements, "Measurements to identify from (CSV)")->required();
  command.add_option("-o,--output", a.directory, "Folder to write")->required();
  command.add_flag("--json", a.json, "Print the result as JSON on stdout, and nothing else there");
  command.add_option("--test", a.test, "Measurements that enter nothing but the final figures (CSV)");
  add_identification_options(command, a);
}

void add_identification_options(CLI::App& command, CalibrationArguments& a) {
  command.add_option("--test-fraction", a.test_fraction, "Share of the groups to hold out as test, in (0, 1)");
  command.add_option("--base", a.base, "fit, or given: positions are in the robot's base frame (or [base])")
      ->check(CLI::IsMember({"fit", "given"}))
      ->capture_default_str();
  command.add_option("--tool", a.tool, "fit, or given: the target is the robot file's tool point")
      ->check(CLI::IsMember({"fit", "given"}))
      ->capture_default_str();
  add_rotation_option(command, a.rotation);
  command.add_option("--joints", a.joints, "Which joint columns to use, read or commanded; better: those read unless the commanded are clearly better")
      ->check(CLI::IsMember({"better", "read", "commanded"}))
      ->capture_default_str();
  command.add_option("--model", a.options.model,
                     "What is identified beside the geometry: gravity, joints (joint functions), full (both), geometry (nothing), or auto: what cross-validation chooses")
      ->check(CLI::IsMember({"auto", "geometry", "gravity", "joints", "full"}))
      ->capture_default_str();
  command.add_option("--noise", a.options.noise_mm, "Standard deviation of a measured coordinate [mm], default 0.02")
      ->check(CLI::PositiveNumber);
  command.add_option("--rotation-noise", a.options.rotation_noise_mrad,
                     "Standard deviation of a measured rotation about any axis [mrad]; by default it is estimated")
      ->check(CLI::PositiveNumber);
  command.add_option("--max-residual", a.options.max_residual_mm,
                     "Median position error that counts as explained [mm]; default 2 mm or 0.2 % of the reach")
      ->check(CLI::PositiveNumber);
  command.add_option("--accept", a.options.accept, "Use a result in spite of the reasons against it, and why: stands in result, report and blob");
  command.add_flag("--rezero", a.options.rezero, "Move zeros that are degrees off into the nominal zeros of the robot that is written");
  command.add_option("--seed", a.options.seed, "Seed of folds and test groups")->capture_default_str();
  command.add_option("--fix", a.fix, "Parameters to keep nominal, such as a2,d5")->delimiter(',');
  command.add_option("--free", a.free, "Parameters to estimate in any case, such as beta4")->delimiter(',');
  command.add_option("--parallel", a.parallel_deg, "Axes closer than this get a beta [deg]")->capture_default_str();
  command.add_option("--prior-length", a.prior_length_mm, "Prior standard deviation of lengths [mm]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command.add_option("--prior-angle", a.prior_angle_mrad, "Prior standard deviation of angles [mrad]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

CalibrationOptions calibration_options(const CalibrationArguments& a) {
  CalibrationOptions options = a.options;
  options.fit_base = a.base == "fit";
  options.fit_tool = a.tool == "fit";
  options.joints = a.joints == "commanded" ? JointReadings::commanded : a.joints == "read" ? JointReadings::read : JointReadings::better;
  if (a.test_fraction) {
    if (!a.test.empty()) throw InputError("--test and --test-fraction exclude each other; give one.");
    if (!(*a.test_fraction > 0.0 && *a.test_fraction < 1.0)) {
      throw InputError("--test-fraction must lie between 0 and 1; found " + std::to_string(*a.test_fraction) + ".");
    }
    options.test_fraction = *a.test_fraction;
  }
  options.parameters.fix = a.fix;
  options.parameters.free = a.free;
  options.parameters.parallel_rad = a.parallel_deg / deg_per_rad;
  options.parameters.prior_length_m = 1e-3 * a.prior_length_mm;
  options.parameters.prior_angle_rad = 1e-3 * a.prior_angle_mrad;
  if (options.lambda && !(*options.lambda >= 0.0 && std::isfinite(*options.lambda))) {
    throw InputError("--lambda must be a number that is not negative.");
  }
  return options;
}

}  // namespace mdhcal::offline
