// SPDX-License-Identifier: MIT
#include "offline/identify/folds.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "offline/base/error.hpp"
#include "offline/base/random.hpp"
#include "offline/identify/robust.hpp"

namespace mdhcal::offline {

namespace {

constexpr std::uint32_t fold_count = 10;
constexpr std::size_t leave_one_out_below = 20;

// Adds the position errors of the good rows of one fold (of all rows if `fold` is negative).
void add_errors(const Estimate& estimate, const Dataset& data, const Selection& selection, std::int64_t fold,
                double& sum, std::size_t& count) {
  const MeasurementModel model(estimate);
  for (std::size_t i = 0; i < selection.rows.size(); ++i) {
    if (fold >= 0 && selection.fold[i] != fold) continue;
    if (!selection.robust_weight.empty() && selection.robust_weight[i] < outlier_weight) continue;
    double r[max_row_residuals];
    const std::size_t n = model.residual(data, selection.rows[i], r);
    sum += n == 1 ? std::fabs(r[0]) : std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
    ++count;
  }
}

}  // namespace

std::vector<std::uint32_t> poses_of(const Dataset& data, const std::vector<std::size_t>& rows) {
  // Groups that share readings are joined: each points at one joined before it, or at itself.
  std::vector<std::uint32_t> joined(data.groups.size());
  std::iota(joined.begin(), joined.end(), 0U);
  const auto root = [&](std::uint32_t group) {
    while (joined[group] != group) group = joined[group] = joined[joined[group]];
    return group;
  };
  std::map<Joints, std::uint32_t> first_with;
  for (const std::size_t row : rows) {
    const auto [found, added] = first_with.emplace(data.rows[row].q, data.rows[row].group);
    if (!added) joined[root(data.rows[row].group)] = root(found->second);
  }
  constexpr std::uint32_t none = 0xFFFFFFFF;
  std::vector<std::uint32_t> number(data.groups.size(), none);
  std::vector<std::uint32_t> out;
  out.reserve(rows.size());
  std::uint32_t poses = 0;
  for (const std::size_t row : rows) {
    std::uint32_t& each = number[root(data.rows[row].group)];
    if (each == none) each = poses++;
    out.push_back(each);
  }
  return out;
}

Folds make_folds(const Dataset& data, const std::vector<std::size_t>& rows, std::uint64_t seed) {
  const std::vector<std::uint32_t> pose = poses_of(data, rows);
  const std::uint32_t groups = pose.empty() ? 0 : *std::max_element(pose.begin(), pose.end()) + 1;
  Folds folds;
  folds.count = groups < leave_one_out_below ? groups : fold_count;
  if (folds.count == 0) folds.count = 1;
  std::vector<std::uint32_t> order(groups);
  std::iota(order.begin(), order.end(), 0U);
  Random random(seed);
  for (std::size_t i = groups; i > 1; --i) std::swap(order[i - 1], order[random.index(i)]);
  folds.of_row.reserve(rows.size());
  for (const std::uint32_t each : pose) folds.of_row.push_back(order[each] % folds.count);
  return folds;
}

FoldJudge::FoldJudge(const Dataset& data, const Selection& selection, const Layout& layout, const Estimate& at,
                     const Linearised& whole)
    : data_(data), selection_(selection), layout_(layout), at_(at), whole_(whole) {
  for (std::size_t fold = 0; fold < whole.parts.size(); ++fold) rest_.push_back(without_fold(whole, layout, fold));
}

double FoldJudge::error_mm(double lambda) const {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t fold = 0; fold < rest_.size(); ++fold) {
    try {
      add_errors(solved(at_, layout_, rest_[fold].system, rest_[fold].problem, whole_.x0, lambda), data_, selection_,
                 static_cast<std::int64_t>(fold), sum, count);
    } catch (const Refusal&) {
      return HUGE_VAL;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : HUGE_VAL;
}

double training_error_mm(const Dataset& data, const Selection& selection, const Layout& layout, const Estimate& at,
                         const Linearised& whole, double lambda) {
  double sum = 0.0;
  std::size_t count = 0;
  try {
    add_errors(solved(at, layout, whole.system, whole.problem, whole.x0, lambda), data, selection, -1, sum, count);
  } catch (const Refusal&) {
    return HUGE_VAL;
  }
  return count > 0 ? sum / static_cast<double>(count) : HUGE_VAL;
}

}  // namespace mdhcal::offline
