// SPDX-License-Identifier: MIT
// Bad input that no fit reports by itself: recognised where it can be, named with what to do about it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "offline/identify/fit.hpp"
#include "offline/identify/unknowns.hpp"

namespace mdhcal::offline {

/// Before any fit. Throws InputError if there are fewer scalar measurements than base and target unknowns or if all
/// poses are equal, Refusal if one orientation throughout leaves base and target inseparable.
void check_poses(const Robot& robot, const Dataset& data, const std::vector<std::size_t>& rows, const Unknowns& unknowns);

/// After the fit of base and targets to the nominal geometry. If the measurements are missed by far and one simple
/// mistake explains them (joint angles or lengths in the wrong unit, two joints swapped, a joint counted the other way
/// round, joints 2 and 3 coupled), throws Refusal naming it; returns silently otherwise.
void check_simple_mistakes(const Robot& robot, const Dataset& data, const std::vector<std::size_t>& rows,
                           const UnknownsOptions& options, double nominal_scale_mm);

/// A place in the rows, in file order, before and after which the measurements lie in two different tracker frames.
struct TrackerMove {
  std::size_t first_row_after = 0;  ///< index into the dataset
  double shift_mm = 0;
  double turn_deg = 0;
};

/// After the calibration: whether two tracker frames explain the measurements at least three times better than one.
std::optional<TrackerMove> find_tracker_move(const Dataset& data, const std::vector<std::size_t>& rows,
                                             const Unknowns& unknowns, const Fit& fit, double noise_mm);

/// Targets within 1 mm of the last turning axis: turning it does not move them. One sentence each.
std::vector<std::string> targets_on_last_axis(const Estimate& estimate, const Dataset& data);

}  // namespace mdhcal::offline
