// SPDX-License-Identifier: MIT
#include "offline/identify/tikhonov.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

#include "offline/identify/factorization.hpp"

namespace mdhcal::offline {

namespace {

Eigen::Index rank_of(const Eigen::VectorXd& singular_values, double tolerance) {
  if (singular_values.size() == 0) return 0;
  const double limit = tolerance * singular_values(0);
  Eigen::Index rank = 0;
  while (rank < singular_values.size() && singular_values(rank) > limit) ++rank;
  return rank;
}

}  // namespace

Eigen::VectorXd column_norms(const Eigen::MatrixXd& a, double largest) {
  Eigen::VectorXd norms = a.colwise().norm().transpose();
  if (norms.size() == 0) return norms;
  largest = std::max(largest, norms.maxCoeff());
  for (double& n : norms) {
    if (!(n > jacobian_tolerance * largest)) n = largest > 0.0 ? largest : 1.0;
  }
  return norms;
}

Eigen::VectorXd SpectralProblem::solution(double lambda) const {
  return v * (s.array() / (s.array().square() + lambda) * beta.array()).matrix();
}

double SpectralProblem::solution_norm2(double lambda) const {
  return (s.array() / (s.array().square() + lambda) * beta.array()).square().sum();
}

double SpectralProblem::residual_norm2(double lambda) const {
  return (lambda / (s.array().square() + lambda) * beta.array()).square().sum() + outside2;
}

double SpectralProblem::effective_parameters(double lambda) const {
  return (s.array().square() / (s.array().square() + lambda)).sum();
}

double SpectralProblem::smallest_lambda() const {
  const double last = rank() > 0 ? s(rank() - 1) / 3.0 : 1.0;
  return last * last;
}

double SpectralProblem::largest_lambda() const { return rank() > 0 ? s(0) * s(0) : 1.0; }

SpectralProblem spectral_problem(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, double rank_tolerance) {
  SpectralProblem out;
  out.data_count = static_cast<std::size_t>(a.rows());
  const double b2 = b.squaredNorm();
  if (a.cols() == 0 || a.rows() == 0 || !(a.squaredNorm() > 0.0)) {
    out.s.resize(0);
    out.beta.resize(0);
    out.v.resize(a.cols(), 0);
    out.outside2 = b2;
    return out;
  }
  // Rank is judged with unit columns, so that the choice of units and priors has no part in it.
  const Eigen::MatrixXd scaled = a * column_norms(a).cwiseInverse().asDiagonal();
  const Eigen::Index rank = rank_of(singular_values(scaled), rank_tolerance);

  const SingularVectors svd = thin_svd(a);
  out.s = svd.s.head(rank);
  out.v = svd.v.leftCols(rank);
  out.beta = svd.u.leftCols(rank).transpose() * b;
  out.outside2 = std::max(0.0, b2 - out.beta.squaredNorm());
  return out;
}

ReducedSystem reduce_frames(const Eigen::MatrixXd& matrix, std::size_t frame_columns, std::size_t row_count) {
  const auto frames = static_cast<Eigen::Index>(frame_columns);
  const Eigen::Index n = matrix.cols() - 1;
  const Eigen::Index parameters = n - frames;
  ReducedSystem out;
  out.row_count = row_count;
  out.outside2 = matrix(n, n) * matrix(n, n);
  out.frame = matrix.topLeftCorner(frames, frames);
  out.frame_by_geometry = matrix.block(0, frames, frames, parameters);
  out.frame_residual = matrix.col(n).head(frames);
  out.geometry = matrix.block(frames, frames, parameters, parameters);
  out.geometry_residual = matrix.col(n).segment(frames, parameters);
  out.frame_rank = frames;
  if (frames == 0) return out;

  out.largest_column = matrix.topLeftCorner(n, n).colwise().norm().maxCoeff();
  const Eigen::VectorXd norms = column_norms(out.frame, out.largest_column);
  const Eigen::MatrixXd scaled = out.frame * norms.cwiseInverse().asDiagonal();
  const SingularVectors svd = full_svd(scaled);
  out.frame_rank = rank_of(svd.s, jacobian_tolerance);
  const Eigen::Index lost = frames - out.frame_rank;
  if (lost == 0) return out;
  const Eigen::MatrixXd turned = svd.u.transpose() * out.frame_by_geometry;
  const Eigen::VectorXd turned_residual = svd.u.transpose() * out.frame_residual;
  Eigen::MatrixXd geometry(parameters + lost, parameters);
  geometry << out.geometry, turned.bottomRows(lost);
  Eigen::VectorXd residual(parameters + lost);
  residual << out.geometry_residual, turned_residual.tail(lost);
  out.geometry = std::move(geometry);
  out.geometry_residual = std::move(residual);
  return out;
}

SpectralProblem penalised_problem(const ReducedSystem& system, const Eigen::VectorXd& x0) {
  const Eigen::VectorXd b = system.geometry * x0 - system.geometry_residual;
  SpectralProblem out = spectral_problem(system.geometry, b, jacobian_tolerance);
  out.outside2 += system.outside2;
  const auto rank = static_cast<std::size_t>(system.frame_rank);
  out.data_count = system.row_count > rank ? system.row_count - rank : 0;
  return out;
}

Eigen::VectorXd frame_step(const ReducedSystem& system, const Eigen::VectorXd& geometry_step) {
  if (system.frame.cols() == 0) return Eigen::VectorXd(0);
  const Eigen::VectorXd target = -(system.frame_residual + system.frame_by_geometry * geometry_step);
  const Eigen::VectorXd norms = column_norms(system.frame, system.largest_column);
  const Eigen::MatrixXd scaled = system.frame * norms.cwiseInverse().asDiagonal();
  return norms.cwiseInverse().asDiagonal() * least_squares(scaled, target, jacobian_tolerance).x;
}

Eigen::VectorXd damped_step(const Eigen::MatrixXd& matrix, std::size_t frame_columns, const Eigen::VectorXd& x0,
                            double lambda, double damping) {
  const Eigen::Index n = matrix.cols() - 1;
  const auto frames = static_cast<Eigen::Index>(frame_columns);
  const Eigen::Index parameters = n - frames;
  const Eigen::VectorXd norms = column_norms(matrix.topLeftCorner(n, n));
  Eigen::MatrixXd stacked = Eigen::MatrixXd::Zero(2 * n + parameters, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * n + parameters);
  stacked.topRows(n) = matrix.topLeftCorner(n, n);
  right.head(n) = -matrix.col(n).head(n);
  stacked.block(n, frames, parameters, parameters).diagonal().setConstant(std::sqrt(lambda));
  right.segment(n, parameters) = -std::sqrt(lambda) * x0;
  stacked.bottomRows(n).diagonal() = std::sqrt(damping) * norms;
  return Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(stacked).solve(right);
}

}  // namespace mdhcal::offline
