// SPDX-License-Identifier: MIT
// What other programs' robot descriptions have in common: fixed transforms and axes between them.
#pragma once

#include <string>
#include <vector>

#include "mdhcal/arm.hpp"
#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// A moving joint: parent_T_child(q) = parent_T_joint * (turn by q about, or slide by q along, `axis`).
struct ChainJoint {
  std::string name;
  JointKind kind = JointKind::revolute;
  Frame<double> parent_T_joint{};  ///< from the frame that the joint before moves (or the base), at q = 0
  Vector3 axis{0, 0, 1};           ///< unit vector in the joint's frame
  bool has_min = false, has_max = false;
  double min = 0, max = 0;         ///< [rad] or [m]
};

/// A serial chain: base_T_tip(q) = joint 1 ... joint N * last_T_tip.
struct Chain {
  std::string name;
  std::vector<ChainJoint> joints;
  Frame<double> last_T_tip{};
  std::string kinematics_hash;     ///< of a UR's factory calibration, where its file states it
  std::vector<std::string> notes;  ///< what was not taken as it stands, to be said once
};

/// The identity transform.
Frame<double> identity_frame();

/// The shortest rotation that takes the z axis to `axis` (a unit vector).
Frame<double> z_to(const Vector3& axis);

/// Roll, pitch and yaw [rad] of a rotation: Rot_z(yaw) Rot_y(pitch) Rot_x(roll). Accurate also where pitch is near a
/// right angle.
Vector3 roll_pitch_yaw(const Frame<double>& frame);
Frame<double> frame_of_xyz_rpy(const Vector3& xyz_m, const Vector3& rpy_rad);

/// base_T_tip at the readings q [rad] or [m], one a joint.
Frame<double> tip(const Chain& chain, const double* q);

/// What is to be said about a robot's base frame against the chain's: empty if they are the same.
std::string base_frame_note(const Robot& robot, const std::string& base);

/// The chain as a robot in the modified convention, exact for every chain. Where link 1 cannot express the way to
/// the first axis, tracker_T_base holds the rest of it: chain base = tracker frame.
/// Throws InputError if the chain has no joint or more than max_joints, or leaves the valid range.
Robot robot_from_chain(const Chain& chain, const std::string& path);

/// A robot's geometry as a chain whose axes are +z or, for a joint of sign -1, -z. With `with_base` the chain starts in
/// the tracker frame where the robot has one. Throws Refusal if a joint is coupled: a chain cannot say that.
Chain chain_of(const Robot& robot, bool with_base);

}  // namespace mdhcal::offline
