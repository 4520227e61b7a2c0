// SPDX-License-Identifier: MIT
#include <cstring>
#include <filesystem>
#include <memory>

#include "offline/base/error.hpp"
#include "offline/base/folder.hpp"
#include "offline/base/read_file.hpp"
#include "offline/cli/commands.hpp"
#include "offline/cli/messages.hpp"
#include "offline/robot/ur_factory.hpp"
#include "offline/robot/urdf.hpp"

namespace mdhcal::offline {

namespace {

struct ConvertArguments {
  std::string input, output, base, tip, model, urdf;
};

// Formats go by the ending of the file's name: what a file is should be seen from its name.
enum class Format { robot, urdf, ros_yaml, ur_calibration };

Format format_of(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".toml") return Format::robot;
  if (ending == ".urdf" || ending == ".xml") return Format::urdf;
  if (ending == ".yaml" || ending == ".yml") return Format::ros_yaml;
  if (ending == ".conf") return Format::ur_calibration;
  throw InputError(path, 0, 0, "The name ends in \"" + ending +
                                   "\"; expected .toml (robot file), .urdf or .xml (URDF), .yaml or .yml (ROS "
                                   "kinematics) or .conf (UR calibration).");
}

Robot from_chain(const Chain& chain, const std::string& path, const std::string& base) {
  for (const std::string& note : chain.notes) inform(note);
  Robot robot = robot_from_chain(chain, path);
  const std::string note = base_frame_note(robot, base);
  if (!note.empty()) inform(path + ": " + note);
  return robot;
}

Robot read(const ConvertArguments& arguments) {
  const std::string& path = arguments.input;
  switch (format_of(path)) {
    case Format::robot: return read_robot(path);
    case Format::urdf:
      return from_chain(read_urdf(path, arguments.base, arguments.tip), path,
                        arguments.base.empty() ? "the URDF's root link" : "link \"" + arguments.base + '"');
    case Format::ros_yaml:
      return from_chain(parse_ros_kinematics(read_file(path, "ROS kinematics"), path), path, "the file's base");
    case Format::ur_calibration: break;
  }
  if (arguments.model.empty()) {
    throw InputError(path, 0, 0, "A calibration.conf holds corrections only; expected --model ur5e or the like.");
  }
  return parse_ur_calibration(read_file(path, "a UR calibration"), path, arguments.model);
}

std::string written(const ConvertArguments& arguments, const Robot& robot) {
  switch (format_of(arguments.output)) {
    case Format::robot: return write_robot(robot);
    case Format::urdf:
      if (arguments.urdf.empty()) return urdf_text(robot);
      return corrected_urdf(read_file(arguments.urdf, "a URDF"), arguments.urdf, robot, arguments.base, arguments.tip);
    case Format::ros_yaml: return ros_kinematics_text(robot);
    case Format::ur_calibration: break;
  }
  throw InputError(arguments.output, 0, 0, "A controller's calibration.conf is read, not written; expected .toml, "
                                           ".urdf or .yaml.");
}

bool beyond_geometry(const Robot& robot) {
  const Transmission none{};
  return std::memcmp(robot.transmission.function, none.function, sizeof none.function) != 0 ||
         std::memcmp(robot.transmission.gravity.compliance, none.gravity.compliance, sizeof none.gravity.compliance) != 0;
}

void run_convert(const ConvertArguments& arguments) {
  const Format format = format_of(arguments.output);
  const Robot robot = read(arguments);
  if (format != Format::robot && beyond_geometry(robot)) {
    warn("this format holds geometry alone: the robot's joint functions and sag are left out, and without them its geometry is not the "
         "best one. `mdhcal calibrate --model geometry` finds that.");
  }
  write_file(arguments.output, written(arguments, robot));
}

}  // namespace

void add_convert(CLI::App& app) {
  auto arguments = std::make_shared<ConvertArguments>();
  CLI::App* command = app.add_subcommand(
      "convert", "Robot descriptions from and to other programs: URDF, ROS kinematics, UR calibration");
  command->add_option("IN", arguments->input, "Robot file (.toml), URDF (.urdf), ROS kinematics (.yaml) or UR "
                                              "calibration (.conf)")->required();
  command->add_option("-o,--output", arguments->output, "File to write: .toml, .urdf or .yaml")->required();
  command->add_option("--base", arguments->base, "First link of the chain in a URDF (default: the root)");
  command->add_option("--tip", arguments->tip, "Last link of the chain in a URDF (default: the only leaf)");
  command->add_option("--model", arguments->model, "The UR arm that a .conf corrects: ur3, ur5, ur10, ur3e, ur5e, "
                                                   "ur10e, ur16e, ur20, ur30");
  command->add_option("--urdf", arguments->urdf,
                      "Write this URDF with its joint origins corrected, shapes and masses kept");
  command->footer(
      "Examples: mdhcal convert arm.urdf --tip tool0 -o robot.toml\n"
      "          mdhcal convert corrected.toml --urdf arm.urdf --tip tool0 -o corrected.urdf\n"
      "          mdhcal convert calibration.conf --model ur10e -o factory.toml");
  command->callback([arguments] { run_convert(*arguments); });
}

}  // namespace mdhcal::offline
