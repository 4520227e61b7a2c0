// SPDX-License-Identifier: MIT
#include "offline/robot/chain.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "offline/base/error.hpp"
#include "offline/robot/convention.hpp"
#include "offline/robot/rotation.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

Frame<double> turn_x(double angle_rad) {
  const double s = std::sin(angle_rad), c = std::cos(angle_rad);
  return {{1, 0, 0, 0, c, -s, 0, s, c}, {0, 0, 0}};
}

Frame<double> turn_y(double angle_rad) {
  const double s = std::sin(angle_rad), c = std::cos(angle_rad);
  return {{c, 0, s, 0, 1, 0, -s, 0, c}, {0, 0, 0}};
}

Frame<double> turn_z(double angle_rad) {
  const double s = std::sin(angle_rad), c = std::cos(angle_rad);
  return {{c, -s, 0, s, c, 0, 0, 0, 1}, {0, 0, 0}};
}

Frame<double> shift(double x_m, double y_m, double z_m) { return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {x_m, y_m, z_m}}; }

bool is_identity(const Frame<double>& frame) {
  // A tenth of a nanometre and of a nanoradian: the rounding of a description written with ten digits.
  constexpr double tolerance = 1e-10;
  const Frame<double> identity = identity_frame();
  for (std::size_t k = 0; k < 9; ++k) {
    if (std::abs(frame.rotation[k] - identity.rotation[k]) > tolerance) return false;
  }
  return std::abs(frame.position_m[0]) <= tolerance && std::abs(frame.position_m[1]) <= tolerance &&
         std::abs(frame.position_m[2]) <= tolerance;
}

bool has_control_character(const std::string& text) {
  return std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
}

// The joints' names where a robot file can state all of them; none where two are the same or one is too long.
std::array<std::string, max_joints> names_of(const Chain& chain) {
  std::array<std::string, max_joints> names{};
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const std::string& name = chain.joints[i].name;
    if (name.size() > most_joint_name_bytes || has_control_character(name) ||
        std::find(names.begin(), names.end(), name) < names.begin() + static_cast<std::ptrdiff_t>(i)) {
      return {};
    }
    names[i] = name;
  }
  return names;
}

}  // namespace

Frame<double> identity_frame() { return shift(0, 0, 0); }

Frame<double> z_to(const Vector3& axis) {
  // The rotation vector e_z x axis, as a quaternion 1 + cos, sin n; at the antipode any axis across z will do.
  Pose<double> pose{};
  const double w = 1 + axis[2];
  if (w < 1e-12) {
    pose.quaternion[1] = 1;
  } else {
    const double norm = std::sqrt(w * w + axis[0] * axis[0] + axis[1] * axis[1]);
    pose.quaternion[0] = w / norm;
    pose.quaternion[1] = -axis[1] / norm;
    pose.quaternion[2] = axis[0] / norm;
  }
  return frame_of(pose);
}

Vector3 roll_pitch_yaw(const Frame<double>& frame) {
  const auto& r = frame.rotation;
  const double across = std::hypot(r[0], r[3]);
  const double yaw = across > 0 ? std::atan2(r[3], r[0]) : 0;
  const double s = std::sin(yaw), c = std::cos(yaw);
  // Roll is taken after the yaw has been removed, so that their sum stays right where each alone is ill-defined.
  return {std::atan2(s * r[2] - c * r[5], c * r[4] - s * r[1]), std::atan2(-r[6], across), yaw};
}

Frame<double> frame_of_xyz_rpy(const Vector3& xyz_m, const Vector3& rpy_rad) {
  return compose(compose(compose(shift(xyz_m[0], xyz_m[1], xyz_m[2]), turn_z(rpy_rad[2])), turn_y(rpy_rad[1])),
                 turn_x(rpy_rad[0]));
}

Frame<double> tip(const Chain& chain, const double* q) {
  Frame<double> base_T_tip = identity_frame();
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const ChainJoint& joint = chain.joints[i];
    const Frame<double> z = z_to(joint.axis);
    const Frame<double> motion = joint.kind == JointKind::revolute ? turn_z(q[i]) : shift(0, 0, q[i]);
    base_T_tip = compose(compose(base_T_tip, joint.parent_T_joint), compose(compose(z, motion), inverted(z)));
  }
  return compose(base_T_tip, chain.last_T_tip);
}

std::string base_frame_note(const Robot& robot, const std::string& base) {
  if (!robot.tracker_T_base) return {};
  const Pose<double>& pose = *robot.tracker_T_base;
  const Vector3 turn = rotation_vector_of({pose.quaternion[0], pose.quaternion[1], pose.quaternion[2], pose.quaternion[3]});
  char text[400];
  std::snprintf(text, sizeof text,
                "The robot's base frame, in which its link 1 is stated and `forward` prints, is not %s: it lies %.6g mm and "
                "%.6g degrees from it, since modified Denavit-Hartenberg parameters cannot express axis 1 from there. "
                "[base] holds the way from %s; --frame tracker prints poses against %s.",
                base.c_str(), mm_per_m * std::hypot(pose.position_m[0], pose.position_m[1], pose.position_m[2]),
                deg_per_rad * std::hypot(turn[0], turn[1], turn[2]), base.c_str(), base.c_str());
  return text;
}

Robot robot_from_chain(const Chain& chain, const std::string& path) {
  const std::size_t n = chain.joints.size();
  if (n == 0 || n > max_joints) {
    throw InputError(path, 0, 0, "The chain has " + std::to_string(n) + " moving joints; expected 1 to " +
                                     std::to_string(max_joints) + '.');
  }
  std::vector<Frame<double>> fixed;
  Frame<double> before = identity_frame();  // undoes the last joint's turn of z onto its axis
  for (const ChainJoint& joint : chain.joints) {
    const Frame<double> z = z_to(joint.axis);
    fixed.push_back(compose(compose(before, joint.parent_T_joint), z));
    before = inverted(z);
  }
  fixed.push_back(compose(before, chain.last_T_tip));
  const ModifiedChain modified = mdh_from_chain(fixed);

  Robot robot;
  robot.path = path;
  robot.name = chain.name.substr(0, 63);
  robot.kinematics_hash = chain.kinematics_hash;
  robot.geometry.joint_count = static_cast<std::int32_t>(n);
  for (std::size_t i = 0; i < n; ++i) {
    const ChainJoint& from = chain.joints[i];
    Joint& joint = robot.geometry.joint[i];
    joint.kind = from.kind;
    joint.sign = 1;
    joint.has_min = from.has_min ? 1 : 0;
    joint.has_max = from.has_max ? 1 : 0;
    joint.min = from.min;
    joint.max = from.max;
    robot.geometry.link[i] = robot.nominal[i] = modified.links[i];
  }
  robot.joint_name = names_of(chain);
  robot.geometry.last_T_flange = pose_of(modified.last_T_flange);
  if (!is_identity(modified.origin)) robot.tracker_T_base = pose_of(modified.origin);
  if (check_geometry(robot.geometry) != Status::ok) {
    throw InputError(path, 0, 0, "The chain's lengths, angles or limits lie outside the valid range.");
  }
  return robot;
}

Chain chain_of(const Robot& robot, bool with_base) {
  Chain chain;
  chain.name = robot.name;
  chain.kinematics_hash = robot.kinematics_hash;
  Frame<double> before =
      with_base && robot.tracker_T_base ? frame_of(*robot.tracker_T_base) : identity_frame();
  for (std::size_t i = 0; i < static_cast<std::size_t>(robot.geometry.joint_count); ++i) {
    const Link& link = robot.geometry.link[i];
    const Joint& joint = robot.geometry.joint[i];
    if (std::any_of(std::begin(joint.coupling), std::end(joint.coupling), [](double c) { return std::abs(c) > 0; })) {
      throw Refusal("joint " + std::to_string(i + 1) +
                    " is coupled to another joint, which this format cannot express; export the robot file instead");
    }
    // Rot_z(theta + s q) Trans_z(d) Ry(beta) = [Rot_z(theta) Trans_z(d)] [turn or slide by q along s z] [Ry(beta)]
    ChainJoint out;
    out.name = robot.joint_name[i].empty() ? "joint_" + std::to_string(i + 1) : robot.joint_name[i];
    out.kind = joint.kind;
    out.axis = {0, 0, joint.sign < 0 ? -1.0 : 1.0};
    out.parent_T_joint = compose(before, compose(compose(turn_x(link.alpha_rad), shift(link.a_m, 0, 0)),
                                                 compose(turn_z(link.theta_rad), shift(0, 0, link.d_m))));
    out.has_min = joint.has_min != 0;
    out.has_max = joint.has_max != 0;
    out.min = joint.min;
    out.max = joint.max;
    chain.joints.push_back(out);
    before = turn_y(link.beta_rad);
  }
  chain.last_T_tip = compose(before, frame_of(robot.geometry.last_T_flange));
  return chain;
}

}  // namespace mdhcal::offline
