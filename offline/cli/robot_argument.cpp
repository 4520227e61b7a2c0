// SPDX-License-Identifier: MIT
#include "offline/cli/robot_argument.hpp"

#include <filesystem>

#include "offline/cli/messages.hpp"
#include "offline/base/error.hpp"
#include "offline/robots/catalogue.hpp"

namespace mdhcal::offline {

Robot robot_of_argument(const std::string& argument) {
  std::error_code ignored;
  const bool is_path = argument.find('/') != std::string::npos || argument.ends_with(".toml");
  const bool is_file = std::filesystem::exists(argument, ignored);
  if (is_path || is_file) {
    if (!is_path && find_in_catalogue(argument) != nullptr) {
      inform("ROBOT is read from the file " + argument + " here, not from the catalogue.");
    }
    return read_robot(argument);
  }
  const embedded::File* found = find_in_catalogue(argument);
  if (found == nullptr) {
    std::string similar;
    for (const std::string& name : similar_in_catalogue(argument, 5)) similar += (similar.empty() ? "" : ", ") + name;
    throw InputError("Found ROBOT \"" + argument + "\", which is no file and no robot of the catalogue; expected a robot file or a name that \"mdhcal robots\" lists" +
                     (similar.empty() ? "" : ", such as " + similar) + ".");
  }
  inform("ROBOT is " + std::string(found->name) + " from the catalogue (mdhcal robots " + std::string(found->name) +
         " prints its file and sources).");
  return parse_robot(std::string(found->text), std::string(found->name));
}

}  // namespace mdhcal::offline
