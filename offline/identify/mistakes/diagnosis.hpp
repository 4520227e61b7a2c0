// SPDX-License-Identifier: MIT
// What the search for mistakes found.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace mdhcal::offline {

/// What a calibration left.
struct Residual {
  double scale_mm = 0;  ///< of one axis, from the median
  double mean_mm = 0;   ///< mean error of all rows
};

/// One explanation, and what the calibration with its cure left.
struct Finding {
  std::vector<std::string> kinds;  ///< word() of each mistake in it
  std::string what;                ///< "q4_deg and q6_deg reversed"
  std::string cure;                ///< "set sign = -1 in links 4 and 6"
  int changes = 1;                 ///< how many facts it changes
  Residual residual;               ///< of the calibration with the cure
  bool offered = false;            ///< it explains the measurements, beyond chance and at least threefold
};

struct Diagnosis {
  Residual as_given;                ///< of the job as it was given
  std::size_t tried = 0;            ///< combinations of hypotheses that were fitted
  std::vector<Finding> findings;    ///< those that a calibration was run with, the best first
  std::string sentence;             ///< what is said to the user

  bool named() const { return !findings.empty() && findings.front().offered; }
};

}  // namespace mdhcal::offline
