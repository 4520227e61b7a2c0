// SPDX-License-Identifier: MIT
#include "offline/identify/reduction.hpp"

#include <cmath>

#include "offline/identify/shared_error.hpp"

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

namespace {

constexpr std::size_t position_axes = 3;

// The rows of one pose, axis by axis: scaled residuals in the last column, and before it their Jacobian if `layout` is given.
std::array<Eigen::MatrixXd, position_axes> rows_of_pose(const MeasurementModel& model, const Dataset& data, const Selection& selection,
                                                         const Layout* layout, double noise_mm, bool any_sigma, const PoseBlock& block) {
  const std::size_t n = layout != nullptr ? layout->columns() : 0;
  std::array<Eigen::MatrixXd, position_axes> out;
  for (Eigen::MatrixXd& axis : out) axis.resize(static_cast<Eigen::Index>(block.selected.size()), static_cast<Eigen::Index>(n) + 1);
  std::vector<double> jacobian(max_row_residuals * n);
  for (std::size_t i = 0; i < block.selected.size(); ++i) {
    const std::size_t row = selection.rows[block.selected[i]];
    double residual[max_row_residuals];
    double scale[max_row_residuals];
    if (layout != nullptr) model.residual(data, row, *layout, residual, jacobian.data(), n);
    else model.residual(data, row, residual);
    residual_scale(data, row, noise_mm, any_sigma, scale);
    for (std::size_t k = 0; k < position_axes; ++k) {
      auto line = out[k].row(static_cast<Eigen::Index>(i));
      for (std::size_t c = 0; c < n; ++c) line(static_cast<Eigen::Index>(c)) = scale[k] * jacobian[k * n + c];
      line(static_cast<Eigen::Index>(n)) = scale[k] * residual[k];
    }
  }
  return out;
}

// Where a row's own entries begin that no pose shares: rotations of a full pose; all of a distance.
std::size_t first_unshared(const Selection& selection, const Measurement& m) {
  return selection.shared.any() && m.kind != MeasurementKind::distance ? position_axes : 0;
}

}  // namespace

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
    for (std::size_t k = first_unshared(selection, data.rows[row]); k < count; ++k) {
      triangle.add_row(jacobian.data() + k * n, residual[k], scale[k] * root);
    }
    for (std::size_t k = 0; k < count; ++k) residual[k] *= scale[k];
    if (error_norms != nullptr) (*error_norms)[i] = standard_error_norm(residual, count);
  }
  if (!selection.shared.any()) return triangles;
  std::vector<double> line(n);
  for (const PoseBlock& block : pose_blocks(data, selection)) {
    Triangle& triangle = triangles[selection.fold.empty() ? 0 : selection.fold[block.selected.front()]];
    for (Eigen::MatrixXd& axis : rows_of_pose(model, data, selection, &layout, noise_mm, any_sigma, block)) {
      whiten(selection.shared, block, selection.robust_weight, axis);
      for (Eigen::Index i = 0; i < axis.rows(); ++i) {
        for (std::size_t c = 0; c < n; ++c) line[c] = axis(i, static_cast<Eigen::Index>(c));
        triangle.add_row(line.data(), axis(i, axis.cols() - 1), 1.0);
      }
    }
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
    for (std::size_t k = 0; k < count; ++k) residual[k] *= scale[k];
    for (std::size_t k = first_unshared(selection, data.rows[row]); k < count; ++k) sum += weight * residual[k] * residual[k];
    if (error_norms != nullptr) (*error_norms)[i] = standard_error_norm(residual, count);
  }
  if (!selection.shared.any()) return sum;
  for (const PoseBlock& block : pose_blocks(data, selection)) {
    for (Eigen::MatrixXd& axis : rows_of_pose(model, data, selection, nullptr, noise_mm, any_sigma, block)) {
      whiten(selection.shared, block, selection.robust_weight, axis);
      sum += axis.squaredNorm();
    }
  }
  return sum;
}

}  // namespace mdhcal::offline
