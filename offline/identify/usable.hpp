// SPDX-License-Identifier: MIT
// Whether a calibration may be used: every reason against it is a full sentence.
#pragma once

#include "offline/identify/calibration.hpp"

namespace mdhcal::offline {

/// Median position error up to which a residual counts as explained unless --max-residual says otherwise [mm]: 2 mm, an
/// uncalibrated arm's own error (docs/method.md), or 0.2 % of the reach, whichever is more.
double default_max_residual_mm(const Robot& robot);

/// Zeros that are further off than a controller accepts as a deviation (the library's max_deviation_rad() and
/// max_deviation_m()): the arm was not mastered, or with another zero.
std::vector<ZeroOffset> large_zero_offsets(const Calibration& calibration);
/// "joint 3's zero is 4.95 degrees off".
std::string sentence_of(const Robot& robot, const ZeroOffset& zero);

/// Adds to `calibration.reasons`: rotations that contradict the positions; not converged; no better than the nominal geometry, or misses by more than the residual
/// that counts as explained, on the rows that judge it; base or targets not determined by the measurements; zeros that no
/// controller would accept. Needs the figures, the covariance and the predicted accuracy.
void find_reasons(const CalibrationOptions& options, Calibration& calibration);

}  // namespace mdhcal::offline
