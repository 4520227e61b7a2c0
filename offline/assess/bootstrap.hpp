// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "offline/identify/calibrate.hpp"

namespace mdhcal::offline {

/// What resampling whole groups with replacement says about the parameters (Efron 1979): no model of the noise, so
/// errors that the geometry does not hold are in it.
struct Bootstrap {
  std::size_t resamples = 0;
  std::vector<double> standard_deviation;  ///< of each parameter's deviation [rad] or [m]
  std::vector<double> low, high;           ///< 2.5 and 97.5 percentile of the deviation [rad] or [m]
};

/// Each resample is solved with the calibration's lambda and robust weights on the problem linearised at its result,
/// which for deviations of this size is exact to far below their scatter. Uses `threads` threads (0: as many as the
/// machine has); the result does not depend on how many. `progress`, if given, is called from any of them with the
/// resamples done and their number.
Bootstrap bootstrap(const Calibration& calibration, std::size_t resamples, std::uint64_t seed, unsigned int threads = 0,
                    const std::function<void(std::size_t, std::size_t)>& progress = {});

}  // namespace mdhcal::offline
