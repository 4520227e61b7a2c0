// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// The names of the built-in example arms: "three-parallel" (6 joints, axes 2, 3, 4 parallel), "spherical-wrist"
/// (6 joints, axes 4, 5, 6 meet), "seven-joint" (shoulder, elbow and wrist offset-free) and "five-joint".
const std::vector<std::string>& family_names();

/// A built-in arm with ordinary dimensions, joint limits and a tool point off the last axis.
/// Throws InputError if the name is none of family_names().
Robot family_robot(const std::string& name);

}  // namespace mdhcal::offline
