// SPDX-License-Identifier: MIT
#include "offline/identify/published_methods.hpp"

#include <cmath>

#include "offline/base/error.hpp"
#include "offline/identify/fit.hpp"
#include "offline/identify/tikhonov.hpp"

namespace mdhcal::offline {

namespace {

constexpr double step_tolerance = 1e-4;  // 0.1 um, 0.1 urad: as in the regularized fit

Eigen::VectorXd deviation_of(const Estimate& estimate, const Layout& layout) {
  const std::vector<double> x = deviation(estimate, layout);
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

// The unpenalised least-squares step at an estimate.
Eigen::VectorXd newton_step(const Dataset& data, const Selection& selection, const Layout& layout,
                            const Estimate& estimate, double noise_mm) {
  Triangle triangle = sum_of(linearise(MeasurementModel(estimate), data, selection, layout, noise_mm));
  const ReducedSystem system = reduce_frames(triangle.matrix(), layout.frame_columns(), triangle.row_count());
  const Eigen::VectorXd x0 = deviation_of(estimate, layout);
  Eigen::VectorXd step(static_cast<Eigen::Index>(layout.columns()));
  // penalised_problem() solves for the whole deviation; with the present one as origin, the step itself is least.
  const SpectralProblem problem = penalised_problem(system, Eigen::VectorXd::Zero(x0.size()));
  step.tail(x0.size()) = problem.solution(0.0);
  step.head(step.size() - x0.size()) = frame_step(system, step.tail(x0.size()));
  return step;
}

double squares_at(const Estimate& estimate, const Dataset& data, const Selection& selection, double noise_mm) {
  try {
    return evaluate(MeasurementModel(estimate), data, selection, noise_mm);
  } catch (const Refusal&) {
    return HUGE_VAL;
  }
}

}  // namespace

MethodOutcome least_squares_step(const Dataset& data, const Selection& selection, const Layout& layout,
                                 const Estimate& start, double noise_mm) {
  MethodOutcome out;
  const Eigen::VectorXd step = newton_step(data, selection, layout, start, noise_mm);
  out.estimate = moved(start, layout, step.data());
  out.iterations = 1;
  const double before = squares_at(start, data, selection, noise_mm);
  const double after = squares_at(out.estimate, data, selection, noise_mm);
  out.converged = after <= before;
  if (!out.converged) {
    out.note = "The single step made the residual larger; the start is kept.";
    out.estimate = start;
  }
  return out;
}

MethodOutcome gauss_newton(const Dataset& data, const Selection& selection, const Layout& layout,
                           const Estimate& start, double noise_mm) {
  MethodOutcome out;
  out.estimate = start;
  const double before = squares_at(start, data, selection, noise_mm);
  for (out.iterations = 1; out.iterations <= 50; ++out.iterations) {
    const Eigen::VectorXd step = newton_step(data, selection, layout, out.estimate, noise_mm);
    const Estimate trial = moved(out.estimate, layout, step.data());
    const double squares = squares_at(trial, data, selection, noise_mm);
    if (!(squares <= 1e6 * before)) {
      out.note = "Gauss-Newton diverged: the residual exploded; the start is kept.";
      out.estimate = start;
      return out;
    }
    out.estimate = trial;
    if (step.size() == 0 || step.cwiseAbs().maxCoeff() < step_tolerance) {
      out.converged = squares <= before;
      if (!out.converged) out.note = "Gauss-Newton settled where the residual is larger than at the start.";
      return out;
    }
  }
  out.note = "Gauss-Newton did not settle within 50 iterations.";
  return out;
}

MethodOutcome levenberg_marquardt(const Dataset& data, const Selection& selection, const Layout& layout,
                                  const Estimate& start, double noise_mm) {
  FitControl control;
  control.loss = Loss::squares;
  control.lambda = 0.0;
  control.noise_mm = noise_mm;
  control.max_iterations = 100;
  control.tolerance = step_tolerance;
  Selection plain = selection;
  plain.robust_weight.clear();
  const Fit result = fit(data, plain, layout, start, control);
  MethodOutcome out;
  out.estimate = result.estimate;
  out.iterations = result.iterations;
  out.converged = result.converged;
  if (!out.converged) out.note = "Levenberg-Marquardt did not settle within 100 iterations.";
  return out;
}

MethodOutcome gradient_descent(const Dataset& data, const Selection& selection, const Layout& layout,
                               const Estimate& start, double noise_mm) {
  constexpr int steps_between_linearisations = 500;
  constexpr int linearisations = 40;
  MethodOutcome out;
  out.estimate = start;
  const auto n = static_cast<Eigen::Index>(layout.columns());
  double first_gradient = 0.0;
  for (int pass = 0; pass < linearisations; ++pass) {
    Triangle triangle = sum_of(linearise(MeasurementModel(out.estimate), data, selection, layout, noise_mm));
    const Eigen::MatrixXd upper = triangle.matrix().topLeftCorner(n, n);
    Eigen::VectorXd residual = triangle.matrix().col(n).head(n);
    Eigen::VectorXd total = Eigen::VectorXd::Zero(n);
    for (int step = 0; step < steps_between_linearisations; ++step) {
      const Eigen::VectorXd gradient = upper.transpose() * residual;
      const double size = gradient.norm();
      if (out.iterations == 0) first_gradient = size;
      if (!(size > 1e-6 * first_gradient)) {
        out.converged = true;
        break;
      }
      const Eigen::VectorXd along = upper * gradient;
      const double length = size * size / along.squaredNorm();
      total -= length * gradient;
      residual -= length * along;
      ++out.iterations;
    }
    const Estimate trial = moved(out.estimate, layout, total.data());
    const double now = squares_at(out.estimate, data, selection, noise_mm);
    if (!(squares_at(trial, data, selection, noise_mm) <= now * (1.0 + 1e-9))) {
      out.converged = false;
      out.note = "Gradient descent made the residual larger after relinearising.";
      return out;
    }
    out.estimate = trial;
    // Converged only if the gradient is small where it was just computed, not on the old linearisation.
    if (out.converged && total.cwiseAbs().maxCoeff() < step_tolerance) return out;
    out.converged = false;
  }
  out.note = "Gradient descent did not reach a small gradient within " + std::to_string(out.iterations) + " steps.";
  return out;
}

MethodOutcome extended_kalman_filter(const Dataset& data, const Selection& selection, const Layout& layout,
                                     const Estimate& start, double noise_mm) {
  MethodOutcome out;
  out.estimate = start;
  const std::size_t columns = layout.columns();
  const auto n = static_cast<Eigen::Index>(columns);
  Eigen::MatrixXd root = Eigen::MatrixXd::Identity(n, n);
  // Base and targets start from a fit to the nominal geometry: some 10 mm and mrad of what that may be off.
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(layout.frame_columns()); ++i) root(i, i) = 10.0;
  const bool any_sigma = states_sigma(data);
  const double variance = any_sigma ? 1.0 : noise_mm * noise_mm;
  std::vector<double> jacobian(max_row_residuals * columns);
  const double before = squares_at(start, data, selection, noise_mm);
  for (std::size_t row : selection.rows) {
    double residual[max_row_residuals];
    double scale[max_row_residuals];
    std::size_t count = 0;
    try {
      count = MeasurementModel(out.estimate).residual(data, row, layout, residual, jacobian.data(), columns);
    } catch (const Refusal&) {
      out.estimate = start;
      out.note = "The filter left the valid range of a geometry; the start is kept.";
      return out;
    }
    residual_scale(data, row, noise_mm, any_sigma, scale);
    Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
    for (std::size_t k = 0; k < count; ++k) {
      const Eigen::VectorXd h = scale[k] * Eigen::Map<const Eigen::VectorXd>(jacobian.data() + k * columns, n);
      const double innovation = -(scale[k] * residual[k] + h.dot(step));
      const Eigen::VectorXd f = root.transpose() * h;
      const double a = 1.0 / (f.squaredNorm() + variance);
      const Eigen::VectorXd gain = a * (root * f);
      step += innovation * gain;
      root -= (1.0 / (1.0 + std::sqrt(a * variance))) * gain * f.transpose();
    }
    out.estimate = moved(out.estimate, layout, step.data());
    ++out.iterations;
  }
  const double after = squares_at(out.estimate, data, selection, noise_mm);
  out.converged = after <= before;
  if (!out.converged) {
    out.note = "The filter ended with a larger residual than it started from; the start is kept.";
    out.estimate = start;
  }
  return out;
}

}  // namespace mdhcal::offline
