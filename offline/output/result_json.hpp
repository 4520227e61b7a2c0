// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "offline/identify/calibrate.hpp"

namespace mdhcal::offline {

/// A calibration as result.json (DESIGN.md): figures in millimetres and degrees under keys that say so; every number is
/// finite, else null. The same calibration gives the same bytes.
std::string result_json(const Calibration& calibration);

}  // namespace mdhcal::offline
