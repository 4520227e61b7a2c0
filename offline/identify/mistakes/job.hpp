// SPDX-License-Identifier: MIT
// What a calibration is asked for, as one value that a hypothesis can change.
#pragma once

#include "offline/identify/calibrate.hpp"

namespace mdhcal::offline {

/// Everything that goes into calibrate(). A hypothesis about a mistake is a function from one job to another.
struct Job {
  Robot robot;
  Dataset data;
  CalibrationOptions options;
};

}  // namespace mdhcal::offline
