// SPDX-License-Identifier: MIT
#include "offline/identify/factorization.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>

namespace mdhcal::offline {

Eigen::VectorXd singular_values(const Eigen::MatrixXd& a) {
  return Eigen::BDCSVD<Eigen::MatrixXd>(a).singularValues();
}

SingularVectors thin_svd(const Eigen::MatrixXd& a) {
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

SingularVectors full_svd(const Eigen::MatrixXd& a) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

LeastSquares least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double tolerance) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(tolerance);
  solver.compute(a);
  return {solver.solve(b), solver.rank()};
}

}  // namespace mdhcal::offline
