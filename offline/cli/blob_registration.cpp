// SPDX-License-Identifier: MIT
#include "offline/cli/blob_registration.hpp"

#include <algorithm>
#include <numeric>

#include "offline/base/error.hpp"
#include "offline/base/progress.hpp"
#include "offline/cli/blob_command.hpp"
#include "offline/cli/messages.hpp"
#include "offline/identify/registration.hpp"
#include "offline/identify/unknowns.hpp"
#include "offline/robot/rotation.hpp"
#include "offline/robot/units.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

std::string listed(const std::vector<TargetPoint>& targets) {
  std::string names;
  for (const TargetPoint& target : targets) {
    names += names.empty() ? "\"" : ", \"";
    names += target.name + '"';
  }
  return names.empty() ? "none" : names;
}

// The blob's point for each target of the measurements. A file that names no target means the blob's only one, or the
// flange origin if the blob has none.
std::vector<Vector3> target_points(const Robot& robot, const Dataset& data) {
  std::vector<Vector3> points;
  for (const std::string& name : data.targets) {
    const auto same = [&](const TargetPoint& t) { return t.name == name; };
    const auto found = std::find_if(robot.targets.begin(), robot.targets.end(), same);
    if (found != robot.targets.end()) {
      points.push_back(found->flange_p_m);
    } else if (name.empty() && robot.targets.size() <= 1) {
      points.push_back(robot.targets.empty() ? Vector3{} : robot.targets[0].flange_p_m);
    } else {
      throw InputError(data.path, 0, 0,
                       (name.empty() ? "Found no column \"target\"" : "Found the target \"" + name + '"') +
                           "; expected one of the blob's targets: " + listed(robot.targets) +
                           " (or --refit-tool, which fits the points to these measurements).");
    }
  }
  return points;
}

}  // namespace

Registration registration(const Robot& stated, const Dataset& data, bool refit_base, bool refit_tool) {
  Robot robot = stated;
  Registration r{frame_of(robot.tracker_T_base.value_or(Pose<double>{{1, 0, 0, 0}, {0, 0, 0}})), {}};
  if (!refit_tool) r.flange_p_m = target_points(robot, data);
  if (!refit_base && !refit_tool) return r;
  // What is fitted starts from nothing; what is kept is handed over as the robot's own.
  robot.targets.clear();
  for (std::size_t k = 0; k < r.flange_p_m.size(); ++k) robot.targets.push_back({data.targets[k], r.flange_p_m[k]});
  std::copy(std::begin(robot.geometry.link), std::end(robot.geometry.link), robot.nominal.begin());
  UnknownsOptions options;
  options.fit_base = refit_base;
  options.fit_tool = refit_tool;
  Selection selection;
  selection.rows.resize(data.rows.size());
  std::iota(selection.rows.begin(), selection.rows.end(), std::size_t{0});
  // The blob has no turn of a probe: the frames are those of the positions.
  Dataset positions = data;
  for (Measurement& m : positions.rows) {
    if (m.kind == MeasurementKind::pose) m.kind = MeasurementKind::position;
  }
  const Unknowns unknowns = choose_unknowns(robot, positions, selection.rows, options);
  const Fit fitted = fit_frames(unknowns, positions, selection, options.noise_mm);
  return {fitted.estimate.tracker_T_base, fitted.estimate.flange_p_m};
}

Vector3 predicted(const Arm<double>& arm, const Registration& r, const Dataset& data, const Measurement& row) {
  Pose<double> pose{};
  if (forward(arm, row.q.data(), pose) != Status::ok) {
    throw InputError(data.path, row.line, 0, "A joint is outside the library's range.");
  }
  return transform(compose(r.tracker_T_base, frame_of(pose)), r.flange_p_m[row.target]);
}

std::vector<double> rotation_errors_deg(const Arm<double>& arm, const Registration& r, const Dataset& data) {
  std::vector<double> angles;
  for (std::size_t target = 0; target < data.targets.size(); ++target) {
    std::vector<Frame<double>> flange_R_probe;
    for (const Measurement& row : data.rows) {
      Pose<double> pose{};
      if (row.kind != MeasurementKind::pose || row.target != target || forward(arm, row.q.data(), pose) != Status::ok) continue;
      flange_R_probe.push_back(compose(inverted(compose(r.tracker_T_base, frame_of(pose))), frame_of(row.quaternion, {})));
    }
    const Frame<double> mean = mean_rotation(flange_R_probe);
    for (const Frame<double>& each : flange_R_probe) {
      angles.push_back(deg_per_rad * norm(log_of_rotation(compose(inverted(mean), each))));
    }
  }
  return angles;
}

Dataset read_measurements(const std::string& path, const Robot& robot, const std::string& rotation) {
  Progress progress("read", verbosity() != Verbosity::quiet);
  Dataset data = read_dataset(path, robot, rotation, progress.callback());
  inform_all(data.notes);
  return data;
}

}  // namespace mdhcal::offline
