// SPDX-License-Identifier: MIT
// The two forms in which Universal Robots' factory calibration reaches users.
#pragma once

#include <string>
#include <vector>

#include "offline/robot/chain.hpp"
#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// The models whose published standard-DH table is built in ("ur3" ... "ur30", "ur3e", ...).
const std::vector<std::string>& ur_models();

/// The maker's published nominal geometry of a model. Throws InputError if it is none of ur_models().
Robot ur_nominal(const std::string& model);

/// The `kinematics:` YAML that the ROS driver's calibration extraction writes: x, y, z [m] and roll, pitch, yaw [rad] of
/// six joints (shoulder, upper_arm, forearm, wrist_1, wrist_2, wrist_3), each about the z axis of its frame; the tip is
/// wrist_3's frame (tool0). The joints of an arm that is not a UR are taken in the order of the file, with an
/// optional `flange` at the end, as ros_kinematics_text() writes them. Throws InputError with line and column.
Chain parse_ros_kinematics(const std::string& text, const std::string& path);

/// The controller's calibration.conf: delta_theta, delta_a, delta_d, delta_alpha, added to the model's standard-DH
/// table. `geometry` is the result, re-anchored with beta so that no length runs away; `nominal` is converted alike.
/// Throws InputError with line and column.
Robot parse_ur_calibration(const std::string& text, const std::string& path, const std::string& model);

/// A robot's geometry in the `kinematics:` form: six joints under UR's names, others as joint_1 ...; a `flange` is
/// added where the last joint's frame is not the flange. Throws Refusal if a joint is coupled or prismatic.
std::string ros_kinematics_text(const Robot& robot);

}  // namespace mdhcal::offline
