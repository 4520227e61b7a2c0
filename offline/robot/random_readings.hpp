// SPDX-License-Identifier: MIT
#pragma once

#include "offline/base/random.hpp"
#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// Readings drawn evenly within the joint limits: half a turn or half a metre each way where the robot states none.
Joints random_readings(const Geometry& geometry, Random& random);

}  // namespace mdhcal::offline
