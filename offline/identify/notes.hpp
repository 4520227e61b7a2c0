// SPDX-License-Identifier: MIT
// What a calibration says about itself.
#pragma once

#include "offline/identify/calibration.hpp"

namespace mdhcal::offline {

/// Notes on rank, on weak and lost parameters, on few measurements and on what is in no parameter.
void add_standing_notes(const Dataset& data, Calibration& calibration);

}  // namespace mdhcal::offline
