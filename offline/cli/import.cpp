// SPDX-License-Identifier: MIT
#include <memory>
#include <optional>

#include "offline/base/error.hpp"
#include "offline/base/folder.hpp"
#include "offline/cli/import_arguments.hpp"
#include "offline/cli/messages.hpp"
#include "offline/cli/robot_argument.hpp"
#include "offline/measure/dataset.hpp"

namespace mdhcal::offline {

namespace {

struct ImportCommand : ImportArguments {
  std::string robot, output;
};

// An arm of which only the number of its joints matters, all of them revolute.
Robot arm_of(std::int32_t joints) {
  Robot robot;
  robot.geometry.joint_count = joints;
  for (std::int32_t j = 0; j < joints; ++j) robot.geometry.joint[j].sign = 1;
  robot.geometry.last_T_flange.quaternion[0] = 1;
  return robot;
}

struct Read {
  Robot robot;
  Imported imported;
};

// Without a robot file the number of joints is what the files have: the first count with which they are read.
Read read_without_robot(const ImportOptions& options) {
  std::optional<InputError> first;
  for (const std::int32_t joints : {6, 7, 5, 4, 8}) {
    try {
      const Robot robot = arm_of(joints);
      return {robot, import_measurements(options, robot)};
    } catch (const InputError& error) {
      if (!first) first = error;
    }
  }
  throw InputError(*first);
}

void run_import(const ImportCommand& arguments) {
  const ImportOptions options = import_options(arguments);
  Read read;
  if (arguments.robot.empty()) {
    read = read_without_robot(options);
    inform("Without --robot, the arm is taken to have " + std::to_string(read.robot.geometry.joint_count) + " revolute joints, and lengths without a unit to be in mm.");
  } else {
    read.robot = robot_of_argument(arguments.robot);
    read.imported = import_measurements(options, read.robot);
  }
  for (const std::string& note : read.imported.notes) inform(note);
  // What is written is what `calibrate` will read; a file that it would refuse is not written.
  const Dataset data = parse_dataset(read.imported.text, arguments.output, read.robot);
  write_file(arguments.output, read.imported.text);
  inform("Wrote " + std::to_string(data.rows.size()) + (data.rows.size() == 1 ? " row to " : " rows to ") + arguments.output + '.');
}

}  // namespace

void add_import(CLI::App& app) {
  auto arguments = std::make_shared<ImportCommand>();
  CLI::App* command = app.add_subcommand("import", "Make a measurement file from a tracker's export and a controller's joints");
  command->add_option("TRACKER", arguments->exports, "Files of the tracker; of several, each may be a reflector")->required();
  command->add_option("--robot", arguments->robot, "Robot file (TOML), or a name of the catalogue: its joints, their names and units, its targets");
  command->add_option("-o,--output", arguments->output, "Measurement file (CSV) to write")->required();
  command->add_option("--rotation", arguments->rotation, "Convention of a rotation in three angles, or none to leave it out");
  add_import_options(*command, *arguments);
  std::string names;
  for (const std::string& name : profile_names()) names += (names.empty() ? "" : ", ") + name;
  command->footer("Built-in profiles: " + names +
                  ".\n"
                  "Example:\n  mdhcal import tracker.txt --robot-log joints.dat --robot kr210-r2700 -o measurements.csv");
  command->callback([arguments] { run_import(*arguments); });
}

}  // namespace mdhcal::offline
