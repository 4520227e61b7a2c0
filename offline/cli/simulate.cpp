// SPDX-License-Identifier: MIT
#include <filesystem>
#include <memory>

#include <nlohmann/json.hpp>

#include "offline/base/folder.hpp"
#include "offline/base/progress.hpp"
#include "offline/cli/commands.hpp"
#include "offline/cli/messages.hpp"
#include "offline/cli/robot_argument.hpp"
#include "offline/robot/units.hpp"
#include "offline/simulate/family.hpp"
#include "offline/simulate/measurement_text.hpp"
#include "offline/simulate/simulate.hpp"

namespace mdhcal::offline {

namespace {


struct SimulateArguments {
  std::string robot, directory;
  SimulationOptions options;
  double length_error_mm = 0.5, angle_error_deg = 0.03, noise_mm = 0.02, rotation_noise_deg = 0.003;
  double joint_noise_deg = 0, joint_function_mrad = 0, sag_mrad = 0, outlier_mm = 5;
};

std::string truth_json(const SimulateArguments& arguments, const Simulation& simulation) {
  nlohmann::ordered_json json;
  json["seed"] = arguments.options.seed;
  json["length_error_mm"] = arguments.length_error_mm;
  json["angle_error_deg"] = arguments.angle_error_deg;
  json["noise_mm"] = arguments.noise_mm;
  json["rotation_noise_deg"] = arguments.rotation_noise_deg;
  json["joint_noise_deg"] = arguments.joint_noise_deg;
  if (arguments.joint_function_mrad > 0) json["joint_function_mrad"] = arguments.joint_function_mrad;
  if (arguments.sag_mrad > 0) json["sag_mrad"] = arguments.sag_mrad;
  json["outlier_mm"] = arguments.outlier_mm;
  json["outliers"] = nlohmann::ordered_json::array();
  for (const std::size_t index : simulation.outlier_rows) {
    const Measurement& row = simulation.train.rows[index];
    json["outliers"].push_back(row_name(simulation.train, row));
  }
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

void run_simulate(SimulateArguments arguments) {
  const auto& names = family_names();
  const bool built_in = !std::filesystem::exists(arguments.robot) &&
                        std::find(names.begin(), names.end(), arguments.robot) != names.end();
  const Robot robot = built_in ? family_robot(arguments.robot) : robot_of_argument(arguments.robot);
  SimulationOptions& options = arguments.options;
  options.length_error_m = arguments.length_error_mm * 1e-3;
  options.angle_error_rad = arguments.angle_error_deg * rad_per_deg;
  options.noise_m = arguments.noise_mm * 1e-3;
  options.rotation_noise_rad = arguments.rotation_noise_deg * rad_per_deg;
  options.joint_noise_rad = arguments.joint_noise_deg * rad_per_deg;
  options.joint_function_rad = arguments.joint_function_mrad * 1e-3;
  options.sag_rad = arguments.sag_mrad * 1e-3;
  options.outlier_m = arguments.outlier_mm * 1e-3;
  OutputFolder folder(arguments.directory, {"robot.toml", "measurements.csv", "test.csv", "truth.toml", "truth.json"});
  const Simulation simulation = [&] {
    Progress progress("simulate", verbosity() != Verbosity::quiet);
    return simulate(robot, options, progress.callback());
  }();
  folder.write("robot.toml", write_robot(simulation.nominal));
  {
    Progress progress("write", verbosity() != Verbosity::quiet);
    folder.write("measurements.csv", measurement_text(simulation.train, simulation.nominal, progress.callback()));
  }
  folder.write("test.csv", measurement_text(simulation.test, simulation.nominal));
  folder.write("truth.toml", write_robot(simulation.truth));
  folder.write("truth.json", truth_json(arguments, simulation));
  folder.commit();
  inform("Written to " + arguments.directory + ".");
}

}  // namespace

void add_simulate(CLI::App& app) {
  auto arguments = std::make_shared<SimulateArguments>();
  CLI::App* command = app.add_subcommand("simulate", "Write a robot with known errors, its measurements and the truth");
  SimulationOptions& options = arguments->options;
  command->add_option("ROBOT", arguments->robot,
                      "Robot file, a name of the catalogue, or a built-in arm: three-parallel, spherical-wrist, seven-joint, five-joint")
      ->required();
  command->add_option("-o,--output", arguments->directory, "Folder to write")->required();
  command->add_option("--poses", options.configurations, "Configurations to measure")->capture_default_str();
  command->add_option("--test-poses", options.test_configurations, "Configurations of test.csv")
      ->capture_default_str();
  command->add_option("--repeats", options.repeats, "Visits of each configuration")->capture_default_str();
  command->add_option("--targets", options.targets, "Reflectors on the flange, 1 to 8")->capture_default_str();
  command->add_flag("--full-pose", options.full_pose, "Measure the rotation too");
  command->add_option("--length-error", arguments->length_error_mm, "Standard deviation of a, d and target points [mm]")
      ->capture_default_str();
  command->add_option("--angle-error", arguments->angle_error_deg, "Standard deviation of the angles [deg]")
      ->capture_default_str();
  command->add_option("--noise", arguments->noise_mm, "Standard deviation of a measured coordinate [mm]")
      ->capture_default_str();
  command->add_option("--rotation-noise", arguments->rotation_noise_deg, "The same of a measured rotation [deg]")
      ->capture_default_str();
  command->add_option("--joint-noise", arguments->joint_noise_deg, "Standard deviation of a joint about its reading [deg]")
      ->capture_default_str();
  command->add_option("--joint-functions", arguments->joint_function_mrad,
                      "Amplitude of every joint's periodic error on the orders 1, 2, 10, 18 and 28 [mrad]")
      ->capture_default_str();
  command->add_option("--sag", arguments->sag_mrad, "Sag of every joint under gravity when the arm is stretched out level [mrad]")
      ->capture_default_str();
  command->add_option("--outliers", options.outlier_fraction, "Fraction of gross errors among the measurements")
      ->capture_default_str();
  command->add_option("--outlier-size", arguments->outlier_mm, "Length of a gross error [mm]")->capture_default_str();
  command->add_flag("--sigma", options.state_sigma, "Write the noise into a sigma column");
  command->add_flag("--base-frame", options.base_frame, "Measure in the robot's base frame");
  command->add_option("--seed", options.seed, "Seed of the random numbers")->capture_default_str();
  command->footer("Example:\n  mdhcal simulate three-parallel -o simulated --poses 40 --outliers 0.05");
  command->callback([arguments] { run_simulate(*arguments); });
}

}  // namespace mdhcal::offline
