// SPDX-License-Identifier: MIT
#include "offline/identify/families/family_choice.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "offline/base/random.hpp"

namespace mdhcal::offline {

namespace {

constexpr std::uint32_t fold_count = 5;

double position_error_mm(const Cell& cell, const Eigen::VectorXd& left) {
  double squares = 0.0;
  for (Eigen::Index k = 0; k < std::min<Eigen::Index>(cell.count, 3); ++k) {
    const double mm = left(cell.first + k) / cell.scale[static_cast<std::size_t>(k)];
    squares += mm * mm;
  }
  return std::sqrt(squares);
}

// Mean over the poses of the errors of cells, each by the fit that left it out.
double left_out_error_mm(const FamilyRows& rows, const std::vector<std::uint32_t>& fold, const std::vector<FamilyFit>& fits) {
  std::vector<double> sum(rows.poses, 0.0);
  std::vector<double> count(rows.poses, 0.0);
  for (std::uint32_t f = 0; f < fits.size(); ++f) {
    const Eigen::VectorXd left = residual_after(rows, fits[f].step);
    for (std::size_t c = 0; c < rows.cells.size(); ++c) {
      if (fold[c] != f) continue;
      sum[rows.cells[c].pose] += position_error_mm(rows.cells[c], left);
      count[rows.cells[c].pose] += 1.0;
    }
  }
  double total = 0.0;
  for (std::size_t p = 0; p < sum.size(); ++p) total += sum[p] / std::max(1.0, count[p]);
  return total / static_cast<double>(std::max<std::size_t>(1, sum.size()));
}

}  // namespace

std::vector<FamilyChoice> candidates_for(std::size_t poses, bool functions) {
  std::vector<FamilyChoice> out{{}};
  if (poses < 12) return out;
  if (functions) out.push_back({false, 1});
  out.push_back({true, 0});
  if (functions) out.push_back({true, 1});
  if (poses < 16 || !functions) return out;
  out.push_back({false, static_cast<std::int32_t>(max_orders)});
  out.push_back({true, static_cast<std::int32_t>(max_orders)});
  return out;
}

std::vector<std::uint32_t> family_folds(std::size_t poses, std::uint64_t seed, std::uint32_t& folds) {
  folds = fold_count;
  std::vector<std::uint32_t> order(poses);
  std::iota(order.begin(), order.end(), 0U);
  Random random(seed);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.index(i)]);
  for (std::uint32_t& each : order) each %= folds;
  return order;
}

FamilyComparison compare_families(const FamilyRows& rows, const std::vector<FamilyChoice>& candidates, const FamilyFitControl& control,
                                  std::uint64_t seed) {
  FamilyComparison out;
  std::uint32_t folds = 0;
  const std::vector<std::uint32_t> of_pose = family_folds(rows.poses, seed, folds);
  std::vector<std::uint32_t> fold;  // of each cell
  for (const Cell& cell : rows.cells) fold.push_back(of_pose[cell.pose]);
  for (const FamilyChoice& choice : candidates) {
    FamilyCandidate candidate;
    candidate.choice = choice;
    FamilyFit start;
    // From the smaller family: what is new begins small, so that it has to earn its part.
    start.variances.sd = {1.0, 0.1, 0.01, 0.01, 0.01, 0.01};
    start.variances.noise = 1.0;
    if (!out.candidates.empty()) {
      const FamilyFit& geometry = out.candidates.front().fit;
      start.variances.sd[0] = geometry.variances.sd[0];
      start.variances.noise = geometry.variances.noise;
    }
    FamilyFitControl whole = control;
    whole.rounds = 8;
    whole.steps = 4;
    candidate.fit = fit_families(rows, {}, choice, start, whole);
    for (std::uint32_t f = 0; f < folds; ++f) {
      std::vector<bool> use;
      for (const std::uint32_t each : fold) use.push_back(each != f);
      candidate.folds.push_back(fit_families(rows, use, choice, candidate.fit, control));
    }
    candidate.error_mm = left_out_error_mm(rows, fold, candidate.folds);
    out.candidates.push_back(std::move(candidate));
  }
  // Geometry unless another gains a tenth; all orders only if they gain a twentieth more than the best without them. The
  // thresholds were found on 25 cases of nine arms; docs/method.md has what other rules did there.
  constexpr double gain = 0.90, gain_of_orders = 0.95;
  const auto best = [&](bool all_orders) {
    std::size_t at = out.candidates.size();
    for (std::size_t i = 0; i < out.candidates.size(); ++i) {
      if ((out.candidates[i].choice.orders > 1) != all_orders) continue;
      if (at == out.candidates.size() || out.candidates[i].error_mm < out.candidates[at].error_mm) at = i;
    }
    return at;
  };
  const double geometry = out.candidates.front().error_mm;
  const std::size_t simple = best(false);
  const std::size_t orders = best(true);
  if (out.candidates[simple].error_mm <= gain * geometry) out.chosen = simple;
  if (orders < out.candidates.size() && out.candidates[orders].error_mm <= gain * geometry &&
      out.candidates[orders].error_mm <= gain_of_orders * out.candidates[simple].error_mm) {
    out.chosen = orders;
  }
  return out;
}

}  // namespace mdhcal::offline
