// SPDX-License-Identifier: MIT
// Calibrations of simulated arms, judged against the noise-free truth.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "offline/identify/calibrate.hpp"
#include "offline/simulate/simulate.hpp"

namespace mdhcal::tests {

/// One simulated arm of the issue: errors of 1 mm and 0.1 degrees (standard deviation), noise 0.02 mm, 60 poses.
offline::SimulationOptions arm_options(std::uint64_t seed);

/// Adds errors of 1 to 50 mm in random directions to a share of the rows; returns their indices, ascending.
std::vector<std::size_t> add_gross_errors(offline::Dataset& data, double share, std::uint64_t seed);

/// Adds an error of `sd_m` an axis (tracker frame) that all rows of a pose share.
void add_shared_error(offline::Dataset& data, double sd_m, std::uint64_t seed);

/// The simulated arm as it is: geometry, base and its (first) target point.
offline::MeasurementModel truth_model(const offline::Simulation& simulation);

/// Mean distance [mm] of the calibrated robot's target from the true one, in the tracker frame, over `count` random
/// poses within the joint limits.
double distance_from_truth_mm(const offline::Simulation& simulation, const offline::Calibration& calibration,
                              std::size_t count, std::uint64_t seed);

/// Whether one of the notes contains `part`.
bool noted(const offline::Calibration& calibration, const std::string& part);

/// Of the identifiable parameters: how many 95 % intervals hold the truth.
struct Coverage {
  std::size_t inside = 0, count = 0;
  std::vector<int> inside_of;  ///< one a parameter, 0 or 1; -1 if not identifiable
};
Coverage coverage(const offline::Simulation& simulation, const offline::Calibration& calibration);

}  // namespace mdhcal::tests
