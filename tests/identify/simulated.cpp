// SPDX-License-Identifier: MIT
#include "tests/identify/simulated.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "offline/base/random.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::tests {

using namespace offline;

SimulationOptions arm_options(std::uint64_t seed) {
  SimulationOptions options;
  options.seed = seed;
  options.configurations = 60;
  options.test_configurations = 1;
  options.length_error_m = 1e-3;
  options.angle_error_rad = 0.1 * std::numbers::pi / 180.0;
  options.noise_m = 0.02e-3;
  return options;
}

std::vector<std::size_t> add_gross_errors(Dataset& data, double share, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::size_t> rows;
  const auto wanted = static_cast<std::size_t>(std::llround(share * static_cast<double>(data.rows.size())));
  while (rows.size() < wanted) {
    const std::size_t row = random.index(data.rows.size());
    if (std::find(rows.begin(), rows.end(), row) != rows.end()) continue;
    Vector3 direction{random.normal(), random.normal(), random.normal()};
    const double length = random.uniform(1e-3, 50e-3) / norm(direction);
    for (std::size_t k = 0; k < 3; ++k) data.rows[row].position_m[k] += length * direction[k];
    rows.push_back(row);
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

void add_shared_error(Dataset& data, double sd_m, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vector3> error(data.groups.size());
  for (Vector3& each : error) {
    for (double& c : each) c = sd_m * random.normal();
  }
  for (Measurement& m : data.rows) m.position_m = plus(m.position_m, error[m.group]);
}

MeasurementModel truth_model(const Simulation& simulation) {
  Estimate truth;
  truth.geometry = simulation.truth.geometry;
  if (simulation.truth.tracker_T_base) truth.tracker_T_base = frame_of(*simulation.truth.tracker_T_base);
  truth.flange_p_m.push_back(simulation.truth.targets.empty() ? *simulation.truth.tool_p_m
                                                              : simulation.truth.targets.front().flange_p_m);
  return MeasurementModel(truth);
}

double distance_from_truth_mm(const Simulation& simulation, const Calibration& calibration, std::size_t count,
                              std::uint64_t seed) {
  const Geometry& geometry = simulation.truth.geometry;
  const MeasurementModel real = truth_model(simulation);
  const MeasurementModel corrected(calibration.estimate);
  Random random(seed);
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    double q[max_joints] = {};
    for (std::int32_t j = 0; j < geometry.joint_count; ++j) {
      const Joint& joint = geometry.joint[j];
      const double half = joint.kind == JointKind::revolute ? std::numbers::pi : 0.5;
      q[j] = random.uniform(joint.has_min == 1 ? joint.min : -half, joint.has_max == 1 ? joint.max : half);
    }
    sum += 1e3 * norm(minus(corrected.target_position(q, 0), real.target_position(q, 0)));
  }
  return sum / static_cast<double>(count);
}

bool noted(const Calibration& calibration, const std::string& part) {
  return std::any_of(calibration.notes.begin(), calibration.notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

Coverage coverage(const Simulation& simulation, const Calibration& calibration) {
  Coverage out;
  for (const EstimatedParameter& p : calibration.parameters) {
    if (!p.identifiable) {
      out.inside_of.push_back(-1);
      continue;
    }
    const double truth = value(simulation.truth.geometry, p.id) - value(simulation.nominal.geometry, p.id);
    const bool inside = truth >= p.low && truth <= p.high;
    out.inside_of.push_back(inside ? 1 : 0);
    out.inside += inside ? 1 : 0;
    ++out.count;
  }
  return out;
}

}  // namespace mdhcal::tests
