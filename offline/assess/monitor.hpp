// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// What a check series says about a calibration.
enum class Condition : std::int32_t {
  good,          ///< as at calibration
  frame_moved,   ///< worse, and the best rigid motion explains it: tracker or base has moved
  recalibrate,   ///< worse, and no motion of the frames explains it: the arm has changed
};

/// The grounds: mean squares of one axis's error against those at calibration, by Fisher's F test.
struct MonitorResult {
  Condition condition = Condition::good;
  std::size_t count = 0;
  double mean_mm = 0, max_mm = 0;        ///< error norms as measured
  double refitted_mean_mm = 0;           ///< after the best rigid motion; 0 below 4 rows
  double expected_mean_mm = 0;           ///< at calibration, on held-out poses
  double ratio = 0, p_value = 1;         ///< mean square over that at calibration; chance of one as large or larger
  double refitted_ratio = 0, refitted_p_value = 1;
  double shift_mm = 0, turn_deg = 0;     ///< of the best rigid motion
  std::string sentence;                  ///< the verdict in words
};

/// Compares a check series (predicted and measured positions in one frame [m]) with the held-out errors at calibration:
/// their mean norm [mm] on `expected_count` poses. Errors at calibration are taken as normal and equal in all axes, so
/// their variance is mean^2 pi / 8 with 3 expected_count degrees of freedom. `alpha`: chance of a false alarm.
/// Preconditions: at least one row, expected_mean_mm > 0, expected_count >= 1.
MonitorResult monitor(const std::vector<Vector3>& predicted_m, const std::vector<Vector3>& measured_m,
                      double expected_mean_mm, std::size_t expected_count, double alpha);

}  // namespace mdhcal::offline
