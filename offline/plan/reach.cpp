// SPDX-License-Identifier: MIT
#include "offline/plan/reach.hpp"

#include <algorithm>
#include <cmath>

#include "offline/robot/rotation.hpp"

namespace mdhcal::offline {

bool meets(const Box& box, const Vector3& a, const Vector3& b) {
  // The parameter range of the segment, cut by one pair of faces after the other (Kay & Kajiya 1986).
  double from = 0, to = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double step = b[axis] - a[axis];
    if (!(std::abs(step) > 0)) {
      if (a[axis] < box.low_m[axis] || a[axis] > box.high_m[axis]) return false;
      continue;
    }
    const double s = (box.low_m[axis] - a[axis]) / step, t = (box.high_m[axis] - a[axis]) / step;
    from = std::max(from, std::min(s, t));
    to = std::min(to, std::max(s, t));
  }
  return from <= to;
}

bool reachable(const Robot& robot, const Arm<double>& arm, const Reach& reach,
               const Joints& q) {
  const auto n = static_cast<std::size_t>(robot.geometry.joint_count);
  for (std::size_t i = 0; i < n; ++i) {
    const Joint& joint = robot.geometry.joint[i];
    if ((joint.has_min != 0 && q[i] < joint.min) || (joint.has_max != 0 && q[i] > joint.max)) return false;
  }
  std::array<Frame<double>, max_joints + 2> frames{};
  if (link_frames(arm, q.data(), frames.data()) != Status::ok) return false;
  const Frame<double>& flange = frames[n + 1];
  const Vector3 target = transform(flange, robot.tool_p_m.value_or(Vector3{}));

  std::vector<Vector3> skeleton;
  for (std::size_t i = 0; i <= n + 1; ++i) {
    skeleton.push_back({frames[i].position_m[0], frames[i].position_m[1], frames[i].position_m[2]});
  }
  skeleton.push_back(target);
  if (reach.tracker_p_m) {
    Frame<double> turn = flange;
    turn.position_m[0] = turn.position_m[1] = turn.position_m[2] = 0;
    const Vector3 normal = transform(turn, reach.reflector_normal);
    double along = 0, squares = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double sight = (*reach.tracker_p_m)[axis] - target[axis];
      along += sight * normal[axis];
      squares += sight * sight;
    }
    if (along < std::cos(reach.cone_rad) * std::sqrt(squares)) return false;
    skeleton.push_back(*reach.tracker_p_m);
  }
  for (const Box& box : reach.keep_out) {
    for (std::size_t i = 0; i + 1 < skeleton.size(); ++i) {
      if (meets(box, skeleton[i], skeleton[i + 1])) return false;
    }
  }
  return true;
}

}  // namespace mdhcal::offline
