// SPDX-License-Identifier: MIT
// One linearisation of a fit's problem, from which rules, covariance and folds take what they need.
#pragma once

#include <vector>

#include "offline/identify/reduction.hpp"
#include "offline/identify/tikhonov.hpp"

namespace mdhcal::offline {

struct Linearised {
  std::vector<Triangle> parts;    ///< one a fold of the selection
  ReducedSystem system;           ///< of all parts together
  SpectralProblem problem;        ///< base and targets projected out, in the total deviation
  Eigen::VectorXd x0;             ///< the deviation at which it was linearised, in units of the prior
};

/// Linearises the selected rows, with their robust weights, at `at`.
Linearised linearised(const Dataset& data, const Selection& selection, const Layout& layout, const Estimate& at,
                      double noise_mm);

/// The same problem without one of its folds; the rest of it if there is only one.
struct WithoutFold {
  ReducedSystem system;
  SpectralProblem problem;
};
WithoutFold without_fold(const Linearised& whole, const Layout& layout, std::size_t fold);

/// The triangle of all folds together.
Triangle sum_of(const std::vector<Triangle>& parts);

/// The estimate that solves the linearised problem for a lambda.
Estimate solved(const Estimate& at, const Layout& layout, const ReducedSystem& system, const SpectralProblem& problem,
                const Eigen::VectorXd& x0, double lambda);

}  // namespace mdhcal::offline
