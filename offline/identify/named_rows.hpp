// SPDX-License-Identifier: MIT
// What rows that are named have in common: gross errors fall anywhere, a model's error lies where the model is wrong.
#pragma once

#include <string>

#include "offline/identify/calibration.hpp"

namespace mdhcal::offline {

/// A sentence that says where the named rows (RowResult::outlier) of the training or the test set lie together: in joint
/// space, in the reading of one joint, far from the middle of one joint's readings, or in the order of the file. Empty if
/// they lie no closer together than random rows do (a permutation test of their mean distance, at 1 in 100 over everything
/// that is looked at), or if fewer than three are named.
/// `in_order`, if not null, receives whether it is the order of the file.
std::string what_named_rows_share(const Calibration& calibration, bool test, bool* in_order = nullptr);

}  // namespace mdhcal::offline
