// SPDX-License-Identifier: MIT
#pragma once

#include "offline/identify/fit.hpp"
#include "offline/identify/uncertainty.hpp"

namespace mdhcal::offline {

/// Covariance of the result of a fit at lambda. In each singular direction of the projected problem
/// (sigma^2 s^2 + lambda^2 t^2) / (s^2 + lambda)^2: the noise's part and the bias's, t being the prior's scale; t^2 in
/// lost directions. sigma comes from the residuals with the robust weights' asymptotic correction (Huber 1981, chapter
/// 6), the degrees of freedom reduced by what the fit took; what rows share is whitened away (`system` and `problem` are).
Covariance covariance_of(const Dataset& data, const Selection& selection, const Layout& layout,
                         const ReducedSystem& system, const SpectralProblem& problem, const Fit& fit, double lambda,
                         double noise_mm);

}  // namespace mdhcal::offline
