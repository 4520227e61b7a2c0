// SPDX-License-Identifier: MIT
// The orthogonal factorizations of this program, compiled once: their templates were a tenth of the build's time.
#pragma once

#include <Eigen/Core>

namespace mdhcal::offline {

/// a = u diag(s) v^T, s descending.
struct SingularVectors {
  Eigen::MatrixXd u;
  Eigen::VectorXd s;
  Eigen::MatrixXd v;
};

/// Singular values alone, descending, by divide and conquer; for any shape that is not empty.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& a);

/// By divide and conquer: with k = min(rows, columns), u is rows x k and v columns x k.
SingularVectors thin_svd(const Eigen::MatrixXd& a);

/// By two-sided Jacobi, the more accurate for small singular values: u and v are square, so that their last columns
/// span what a does not reach and does not see.
SingularVectors full_svd(const Eigen::MatrixXd& a);

/// The shortest of the x that minimise |a x - b|, one a column of b, by a complete orthogonal decomposition.
struct LeastSquares {
  Eigen::MatrixXd x;
  Eigen::Index rank = 0;  ///< columns of a whose pivot is above `tolerance` times the largest
};
LeastSquares least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double tolerance);

}  // namespace mdhcal::offline
