// SPDX-License-Identifier: MIT
#include "offline/identify/fit.hpp"

#include <cmath>

#include "offline/base/error.hpp"
#include "offline/identify/shared_error.hpp"

namespace mdhcal::offline {

namespace {

// Rounding alone must not count as an increase: sums of squares over 1e5 rows round by some 1e-11.
constexpr double not_above = 1.0 + 1e-9;
// Levenberg-Marquardt damping of unit columns: the first shortens directions below a hundredth of the largest, the least
// none that a well-told problem has.
constexpr double first_damping = 1e-4, least_damping = 1e-6;

// Weighted squares at a trial estimate; infinite where the geometry is no longer valid.
double trial_squares(const Estimate& estimate, const Dataset& data, const Selection& selection, double noise_mm,
                     std::vector<double>& norms) {
  try {
    return evaluate(MeasurementModel(estimate), data, selection, noise_mm, &norms);
  } catch (const Refusal&) {
    return HUGE_VAL;
  }
}

// A fit takes degrees of freedom from the residuals that its scale is read off: what m scalar residuals leave after p
// parameters is small by the root of (m - p) / m. At most threefold: beyond, the floor has to hold.
double freedom_factor(double scalars, double parameters) {
  return scalars > parameters * 9.0 / 8.0 ? std::sqrt(scalars / (scalars - parameters)) : 3.0;
}

double scalars_used(const Dataset& data, const Selection& selection) {
  double sum = 0.0;
  for (std::size_t i = 0; i < selection.rows.size(); ++i) {
    if (!selection.robust_weight.empty() && !(selection.robust_weight[i] > 0.0)) continue;
    sum += static_cast<double>(residual_count(data.rows[selection.rows[i]].kind));
  }
  return sum;
}

double penalty(const Estimate& estimate, const Layout& layout, double lambda) {
  double sum = 0.0;
  for (double x : deviation(estimate, layout)) sum += x * x;
  return lambda * sum;
}

}  // namespace

Fit fit(const Dataset& data, Selection& selection, const Layout& layout, const Estimate& start,
        const FitControl& control) {
  Fit out;
  out.estimate = start;
  // Without sigma the residual is in mm and so is its floor; with sigma it is in standard deviations.
  const double floor = states_sigma(data) ? 1.0 : control.noise_mm;
  const auto frames = static_cast<Eigen::Index>(layout.frame_columns());
  const auto parameters = static_cast<Eigen::Index>(layout.geometry.size());
  const auto columns = frames + parameters;

  selection.robust_weight.clear();
  evaluate(MeasurementModel(out.estimate), data, selection, control.noise_mm, &out.error_norms);
  out.scale = robust_scale(out.error_norms, 1.0, floor);
  selection.robust_weight = robust_weights(control.loss, out.error_norms, out.scale);

  const double share = independent_share(data, selection);
  double damping = 0.0;
  double parameters_used = 0.0;
  for (out.iterations = 0; out.iterations < control.max_iterations; ++out.iterations) {
    out.lambda = control.lambda >= 0.0 ? control.lambda : out.scale * out.scale;
    Triangle triangle = sum_of(linearise(MeasurementModel(out.estimate), data, selection, layout, control.noise_mm));
    const Eigen::MatrixXd& matrix = triangle.matrix();
    const std::vector<double> now = deviation(out.estimate, layout);
    const Eigen::VectorXd x0 = Eigen::Map<const Eigen::VectorXd>(now.data(), parameters);
    const double squares = matrix.col(columns).squaredNorm();
    const double objective = squares + penalty(out.estimate, layout, out.lambda);

    Eigen::VectorXd step(columns);
    double trial_objective = HUGE_VAL;
    Estimate trial;
    std::vector<double> norms;
    for (int attempt = 0; attempt < 12; ++attempt) {
      if (damping > 0.0) {
        step = damped_step(matrix, layout.frame_columns(), x0, out.lambda, damping);
      } else {
        const ReducedSystem system = reduce_frames(matrix, layout.frame_columns(), triangle.row_count());
        const SpectralProblem problem = penalised_problem(system, x0);
        step.tail(parameters) = problem.solution(out.lambda) - x0;
        parameters_used = static_cast<double>(system.frame_rank) + problem.effective_parameters(out.lambda);
        step.head(frames) = frame_step(system, step.tail(parameters));
      }
      trial = moved(out.estimate, layout, step.data());
      trial_objective = trial_squares(trial, data, selection, control.noise_mm, norms) +
                        penalty(trial, layout, out.lambda);
      if (trial_objective <= objective * not_above) break;
      damping = damping > 0.0 ? 10.0 * damping : first_damping;
    }
    if (!(trial_objective <= objective * not_above)) return out;
    damping = damping > least_damping ? 0.1 * damping : 0.0;
    out.estimate = trial;
    out.error_norms = norms;
    const double scalars = share * scalars_used(data, selection);
    out.scale = robust_scale(out.error_norms, freedom_factor(scalars, parameters_used), floor);
    selection.robust_weight = robust_weights(control.loss, out.error_norms, out.scale);
    if (step.size() == 0 || step.cwiseAbs().maxCoeff() < control.tolerance) {
      out.converged = damping <= 0.0;
      if (out.converged) {
        ++out.iterations;
        return out;
      }
    }
  }
  return out;
}

}  // namespace mdhcal::offline
