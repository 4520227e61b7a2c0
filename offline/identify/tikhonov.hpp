// SPDX-License-Identifier: MIT
// The regularized linear problem: base and targets projected out, parameters in units of their prior, rank decided,
// then everything that depends on lambda is a few filter factors.
#pragma once

#include <Eigen/Core>

#include <cstddef>

namespace mdhcal::offline {

/// min |A x - b|^2 + lambda |x|^2 through the singular values of A: x(lambda) = V diag(s / (s^2 + lambda)) beta.
struct SpectralProblem {
  Eigen::VectorXd s;         ///< singular values above the rank tolerance, descending; rank = s.size()
  Eigen::VectorXd beta;      ///< U^T b, as many
  Eigen::MatrixXd v;         ///< right singular vectors of those, one a column
  double outside2 = 0;       ///< |b|^2 outside the range of A: no x reaches it
  std::size_t data_count = 0;///< scalar rows behind A, less the unpenalised unknowns that were projected out

  Eigen::Index rank() const { return s.size(); }
  Eigen::VectorXd solution(double lambda) const;
  double solution_norm2(double lambda) const;
  double residual_norm2(double lambda) const;
  double effective_parameters(double lambda) const;  ///< sum of s^2 / (s^2 + lambda)
  double smallest_lambda() const;                    ///< (s_r / 3)^2: the lower bound of every search
  double largest_lambda() const;                     ///< s_1^2: the upper bound
};

/// From A and b. Directions whose singular value, after the columns of A are scaled to unit length, is below
/// `rank_tolerance` times the largest are cut.
SpectralProblem spectral_problem(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, double rank_tolerance);

/// The Jacobian's own relative error: rounding in a product of eight frames and in the reduction is some 1e-14; a
/// direction below 1e-10 of the largest carries no information from any measurement.
inline constexpr double jacobian_tolerance = 1e-10;

/// Lengths of the columns, to scale them to unit length. A column that is rounding beside the longest (or beside
/// `largest`, the longest of the whole system) is divided by that instead: scaled up, it would pass for information.
Eigen::VectorXd column_norms(const Eigen::MatrixXd& a, double largest = 0.0);

/// A triangle taken apart: frames (base, targets) first, then the geometry.
struct ReducedSystem {
  Eigen::MatrixXd frame;             ///< frame rows, frame columns
  Eigen::MatrixXd frame_by_geometry; ///< frame rows, geometry columns
  Eigen::VectorXd frame_residual;
  Eigen::MatrixXd geometry;          ///< rows on which the frames have no influence, geometry columns
  Eigen::VectorXd geometry_residual;
  double outside2 = 0;               ///< squared residual that no unknown influences (to first order)
  Eigen::Index frame_rank = 0;
  double largest_column = 0;         ///< length of the longest column, frames and geometry
  std::size_t row_count = 0;
};

/// `matrix` is Triangle::matrix(). Where the frames' columns are rank-deficient, the rows that they do not reach are
/// handed to the geometry.
ReducedSystem reduce_frames(const Eigen::MatrixXd& matrix, std::size_t frame_columns, std::size_t row_count);

/// The penalised problem in the total deviation x (not the step), linearised at the deviation `x0`.
SpectralProblem penalised_problem(const ReducedSystem& system, const Eigen::VectorXd& x0);

/// The step of base and targets that belongs to the geometry's step (least norm where they are rank-deficient).
Eigen::VectorXd frame_step(const ReducedSystem& system, const Eigen::VectorXd& geometry_step);

/// Levenberg-Marquardt step of all unknowns: the regularized step with `damping` times the squared, column-scaled
/// step added; through a QR of the stacked system. damping > 0.
Eigen::VectorXd damped_step(const Eigen::MatrixXd& matrix, std::size_t frame_columns, const Eigen::VectorXd& x0,
                            double lambda, double damping);

}  // namespace mdhcal::offline
