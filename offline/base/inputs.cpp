// SPDX-License-Identifier: MIT
#include "offline/base/inputs.hpp"

#include <map>
#include <mutex>
#include <utility>

#include <sys/stat.h>

#include "offline/base/error.hpp"

namespace mdhcal::offline {

namespace {

std::mutex inputs_mutex;
std::map<std::pair<dev_t, ino_t>, std::string>& inputs() {
  static std::map<std::pair<dev_t, ino_t>, std::string> all;
  return all;
}

}  // namespace

void note_input(const struct stat& file, const std::string& path) {
  if (!S_ISREG(file.st_mode)) return;
  const std::lock_guard guard(inputs_mutex);
  inputs().emplace(std::pair{file.st_dev, file.st_ino}, path);
}

void refuse_input(const std::filesystem::path& path, const std::filesystem::path& destination) {
  struct stat file = {};
  if (stat(path.c_str(), &file) != 0 || !S_ISREG(file.st_mode)) return;
  const std::lock_guard guard(inputs_mutex);
  const auto found = inputs().find({file.st_dev, file.st_ino});
  if (found == inputs().end()) return;
  throw InputError(destination.string() + ": Writing this would take away " + found->second +
                   ", which this command has read; expected another name. Nothing was written.");
}

}  // namespace mdhcal::offline
