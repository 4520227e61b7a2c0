// SPDX-License-Identifier: MIT
// Mistakes that are a number: a zero, a gear ratio, a coupling, a drift. Each is one more column (or six) of the
// linearised problem; what the column takes off the residual is found without another fit, for all of them at once.
#pragma once

#include "offline/identify/mistakes/hypothesis.hpp"
#include "offline/identify/mistakes/judge.hpp"

namespace mdhcal::offline {

/// The hypotheses that take most off the residual of `job`, which `at` judged, each with its number refined by fits.
std::vector<Hypothesis> continuous_mistakes(const Job& job, const Judgement& at);

/// The tracker's frame moves evenly with the rows: by `turn_rad` about `pivot_m` and `shift_m` from the first to the last.
Hypothesis drifting(const Job& job, const Vector3& turn_rad, const Vector3& shift_m, const Vector3& pivot_m);

}  // namespace mdhcal::offline
