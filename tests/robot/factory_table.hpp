// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "offline/robot/convention.hpp"
#include "tests/support/program.hpp"

namespace mdhcal::tests {

/// The standard table of a shared factory calibration, read apart from the reader under test: the numbers after "d =" and
/// so on, in the file's order.
inline std::vector<offline::StandardLink> factory_table(const std::string& path) {
  std::vector<offline::StandardLink> table;
  const std::string text = read_bytes(path);
  std::size_t at = 0;
  while ((at = text.find("[[link]]", at)) != std::string::npos) {
    const auto value = [&](const char* key) { return std::stod(text.substr(text.find(key, at) + std::string(key).size())); };
    table.push_back({value("\ntheta = "), value("\nd = "), value("\na = "), value("\nalpha = ")});
    ++at;
  }
  return table;
}

}  // namespace mdhcal::tests
