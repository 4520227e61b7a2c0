// SPDX-License-Identifier: MIT
// The regularized, robust identification with lambda chosen by a rule: what `--method rpim` runs.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "offline/identify/fit.hpp"
#include "offline/identify/folds.hpp"
#include "offline/identify/lambda_rules.hpp"

namespace mdhcal::offline {

enum class LambdaRule { rpim, rpim_train, l_curve, gcv, cv, discrepancy, quasi_optimality, fixed, marginal_likelihood };

/// Every rule by the word that names it.
inline constexpr std::pair<std::string_view, LambdaRule> lambda_rules[] = {
    {"reml", LambdaRule::marginal_likelihood}, {"rpim", LambdaRule::rpim},
    {"rpim-train", LambdaRule::rpim_train},    {"l-curve", LambdaRule::l_curve},
    {"gcv", LambdaRule::gcv},                  {"cv", LambdaRule::cv},
    {"discrepancy", LambdaRule::discrepancy},  {"quasi-optimality", LambdaRule::quasi_optimality}};

struct RegularizedControl {
  LambdaRule rule = LambdaRule::rpim;
  double lambda = 0;            ///< (rule fixed)
  double noise_mm = 0.02;
  std::optional<double> sigma;  ///< of a scaled residual, for the discrepancy principle
  bool robust = true;
  std::uint64_t seed = 1;
};

struct RegularizedFit {
  Fit fit;                 ///< converged at `choice.lambda`
  LambdaChoice choice;
  LambdaChoice corner;     ///< the L-curve of the same problem, for the record
  Linearised linearised;   ///< at the result
};

/// What the rule of `control` says on the problem linearised at `at`; `selection` has folds and weights. Throws InputError
/// if the rule is discrepancy and there is no sigma.
LambdaChoice choose_lambda(const Dataset& data, const Selection& selection, const Layout& layout, const Estimate& at,
                           const Linearised& whole, const RegularizedControl& control);

/// Why a choice is not to be followed, a clause: it lies at a bound of the search, or leaves the deviations near nominal
/// although the measurements tell them. Empty if neither.
std::string why_not(const LambdaChoice& choice, const SpectralProblem& problem);

/// Robust starting fit with lambda following the residual's scale (Huber, then Tukey), then the rule on the problem
/// linearised there, then the fit with that lambda; again until lambda stays. `selection` returns with the weights.
RegularizedFit regularized_fit(const Dataset& data, Selection& selection, const Layout& layout, const Estimate& start,
                               const RegularizedControl& control);

}  // namespace mdhcal::offline
