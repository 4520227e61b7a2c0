// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace mdhcal::offline {

/// The bytes of a file ("-" is not special). `expected` names in messages what the file should be, "a robot file".
/// Throws InputError naming the path and the reason.
std::string read_file(const std::string& path, const std::string& expected);

}  // namespace mdhcal::offline
