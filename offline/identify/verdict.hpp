// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "offline/identify/calibration.hpp"

namespace mdhcal::offline {

/// What a reader signs: whether the result may be used and why not, on which rows that was judged, their mean with its 95 %
/// bounds and maximum over all of them, the same of the nominal geometry, and how it looks without gross rows.
std::string verdict_of(const Calibration& calibration);

/// What the judged rows say about the model, a sentence each: rows that were named, what they share, and where the error
/// that was seen and the error that was predicted disagree.
std::vector<std::string> findings_of(const Calibration& calibration);

}  // namespace mdhcal::offline
