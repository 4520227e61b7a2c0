// SPDX-License-Identifier: MIT
#include "offline/identify/prediction.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mdhcal::offline {

Prediction predict(const Predictor& predictor, const Dataset& data, std::size_t row) {
  const std::size_t n = predictor.layout.columns();
  std::vector<double> jacobian(max_row_residuals * n);
  double residual[max_row_residuals];
  double scale[max_row_residuals];
  const std::size_t count = predictor.model.residual(data, row, predictor.layout, residual, jacobian.data(), n);
  residual_scale(data, row, predictor.noise_mm, predictor.any_sigma, scale);

  using Rows = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
  const auto size = static_cast<Eigen::Index>(n);
  const auto rows = static_cast<Eigen::Index>(count);
  const Rows j(jacobian.data(), rows, size);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(rows, rows);
  if (predictor.covariance.size == n && n > 0) {
    const Rows parameters(predictor.covariance.value.data(), size, size);
    covariance = j * parameters * j.transpose();
  }
  for (Eigen::Index k = 0; k < rows; ++k) {
    const double sd_mm = predictor.scale / scale[k];
    covariance(k, k) += sd_mm * sd_mm;
  }
  Prediction out;
  const std::size_t leading = std::min<std::size_t>(count, 3);
  double trace = 0.0;
  for (std::size_t k = 0; k < leading; ++k) {
    out.error_mm[k] = residual[k];
    trace += covariance(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k));
  }
  const Eigen::Map<const Eigen::VectorXd> r(residual, rows);
  if (count == max_row_residuals) out.turn_mm = {residual[3], residual[4], residual[5]};
  out.standardised = covariance.llt().matrixL().solve(r).norm() / chi_median(count);
  // Mean norm of normal errors of one variance on every axis: one axis sqrt(2 / pi) sd, three sqrt(8 / pi) sd (Maxwell).
  const double axes = static_cast<double>(leading);
  out.mean_mm = std::sqrt(trace / axes) * std::sqrt((leading == 1 ? 2.0 : 8.0) / std::numbers::pi);
  return out;
}

}  // namespace mdhcal::offline
