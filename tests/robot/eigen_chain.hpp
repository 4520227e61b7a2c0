// SPDX-License-Identifier: MIT
// Forward kinematics by Eigen's products of elementary transforms: a second derivation for the interchange tests.
#pragma once

#include <string>

#include <Eigen/Geometry>

#include "mdhcal/kinematics.hpp"
#include "offline/base/random.hpp"
#include "offline/robot/robot.hpp"

namespace mdhcal::offline::test {

inline Eigen::Isometry3d about(double angle_rad, const Eigen::Vector3d& axis) {
  return Eigen::Isometry3d(Eigen::AngleAxisd(angle_rad, axis));
}

inline Eigen::Isometry3d along(double x_m, double y_m, double z_m) {
  return Eigen::Isometry3d(Eigen::Translation3d(x_m, y_m, z_m));
}

inline Eigen::Isometry3d xyz_rpy(const Eigen::Vector3d& xyz_m, const Eigen::Vector3d& rpy_rad) {
  return along(xyz_m.x(), xyz_m.y(), xyz_m.z()) * about(rpy_rad.z(), Eigen::Vector3d::UnitZ()) *
         about(rpy_rad.y(), Eigen::Vector3d::UnitY()) * about(rpy_rad.x(), Eigen::Vector3d::UnitX());
}

inline Eigen::Isometry3d isometry(const Pose<double>& pose) {
  const Eigen::Quaterniond q(pose.quaternion[0], pose.quaternion[1], pose.quaternion[2], pose.quaternion[3]);
  return Eigen::Translation3d(pose.position_m[0], pose.position_m[1], pose.position_m[2]) * q;
}

inline void random_readings(Random& random, double largest, double (&q)[max_joints]) {
  for (double& reading : q) reading = random.uniform(-largest, largest);
}

/// The flange by lib's forward(), in the tracker frame where the robot has one.
inline Eigen::Isometry3d flange(const Robot& robot, const double* q) {
  Arm<double> arm{};
  Pose<double> pose{};
  if (make_arm(robot.geometry, arm) != Status::ok || forward(arm, q, pose) != Status::ok) {
    return Eigen::Isometry3d(Eigen::Matrix4d::Constant(std::nan("")));
  }
  return robot.tracker_T_base ? isometry(*robot.tracker_T_base) * isometry(pose) : isometry(pose);
}

/// The largest difference of two transforms' entries [m and 1].
inline double difference(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  const double d = (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
  return std::isfinite(d) ? d : 1e9;
}

}  // namespace mdhcal::offline::test
