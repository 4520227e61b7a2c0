// SPDX-License-Identifier: MIT
#pragma once

#include "offline/identify/identifiability.hpp"
#include "offline/identify/tikhonov.hpp"

namespace mdhcal::offline {

/// The column-scaled spectrum of a reduced system.
Spectrum spectrum_of(const ReducedSystem& system);

/// Everything but `before`. `seed` draws the trial poses among which one that separates a weak direction is sought.
Identifiability identifiability(const ReducedSystem& system, const SpectralProblem& problem, const Layout& layout,
                                const MeasurementModel& model, double lambda, std::uint64_t seed);

}  // namespace mdhcal::offline
