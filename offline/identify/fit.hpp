// SPDX-License-Identifier: MIT
// One nonlinear regularized fit: relinearise, step, reweight, until the step is small.
#pragma once

#include <vector>

#include "offline/identify/linearised.hpp"
#include "offline/identify/robust.hpp"

namespace mdhcal::offline {

struct FitControl {
  Loss loss = Loss::squares;
  double noise_mm = 0.02;
  /// Negative: lambda follows the residual's scale squared, the maximum a posteriori choice for honest priors.
  double lambda = -1.0;
  int max_iterations = 50;
  double tolerance = 1e-4;  ///< largest step at which the fit has converged, in columns' units (0.1 um, 0.1 urad)
};

struct Fit {
  Estimate estimate;
  std::vector<double> error_norms;  ///< standard_error_norm() of each selected row
  double scale = 0;                 ///< of one axis's residual, in the residual's scaled unit (mm without sigma)
  double lambda = 0;                ///< of the last step
  int iterations = 0;
  bool converged = false;
};

/// Minimises the weighted squares plus lambda |x|^2 from `start`. `selection.robust_weight` is set for `loss`.
/// Gauss-Newton, each step solved orthogonally and safeguarded by Levenberg-Marquardt damping; the penalty is on the
/// whole deviation x, not on the step.
Fit fit(const Dataset& data, Selection& selection, const Layout& layout, const Estimate& start,
        const FitControl& control);

}  // namespace mdhcal::offline
