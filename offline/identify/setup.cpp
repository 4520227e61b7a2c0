// SPDX-License-Identifier: MIT
#include "offline/identify/setup.hpp"

#include <algorithm>

#include "offline/error.hpp"
#include "offline/identify/registration.hpp"
#include "offline/identify/rigid.hpp"

namespace mdhcal::offline {

namespace {

Vector3 nominal_target(const Robot& robot, const std::string& word) {
  for (const TargetPoint& target : robot.targets) {
    if (target.name == word) return target.flange_p_m;
  }
  return robot.tool_p_m.value_or(Vector3{});
}

}  // namespace

Setup make_setup(const Robot& robot, const Dataset& data, const std::vector<std::size_t>& rows,
                 const SetupOptions& options) {
  Setup setup;
  Gauge gauge;
  gauge.base_fitted = options.fit_base;
  gauge.target_fitted = options.fit_tool;
  gauge.rotations_measured = std::any_of(rows.begin(), rows.end(), [&](std::size_t row) {
    return data.rows[row].kind == MeasurementKind::pose;
  });
  setup.parameters = choose_parameters(robot, gauge, options.parameters);

  setup.nominal.geometry = robot.geometry;
  if (robot.tracker_T_base) setup.nominal.tracker_T_base = frame_of(*robot.tracker_T_base);
  for (const std::string& word : data.targets) setup.nominal.flange_p_m.push_back(nominal_target(robot, word));
  if (setup.nominal.flange_p_m.empty()) setup.nominal.flange_p_m.push_back(robot.tool_p_m.value_or(Vector3{}));

  setup.frames.base = options.fit_base;
  setup.frames.target = options.fit_tool;
  setup.frames.targets = setup.nominal.flange_p_m.size();
  std::size_t seen = 0;
  for (std::size_t row : rows) {
    const Measurement& m = data.rows[row];
    if (m.kind == MeasurementKind::distance) continue;
    setup.frames.pivot_m = plus(setup.frames.pivot_m, m.position_m);
    ++seen;
  }
  if (seen > 0) {
    for (double& c : setup.frames.pivot_m) c /= static_cast<double>(seen);
  }
  setup.layout = setup.frames;
  setup.layout.geometry = setup.parameters.free;
  return setup;
}

Fit fit_frames(const Setup& setup, const Dataset& data, Selection& selection, double noise_mm) {
  FitControl control;
  control.loss = Loss::huber;
  control.noise_mm = noise_mm;
  control.tolerance = 1e-3;
  Fit best;
  Selection best_selection = selection;
  bool found = false;
  for (const Estimate& start : starting_values(data, selection.rows, setup.frames, setup.nominal)) {
    Fit candidate = fit(data, selection, setup.frames, start, control);
    if (!found || candidate.scale < best.scale) {
      best = std::move(candidate);
      best_selection = selection;
      found = true;
    }
  }
  selection = std::move(best_selection);
  return best;
}

}  // namespace mdhcal::offline
