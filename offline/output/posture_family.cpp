// SPDX-License-Identifier: MIT
#include "offline/output/posture_family.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>

#include "mdhcal/kinematics.hpp"

namespace mdhcal::offline {

namespace {

constexpr double parallel_rad = 1e-3;
constexpr double meeting_m = 1e-3;

struct Axis {
  Eigen::Vector3d point, direction;
};

std::array<Axis, 6> axes_of(const Geometry& geometry) {
  Arm<double> arm{};
  std::array<Frame<double>, max_joints + 2> frames{};
  const std::array<double, max_joints> zero{};
  std::array<Axis, 6> axes;
  if (make_arm(geometry, arm) != Status::ok || link_frames(arm, zero.data(), frames.data()) != Status::ok) return axes;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const Frame<double>& frame = frames[i + 1];
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation(frame.rotation);
    const double beta = geometry.link[i].beta_rad;  // the axis is z before Rot_y(beta)
    axes[i].direction = rotation * Eigen::Vector3d(-std::sin(beta), 0.0, std::cos(beta));
    axes[i].point = Eigen::Map<const Eigen::Vector3d>(frame.position_m);
  }
  return axes;
}

bool parallel(const Axis& a, const Axis& b) { return a.direction.cross(b.direction).norm() < parallel_rad; }

double distance(const Eigen::Vector3d& point, const Axis& axis) {
  return (point - axis.point).cross(axis.direction).norm();
}

// Where axis b comes nearest to axis a; the two are not parallel.
Eigen::Vector3d nearest(const Axis& a, const Axis& b) {
  const Eigen::Vector3d normal = a.direction.cross(b.direction);
  const double along = (b.point - a.point).cross(b.direction).dot(normal) / normal.squaredNorm();
  return a.point + along * a.direction;
}

}  // namespace

PostureFamily posture_family(const Geometry& nominal) {
  if (nominal.joint_count != 6) return PostureFamily::general;
  for (int i = 0; i < 6; ++i) {
    if (nominal.joint[i].kind != JointKind::revolute) return PostureFamily::general;
  }
  const std::array<Axis, 6> axis = axes_of(nominal);
  if (parallel(axis[1], axis[2]) && parallel(axis[2], axis[3])) return PostureFamily::parallel_axes;
  if (parallel(axis[3], axis[4]) || parallel(axis[4], axis[5])) return PostureFamily::general;
  const Eigen::Vector3d centre = nearest(axis[4], axis[3]);
  const bool meet = distance(centre, axis[3]) < meeting_m && distance(centre, axis[5]) < meeting_m;
  return meet ? PostureFamily::spherical_wrist : PostureFamily::general;
}

}  // namespace mdhcal::offline
