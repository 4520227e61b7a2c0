// SPDX-License-Identifier: MIT
#include "offline/identify/families/family_fit.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

#include "offline/base/distributions.hpp"
#include "offline/identify/factorization.hpp"
#include "offline/identify/robust.hpp"
#include "offline/identify/tikhonov.hpp"

namespace mdhcal::offline {

namespace {

// Sound caps of the prior standard deviations: 30 mm or mrad of geometry, 3 mrad a metre of gravity's lever ... (terms),
// 0.15 mrad an order, beyond which rows outside the readings seen ran away.
constexpr double most_geometry = 30.0;
constexpr double most_gravity = 10.0;
constexpr double most_order = 0.15;

std::vector<Eigen::Index> columns_of(const FamilyRows& rows, const FamilyChoice& choice) {
  std::vector<Eigen::Index> out;
  for (std::size_t c = 0; c < rows.family.size(); ++c) {
    const bool in = rows.family[c] == TermFamily::geometry || (rows.family[c] == TermFamily::gravity && choice.gravity) ||
                    (rows.order[c] > 0 && rows.order[c] <= choice.orders);
    if (in) out.push_back(static_cast<Eigen::Index>(c));
  }
  return out;
}

// The weighted rows with the frames projected out, and what their step takes.
struct Projection {
  ProjectedRows rows;
  Eigen::MatrixXd triangle;         // of the frames' independent columns
  std::vector<Eigen::Index> frames; // those columns
  Eigen::MatrixXd above;            // columns in the rows that the frames reach
  Eigen::VectorXd above_y;
};

Projection project(const FamilyRows& rows, const std::vector<std::size_t>& cells, const std::vector<double>& weight,
                   const std::vector<Eigen::Index>& columns) {
  Eigen::Index n = 0;
  for (const std::size_t c : cells) n += weight[c] > 0.0 ? rows.cells[c].count : 0;
  const Eigen::Index f = rows.frames.cols();
  const auto p = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd frames(n, f);
  Eigen::MatrixXd all(n, p + 1);
  const Eigen::VectorXd y = rows.columns(Eigen::all, columns) * rows.x0(columns) - rows.residual;
  Eigen::Index next = 0;
  for (const std::size_t c : cells) {
    if (!(weight[c] > 0.0)) continue;
    const Cell& cell = rows.cells[c];
    const double root = std::sqrt(weight[c]);
    frames.middleRows(next, cell.count) = root * rows.frames.middleRows(cell.first, cell.count);
    for (Eigen::Index k = 0; k < p; ++k) {
      all.col(k).segment(next, cell.count) = root * rows.columns.col(columns[static_cast<std::size_t>(k)]).segment(cell.first, cell.count);
    }
    all.col(p).segment(next, cell.count) = root * y.segment(cell.first, cell.count);
    next += cell.count;
  }
  Projection out;
  Eigen::Index rank = 0;
  if (f > 0 && n > 0) {
    const Eigen::VectorXd norms = column_norms(frames);
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(frames * norms.cwiseInverse().asDiagonal());
    qr.setThreshold(jacobian_tolerance);
    rank = qr.rank();
    all.applyOnTheLeft(qr.householderQ().setLength(rank).adjoint());
    out.triangle = qr.matrixR().topLeftCorner(rank, rank).template triangularView<Eigen::Upper>();
    for (Eigen::Index k = 0; k < rank; ++k) {
      out.frames.push_back(qr.colsPermutation().indices()(k));
      out.triangle.col(k) *= norms(out.frames.back());
    }
  }
  out.above = all.topRows(rank).leftCols(p);
  out.above_y = all.topRows(rank).col(p);
  Eigen::MatrixXd rest = all.bottomRows(n - rank);
  if (rest.rows() > p + 1) {
    // What a least-squares solution needs of many rows is their triangle; the rows below it read nothing but noise.
    out.rows.silent = static_cast<double>(rest.rows() - (p + 1));
    Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(rest);
    rest = rest.topRows(p + 1).triangularView<Eigen::Upper>().toDenseMatrix().eval();
  }
  out.rows.columns = rest.leftCols(p);
  out.rows.y = rest.col(p);
  for (const Eigen::Index c : columns) out.rows.family.push_back(rows.family[static_cast<std::size_t>(c)]);
  return out;
}

Eigen::VectorXd step_of(const FamilyRows& rows, const Projection& projection, const FamilySolution& solution,
                        const std::vector<Eigen::Index>& columns) {
  const Eigen::Index f = rows.frames.cols();
  Eigen::VectorXd step = Eigen::VectorXd::Zero(f + rows.columns.cols());
  for (std::size_t k = 0; k < columns.size(); ++k) {
    step(f + columns[k]) = solution.u(static_cast<Eigen::Index>(k)) - rows.x0(columns[k]);
  }
  const Eigen::VectorXd b = projection.triangle.triangularView<Eigen::Upper>().solve(projection.above_y - projection.above * solution.u);
  for (std::size_t k = 0; k < projection.frames.size(); ++k) step(projection.frames[k]) = b(static_cast<Eigen::Index>(k));
  return step;
}

// Posterior covariance: D - D A^T A D of the coefficients, A = L^-1 G, D their priors; frames follow with their own noise.
Covariance posterior(const FamilyRows& rows, const Projection& projection, const FamilySolution& solution,
                     const std::vector<Eigen::Index>& columns, double freedom) {
  const Eigen::Index f = rows.frames.cols();
  const auto p = static_cast<Eigen::Index>(columns.size());
  Eigen::VectorXd prior(p);
  for (Eigen::Index k = 0; k < p; ++k) {
    prior(k) = std::pow(solution.variances.sd[static_cast<std::size_t>(projection.rows.family[static_cast<std::size_t>(k)])], 2);
  }
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(p, p);
  const Eigen::MatrixXd scaled = solution.whitened * prior.asDiagonal();
  spread.selfadjointView<Eigen::Lower>().rankUpdate(scaled.transpose(), -1.0);
  spread.diagonal() += prior;
  spread = Eigen::MatrixXd(spread.selfadjointView<Eigen::Lower>());
  const auto rank = static_cast<Eigen::Index>(projection.frames.size());
  const Eigen::MatrixXd inverse = projection.triangle.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(rank, rank));
  const Eigen::MatrixXd follow = -inverse * projection.above;
  const Eigen::MatrixXd across = follow * spread;
  const double noise2 = solution.variances.noise * solution.variances.noise;
  const Eigen::MatrixXd own = noise2 * inverse * inverse.transpose() + across * follow.transpose();

  Covariance out;
  out.size = static_cast<std::size_t>(f + rows.columns.cols());
  out.value.assign(out.size * out.size, 0.0);
  Eigen::Map<Eigen::MatrixXd> value(out.value.data(), f + rows.columns.cols(), f + rows.columns.cols());
  std::vector<Eigen::Index> at(columns.size());
  for (std::size_t k = 0; k < at.size(); ++k) at[k] = f + columns[k];
  value(at, at) = spread;
  value(projection.frames, projection.frames) = own;
  value(projection.frames, at) = across;
  value(at, projection.frames) = across.transpose();
  out.sigma = solution.variances.noise;
  out.freedom = std::max(1.0, freedom);
  out.coverage_factor = student_975(std::max(3.0, freedom));
  return out;
}

}  // namespace

std::string name(const FamilyChoice& choice) {
  const std::string functions = choice.orders == 0 ? "" : choice.orders == 1 ? "joint functions of order 1" : "joint functions";
  if (!choice.gravity) return functions.empty() ? "geometry alone" : functions;
  return functions.empty() ? "gravity" : "gravity and " + functions;
}

Eigen::VectorXd residual_after(const FamilyRows& rows, const Eigen::VectorXd& step) {
  return rows.residual + rows.frames * step.head(rows.frames.cols()) + rows.columns * step.tail(rows.columns.cols());
}

FamilyFit fit_families(const FamilyRows& rows, const std::vector<bool>& use, const FamilyChoice& choice, const FamilyFit& start,
                       const FamilyFitControl& control, bool with_covariance) {
  const std::vector<Eigen::Index> columns = columns_of(rows, choice);
  std::vector<std::size_t> cells;
  for (std::size_t c = 0; c < rows.cells.size(); ++c) {
    if (use.empty() || use[c]) cells.push_back(c);
  }
  VarianceBounds bounds;
  bounds.most = {most_geometry, most_gravity, most_order, most_order, most_order, most_order};
  bounds.least_noise = control.floor;

  FamilyFit out;
  out.variances = start.variances;
  out.weight = start.weight.empty() ? std::vector<double>(rows.cells.size(), 1.0) : start.weight;
  for (int round = 0; round < control.rounds; ++round) {
    const Projection projection = project(rows, cells, out.weight, columns);
    bool still = false;
    const FamilySolution solution = maximise_likelihood(projection.rows, out.variances, bounds, control.steps, &still);
    out.variances = solution.variances;
    out.log_likelihood = solution.log_likelihood;
    out.step = step_of(rows, projection, solution, columns);
    const Eigen::VectorXd left = residual_after(rows, out.step);
    out.error_norm.resize(rows.cells.size());
    for (std::size_t c = 0; c < rows.cells.size(); ++c) {
      out.error_norm[c] = standard_error_norm(left.data() + rows.cells[c].first, static_cast<std::size_t>(rows.cells[c].count));
    }
    std::vector<double> used;
    double scalars = 0.0;
    for (const std::size_t c : cells) {
      used.push_back(out.error_norm[c]);
      scalars += out.weight[c] > 0.0 ? static_cast<double>(rows.cells[c].count) : 0.0;
    }
    out.parameters_used = static_cast<double>(projection.frames.size()) + solution.effective_parameters;
    const double freedom = scalars - out.parameters_used;
    out.scale = robust_scale(used, scalars > out.parameters_used * 9.0 / 8.0 ? std::sqrt(scalars / freedom) : 3.0, control.floor);
    std::vector<double> weight(rows.cells.size(), 1.0);
    if (control.robust) {
      const Loss loss = round == 0 && start.weight.empty() ? Loss::huber : Loss::tukey;
      weight = robust_weights(loss, out.error_norm, out.scale);
    }
    double change = 0.0;
    for (const std::size_t c : cells) change = std::max(change, std::fabs(weight[c] - out.weight[c]));
    out.settled = still && change < 0.05;
    const bool last = out.settled || round + 1 == control.rounds;
    if (last && with_covariance) out.covariance = posterior(rows, projection, solution, columns, freedom);
    if (last) break;
    out.weight = std::move(weight);
  }
  return out;
}

}  // namespace mdhcal::offline
