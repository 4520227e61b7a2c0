// SPDX-License-Identifier: MIT
// Jobs with one mistake each, made from simulated sound ones by code of its own: what the search for mistakes is tried on.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "offline/identify/mistakes/job.hpp"
#include "offline/simulate/simulate.hpp"

namespace mdhcal::tests {

/// A job with a mistake in it, and rows of the same making that took no part.
struct WrongJob {
  offline::Job job;
  offline::Dataset unseen;
};

struct MistakeMaker {
  std::string name;
  std::vector<std::string> kinds;  ///< what may be named: as word(MistakeKind), any one of them
  /// Puts the mistake into a sound job; false where this arm has no such thing.
  std::function<bool(WrongJob&, offline::Random&)> make;
  /// The residual scale that the cure leaves at most [mm]: the noise is 0.02 mm. What no cure can restore, the readings of a
  /// joint that recorded none, are found through the nominal geometry.
  double leaves_mm = 0.1;
};

const std::vector<MistakeMaker>& mistake_makers();

/// A sound job of a built-in arm: deviations of 0.5 mm and 0.5 mrad, noise 0.02 mm, positions of one target.
WrongJob sound_job(const std::string& family, std::size_t poses, std::uint64_t seed);

/// Sound jobs as they come: 6 to 60 poses, some with gross rows, with sag, with several reflectors, with full poses.
WrongJob sound_job_of_any_kind(std::uint64_t seed);

/// Mean distance [mm] between where a calibration puts the target of the unseen rows and where it was.
double unseen_error_mm(const offline::Calibration& calibration, const offline::Dataset& unseen);

}  // namespace mdhcal::tests
