// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "offline/assess/bootstrap.hpp"
#include "offline/assess/cross_validation.hpp"
#include "offline/identify/calibrate.hpp"
#include "offline/identify/mistakes/diagnosis.hpp"

namespace mdhcal::offline {

/// What was assessed beside the calibration itself; null in the file where it was not.
struct Assessment {
  std::optional<Bootstrap> bootstrap;
  std::optional<RepeatedCrossValidation> cross_validation;
  std::optional<Diagnosis> diagnosis;
};

/// A calibration as result.json: figures in millimetres and degrees under keys that say so; every number is
/// finite, else null. The same calibration gives the same bytes.
std::string result_json(const Calibration& calibration, const Assessment& assessment = {});

}  // namespace mdhcal::offline
