// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

namespace mdhcal::offline {

/// The bytes of a file ("-" is not special). `expected` names in messages what the file should be, "a robot file".
/// At most `most_bytes` are read, so that a device without end is no end of this program; a gibibyte is 10^7 measured rows.
/// From then on nothing is written in its place (inputs.hpp). Throws InputError naming the path and the reason.
std::string read_file(const std::string& path, const std::string& expected, std::size_t most_bytes = std::size_t{1} << 30);

}  // namespace mdhcal::offline
