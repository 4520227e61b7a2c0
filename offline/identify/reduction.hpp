// SPDX-License-Identifier: MIT
// Blocked orthogonal reduction: however many rows there are, what a least-squares solution needs of them is one small
// triangle, and triangles of parts add up to the triangle of the whole. Folds and sweeps then never touch rows again.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <vector>

#include "offline/identify/model.hpp"

namespace mdhcal::offline {

/// The triangle of rows [J | r]: upper triangular with |J x + r| = |T [x; 1]| for every x (Householder, in blocks).
class Triangle {
 public:
  explicit Triangle(std::size_t unknowns);

  /// Adds one row of `unknowns` coefficients and its residual, both times `weight`.
  void add_row(const double* coefficients, double residual, double weight);
  /// Adds the rows behind another triangle, each times `factor`.
  void add(const Triangle& other, double factor = 1.0);

  /// (unknowns + 1) square, upper triangular. Reduces what is still buffered first.
  const Eigen::MatrixXd& matrix();
  /// Scalar rows of non-zero weight that went in.
  std::size_t row_count() const { return row_count_; }
  std::size_t unknowns() const { return static_cast<std::size_t>(triangle_.cols()) - 1; }

 private:
  void reduce();

  Eigen::MatrixXd triangle_;
  Eigen::MatrixXd block_;
  Eigen::Index filled_ = 0;
  std::size_t row_count_ = 0;
};

/// What the rows of one pose have in common: their position errors are the sum of one error of the pose, one of the pose and
/// target, and one of the row, each with the same variance on every axis. Shares of the variance of one row, in all below 1.
struct SharedError {
  double by_pose = 0;     ///< the arm's error there that the model does not hold
  double by_target = 0;   ///< what repeats of one target share besides

  double own() const { return 1.0 - by_pose - by_target; }
  bool any() const { return by_pose > 0.0 || by_target > 0.0; }
};

/// The rows of a dataset that take part in a fit, their folds and their weights.
struct Selection {
  std::vector<std::size_t> rows;         ///< indices into Dataset::rows
  std::vector<std::uint32_t> fold;       ///< one a selected row; empty: one fold
  std::uint32_t folds = 1;
  std::vector<double> robust_weight;     ///< one a selected row, 0 ... 1; empty: all 1
  std::vector<std::uint32_t> pose;       ///< one a selected row; empty: each row is its own pose
  SharedError shared;                    ///< of the rows of one pose
};

/// Scale of each scalar residual of a row: 1 / sigma where the file states sigma (per axis), else 1 if no row of the
/// dataset states one and 1 / noise_mm if others do. Multiplies residuals in mm. A rotation whose sigma is not stated
/// takes the mean of its position's through the dataset's lever.
void residual_scale(const Dataset& data, std::size_t row, double noise_mm, bool any_sigma, double* scale);
bool states_sigma(const Dataset& data);
/// Mean over the rows and axes of the stated standard deviation, `noise_mm` where none is stated [mm].
double mean_sigma_mm(const Dataset& data, const std::vector<std::size_t>& rows, double noise_mm);

/// Median of the norm of `count` standard normal numbers (chi distribution); count is 1, 3 or 6.
double chi_median(std::size_t count);

/// Standardised error of one row from its scaled residuals: the norm, divided by the median that the norm of as many
/// standard normal numbers has, so that rows of all kinds compare, and its median over good rows is one axis's sigma.
double standard_error_norm(const double* scaled_residual, std::size_t count);

/// Linearises at the model: one triangle a fold, of rows scaled by residual_scale() and the root of the robust weight. Rows
/// that share errors are whitened together (whiten() in shared_error.hpp); no pose may lie in two folds.
/// `error_norms`, if not null, receives standard_error_norm() of each selected row.
std::vector<Triangle> linearise(const MeasurementModel& model, const Dataset& data, const Selection& selection,
                                const Layout& layout, double noise_mm, std::vector<double>* error_norms = nullptr);

/// Only the residuals: standard_error_norm() of each selected row; returns the weighted sum of squares, whitened likewise.
double evaluate(const MeasurementModel& model, const Dataset& data, const Selection& selection, double noise_mm,
                std::vector<double>* error_norms = nullptr);

}  // namespace mdhcal::offline
