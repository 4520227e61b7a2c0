// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "offline/cli/commands.hpp"

namespace mdhcal::offline {

/// Adds --rotation, the convention of the rotations that a command reads.
inline void add_rotation_option(CLI::App& command, std::string& rotation) {
  command.add_option("--rotation", rotation,
                     "Convention of the rotation columns: kuka, fanuc, staubli, abb, yaskawa, ur, rpy, zyx, zyx-extrinsic, "
                     "vector, quaternion, quaternion-xyzw, ... or none (docs/file-formats.md)");
}

}  // namespace mdhcal::offline
