// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mdhcal/transmission.hpp"

namespace mdhcal::offline {

using Vector3 = std::array<double, 3>;
using Joints = std::array<double, max_joints>;  ///< readings [rad] or [m]

/// The longest joint_name [bytes].
inline constexpr std::size_t most_joint_name_bytes = 63;

/// A point on the flange that a reflector or tool defines, in the flange frame [m].
struct TargetPoint {
  std::string name;      ///< the `target` column's word; at most 15 bytes
  Vector3 flange_p_m{};
  /// How the probe that measures rotations there is turned on the flange (flange_R_probe); not in the blob.
  std::optional<std::array<double, 4>> quaternion{};
};

/// A robot as its file states it, in SI units and the modified convention, whatever the file used.
struct Robot {
  std::string path;      ///< the file that it came from, for messages
  std::string name;      ///< at most 63 bytes
  std::string serial;    ///< empty if none; at most 31 bytes

  /// The geometry to use: joints, links, flange. For a plain robot file this is the nominal geometry; for a
  /// corrected.toml it is the corrected one.
  Geometry geometry{};
  /// The nominal links. Equal to geometry.link unless the file states `nominal` tables (corrected.toml does).
  std::array<Link, max_joints> nominal{};

  /// joint_name: what other systems call each joint, for columns of measurements; empty where none is stated.
  std::array<std::string, max_joints> joint_name{};

  /// kinematics_hash: which factory calibration of a UR arm this is; kept from and for its ROS driver's file.
  std::string kinematics_hash;

  std::optional<Vector3> tool_p_m;                 ///< [tool]: nominal target point in the flange frame
  std::optional<std::array<double, 4>> tool_quaternion;  ///< [tool]: the turn of its probe, as TargetPoint's
  std::optional<Pose<double>> tracker_T_base;      ///< [base]
  std::vector<TargetPoint> targets;                ///< [[target]]

  /// [gravity]: where things fall, a unit vector in the base frame; straight down if the file does not say.
  Vector3 gravity_direction{0, 0, -1};
  /// Joint functions, sag and payload of the corrected arm ([[joint_function]], [[sag]], [payload]); the nominal arm has none.
  Transmission transmission{};

  /// [prior]: prior standard deviation of single parameters, by name ("alpha2", "d5", ...) [rad] or [m].
  std::map<std::string, double> prior;

  /// Units in which a file of this robot is written back.
  bool length_in_mm = true;
  bool angle_in_deg = true;

  bool standard = false;  ///< the file's table is in the standard convention
  std::string text;       ///< the file itself, for read_as(); empty if the robot came from no robot file
};

/// How to read a robot file's numbers in place of what the file says.
struct ReadAs {
  std::optional<bool> standard;
  std::optional<bool> length_in_mm;
  std::optional<bool> angle_in_deg;
};

/// The robot that its file states when it is read another way; nothing if the numbers are then out of range.
std::optional<Robot> read_as(const Robot& robot, const ReadAs& as);

/// Reads a robot file (TOML, docs/file-formats.md). A standard-convention table is converted exactly, with Hayati's beta where
/// neighbouring axes are nearly, but not exactly, parallel, so that no length runs away.
/// Throws InputError naming file, line, column, what was found and what was expected.
Robot read_robot(const std::string& path);

/// The same from text; `path` is only named in messages.
Robot parse_robot(const std::string& text, const std::string& path);

/// The robot as a robot file in the modified convention, with 17 significant digits where that is needed to read the
/// same values back: parse_robot(write_robot(r)) gives the bits of r, provided r came from parse_robot.
std::string write_robot(const Robot& robot);

}  // namespace mdhcal::offline
