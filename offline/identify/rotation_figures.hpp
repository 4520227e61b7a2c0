// SPDX-License-Identifier: MIT
// How far the rotations of full poses are met.
#pragma once

#include <string>
#include <vector>

#include "offline/base/statistics.hpp"
#include "offline/identify/model.hpp"

namespace mdhcal::offline {

/// Angles between predicted and measured rotation [deg], of the rows that are full poses; count 0 where there are none.
struct RotationFigures {
  Statistics before, after;  ///< nominal and corrected geometry, the probes' turns fitted with each
};

/// The rotation vector of predicted * measured^-1 [rad] of a full pose, in the frame of the measurements.
Vector3 rotation_error_rad(const MeasurementModel& model, const Dataset& data, std::size_t row);

RotationFigures rotation_figures(const Estimate& before, const Estimate& after, const Dataset& data,
                                 const std::vector<std::size_t>& rows);

/// What is said of them: "Rotations: mean 0.011 degrees, maximum 0.034 degrees on 20 full poses (nominal ...)."; empty where
/// there are none. `on` names the rows: "held-out".
std::string rotation_sentence(const RotationFigures& figures, const std::string& on);

}  // namespace mdhcal::offline
