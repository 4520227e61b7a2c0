// SPDX-License-Identifier: MIT
// In which frame and at which points a blob is compared with measurements.
#pragma once

#include <vector>

#include "mdhcal/kinematics.hpp"
#include "offline/measure/dataset.hpp"

namespace mdhcal::offline {

/// Frame and points in which the comparison is made: the blob's, or fitted to the measurements with the geometry of the
/// blob kept.
struct Registration {
  Frame<double> tracker_T_base;
  std::vector<Vector3> flange_p_m;  ///< one a target of the measurements
};

/// Throws InputError if a target of the measurements is none of the blob's and is not refitted.
Registration registration(const Robot& robot, const Dataset& data, bool refit_base, bool refit_tool);

/// Predicted position of a row's target through lib, tracker frame [m]. Throws InputError for joints out of range.
Vector3 predicted(const Arm<double>& arm, const Registration& registration, const Dataset& data, const Measurement& row);

/// Angles between predicted and measured rotation of the full poses [deg], each target's probe taken to be turned on the
/// flange as the mean of its rows says: a blob does not state it.
std::vector<double> rotation_errors_deg(const Arm<double>& arm, const Registration& registration, const Dataset& data);

/// Reads measurements of the blob's robot, with progress on a terminal, and says what the reader noted.
Dataset read_measurements(const std::string& path, const Robot& robot, const std::string& rotation);

}  // namespace mdhcal::offline
