// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "mdhcal/blob.hpp"
#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// The model in a blob file, decoded by lib. Throws InputError naming the file and the reason of the refusal.
Model read_blob(const std::string& path);

/// The robot that a model describes: corrected and nominal geometry, base and target points; millimetres and degrees.
Robot robot_of(const Model& model, const std::string& path);

}  // namespace mdhcal::offline
