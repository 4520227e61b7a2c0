// SPDX-License-Identifier: MIT
#include "offline/identify/unknowns.hpp"

#include <algorithm>

#include "offline/base/error.hpp"
#include "offline/identify/registration.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

TargetPoint nominal_target(const Robot& robot, const std::string& word) {
  for (const TargetPoint& target : robot.targets) {
    if (target.name == word) return target;
  }
  return {word, robot.tool_p_m.value_or(Vector3{}), robot.tool_quaternion};
}

// The targets whose rotation some row measures.
std::vector<std::size_t> turned_targets(const Dataset& data, const std::vector<std::size_t>& rows, std::size_t targets) {
  std::vector<bool> turned(targets, false);
  for (const std::size_t row : rows) {
    if (data.rows[row].kind == MeasurementKind::pose) turned[data.rows[row].target] = true;
  }
  std::vector<std::size_t> out;
  for (std::size_t t = 0; t < targets; ++t) {
    if (turned[t]) out.push_back(t);
  }
  return out;
}

}  // namespace

Unknowns choose_unknowns(const Robot& robot, const Dataset& data, const std::vector<std::size_t>& rows,
                 const UnknownsOptions& options) {
  Unknowns unknowns;
  Gauge gauge;
  gauge.base_fitted = options.fit_base;
  gauge.target_fitted = options.fit_tool;
  unknowns.parameters = choose_parameters(robot, gauge, options.parameters);

  unknowns.nominal.geometry = robot.geometry;
  unknowns.nominal.transmission = robot.transmission;
  if (robot.tracker_T_base) unknowns.nominal.tracker_T_base = frame_of(*robot.tracker_T_base);
  for (const std::string& word : data.targets.empty() ? std::vector<std::string>{""} : data.targets) {
    const TargetPoint target = nominal_target(robot, word);
    unknowns.nominal.flange_p_m.push_back(target.flange_p_m);
    unknowns.nominal.flange_R_probe.push_back(frame_of(target.quaternion.value_or(std::array<double, 4>{1, 0, 0, 0}), {}));
  }

  unknowns.frames.base = options.fit_base;
  unknowns.frames.target = options.fit_tool;
  unknowns.frames.targets = unknowns.nominal.flange_p_m.size();
  if (options.fit_tool) unknowns.frames.probes = turned_targets(data, rows, unknowns.frames.targets);
  std::size_t seen = 0;
  for (std::size_t row : rows) {
    const Measurement& m = data.rows[row];
    if (m.kind == MeasurementKind::distance) continue;
    unknowns.frames.pivot_m = plus(unknowns.frames.pivot_m, m.position_m);
    ++seen;
  }
  if (seen > 0) {
    for (double& c : unknowns.frames.pivot_m) c /= static_cast<double>(seen);
  }
  unknowns.layout = unknowns.frames;
  unknowns.layout.geometry = unknowns.parameters.free;
  return unknowns;
}

Fit fit_frames(const Unknowns& unknowns, const Dataset& data, Selection& selection, double noise_mm) {
  FitControl control;
  control.loss = Loss::huber;
  control.noise_mm = noise_mm;
  control.tolerance = 1e-3;
  Fit best;
  Selection best_selection = selection;
  bool found = false;
  for (const Estimate& start : starting_values(data, selection.rows, unknowns.frames, unknowns.nominal)) {
    Fit candidate = fit(data, selection, unknowns.frames, start, control);
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
