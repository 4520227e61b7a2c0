// SPDX-License-Identifier: MIT
// ROBOT on the command line: a file, or the name of an arm in the catalogue.
#pragma once

#include <string>

#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// The robot that the argument means. A file of that name wins over the catalogue; which of them was read is said where the
/// name could mean both, or means an arm of the catalogue. Throws InputError if it is neither, or the file is bad.
Robot robot_of_argument(const std::string& argument);

}  // namespace mdhcal::offline
