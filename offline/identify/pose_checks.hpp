// SPDX-License-Identifier: MIT
// Poses and targets from which no calibration can come: recognised before the fit, named with what to do about it.
#pragma once

#include <string>
#include <vector>

#include "offline/identify/fit.hpp"
#include "offline/identify/unknowns.hpp"

namespace mdhcal::offline {

/// Before any fit. Throws InputError if there are fewer scalar measurements than base and target unknowns or if all
/// poses are equal, Refusal if one orientation throughout leaves base and target inseparable.
void check_poses(const Robot& robot, const Dataset& data, const std::vector<std::size_t>& rows, const Unknowns& unknowns);

/// Targets within 1 mm of the last turning axis: turning it does not move them. One sentence each.
std::vector<std::string> targets_on_last_axis(const Estimate& estimate, const Dataset& data);

}  // namespace mdhcal::offline
