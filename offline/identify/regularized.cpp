// SPDX-License-Identifier: MIT
#include "offline/identify/regularized.hpp"

#include <cmath>

#include "offline/base/error.hpp"

namespace mdhcal::offline {

LambdaChoice choose_lambda(const Dataset& data, const Selection& selection, const Layout& layout, const Estimate& at,
                           const RegularizedControl& control, LambdaChoice& corner) {
  const MeasurementModel model(at);
  const std::vector<Triangle> parts = linearise(model, data, selection, layout, control.noise_mm);
  Triangle whole = sum_of(parts);
  const ReducedSystem system = reduce_frames(whole.matrix(), layout.frame_columns(), whole.row_count());
  const std::vector<double> x = deviation(at, layout);
  const Eigen::VectorXd x0 = Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
  const SpectralProblem problem = penalised_problem(system, x0);
  corner = l_curve(problem);

  const auto by_folds = [&] {
    const FoldJudge judge(data, selection, layout, model, parts);
    const Judge error = [&](double lambda) { return judge.error_mm(lambda); };
    return control.rule == LambdaRule::cv ? cross_validation(problem, error) : two_stage_sweep(problem, error, "rpim");
  };
  switch (control.rule) {
    case LambdaRule::rpim:
    case LambdaRule::cv: return by_folds();
    case LambdaRule::rpim_train:
      return two_stage_sweep(
          problem,
          [&](double lambda) {
            return training_error_mm(data, selection, layout, model, system, problem, lambda);
          },
          "rpim-train");
    case LambdaRule::l_curve: return corner;
    case LambdaRule::gcv: return generalised_cross_validation(problem);
    case LambdaRule::marginal_likelihood: return marginal_likelihood(problem, independent_share(data, selection, model));
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
  choice.rule = "fixed";
  choice.lambda = control.lambda;
  choice.found = true;
  choice.curve = corner.curve;
  return choice;
}

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
  stage.independent_share = independent_share(data, selection, MeasurementModel(out.fit.estimate));
  stage.loss = control.robust ? Loss::tukey : Loss::squares;
  stage.tolerance = 1e-2;
  out.fit = fit(data, selection, layout, out.fit.estimate, stage);
  stage.tolerance = 1e-4;
  constexpr int rounds = 4;
  for (int round = 0; round < rounds; ++round) {
    const double before = stage.lambda;
    out.choice = choose_lambda(data, selection, layout, out.fit.estimate, control, out.corner);
    if (!out.choice.found) {
      LambdaChoice fallback = out.choice;
      fallback.lambda = out.fit.lambda;
      fallback.note += (fallback.note.empty() ? "" : " ") + std::string("Lambda is the residual's scale squared.");
      out.choice = fallback;
    }
    stage.lambda = out.choice.lambda;
    out.fit = fit(data, selection, layout, out.fit.estimate, stage);
    // A change of lambda by a tenth moves no result by more than a small part of its uncertainty.
    if (control.rule == LambdaRule::fixed) break;
    if (before > 0.0 && std::fabs(std::log(stage.lambda / before)) < 0.1) break;
  }
  return out;
}

}  // namespace mdhcal::offline
