// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>

#include "offline/identify/calibrate.hpp"

namespace mdhcal::offline {

/// Position errors of rows that their own calibration did not see.
struct RepeatedCrossValidation {
  std::size_t folds = 0;
  Statistics before, after;  ///< over all rows [mm]
  std::vector<double> lambda; ///< chosen in each fold
};

/// Repeats the whole calibration, choice of lambda and handling of gross errors included, with one fold of whole groups
/// left out at a time; `folds` 0 leaves one group out at a time. Throws what calibrate() throws. `progress`, if given, is
/// called with the folds done and their number.
RepeatedCrossValidation cross_validate(const Robot& robot, const Dataset& data, const CalibrationOptions& options,
                               std::size_t folds, const std::function<void(std::size_t, std::size_t)>& progress = {});

}  // namespace mdhcal::offline
