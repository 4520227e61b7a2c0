// SPDX-License-Identifier: MIT
// Simulated calibration jobs whose verdict is held against the truth: what the arm does beyond its geometry is written here,
// by code that shares nothing with the identification.
#pragma once

#include <cstdint>
#include <string>

#include "offline/identify/calibrate.hpp"

namespace mdhcal::tests {

struct VerdictJob {
  std::string family;
  std::size_t poses = 0;       ///< of the training set: 6 to 80, evenly on a logarithmic scale
  bool sag = false;            ///< joints 2 and 3 give way under gravity
  bool joint_function = false; ///< every joint errs with one and two periods a turn
  bool gross = false;          ///< 5 % of the training rows (at least one) and of the held-out rows are off by 1 to 50 mm
  offline::Robot nominal;
  offline::Dataset train, test;///< 15 held-out rows
};

/// What became of a job's verdict. Lengths in mm.
struct VerdictOutcome {
  double mean = 0, low = 0, high = 0;  ///< as the verdict says
  double truth = 0;            ///< mean over 1000 other poses, measured with the same noise
  double noise_free = 0;       ///< likewise without the noise of the measurement
  bool usable = false;
  std::string verdict;
};

/// The job of a seed. Half of them have sag or a joint function, a tenth gross rows.
VerdictJob verdict_job(std::uint64_t seed);

/// Calibrates the job with its held-out rows, or without (the verdict is then cross-validated), and looks at the truth.
VerdictOutcome outcome_of(const VerdictJob& job, std::uint64_t seed, bool held_out);

}  // namespace mdhcal::tests
