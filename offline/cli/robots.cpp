// SPDX-License-Identifier: MIT
#include <cstdio>
#include <memory>

#include "offline/cli/commands.hpp"
#include "offline/base/error.hpp"
#include "offline/robots/catalogue.hpp"

namespace mdhcal::offline {

namespace {

void print_list() {
  std::printf("%-22s %-17s %5s %9s  %s\n", "name", "maker", "axes", "reach_mm", "sources");
  for (const CatalogueEntry& arm : catalogue()) {
    std::printf("%-22s %-17s %5zu %9.0f  %zu\n", arm.name.c_str(), arm.maker.c_str(), arm.axes, 1e3 * arm.reach_m, arm.sources);
  }
}

void print_file(const std::string& name) {
  const embedded::File* file = find_in_catalogue(name);
  if (file == nullptr) {
    std::string similar;
    for (const std::string& each : similar_in_catalogue(name, 5)) similar += (similar.empty() ? "" : ", ") + each;
    throw InputError("Found no robot \"" + name + "\" in the catalogue; expected a name that \"mdhcal robots\" lists" +
                     (similar.empty() ? "" : ", such as " + similar) + ".");
  }
  std::fwrite(file->text.data(), 1, file->text.size(), stdout);
}

}  // namespace

void add_robots(CLI::App& app) {
  auto name = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("robots", "List the catalogue of robots, or print one's file");
  command->add_option("NAME", *name, "A robot of the catalogue, whose file is printed");
  command->footer(
      "reach_mm: the largest distance of the flange from the axis of joint 1, within the limits.\n"
      "sources: how many independent sources agree on the numbers; the file names them, and what is not confirmed.\n"
      "ROBOT on calibrate, compare, import, pack, plan and simulate may be such a name. The maker may be left out, and words that only one name has are enough.\n"
      "Example:\n  mdhcal robots ur5e > my.toml");
  command->callback([name] { name->empty() ? print_list() : print_file(*name); });
}

}  // namespace mdhcal::offline
