// SPDX-License-Identifier: MIT
#include "offline/identify/regularized.hpp"

#include <cmath>

#include "offline/base/error.hpp"
#include "offline/identify/shared_error.hpp"

namespace mdhcal::offline {

LambdaChoice choose_lambda(const Dataset& data, const Selection& selection, const Layout& layout, const Estimate& at,
                           const Linearised& whole, const RegularizedControl& control) {
  const SpectralProblem& problem = whole.problem;
  const auto by_folds = [&] {
    const FoldJudge judge(data, selection, layout, at, whole);
    const Judge error = [&](double lambda) { return judge.error_mm(lambda); };
    return control.rule == LambdaRule::cv ? cross_validation(problem, error) : two_stage_sweep(problem, error, "rpim");
  };
  switch (control.rule) {
    case LambdaRule::rpim:
    case LambdaRule::cv: return by_folds();
    case LambdaRule::rpim_train:
      return two_stage_sweep(
          problem, [&](double lambda) { return training_error_mm(data, selection, layout, at, whole, lambda); }, "rpim-train");
    case LambdaRule::l_curve: return l_curve(problem);
    case LambdaRule::gcv: return generalised_cross_validation(problem);
    case LambdaRule::marginal_likelihood: return marginal_likelihood(problem);
    case LambdaRule::quasi_optimality: return quasi_optimality(problem);
    case LambdaRule::discrepancy: {
      if (!control.sigma) {
        throw InputError("The discrepancy principle needs the measurements' standard deviation: give a sigma column "
                         "or --noise.");
      }
      // Robust weights shrink what the noise leaves; the mean weight carries that over.
      double mean_weight = 0.0;
      std::size_t used = 0;
      for (double w : selection.robust_weight) {
        if (w > 0.0) mean_weight += w, ++used;
      }
      mean_weight = used > 0 ? mean_weight / static_cast<double>(used) : 1.0;
      return discrepancy(problem, *control.sigma * std::sqrt(mean_weight));
    }
    case LambdaRule::fixed: break;
  }
  LambdaChoice choice;
  choice = l_curve(problem);
  choice.rule = "fixed";
  choice.note.clear();
  choice.lambda = control.lambda;
  choice.found = true;
  return choice;
}

std::string why_not(const LambdaChoice& choice, const SpectralProblem& problem) {
  if (!choice.found) return choice.note.empty() ? "it has no answer here" : choice.note.substr(0, choice.note.size() - 1);
  // A minimum at the edge of the range is where the search ended, not where the criterion turns: within one step of the
  // grid of lambda_rules.cpp, some twentieth.
  if (choice.lambda < 1.06 * problem.smallest_lambda()) return "it runs to the lower bound of the search, where the weakest direction is not held";
  if (choice.lambda > problem.largest_lambda() / 1.06) return "it runs to the upper bound of the search, where nothing is estimated";
  // Nearer (in the logarithm of the residual) to the nominal arm than to what the measurements tell. Within a factor of two
  // of each other the two cannot be told apart by it.
  const double fitted = problem.residual_norm2(0.0);
  const double nominal = fitted + problem.beta.squaredNorm();
  const double here = problem.residual_norm2(choice.lambda);
  if (nominal > 4.0 * fitted && here * here > nominal * fitted) return "it leaves the arm near its nominal geometry, against the measurements";
  return "";
}

namespace {

// The rule's choice, or the default rule's where that is not to be followed, or else the residual's scale squared.
LambdaChoice followed(const Dataset& data, const Selection& selection, const Layout& layout, const RegularizedFit& now,
                      const RegularizedControl& control) {
  const SpectralProblem& problem = now.linearised.problem;
  LambdaChoice choice = choose_lambda(data, selection, layout, now.fit.estimate, now.linearised, control);
  const bool without_judge = control.rule == LambdaRule::gcv || control.rule == LambdaRule::l_curve ||
                             control.rule == LambdaRule::quasi_optimality;
  const std::string reason = without_judge ? why_not(choice, problem) : "";
  if (!reason.empty() && problem.rank() > 0) {
    const std::string rule = choice.rule;
    choice = marginal_likelihood(problem);
    choice.note = "The rule " + rule + " is not followed: " + reason + ". Lambda is that of the default rule, reml.";
  }
  if (!choice.found) {
    choice.lambda = now.fit.lambda;
    choice.note += (choice.note.empty() ? "" : " ") + std::string("Lambda is the residual's scale squared.");
  }
  return choice;
}

}  // namespace

RegularizedFit regularized_fit(const Dataset& data, Selection& selection, const Layout& layout, const Estimate& start,
                               const RegularizedControl& control) {
  const Folds folds = make_folds(data, selection.rows, control.seed);
  selection.fold = folds.of_row;
  selection.folds = folds.count;

  RegularizedFit out;
  FitControl stage;
  stage.noise_mm = control.noise_mm;
  stage.loss = control.robust ? Loss::huber : Loss::squares;
  stage.tolerance = 0.05;  // only a start for the next stage
  out.fit = fit(data, selection, layout, start, stage);
  set_shared_error(data, layout, out.fit.estimate, control.noise_mm, selection);
  stage.loss = control.robust ? Loss::tukey : Loss::squares;
  stage.tolerance = 1e-2;
  out.fit = fit(data, selection, layout, out.fit.estimate, stage);
  stage.tolerance = 1e-4;
  constexpr int rounds = 4;
  for (int round = 0; round < rounds; ++round) {
    const double before = stage.lambda;
    out.linearised = linearised(data, selection, layout, out.fit.estimate, control.noise_mm);
    out.corner = l_curve(out.linearised.problem);
    out.choice = followed(data, selection, layout, out, control);
    stage.lambda = out.choice.lambda;
    out.fit = fit(data, selection, layout, out.fit.estimate, stage);
    // A change of lambda by a tenth moves no result by more than a small part of its uncertainty.
    if (control.rule == LambdaRule::fixed) break;
    if (before > 0.0 && std::fabs(std::log(stage.lambda / before)) < 0.1) break;
  }
  out.linearised = linearised(data, selection, layout, out.fit.estimate, control.noise_mm);
  return out;
}

}  // namespace mdhcal::offline
