// SPDX-License-Identifier: MIT
// What a column of someone else's table means.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "offline/import/profile.hpp"
#include "offline/robot/robot.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

enum class Quantity : std::int32_t {
  unused,
  name,         ///< part of the point's name; Meaning::part says which: "id", "group", "target", "collection"
  time,         ///< [s]
  position,     ///< index 0, 1, 2: x, y, z [m]
  sigma,        ///< standard deviation in x, y, z [m]; index 3: in each of them
  expanded,     ///< expanded uncertainty (U95) in x, y, z [m]
  spherical,    ///< index 0 azimuth, 1 zenith angle, 2 range, 3 elevation [rad], [m]
  quaternion,   ///< index 0 ... 3: w, x, y, z
  rotation,     ///< three angles: index 0, 1, 2 in the convention's order, 3, 4, 5 about x, y, z [rad]
  joint,        ///< index: the joint, from 0 [rad] or [m]
  temperature, direction, payload,  ///< columns that a measurement file takes as they are
};

struct Meaning {
  Quantity quantity = Quantity::unused;
  std::size_t index = 0;
  std::string part;            ///< of a name
  std::string object;          ///< of a position, its uncertainty or rotation: which of several points of the row, "" for one
  const Unit* unit = nullptr;  ///< as the column states it; null where it does not
};

/// The meaning of a word: "id", "group", "target", "collection", "t", "x", "y", "z" (of several points "x1", "x2", ...),
/// "sx" ..., "sigma", "ux" ..., "azimuth", "zenith", "elevation", "range", "qw" ..., "rx", "ry", "rz" (about those axes),
/// "r1", "r2", "r3" (in the convention's order), "q1" ... "q8", "temperature", "direction", "payload", "-" (unused); with "_mm",
/// "_m", "_um", "_in", "_deg", "_rad", "_s", "_ms" for the unit. Nothing if it is none.
std::optional<Meaning> meaning_of_word(const std::string& word);

/// The words above, for messages.
std::string meaning_words();

/// The unit that a word names ("mm", "[deg]", a degree sign, "seconds", ...), or null.
const Unit* unit_of_word(std::string_view word);

/// The meanings of a header's columns: as the profile's [rename] says, else as their words tell. Nominal values, deviations,
/// tolerances and surface normals are unused.
/// Joints are told by the profile's `joints`, the robot's joint names, UR's joint names in ROS, S L U R B T, or a
/// number behind q, j, a, joint, axis, counted from 1 (or from 0): all of the robot's joints or none.
/// Throws InputError if a pattern of [rename] fits no column, or two columns mean the same.
std::vector<Meaning> meanings_of_header(const std::vector<std::string>& header, const Profile& profile, const Robot& robot,
                                        const std::string& path);

/// The parts of a point's name by a pattern: "RobotCal::Pose01::A" by "{collection}::{id}::{target}". Nothing if the name
/// does not fit. With `check_only` the pattern alone is looked at: nothing if it is none.
std::optional<std::map<std::string, std::string>> parts_of_name(std::string_view name, const std::string& pattern, bool check_only = false);

}  // namespace mdhcal::offline
