// SPDX-License-Identifier: MIT
#include "offline/identify/covariance.hpp"

#include <algorithm>
#include <cmath>

#include "offline/base/distributions.hpp"
#include "offline/identify/factorization.hpp"
#include "offline/identify/lambda_rules.hpp"

namespace mdhcal::offline {

namespace {

struct Noise {
  double variance = 0;  // to be used with the weighted triangle
  double freedom = 0;
};

// Back from standard_error_norm() to the sum of squares.
double squared_norm(double error_norm, std::size_t count) {
  const double norm = error_norm * chi_median(count);
  return norm * norm;
}

// Squared length of the rows' last column behind a triangle: the weighted, whitened residuals.
double whitened_squares(const ReducedSystem& system) {
  return system.frame_residual.squaredNorm() + system.geometry_residual.squaredNorm() + system.outside2;
}

Noise noise_of(const Dataset& data, const Selection& selection, const ReducedSystem& system, const Fit& fit, double parameters,
               double floor) {
  // psi(r) = w(|r|) r: its variance over its mean slope squared is the estimate's variance in units of (J^T J)^-1;
  // times the mean weight, in units of (J^T W J)^-1, which is what the triangle holds.
  double scalars = 0;
  double weight = 0;
  double slope = 0;
  double psi2 = 0;
  double squares = 0;
  for (std::size_t i = 0; i < selection.rows.size(); ++i) {
    const auto count = residual_count(data.rows[selection.rows[i]].kind);
    const auto n = static_cast<double>(count);
    const double w = selection.robust_weight.empty() ? 1.0 : selection.robust_weight[i];
    if (!(w > 0.0)) continue;
    const double u = fit.error_norms[i] / (tukey_threshold * fit.scale);
    const double dw = selection.robust_weight.empty() ? 0.0 : -4.0 * u * u * (1.0 - u * u);  // |r| dw/d|r|
    scalars += n;
    weight += n * w;
    slope += n * w + dw;
    psi2 += w * w * squared_norm(fit.error_norms[i], count);
    squares += w * squared_norm(fit.error_norms[i], count);
  }
  Noise out;
  // What rows share is taken out of the triangle: its residuals count, not the rows'.
  if (selection.shared.any() && squares > 0.0) psi2 *= whitened_squares(system) / squares;
  out.freedom = scalars - parameters;
  if (!(out.freedom >= 1.0) || !(slope > 0.0)) {
    out.freedom = std::max(1.0, out.freedom);
    out.variance = floor * floor;
    return out;
  }
  const double one = psi2 / scalars * (weight / scalars) / ((slope / scalars) * (slope / scalars));
  out.variance = one * scalars / out.freedom;
  // With hardly any freedom left the residuals say nothing about the noise: then the stated noise is the least.
  if (out.freedom < 10.0) out.variance = std::max(out.variance, floor * floor);
  return out;
}

}  // namespace

Covariance covariance_of(const Dataset& data, const Selection& selection, const Layout& layout,
                         const ReducedSystem& system, const SpectralProblem& problem, const Fit& fit, double lambda,
                         double noise_mm) {
  Covariance out;
  out.size = layout.columns();
  const auto frames = static_cast<Eigen::Index>(layout.frame_columns());
  const auto n = static_cast<Eigen::Index>(layout.geometry.size());
  const double floor = states_sigma(data) ? 1.0 : noise_mm;
  const double used = static_cast<double>(system.frame_rank) + problem.effective_parameters(lambda);
  const Noise noise = noise_of(data, selection, system, fit, used, floor);
  out.sigma = std::sqrt(noise.variance);
  out.freedom = noise.freedom;
  out.coverage_factor = student_975(std::max(3.0, noise.freedom));
  const double ratio = marginal_likelihood(problem).lambda;
  if (problem.rank() > 0 && ratio > 0.0) {
    // Two estimates of the prior's variance: the noise over the ratio with the greatest likelihood, and the deviations
    // found, since a deviation's expected square is that variance times its filter factor. They agree where the data tell
    // the ratio; where hardly anything is left of the residual the first one has no bound.
    const double found = problem.solution_norm2(lambda) / std::max(1.0, problem.effective_parameters(lambda));
    out.prior_scale = std::sqrt(std::max(1.0, std::min(noise.variance / ratio, found)));
  }

  const double t2 = out.prior_scale * out.prior_scale;
  const Eigen::ArrayXd s2 = problem.s.array().square();
  const Eigen::ArrayXd variance = (noise.variance * s2 + lambda * lambda * t2) / (s2 + lambda).square();
  Eigen::MatrixXd geometry = problem.v * variance.matrix().asDiagonal() * problem.v.transpose();
  geometry += t2 * (Eigen::MatrixXd::Identity(n, n) - problem.v * problem.v.transpose());

  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(frames + n, frames + n);
  all.bottomRightCorner(n, n) = geometry;
  if (frames > 0) {
    const Eigen::MatrixXd spread =
        least_squares(system.frame, Eigen::MatrixXd::Identity(frames, frames), jacobian_tolerance).x;
    const Eigen::MatrixXd follow = -spread * system.frame_by_geometry;
    all.topLeftCorner(frames, frames) =
        noise.variance * spread * spread.transpose() + follow * geometry * follow.transpose();
    const Eigen::MatrixXd alone = noise.variance * spread * spread.transpose();
    out.frame_size = layout.frame_columns();
    out.frames.assign(alone.data(), alone.data() + alone.size());
    all.topRightCorner(frames, n) = follow * geometry;
    all.bottomLeftCorner(n, frames) = all.topRightCorner(frames, n).transpose();
  }
  out.value.resize(out.size * out.size);
  for (Eigen::Index i = 0; i < all.rows(); ++i) {
    for (Eigen::Index j = 0; j < all.cols(); ++j) {
      out.value[static_cast<std::size_t>(i) * out.size + static_cast<std::size_t>(j)] = 0.5 * (all(i, j) + all(j, i));
    }
  }
  return out;
}

double predicted_position_sd_mm(const MeasurementModel& model, const Layout& layout, const Covariance& covariance,
                                const double* q, std::size_t target, double* axes_mm) {
  Dataset one;
  one.rows.resize(1);
  std::copy(q, q + model.estimate().geometry.joint_count, one.rows[0].q.begin());
  one.rows[0].target = static_cast<std::uint32_t>(target);
  const std::size_t n = layout.columns();
  std::vector<double> jacobian(3 * n);
  double residual[3];
  model.residual(one, 0, layout, residual, jacobian.data(), n);
  double trace = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    double variance = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double* row = covariance.value.data() + i * n;
      double sum = 0.0;
      for (std::size_t j = 0; j < n; ++j) sum += row[j] * jacobian[k * n + j];
      variance += jacobian[k * n + i] * sum;
    }
    if (axes_mm != nullptr) axes_mm[k] = std::sqrt(std::max(0.0, variance));
    trace += std::max(0.0, variance);
  }
  return std::sqrt(trace);
}

}  // namespace mdhcal::offline
