// SPDX-License-Identifier: MIT
#pragma once

#include "offline/output/blob_writer.hpp"

namespace mdhcal::offline {

/// A calibrated six-joint arm that uses every part of a blob.
inline Robot sample_robot() {
  Robot robot;
  robot.path = "sample.toml";
  robot.name = "sample arm";
  robot.serial = "SN-0007";
  robot.geometry.joint_count = 6;
  const Link links[6] = {{0.0, 0.0, 0.1, 0.36, 0.0},  {-1.57, 0.05, 0.0, 0.0, 0.0}, {0.0, 0.45, -1.5, 0.01, 0.0},
                         {-1.57, 0.04, 0.0, 0.42, 0.0}, {1.57, 0.0, 0.2, 0.0, 0.0},   {-1.57, 0.0, 0.0, 0.08, 0.0}};
  for (std::size_t i = 0; i < 6; ++i) {
    robot.nominal[i] = links[i];
    robot.geometry.link[i] = links[i];
    robot.geometry.link[i].d_m += 0.001 * static_cast<double>(i + 1);
    robot.geometry.link[i].alpha_rad -= 0.0005;
    robot.geometry.joint[i].sign = i == 3 ? -1 : 1;
  }
  robot.geometry.link[1].beta_rad = 0.002;
  robot.geometry.joint[0].has_min = 1;
  robot.geometry.joint[0].min = -3.0;
  robot.geometry.joint[0].has_max = 1;
  robot.geometry.joint[0].max = 3.0;
  robot.geometry.joint[1].max = 7.0;  // not in force
  robot.geometry.joint[2].coupling[1] = 0.5;
  robot.geometry.last_T_flange = {{0.8, 0.0, 0.6, 0.0}, {0.01, 0.0, 0.02}};
  robot.tracker_T_base = Pose<double>{{-0.6, 0.0, 0.0, 0.8}, {1.5, -0.5, 0.25}};
  robot.targets = {{"A", {0.1, 0.0, 0.2}}, {"B", {0.0, 0.1, 0.3}}};
  return robot;
}

/// The provenance of a calibration.
inline Provenance sample_provenance() {
  Provenance provenance;
  provenance.date = "2026-01-31";
  provenance.method = "rpim";
  provenance.lambda_rule = "quasi-optimality";
  provenance.measurements_sha256 = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";
  provenance.pose_count = 50;
  provenance.lambda = 0.25;
  provenance.held_out = Provenance::HeldOut{20, 0.002, 0.005, 0.0001, 0.0002};
  return provenance;
}

}  // namespace mdhcal::offline
