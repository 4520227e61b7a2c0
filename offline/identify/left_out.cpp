// SPDX-License-Identifier: MIT
#include "offline/identify/left_out.hpp"

#include <algorithm>

#include "offline/base/error.hpp"
#include "offline/identify/covariance.hpp"
#include "offline/identify/lambda_rules.hpp"

namespace mdhcal::offline {

namespace {

Selection without(const Selection& selection, std::uint32_t fold) {
  Selection rest;
  rest.shared = selection.shared;
  for (std::size_t i = 0; i < selection.rows.size(); ++i) {
    if (selection.fold[i] == fold && selection.folds > 1) continue;
    rest.rows.push_back(selection.rows[i]);
    if (!selection.pose.empty()) rest.pose.push_back(selection.pose[i]);
  }
  return rest;
}

// The fit without one fold, and its covariance.
struct FoldFit {
  Fit fit;
  Covariance covariance;
};

FoldFit fit_without(const Dataset& data, Selection rest, const Layout& layout, const Linearised& whole, const WithoutFold& part,
                    const Fit& result, const LeaveOutControl& control) {
  FitControl stage;
  stage.noise_mm = control.noise_mm;
  stage.loss = control.robust ? Loss::tukey : Loss::squares;
  stage.lambda = result.lambda;
  // What is left of the error is far above a hundredth of a prior's standard deviation.
  stage.tolerance = 1e-2;
  if (control.choose_lambda && part.problem.rank() > 0) {
    const LambdaChoice choice = marginal_likelihood(part.problem);
    if (choice.found) stage.lambda = choice.lambda;
  }
  FoldFit out;
  out.fit.estimate = result.estimate;
  try {
    out.fit = fit(data, rest, layout, solved(result.estimate, layout, part.system, part.problem, whole.x0, stage.lambda), stage);
  } catch (const Refusal&) {
    // The linear solution left the valid range of a geometry: from the result itself.
    out.fit = fit(data, rest, layout, result.estimate, stage);
  }
  out.covariance = covariance_of(data, rest, layout, part.system, part.problem, out.fit, stage.lambda, control.noise_mm);
  return out;
}

}  // namespace

LeftOut leave_out(const Dataset& data, const Selection& selection, const Unknowns& unknowns, const Linearised& whole,
                  const Fit& result, const Estimate& start, const LeaveOutControl& control) {
  LeftOut out;
  out.folds = selection.folds;
  out.after.resize(selection.rows.size());
  out.before_mm.resize(selection.rows.size());
  out.before_turn_mm.resize(selection.rows.size());
  const bool any_sigma = states_sigma(data);
  for (std::uint32_t fold = 0; fold < selection.folds; ++fold) {
    Selection rest = without(selection, fold);
    const FoldFit after = fit_without(data, rest, unknowns.layout, whole, without_fold(whole, unknowns.layout, fold), result,
                                      control);
    FitControl frames;
    frames.noise_mm = control.noise_mm;
    frames.loss = Loss::huber;
    frames.tolerance = 1e-2;
    const MeasurementModel before(fit(data, rest, unknowns.frames, start, frames).estimate);
    const Predictor predictor{MeasurementModel(after.fit.estimate), unknowns.layout, after.covariance, after.fit.scale,
                              control.noise_mm, any_sigma};
    for (std::size_t i = 0; i < selection.rows.size(); ++i) {
      if (selection.fold[i] != fold) continue;
      const std::size_t row = selection.rows[i];
      double residual[max_row_residuals] = {};
      const std::size_t count = before.residual(data, row, residual);
      for (std::size_t k = 0; k < std::min<std::size_t>(count, 3); ++k) out.before_mm[i][k] = residual[k];
      for (std::size_t k = 3; k < count; ++k) out.before_turn_mm[i][k - 3] = residual[k];
      out.after[i] = predict(predictor, data, row);
    }
  }
  return out;
}

}  // namespace mdhcal::offline
