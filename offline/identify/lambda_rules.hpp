// SPDX-License-Identifier: MIT
// Rules that choose lambda. Each looks at the singular values of the projected, prior-scaled, weighted problem and
// nothing else, within [(s_r / 3)^2, s_1^2] (reml reaches lower); those with a judge call it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "offline/identify/tikhonov.hpp"

namespace mdhcal::offline {

/// One lambda that a rule looked at.
struct LambdaPoint {
  double lambda = 0;
  double residual_norm = 0;  ///< |A x - b|
  double solution_norm = 0;  ///< |x|, in units of the prior
  double criterion = 0;      ///< what the rule looks at: curvature, GCV function, judged error [mm], ...
};

struct LambdaChoice {
  std::string rule;      ///< the rule that made the choice
  double lambda = 0;
  bool found = false;    ///< false: the rule has no answer, lambda is meaningless
  std::string note;      ///< a sentence, if something is to be said
  std::vector<LambdaPoint> curve;
};

/// Greatest signed curvature of (log residual norm, log solution norm) by the filter factors' exact derivatives; only
/// a convex corner inside the range counts. (Li 2022, Eq. 15, 16 with the sign kept; Hansen 1992)
LambdaChoice l_curve(const SpectralProblem& problem);

/// Curvature of the L-curve at lambda, positive where convex.
double l_curve_curvature(const SpectralProblem& problem, double lambda);

/// Minimum of |r|^2 / (m - effective parameters)^2. (Golub, Heath, Wahba 1979)
LambdaChoice generalised_cross_validation(const SpectralProblem& problem);

/// Largest lambda whose residual is no more than noise of standard deviation `sigma` a row: |r|^2 = m sigma^2 (Morozov
/// 1966). The fit takes degrees of freedom, so with few rows a parameter it smooths too much; counting them makes the
/// equation unsolvable in every other draw (docs/method.md).
LambdaChoice discrepancy(const SpectralProblem& problem, double sigma);

/// Greatest marginal likelihood of the data when noise and deviations are both normal, their variances unknown but for
/// the ratio lambda that is sought (restricted maximum likelihood: base and targets projected out; Patterson and
/// Thompson 1971).
LambdaChoice marginal_likelihood(const SpectralProblem& problem);

/// Its criterion: twice the negative logarithm of that likelihood for a lambda, but for a constant.
double marginal_deviance(const SpectralProblem& problem, double lambda);

/// Minimum of |lambda dx/dlambda|. (Tikhonov and Glasko 1965)
LambdaChoice quasi_optimality(const SpectralProblem& problem);

/// Error of the full corrected model for one lambda [mm]; smaller is better.
using Judge = std::function<double(double lambda)>;

/// k-fold cross-validation over the whole range: 40 logarithmic steps, then 10 within the best one's neighbours.
LambdaChoice cross_validation(const SpectralProblem& problem, const Judge& judge);

/// The source's two stepping stages around the corner: 30 logarithmic steps from nine decades below to one above,
/// clipped to the range, then 10 linear steps within the best decade, each judged. Without a corner they are laid
/// around the choice of generalised cross-validation. (Li 2022, section on RPIM)
LambdaChoice two_stage_sweep(const SpectralProblem& problem, const Judge& judge, const std::string& rule);

}  // namespace mdhcal::offline
