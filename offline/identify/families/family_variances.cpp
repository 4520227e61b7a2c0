// SPDX-License-Identifier: MIT
#include "offline/identify/families/family_variances.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <vector>

namespace mdhcal::offline {

namespace {

// A family of which nothing is left: a ten-thousandth of a column's unit.
constexpr double least_sd = 1e-4;

struct Block {
  TermFamily family;
  Eigen::Index first, count;
};

std::vector<Block> blocks_of(const std::vector<TermFamily>& family) {
  std::vector<Block> out;
  for (std::size_t c = 0; c < family.size(); ++c) {
    if (out.empty() || out.back().family != family[c]) out.push_back({family[c], static_cast<Eigen::Index>(c), 0});
    ++out.back().count;
  }
  return out;
}

std::size_t index(TermFamily family) { return static_cast<std::size_t>(family); }

// The logarithms of the standard deviations that are sought: the blocks', then the noise's.
using Logarithms = Eigen::VectorXd;

struct Evaluation {
  double log_likelihood = -HUGE_VAL;
  Eigen::VectorXd gradient;         // by the logarithms
  Eigen::MatrixXd information;      // average of observed and expected
  Eigen::VectorXd score;            // columns^T V^-1 y
  Eigen::VectorXd hat;              // sd^2 times the squared length of each whitened column
  Eigen::MatrixXd whitened;
};

class Likelihood {
 public:
  Likelihood(const ProjectedRows& rows, const std::vector<Block>& blocks) : rows_(rows), blocks_(blocks) {
    const Eigen::Index n = rows.y.size();
    for (const Block& b : blocks) {
      Eigen::MatrixXd product = Eigen::MatrixXd::Zero(n, n);
      product.selfadjointView<Eigen::Lower>().rankUpdate(rows.columns.middleCols(b.first, b.count));
      products_.push_back(std::move(product));
    }
  }

  // V = noise^2 I + sum of sd^2 columns columns^T is what the model says of the rows, not a normal equation of theirs: its
  // condition is that of signal over noise, below 1e10, and the variances are sought to a few per cent.
  Evaluation at(const Logarithms& logarithms) const {
    const Eigen::Index n = rows_.y.size();
    const auto k = static_cast<Eigen::Index>(blocks_.size());
    Evaluation out;
    const double noise2 = std::exp(2.0 * logarithms(k));
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index b = 0; b < k; ++b) {
      covariance.triangularView<Eigen::Lower>() += std::exp(2.0 * logarithms(b)) * products_[static_cast<std::size_t>(b)];
    }
    covariance.diagonal().array() += noise2;
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(covariance);
    if (factor.info() != Eigen::Success) return out;
    const Eigen::VectorXd z = factor.matrixL().solve(rows_.y);
    out.whitened = factor.matrixL().solve(rows_.columns);
    const double squares = z.squaredNorm();
    out.log_likelihood = -0.5 * squares - 0.5 * rows_.silent * std::log(noise2);
    for (Eigen::Index i = 0; i < n; ++i) out.log_likelihood -= std::log(covariance(i, i));

    out.score = out.whitened.transpose() * z;
    out.hat = out.whitened.colwise().squaredNorm().transpose();
    out.gradient.resize(k + 1);
    Eigen::MatrixXd directions(n, k + 1);
    double explained = 0.0, traced = 0.0;
    for (Eigen::Index b = 0; b < k; ++b) {
      const Block& block = blocks_[static_cast<std::size_t>(b)];
      const double sd2 = std::exp(2.0 * logarithms(b));
      const auto score = out.score.segment(block.first, block.count);
      const double s = sd2 * score.squaredNorm();
      const double h = sd2 * out.hat.segment(block.first, block.count).sum();
      out.hat.segment(block.first, block.count) *= sd2;
      explained += s;
      traced += h;
      out.gradient(b) = s - h;
      directions.col(b) = sd2 * (out.whitened.middleCols(block.first, block.count) * score);
    }
    // tr(V^-1 V) = n and y^T V^-1 y = squares leave the noise's share.
    out.gradient(k) = (squares - explained) - (static_cast<double>(n) - traced) - rows_.silent;
    Eigen::VectorXd left = z;
    factor.matrixL().adjoint().solveInPlace(left);
    directions.col(k) = noise2 * factor.matrixL().solve(left);
    out.information = 2.0 * directions.transpose() * directions;
    return out;
  }

 private:
  const ProjectedRows& rows_;
  const std::vector<Block>& blocks_;
  std::vector<Eigen::MatrixXd> products_;
};

}  // namespace

FamilySolution maximise_likelihood(const ProjectedRows& rows, const FamilyVariances& start, const VarianceBounds& bounds, int steps,
                                   bool* settled) {
  const std::vector<Block> blocks = blocks_of(rows.family);
  const auto k = static_cast<Eigen::Index>(blocks.size());
  Logarithms low(k + 1), high(k + 1), now(k + 1);
  for (Eigen::Index b = 0; b < k; ++b) {
    const std::size_t f = index(blocks[static_cast<std::size_t>(b)].family);
    low(b) = std::log(least_sd);
    high(b) = std::log(bounds.most[f]);
    now(b) = std::log(std::max(start.sd[f], least_sd));
  }
  low(k) = std::log(bounds.least_noise);
  high(k) = HUGE_VAL;
  now(k) = std::log(start.noise);
  now = now.cwiseMax(low).cwiseMin(high);

  const Likelihood likelihood(rows, blocks);
  Evaluation here = likelihood.at(now);
  bool still = false;
  for (int step = 0; step < steps && !still; ++step) {
    // Those at a bound that the gradient would cross stay there.
    std::vector<Eigen::Index> free;
    for (Eigen::Index b = 0; b <= k; ++b) {
      const bool held = (now(b) <= low(b) && here.gradient(b) < 0.0) || (now(b) >= high(b) && here.gradient(b) > 0.0);
      if (!held) free.push_back(b);
    }
    Eigen::MatrixXd information = here.information(free, free);
    information.diagonal().array() += 1.0;  // one observation's worth: keeps a family of which the rows say nothing in place
    const Eigen::VectorXd change = Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(information).solve(here.gradient(free));
    Logarithms next = now;
    for (std::size_t i = 0; i < free.size(); ++i) {
      // A family is given up or taken up by not more than a factor of three a step.
      next(free[i]) += std::clamp(change(static_cast<Eigen::Index>(i)), -1.1, 1.1);
    }
    Evaluation there;
    for (int attempt = 0; attempt < 4; ++attempt) {
      next = next.cwiseMax(low).cwiseMin(high);
      there = likelihood.at(next);
      if (there.log_likelihood >= here.log_likelihood - 1e-3) break;
      next = now + 0.25 * (next - now);
    }
    if (!(there.log_likelihood >= here.log_likelihood - 1e-3)) break;
    // Of a family that is nearly gone the size does not matter.
    still = true;
    for (Eigen::Index b = 0; b <= k; ++b) {
      const bool gone = b < k && here.hat.segment(blocks[static_cast<std::size_t>(b)].first, blocks[static_cast<std::size_t>(b)].count).sum() < 0.5 &&
                        next(b) < now(b);
      still = still && (gone || std::fabs(next(b) - now(b)) < 0.03);
    }
    now = next;
    here = std::move(there);
  }
  if (settled != nullptr) *settled = still;

  FamilySolution out;
  out.log_likelihood = here.log_likelihood;
  out.u = here.score;
  for (Eigen::Index b = 0; b < k; ++b) {
    const Block& block = blocks[static_cast<std::size_t>(b)];
    const double sd = std::exp(now(b));
    out.variances.sd[index(block.family)] = sd;
    out.u.segment(block.first, block.count) *= sd * sd;
  }
  out.variances.noise = std::exp(now(k));
  out.effective_parameters = here.hat.sum();
  out.whitened = std::move(here.whitened);
  return out;
}

}  // namespace mdhcal::offline
