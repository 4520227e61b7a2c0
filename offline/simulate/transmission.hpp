// SPDX-License-Identifier: MIT
// Joint functions and sag of a simulated arm, evaluated by code of its own: a truth that shares nothing with what is tested.
#pragma once

#include "offline/base/random.hpp"
#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// Gives every joint that turns a function with `amplitude_rad` on the orders 1, 2, 10, 18 and 28, each in a random phase, and
/// lets it sag by up to `sag_rad` when the arm is stretched out level.
void add_transmission(Robot& truth, double amplitude_rad, double sag_rad, Random& random);

/// What joint functions and sag add to each joint coordinate at the readings q [rad].
Joints turns_of(const Robot& truth, const Joints& q);

}  // namespace mdhcal::offline
