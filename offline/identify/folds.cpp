// SPDX-License-Identifier: MIT
#include "offline/identify/folds.hpp"

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

Eigen::VectorXd deviation_vector(const Estimate& estimate, const Layout& layout) {
  const std::vector<double> x = deviation(estimate, layout);
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

Estimate solved(const MeasurementModel& model, const Layout& layout, const ReducedSystem& system,
                const SpectralProblem& problem, const Eigen::VectorXd& x0, double lambda) {
  const auto frames = static_cast<Eigen::Index>(layout.frame_columns());
  Eigen::VectorXd step(frames + x0.size());
  step.tail(x0.size()) = problem.solution(lambda) - x0;
  step.head(frames) = frame_step(system, step.tail(x0.size()));
  return moved(model.estimate(), layout, step.data());
}

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

Folds make_folds(const Dataset& data, const std::vector<std::size_t>& rows, std::uint64_t seed) {
  constexpr std::uint32_t none = 0xFFFFFFFF;
  std::vector<std::uint32_t> rank_of_group(data.groups.size(), none);
  std::uint32_t groups = 0;
  for (std::size_t row : rows) {
    std::uint32_t& rank = rank_of_group[data.rows[row].group];
    if (rank == none) rank = groups++;
  }
  Folds folds;
  folds.count = groups < leave_one_out_below ? groups : fold_count;
  if (folds.count == 0) folds.count = 1;
  std::vector<std::uint32_t> order(groups);
  std::iota(order.begin(), order.end(), 0U);
  Random random(seed);
  for (std::size_t i = groups; i > 1; --i) std::swap(order[i - 1], order[random.index(i)]);
  folds.of_row.reserve(rows.size());
  for (std::size_t row : rows) folds.of_row.push_back(order[rank_of_group[data.rows[row].group]] % folds.count);
  return folds;
}

FoldJudge::FoldJudge(const Dataset& data, const Selection& selection, const Layout& layout, const MeasurementModel& model,
                     const std::vector<Triangle>& parts)
    : data_(data), selection_(selection), layout_(layout), model_(model),
      x0_(deviation_vector(model.estimate(), layout)) {
  for (std::size_t left_out = 0; left_out < parts.size(); ++left_out) {
    Triangle rest(layout.columns());
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (p != left_out || parts.size() == 1) rest.add(parts[p]);
    }
    Part part;
    part.system = reduce_frames(rest.matrix(), layout.frame_columns(), rest.row_count());
    part.problem = penalised_problem(part.system, x0_);
    part_.push_back(std::move(part));
  }
}

double FoldJudge::error_mm(double lambda) const {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t fold = 0; fold < part_.size(); ++fold) {
    try {
      add_errors(solved(model_, layout_, part_[fold].system, part_[fold].problem, x0_, lambda), data_, selection_,
                 static_cast<std::int64_t>(fold), sum, count);
    } catch (const Refusal&) {
      return HUGE_VAL;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : HUGE_VAL;
}

double independent_share(const Dataset& data, const Selection& selection, const MeasurementModel& model) {
  struct Cell {
    std::size_t count = 0;
    double sum[3] = {0, 0, 0};
    double squares = 0;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, Cell> cells;
  for (std::size_t i = 0; i < selection.rows.size(); ++i) {
    const Measurement& m = data.rows[selection.rows[i]];
    if (m.kind == MeasurementKind::distance) continue;
    if (!selection.robust_weight.empty() && selection.robust_weight[i] < outlier_weight) continue;
    double r[max_row_residuals];
    model.residual(data, selection.rows[i], r);
    Cell& cell = cells[{m.group, m.target}];
    ++cell.count;
    for (std::size_t k = 0; k < 3; ++k) {
      cell.sum[k] += r[k];
      cell.squares += r[k] * r[k];
    }
  }
  double rows = 0;
  double repeated = 0;  // cells with repeats
  double repeats = 0;   // rows in those
  double within = 0;    // squares about the cell's mean
  double between = 0;   // squares of the cells' means
  for (const auto& [key, cell] : cells) {
    rows += static_cast<double>(cell.count);
    if (cell.count < 2) continue;
    const auto n = static_cast<double>(cell.count);
    const double mean2 =
        (cell.sum[0] * cell.sum[0] + cell.sum[1] * cell.sum[1] + cell.sum[2] * cell.sum[2]) / (n * n);
    repeated += 1;
    repeats += n;
    within += std::max(0.0, cell.squares - n * mean2);
    between += mean2;
  }
  if (!(repeats > repeated)) return 1.0;
  const double n = repeats / repeated;
  const double scatter = within / (repeats - repeated);
  const double shared = std::max(0.0, between / repeated - scatter / n);
  if (!(shared + scatter > 0.0)) return 1.0;
  const double effect = 1.0 + (n - 1.0) * shared / (shared + scatter);
  return (rows - repeats + repeats / effect) / rows;
}

double training_error_mm(const Dataset& data, const Selection& selection, const Layout& layout, const MeasurementModel& model,
                         const ReducedSystem& system, const SpectralProblem& problem, double lambda) {
  double sum = 0.0;
  std::size_t count = 0;
  try {
    const Eigen::VectorXd x0 = deviation_vector(model.estimate(), layout);
    add_errors(solved(model, layout, system, problem, x0, lambda), data, selection, -1, sum, count);
  } catch (const Refusal&) {
    return HUGE_VAL;
  }
  return count > 0 ? sum / static_cast<double>(count) : HUGE_VAL;
}

}  // namespace mdhcal::offline
