// SPDX-License-Identifier: MIT
#include "offline/plan/design.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

#include "offline/identify/factorization.hpp"

namespace mdhcal::offline {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// E-optimality: this many candidates, best by the weakest directions, are tried exactly. More changed no design tried.
constexpr std::size_t shortlist = 30;
// An exchange must better the criterion by more than rounding.
constexpr double least_gain = 1e-9;

MatrixXd upper_factor(const MatrixXd& stacked) {
  const Eigen::HouseholderQR<MatrixXd> qr(stacked);
  return qr.matrixQR().topRows(stacked.cols()).triangularView<Eigen::Upper>();
}

auto rows_of(const Experiment& experiment, std::size_t candidate) {
  return experiment.rows.middleRows(static_cast<Index>(candidate) * experiment.rows_per_pose,
                                    experiment.rows_per_pose);
}

// Predictions whose summed variance a linear criterion makes small, applied to R^-1.
MatrixXd spread(const Experiment& experiment, Criterion criterion, const MatrixXd& factor) {
  const Index n = factor.cols();
  MatrixXd of_interest;
  if (criterion == Criterion::a) {
    of_interest = MatrixXd::Identity(n, n).bottomRows(n - experiment.of_interest);
  } else {
    of_interest = experiment.targets;
  }
  return factor.transpose().triangularView<Eigen::Lower>().solve(of_interest.transpose());
}

// How much each candidate would better the criterion (not for e).
VectorXd gains(const Experiment& experiment, Criterion criterion, const MatrixXd& factor) {
  // V = R^-T J^T, and G = V^T V block by block: M + J^T J = R^T (I + V V^T) R.
  const MatrixXd v = factor.transpose().triangularView<Eigen::Lower>().solve(experiment.rows.transpose());
  MatrixXd b;
  if (criterion != Criterion::d) b = spread(experiment, criterion, factor).transpose() * v;
  const Index m = experiment.rows_per_pose;
  VectorXd gain(static_cast<Index>(experiment.candidates()));
  for (Index c = 0; c < gain.size(); ++c) {
    const auto block = v.middleCols(c * m, m);
    const MatrixXd g = MatrixXd::Identity(m, m) + block.transpose() * block;
    const Eigen::LLT<MatrixXd> llt(g);
    if (criterion == Criterion::d) {
      gain[c] = 2 * MatrixXd(llt.matrixL()).diagonal().array().log().sum();
    } else {
      gain[c] = llt.matrixL().solve(b.middleCols(c * m, m).transpose()).squaredNorm();
    }
  }
  return gain;
}

double smallest_eigenvalue(const MatrixXd& factor) {
  const double s = singular_values(factor)[factor.cols() - 1];
  return s * s;
}

// The best candidate that is not taken, and the criterion's value with it.
std::pair<std::size_t, double> best_addition(const Experiment& experiment, Criterion criterion, const MatrixXd& factor,
                                             const std::vector<bool>& taken) {
  std::size_t best = 0;
  double best_value = -HUGE_VAL;
  if (criterion != Criterion::e) {
    const double now = value(experiment, criterion, factor);
    const VectorXd gain = gains(experiment, criterion, factor);
    for (std::size_t c = 0; c < taken.size(); ++c) {
      if (taken[c] || now + gain[static_cast<Index>(c)] <= best_value) continue;
      best = c;
      best_value = now + gain[static_cast<Index>(c)];
    }
    return {best, best_value};
  }
  const SingularVectors svd = thin_svd(factor);
  const Index weak = std::min<Index>(3, factor.cols());
  const VectorXd s = svd.s.tail(weak);
  const MatrixXd along = experiment.rows * svd.v.rightCols(weak) * s.cwiseInverse().asDiagonal();
  std::vector<std::size_t> order;
  for (std::size_t c = 0; c < taken.size(); ++c) {
    if (!taken[c]) order.push_back(c);
  }
  const auto score = [&](std::size_t c) {
    return along.middleRows(static_cast<Index>(c) * experiment.rows_per_pose, experiment.rows_per_pose).squaredNorm();
  };
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(std::min(shortlist, order.size()));
  std::partial_sort(order.begin(), end, order.end(), [&](std::size_t a, std::size_t b) {
    const double sa = score(a), sb = score(b);
    return sa > sb || (!(sa < sb) && a < b);
  });
  for (auto c = order.begin(); c != end; ++c) {
    MatrixXd stacked(factor.rows() + experiment.rows_per_pose, factor.cols());
    stacked << factor, rows_of(experiment, *c);
    const double with = smallest_eigenvalue(stacked);
    if (with <= best_value) continue;
    best = *c;
    best_value = with;
  }
  return {best, best_value};
}

}  // namespace

MatrixXd information_factor(const Experiment& experiment, const std::vector<std::size_t>& chosen) {
  const Index n = experiment.prior.size(), m = experiment.rows_per_pose;
  MatrixXd stacked(n + m * static_cast<Index>(chosen.size()), n);
  stacked.topRows(n) = experiment.prior.asDiagonal();
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    stacked.middleRows(n + m * static_cast<Index>(i), m) = rows_of(experiment, chosen[i]);
  }
  return upper_factor(stacked);
}

double value(const Experiment& experiment, Criterion criterion, const MatrixXd& factor) {
  switch (criterion) {
    case Criterion::d: return 2 * factor.diagonal().array().abs().log().sum();
    case Criterion::e: return smallest_eigenvalue(factor);
    case Criterion::a:
    case Criterion::position: break;
  }
  return -spread(experiment, criterion, factor).squaredNorm();
}

VectorXd expected_errors(const MatrixXd& rows, Index rows_per_pose, const MatrixXd& factor) {
  const MatrixXd v = factor.transpose().triangularView<Eigen::Lower>().solve(rows.transpose());
  VectorXd errors(rows.rows() / rows_per_pose);
  for (Index c = 0; c < errors.size(); ++c) errors[c] = v.middleCols(c * rows_per_pose, rows_per_pose).norm();
  return errors;
}

std::vector<std::size_t> exchange(const Experiment& stated, Criterion criterion, std::size_t count,
                                  const std::vector<std::size_t>& given, const std::function<void()>& step) {
  // Of the predictions only the sum of their variances counts, and that is in their triangle.
  Experiment experiment = stated;
  if (stated.targets.rows() > stated.targets.cols()) experiment.targets = upper_factor(stated.targets);
  std::vector<bool> taken(experiment.candidates(), false);
  std::vector<std::size_t> all = given;
  for (const std::size_t c : given) taken[c] = true;
  const auto add_best = [&] {
    const std::size_t c = best_addition(experiment, criterion, information_factor(experiment, all), taken).first;
    all.push_back(c);
    taken[c] = true;
    if (step) step();
  };
  for (std::size_t i = 0; i < count; ++i) add_best();

  // Each sweep tries every chosen pose once; the criterion only grows, so it ends, and 50 sweeps were never seen.
  for (int sweep = 0; sweep < 50; ++sweep) {
    bool exchanged = false;
    for (std::size_t i = given.size(); i < all.size(); ++i) {
      const double now = value(experiment, criterion, information_factor(experiment, all));
      std::vector<std::size_t> others = all;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      const auto [best, with] = best_addition(experiment, criterion, information_factor(experiment, others), taken);
      if (step) step();
      if (with <= now + least_gain * std::abs(now)) continue;
      taken[all[i]] = false;
      taken[best] = true;
      all[i] = best;
      exchanged = true;
    }
    if (!exchanged) break;
  }
  return {all.begin() + static_cast<std::ptrdiff_t>(given.size()), all.end()};
}

}  // namespace mdhcal::offline
