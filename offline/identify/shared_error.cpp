// SPDX-License-Identifier: MIT
#include "offline/identify/shared_error.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "offline/identify/factorization.hpp"
#include "offline/identify/folds.hpp"
#include "offline/identify/lambda_rules.hpp"

namespace mdhcal::offline {

namespace {

// More poses tell the shares to no purpose: at 300 each is known to a tenth.
constexpr std::size_t enough_poses = 300;

// The ranges [begin, end) of one target within a block.
template <class Visit>
void for_each_target(const PoseBlock& block, Visit&& visit) {
  for (std::size_t begin = 0, end = 0; begin < block.target.size(); begin = end) {
    while (end < block.target.size() && block.target[end] == block.target[begin]) ++end;
    visit(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(end - begin));
  }
}

// For rows whose covariance is I + variance g g^T: multiplies by its inverse root, and g with it. Returns its log determinant.
double take_out(double variance, Eigen::Ref<Eigen::VectorXd> g, Eigen::Ref<Eigen::MatrixXd> rows) {
  const double length2 = g.squaredNorm();
  if (!(variance * length2 > 0.0)) return 0.0;
  const double shrink = 1.0 / std::sqrt(1.0 + variance * length2);
  const Eigen::RowVectorXd along = g.transpose() * rows / length2;
  rows.noalias() -= (1.0 - shrink) * g * along;
  g *= shrink;
  return -2.0 * std::log(shrink);
}

// Deviance (twice the negative logarithm of the restricted likelihood, but for a constant) of the shares.
class Deviance {
 public:
  Deviance(const Dataset& data, const Layout& layout, const Estimate& at, double noise_mm, Selection selection)
      : data_(data), layout_(layout), model_(at), noise_mm_(noise_mm), selection_(std::move(selection)),
        blocks_(pose_blocks(data, selection_)) {
    const std::vector<double> x = deviation(at, layout);
    x0_ = Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
  }

  double operator()(const SharedError& shared) {
    selection_.shared = shared;
    Triangle whole = sum_of(linearise(model_, data_, selection_, layout_, noise_mm_));
    const ReducedSystem system = reduce_frames(whole.matrix(), layout_.frame_columns(), whole.row_count());
    const SpectralProblem problem = penalised_problem(system, x0_);
    const LambdaChoice choice = marginal_likelihood(problem);
    double sum = choice.found ? marginal_deviance(problem, choice.lambda)
                              : static_cast<double>(problem.data_count) * std::log(problem.outside2);
    if (system.frame_rank > 0) sum += 2.0 * singular_values(system.frame).head(system.frame_rank).array().log().sum();
    constexpr double axes = 3.0;
    for (const PoseBlock& block : blocks_) {
      Eigen::MatrixXd none(static_cast<Eigen::Index>(block.selected.size()), 0);
      sum += axes * whiten(shared, block, selection_.robust_weight, none);
    }
    return sum;
  }

 private:
  const Dataset& data_;
  const Layout& layout_;
  MeasurementModel model_;
  double noise_mm_;
  Selection selection_;
  std::vector<PoseBlock> blocks_;
  Eigen::VectorXd x0_;
};

// Variances of the pose's and the target's error over the row's own.
SharedError shares_of(double pose, double target) {
  const double sum = 1.0 + pose + target;
  return {pose / sum, target / sum};
}

// The least of f over a ratio of variances: none, or 1e-3 ... 1e4 (an arm's error of 2 mm in a tracker's noise of 0.02 mm),
// by golden section on its logarithm.
template <class Function>
double best_ratio(Function&& f, double& least) {
  constexpr double golden = 0.6180339887498949;
  double low = std::log(1e-3), high = std::log(1e4);
  double a = high - golden * (high - low), b = low + golden * (high - low);
  double fa = f(std::exp(a)), fb = f(std::exp(b));
  // Twelve steps narrow it to a twentieth of a decade; a ratio that is a tenth off costs no interval a hundredth.
  for (int step = 0; step < 12; ++step) {
    if (fa < fb) {
      high = b, b = a, fb = fa;
      a = high - golden * (high - low), fa = f(std::exp(a));
    } else {
      low = a, a = b, fa = fb;
      b = low + golden * (high - low), fb = f(std::exp(b));
    }
  }
  const double none = f(0.0);
  least = std::min({none, fa, fb});
  return none <= std::min(fa, fb) ? 0.0 : std::exp(fa < fb ? a : b);
}

// Of a selection with folds and weights, every so-manieth pose.
Selection thinned(const Selection& selection) {
  const std::size_t poses = selection.pose.empty() ? 0 : *std::max_element(selection.pose.begin(), selection.pose.end()) + std::size_t{1};
  const std::size_t stride = 1 + (poses - 1) / enough_poses;
  Selection out;
  for (std::size_t i = 0; i < selection.rows.size(); ++i) {
    if (selection.pose[i] % stride != 0) continue;
    out.rows.push_back(selection.rows[i]);
    out.pose.push_back(selection.pose[i]);
    if (!selection.robust_weight.empty()) out.robust_weight.push_back(selection.robust_weight[i]);
  }
  return out;
}

}  // namespace

std::vector<PoseBlock> pose_blocks(const Dataset& data, const Selection& selection) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < selection.rows.size(); ++i) {
    if (data.rows[selection.rows[i]].kind == MeasurementKind::distance) continue;
    if (selection.robust_weight.empty() || selection.robust_weight[i] > 0.0) order.push_back(i);
  }
  const auto target = [&](std::size_t i) { return data.rows[selection.rows[i]].target; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (selection.pose[a] != selection.pose[b]) return selection.pose[a] < selection.pose[b];
    return target(a) < target(b);
  });
  std::vector<PoseBlock> out;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k == 0 || selection.pose[order[k]] != selection.pose[order[k - 1]]) out.emplace_back();
    out.back().selected.push_back(order[k]);
    out.back().target.push_back(target(order[k]));
  }
  return out;
}

double whiten(const SharedError& shared, const PoseBlock& block, const std::vector<double>& robust_weight,
              Eigen::Ref<Eigen::MatrixXd> rows) {
  const auto count = static_cast<Eigen::Index>(block.selected.size());
  Eigen::VectorXd g(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double weight = robust_weight.empty() ? 1.0 : robust_weight[block.selected[static_cast<std::size_t>(i)]];
    g(i) = std::sqrt(weight / shared.own());
    rows.row(i) *= g(i);
  }
  double volume = static_cast<double>(count) * std::log(shared.own());
  for_each_target(block, [&](Eigen::Index begin, Eigen::Index size) {
    volume += take_out(shared.by_target, g.segment(begin, size), rows.middleRows(begin, size));
  });
  return volume + take_out(shared.by_pose, g, rows);
}

void set_shared_error(const Dataset& data, const Layout& layout, const Estimate& at, double noise_mm, Selection& selection) {
  selection.pose = poses_of(data, selection.rows);
  selection.shared = {};
  bool targets = false;  // some pose has more than one
  bool repeats = false;  // some target is repeated in a pose
  const Selection few = thinned(selection);
  for (const PoseBlock& block : pose_blocks(data, few)) {
    targets = targets || block.target.front() != block.target.back();
    for_each_target(block, [&](Eigen::Index, Eigen::Index size) { repeats = repeats || size > 1; });
  }
  if (!targets && !repeats) return;
  Deviance deviance(data, layout, at, noise_mm, few);
  double pose = 0.0;
  double target = 0.0;
  double least = 0.0;
  // One after the other; with both there, twice settles them to what a ratio need be known to.
  for (int round = 0; round < (targets && repeats ? 2 : 1); ++round) {
    if (targets) pose = best_ratio([&](double ratio) { return deviance(shares_of(ratio, target)); }, least);
    if (repeats) target = best_ratio([&](double ratio) { return deviance(shares_of(pose, ratio)); }, least);
  }
  selection.shared = shares_of(pose, target);
}

double independent_share(const Dataset& data, const Selection& selection) {
  if (!selection.shared.any()) return 1.0;
  double rows = 0.0;
  double informs = 0.0;
  for (const PoseBlock& block : pose_blocks(data, selection)) {
    double g2 = 0.0;
    for_each_target(block, [&](Eigen::Index, Eigen::Index size) {
      const double n = static_cast<double>(size) / selection.shared.own();
      g2 += n / (1.0 + selection.shared.by_target * n);
    });
    rows += static_cast<double>(block.selected.size());
    informs += g2 / (1.0 + selection.shared.by_pose * g2);
  }
  return rows > 0.0 ? informs / rows : 1.0;
}

}  // namespace mdhcal::offline
