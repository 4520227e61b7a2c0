// SPDX-License-Identifier: MIT
#include "offline/simulate/measurement_text.hpp"

#include <algorithm>
#include <stdexcept>

#include "offline/robot/units.hpp"

namespace mdhcal::offline {

std::string measurement_text(const Dataset& dataset, const Robot& robot,
                             const std::function<void(std::size_t, std::size_t)>& progress) {
  const auto any = [&](auto&& holds) { return std::any_of(dataset.rows.begin(), dataset.rows.end(), holds); };
  if (any([](const Measurement& row) { return row.kind == MeasurementKind::distance; })) {
    throw std::invalid_argument("distance rows have no column in this writer");
  }
  const bool grouped = dataset.groups.size() < dataset.rows.size();
  const bool several_targets = dataset.targets.size() > 1;
  const bool sigma = any([](const Measurement& row) { return row.sigma_m[0] > 0; });
  const bool pose = any([](const Measurement& row) { return row.kind == MeasurementKind::pose; });

  std::string text = "id";
  if (grouped) text += ",group";
  if (several_targets) text += ",target";
  for (std::size_t i = 0; i < dataset.joint_count; ++i) {
    const bool revolute = robot.geometry.joint[i].kind == JointKind::revolute;
    text += ",q" + std::to_string(i + 1) + (revolute ? "_deg" : "_mm");
  }
  text += ",x_mm,y_mm,z_mm";
  if (sigma) text += ",sigma_mm";
  if (pose) text += ",qw,qx,qy,qz";
  text += '\n';
  std::size_t done = 0;
  for (const Measurement& row : dataset.rows) {
    if (progress) progress(done++, dataset.rows.size());
    text += row.id;
    if (grouped) text += ',' + dataset.groups[row.group];
    if (several_targets) text += ',' + dataset.targets[row.target];
    for (std::size_t i = 0; i < dataset.joint_count; ++i) {
      const bool revolute = robot.geometry.joint[i].kind == JointKind::revolute;
      text += ',' + shortest_decimal((revolute ? degree : millimetre).from_si(row.q[i]));
    }
    for (const double coordinate : row.position_m) text += ',' + shortest_decimal(millimetre.from_si(coordinate));
    if (sigma) text += ',' + shortest_decimal(millimetre.from_si(row.sigma_m[0]));
    if (pose) {
      for (const double component : row.quaternion) text += ',' + shortest_decimal(component);
    }
    text += '\n';
  }
  return text;
}

}  // namespace mdhcal::offline
