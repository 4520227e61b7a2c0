// SPDX-License-Identifier: MIT
#include "offline/identify/families/family_rows.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "offline/identify/folds.hpp"
#include "offline/identify/robust.hpp"

namespace mdhcal::offline {

namespace {

struct Members {
  std::vector<std::size_t> selected;  // indices into the selection
  std::uint32_t pose = 0;
  std::size_t count = 0;              // scalar rows of each
};

std::vector<Members> cells_of(const Dataset& data, const Selection& selection, std::size_t& poses) {
  const std::vector<std::uint32_t> pose = poses_of(data, selection.rows);
  poses = pose.empty() ? 0 : *std::max_element(pose.begin(), pose.end()) + 1U;
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::int32_t>, std::size_t> known;
  std::vector<Members> cells;
  for (std::size_t i = 0; i < selection.rows.size(); ++i) {
    const Measurement& m = data.rows[selection.rows[i]];
    const std::size_t count = residual_count(m.kind);
    if (count == 0) continue;
    std::size_t at = cells.size();
    if (m.kind != MeasurementKind::distance) at = known.emplace(std::tuple{pose[i], m.target, static_cast<std::int32_t>(m.kind)}, at).first->second;
    if (at == cells.size()) cells.push_back({{}, pose[i], count});
    cells[at].selected.push_back(i);
  }
  for (Members& cell : cells) {
    if (selection.robust_weight.empty() || cell.selected.size() < 2) continue;
    const auto gross = [&](std::size_t i) { return selection.robust_weight[i] < outlier_weight; };
    if (std::all_of(cell.selected.begin(), cell.selected.end(), gross)) continue;
    std::erase_if(cell.selected, gross);
  }
  return cells;
}

}  // namespace

FamilyRows family_rows(const Dataset& data, const Selection& selection, const Layout& layout, const Estimate& at, double noise_mm) {
  FamilyRows out;
  const std::vector<Members> cells = cells_of(data, selection, out.poses);
  Eigen::Index rows = 0;
  for (const Members& cell : cells) rows += static_cast<Eigen::Index>(cell.count);
  const auto n = static_cast<Eigen::Index>(layout.columns());
  const auto frames = static_cast<Eigen::Index>(layout.frame_columns());
  out.frames = Eigen::MatrixXd::Zero(rows, frames);
  out.columns = Eigen::MatrixXd::Zero(rows, n - frames);
  out.residual = Eigen::VectorXd::Zero(rows);
  out.family.assign(layout.geometry.size(), TermFamily::geometry);
  out.order.assign(layout.geometry.size(), 0);
  for (const Term& term : layout.terms) {
    out.family.push_back(term.family);
    out.order.push_back(term.family == TermFamily::gravity ? 0 : term.index);
  }
  const std::vector<double> x = deviation(at, layout);
  out.x0 = Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));

  const MeasurementModel model(at);
  const bool any_sigma = states_sigma(data);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobian(max_row_residuals, n);
  Eigen::Index next = 0;
  for (const Members& members : cells) {
    Cell cell;
    cell.first = next;
    cell.count = static_cast<Eigen::Index>(members.count);
    cell.pose = members.pose;
    const double share = 1.0 / static_cast<double>(members.selected.size());
    for (const std::size_t i : members.selected) {
      double residual[max_row_residuals];
      double scale[max_row_residuals];
      model.residual(data, selection.rows[i], layout, residual, jacobian.data(), static_cast<std::size_t>(n));
      residual_scale(data, selection.rows[i], noise_mm, any_sigma, scale);
      for (Eigen::Index k = 0; k < cell.count; ++k) {
        const double factor = share * scale[k];
        out.residual(next + k) += factor * residual[k];
        out.frames.row(next + k) += factor * jacobian.row(k).head(frames);
        out.columns.row(next + k) += factor * jacobian.row(k).tail(n - frames);
        if (k < 3) cell.scale[static_cast<std::size_t>(k)] += factor;
      }
    }
    next += cell.count;
    out.cells.push_back(cell);
  }
  return out;
}

}  // namespace mdhcal::offline
