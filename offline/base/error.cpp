// SPDX-License-Identifier: MIT
#include "offline/base/error.hpp"

namespace mdhcal::offline {

namespace {

std::string located(const std::string& path, long line, long column, const std::string& message) {
  std::string text = path;
  if (line > 0) {
    text += ':' + std::to_string(line);
    if (column > 0) text += ':' + std::to_string(column);
  }
  return text + ": " + message;
}

}  // namespace

InputError::InputError(const std::string& path, long line, long column, const std::string& message)
    : std::runtime_error(located(path, line, column, message)) {}

}  // namespace mdhcal::offline
