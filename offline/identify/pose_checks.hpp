// SPDX-License-Identifier: MIT
// Poses and targets from which no calibration can come: recognised before the fit, named with what to do about it.
#pragma once

#include <string>
#include <vector>

#include "offline/identify/fit.hpp"
#include "offline/identify/unknowns.hpp"

namespace mdhcal::offline {

/// Before any fit. Throws InputError if there are no rows, fewer scalar measurements than base and target unknowns (of
/// `layout`), or if all poses or all points are equal.
void check_poses(const Dataset& data, const std::vector<std::size_t>& rows, const Layout& layout);

/// What base and targets are told by: the measured points' root mean square spread along their principal axes, and how far the
/// flange turns. A sentence.
std::string spread_of_poses(const Robot& robot, const Dataset& data, const std::vector<std::size_t>& rows);

/// Targets within 1 mm of the last turning axis: turning it does not move them. One sentence each.
std::vector<std::string> targets_on_last_axis(const Estimate& estimate, const Dataset& data);

}  // namespace mdhcal::offline
