// SPDX-License-Identifier: MIT
// A whole calibration: from a robot and its measurements to the corrected robot and everything that is said about it.
#pragma once

#include "offline/identify/calibration.hpp"

namespace mdhcal::offline {

/// Identifies `robot` from `data`. Test rows (of `test`, or drawn by test_fraction) enter nothing but the final figures.
/// A result that must not be used is returned with its reasons (Calibration::reasons). Throws InputError for bad input,
/// and Refusal where the measurements carry no calibration at all, saying why.
Calibration calibrate(const Robot& robot, const Dataset& data, const CalibrationOptions& options,
                      const Dataset* test = nullptr);

}  // namespace mdhcal::offline
