// SPDX-License-Identifier: MIT
// The search over what people get wrong: screening by the closed fit, judging with the geometry, confirming by the
// calibration with the cure.
#pragma once

#include <functional>
#include <optional>

#include "offline/identify/mistakes/diagnosis.hpp"
#include "offline/identify/mistakes/job.hpp"

namespace mdhcal::offline {

/// Searches for the mistakes in `job`, up to three together. `as_given` is what its calibration left, if
/// there is one. The work is bounded: some 15 000 fits of at most 40 rows, some hundred of at most 150 rows, and at most
/// four calibrations. `progress`, if given, is called with the steps done and all of them. Never throws for what the
/// job's data are: what cannot be fitted is no explanation.
Diagnosis diagnose(const Job& job, const std::optional<Residual>& as_given,
                   const std::function<void(std::size_t, std::size_t)>& progress = {});

/// The search that a calibration of `job` calls for. The whole of it where the calibration is not usable, or `always`; where
/// it is but leaves more than twice the noise, whether a given base or tool is wrong or the tracker (or the robot's foot)
/// moved, which may leave little and still be wrong: some dozen fits of at most 150 rows. What is named becomes the first
/// reason against the calibration, and its verdict follows. Nothing where no search was called for.
std::optional<Diagnosis> explain_by_mistakes(const Job& job, bool always, Calibration& calibration,
                                             const std::function<void(std::size_t, std::size_t)>& progress = {});

}  // namespace mdhcal::offline
