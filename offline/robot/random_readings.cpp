// SPDX-License-Identifier: MIT
#include "offline/robot/random_readings.hpp"

#include <numbers>

namespace mdhcal::offline {

Joints random_readings(const Geometry& geometry, Random& random) {
  Joints q{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(geometry.joint_count); ++i) {
    const Joint& joint = geometry.joint[i];
    const double span = joint.kind == JointKind::revolute ? std::numbers::pi : 0.5;
    const double low = joint.has_min != 0 ? joint.min : (joint.has_max != 0 ? joint.max - 2 * span : -span);
    const double high = joint.has_max != 0 ? joint.max : low + 2 * span;
    q[i] = random.uniform(low, high);
  }
  return q;
}

}  // namespace mdhcal::offline
