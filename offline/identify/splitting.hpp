// SPDX-License-Identifier: MIT
// Which rows identify and which judge, and rows of a test file in terms of the training data.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "offline/identify/calibration.hpp"
#include "offline/measure/dataset.hpp"

namespace mdhcal::offline {

/// Draws whole groups for the test until options.test_fraction is reached, and those of options.held_out_groups; the row
/// numbers of both sides. Rows that state joints alone belong to neither. The same seed draws the same.
void split_off_test(const Dataset& data, const CalibrationOptions& options, std::vector<std::size_t>& training,
                    std::vector<std::size_t>& testing);

/// Rows of another file, their targets renumbered to those of the training data. Throws InputError with file and line at a
/// target that the training data does not have.
Dataset aligned(const Dataset& test, const Dataset& training);

/// A test file's rows, those of a target that was measured under two names under the name that stays: (twin, target) each.
Dataset renamed(Dataset data, const std::vector<std::pair<std::string, std::string>>& twins);

}  // namespace mdhcal::offline
