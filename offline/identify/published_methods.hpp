// SPDX-License-Identifier: MIT
// The methods that the source compares, as they are usually published: no penalty and no robust weights.
#pragma once

#include <string>

#include "offline/identify/reduction.hpp"

namespace mdhcal::offline {

struct MethodOutcome {
  Estimate estimate;
  int iterations = 0;
  bool converged = false;
  std::string note;   ///< why it did not converge; empty if it did
};

/// One least-squares step from the start; directions below the Jacobian's own error are left alone.
MethodOutcome least_squares_step(const Dataset& data, const Selection& selection, const Layout& layout,
                                 const Estimate& start, double noise_mm);

/// Gradient descent on the squares of the residuals, in units of the priors, with the step that is best to first order
/// along the gradient (Cauchy). Stops when the gradient has fallen by 1e-6, or unconverged after 20 000 steps.
MethodOutcome gradient_descent(const Dataset& data, const Selection& selection, const Layout& layout,
                               const Estimate& start, double noise_mm);

/// Undamped Gauss-Newton; unconverged after 50 iterations or when the residual explodes.
MethodOutcome gauss_newton(const Dataset& data, const Selection& selection, const Layout& layout,
                           const Estimate& start, double noise_mm);

/// Gauss-Newton with Levenberg-Marquardt damping (Marquardt 1963), scaled by the columns' lengths.
MethodOutcome levenberg_marquardt(const Dataset& data, const Selection& selection, const Layout& layout,
                                  const Estimate& start, double noise_mm);

/// Extended Kalman filter over the poses in file order, one pass, constant state; the prior is its initial covariance.
/// Scalar updates of a square root of the covariance (Potter's form: Bierman 1977, II.5), which keeps it positive.
MethodOutcome extended_kalman_filter(const Dataset& data, const Selection& selection, const Layout& layout,
                                     const Estimate& start, double noise_mm);

}  // namespace mdhcal::offline
