// SPDX-License-Identifier: MIT
// Which configurations can be measured at all.
#pragma once

#include <optional>
#include <vector>

#include "mdhcal/kinematics.hpp"
#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// An axis-parallel box in the robot's base frame [m].
struct Box {
  Vector3 low_m{}, high_m{};
};

/// What a configuration has to satisfy beside the joint limits.
struct Reach {
  std::optional<Vector3> tracker_p_m;        ///< the tracker in the robot's base frame; none: visible from anywhere
  Vector3 reflector_normal{0, 0, 1};         ///< the reflector's axis in the flange frame, unit length
  double cone_rad = 0.8726646259971648;      ///< half angle within which the reflector returns the beam (50 degrees)
  std::vector<Box> keep_out;                 ///< no part of the arm's skeleton and not the target may enter
};

/// True if the readings are within their limits, the target is seen by the tracker within the cone, and neither the
/// polyline through the link frames and the flange to the target nor the line of sight meets a keep-out box.
bool reachable(const Robot& robot, const Arm<double>& arm, const Reach& reach,
               const Joints& q);

/// True if the segment from a to b meets the box.
bool meets(const Box& box, const Vector3& a, const Vector3& b);

}  // namespace mdhcal::offline
