// SPDX-License-Identifier: MIT
#include <memory>
#include <optional>

#include "offline/base/folder.hpp"
#include "offline/cli/commands.hpp"
#include "offline/cli/robot_argument.hpp"
#include "offline/output/blob_writer.hpp"

namespace mdhcal::offline {

namespace {

struct PackArguments {
  std::string robot, output;
  std::optional<std::string> date;
};

void run_pack(const PackArguments& arguments) {
  const Robot robot = robot_of_argument(arguments.robot);
  Provenance provenance;
  provenance.date = blob_date(arguments.date);
  const Blob blob = make_blob(robot, provenance);
  write_file(arguments.output, {reinterpret_cast<const char*>(blob.data()), blob.size()});
}

}  // namespace

void add_pack(CLI::App& app) {
  auto arguments = std::make_shared<PackArguments>();
  CLI::App* command = app.add_subcommand("pack", "Write a blob from a robot file alone");
  command->add_option("ROBOT", arguments->robot, "Robot file (TOML), or a name of the catalogue")->required();
  command->add_option("-o,--output", arguments->output, "Blob to write")->required();
  command->add_option("--date", arguments->date, "Date in the blob, YYYY-MM-DD; default SOURCE_DATE_EPOCH, else today");
  command->footer("Example:\n  mdhcal pack robot.toml -o nominal.blob");
  command->callback([arguments] { run_pack(*arguments); });
}

}  // namespace mdhcal::offline
