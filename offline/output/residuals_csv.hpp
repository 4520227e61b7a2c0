// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "offline/identify/calibrate.hpp"

namespace mdhcal::offline {

/// residuals.csv: id, target, split, outlier, then predicted minus measured before and after in x, y, z [mm]. Of a
/// distance only the first component is a residual, the others are 0.
std::string residuals_csv(const Calibration& calibration);

}  // namespace mdhcal::offline
