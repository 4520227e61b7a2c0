// SPDX-License-Identifier: MIT
#include "offline/identify/reduction.hpp"

#include <cmath>

namespace mdhcal::offline {

namespace {

// Large enough that the triangle's share of the work is small, small enough that a block stays in the first cache.
constexpr Eigen::Index block_rows = 128;

// Zeroes `block` against the triangle above it, column by column (Golub and Van Loan, Matrix Computations, 5.2).
void reduce_into(Eigen::MatrixXd& triangle, Eigen::Ref<Eigen::MatrixXd> block) {
  const Eigen::Index n = triangle.cols();
  Eigen::RowVectorXd w(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double below = block.col(k).squaredNorm();
    if (!(below > 0.0)) continue;
    const double alpha = triangle(k, k);
    const double length = std::sqrt(alpha * alpha + below);
    const double head = alpha > 0.0 ? alpha + length : alpha - length;
    const double tau = 2.0 * head * head / (head * head + below);
    block.col(k) /= head;
    triangle(k, k) = alpha > 0.0 ? -length : length;
    const Eigen::Index rest = n - k - 1;
    if (rest == 0) continue;
    w.head(rest).noalias() = block.col(k).transpose() * block.rightCols(rest);
    w.head(rest) += triangle.row(k).tail(rest);
    w.head(rest) *= tau;
    triangle.row(k).tail(rest) -= w.head(rest);
    block.rightCols(rest).noalias() -= block.col(k) * w.head(rest);
  }
}

}  // namespace

Triangle::Triangle(std::size_t unknowns)
    : triangle_(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(unknowns) + 1,
                                      static_cast<Eigen::Index>(unknowns) + 1)),
      block_(block_rows, static_cast<Eigen::Index>(unknowns) + 1) {}

void Triangle::add_row(const double* coefficients, double residual, double weight) {
  if (!(weight > 0.0)) return;
  const Eigen::Index n = triangle_.cols() - 1;
  for (Eigen::Index c = 0; c < n; ++c) block_(filled_, c) = weight * coefficients[c];
  block_(filled_, n) = weight * residual;
  ++row_count_;
  if (++filled_ == block_rows) reduce();
}

void Triangle::add(const Triangle& other, double factor) {
  if (!(factor > 0.0)) return;
  Eigen::MatrixXd rows = factor * other.triangle_;
  reduce_into(triangle_, rows);
  if (other.filled_ > 0) {
    rows = factor * other.block_.topRows(other.filled_);
    reduce_into(triangle_, rows);
  }
  row_count_ += other.row_count_;
}

void Triangle::reduce() {
  if (filled_ == 0) return;
  reduce_into(triangle_, block_.topRows(filled_));
  filled_ = 0;
}

const Eigen::MatrixXd& Triangle::matrix() {
  reduce();
  return triangle_;
}

bool states_sigma(const Dataset& data) {
  for (const Measurement& m : data.rows) {
    if (m.sigma_m[0] > 0.0 || m.sigma_m[1] > 0.0 || m.sigma_m[2] > 0.0 || m.sigma_rotation_rad > 0.0) return true;
  }
  return false;
}

double mean_sigma_mm(const Dataset& data, const std::vector<std::size_t>& rows, double noise_mm) {
  double sum = 0.0;
  for (const std::size_t row : rows) {
    for (const double sigma_m : data.rows[row].sigma_m) sum += sigma_m > 0.0 ? 1e3 * sigma_m : noise_mm;
  }
  return rows.empty() ? noise_mm : sum / (3.0 * static_cast<double>(rows.size()));
}

void residual_scale(const Dataset& data, std::size_t row, double noise_mm, bool any_sigma, double* scale) {
  const Measurement& m = data.rows[row];
  double mean_sigma = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double sigma_mm = m.sigma_m[k] > 0.0 ? 1e3 * m.sigma_m[k] : noise_mm;
    scale[k] = any_sigma ? 1.0 / sigma_mm : 1.0;
    mean_sigma += sigma_mm / 3.0;
  }
  const double sigma_rotation_mm =
      m.sigma_rotation_rad > 0.0 ? data.rotation_lever_mm * m.sigma_rotation_rad : mean_sigma;
  for (std::size_t k = 3; k < max_row_residuals; ++k) scale[k] = any_sigma ? 1.0 / sigma_rotation_mm : 1.0;
}

double chi_median(std::size_t count) { return count == 1 ? 0.674490 : count == 3 ? 1.538172 : 2.312596; }

double standard_error_norm(const double* scaled_residual, std::size_t count) {
  double sum = 0.0;
  for (std::size_t k = 0; k < count; ++k) sum += scaled_residual[k] * scaled_residual[k];
  return std::sqrt(sum) / chi_median(count);
}

std::vector<Triangle> linearise(const MeasurementModel& model, const Dataset& data, const Selection& selection,
                                const Layout& layout, double noise_mm, std::vector<double>* error_norms) {
  const std::size_t n = layout.columns();
  const bool any_sigma = states_sigma(data);
  std::vector<Triangle> triangles(selection.folds, Triangle(n));
  std::vector<double> jacobian(max_row_residuals * n);
  if (error_norms != nullptr) error_norms->assign(selection.rows.size(), 0.0);
  for (std::size_t i = 0; i < selection.rows.size(); ++i) {
    const std::size_t row = selection.rows[i];
    double residual[max_row_residuals];
    double scale[max_row_residuals];
    const std::size_t count = model.residual(data, row, layout, residual, jacobian.data(), n);
    residual_scale(data, row, noise_mm, any_sigma, scale);
    const double root = selection.robust_weight.empty() ? 1.0 : std::sqrt(selection.robust_weight[i]);
    Triangle& triangle = triangles[selection.fold.empty() ? 0 : selection.fold[i]];
    for (std::size_t k = 0; k < count; ++k) {
      triangle.add_row(jacobian.data() + k * n, residual[k], scale[k] * root);
      residual[k] *= scale[k];
    }
    if (error_norms != nullptr) (*error_norms)[i] = standard_error_norm(residual, count);
  }
  return triangles;
}

double evaluate(const MeasurementModel& model, const Dataset& data, const Selection& selection, double noise_mm,
                std::vector<double>* error_norms) {
  const bool any_sigma = states_sigma(data);
  double sum = 0.0;
  if (error_norms != nullptr) error_norms->assign(selection.rows.size(), 0.0);
  for (std::size_t i = 0; i < selection.rows.size(); ++i) {
    const std::size_t row = selection.rows[i];
    double residual[max_row_residuals];
    double scale[max_row_residuals];
    const std::size_t count = model.residual(data, row, residual);
    residual_scale(data, row, noise_mm, any_sigma, scale);
    const double weight = selection.robust_weight.empty() ? 1.0 : selection.robust_weight[i];
    for (std::size_t k = 0; k < count; ++k) {
      residual[k] *= scale[k];
      sum += weight * residual[k] * residual[k];
    }
    if (error_norms != nullptr) (*error_norms)[i] = standard_error_norm(residual, count);
  }
  return sum;
}

}  // namespace mdhcal::offline
