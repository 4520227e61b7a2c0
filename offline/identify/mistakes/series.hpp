// SPDX-License-Identifier: MIT
// Mistakes of a series: what goes wrong from some row on.
#pragma once

#include "offline/identify/mistakes/hypothesis.hpp"
#include "offline/identify/mistakes/judge.hpp"

namespace mdhcal::offline {

/// A tracker (or foot) that moved once, at least four stands of the arm on either side: place and size.
std::vector<Hypothesis> moved_tracker(const Job& job, const Judgement& at);

/// Readings and points that are out of step by one row from some row on: a row lost, or listed twice, in the one or the
/// other. The best place for either direction.
std::vector<Hypothesis> slipped_rows(const Job& job);

/// Points that the row before has already although the joints moved on: those rows left out.
std::vector<Hypothesis> repeated_points(const Job& job);

/// A joint whose reading is the same in every row although the arm's joint moved: its readings are found from the points,
/// one unknown a row.
std::vector<Hypothesis> stuck_joints(const Job& job);

}  // namespace mdhcal::offline
