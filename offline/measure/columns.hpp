// SPDX-License-Identifier: MIT
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "offline/measure/csv.hpp"
#include "offline/robot/robot.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

/// A column of a table and the unit of its numbers.
struct Column {
  std::size_t index = 0;
  Unit unit = plain_number;
  bool found = false;
  bool unit_stated = false;  ///< by a suffix of the column's name

  explicit operator bool() const { return found; }
  /// The field of the current row in SI units; InputError if it is not a number of at most `bound` in size.
  double read(const Csv& csv, double bound = 1e6) const;
  bool empty(const Csv& csv) const { return csv.empty(index); }
};

/// The columns of a table by their names: "x", or with a unit "x_mm", "x_m", "q1_deg", "q1_rad". Every InputError names
/// the column's place in the header.
class Columns {
 public:
  explicit Columns(const Csv& csv) : csv_(csv), used_(csv.names().size(), false) {}

  /// The column `name`, with `unit` unless a suffix says another of the same kind. Refuses repeated columns; what was
  /// found before is not found again.
  Column find(const std::string& name, const Unit& unit);
  Column find_text(const std::string& name) { return find(name, plain_number); }
  /// The same, but InputError if it is missing. `purpose` ends the sentence "expected it ...".
  Column require(const std::string& name, const Unit& unit, const std::string& purpose);

  /// Columns of several names that are there all or not at all: empty, or one each.
  std::vector<Column> find_all(std::initializer_list<std::string> names, const Unit& unit);

  /// Whether the column `name` is there, with a unit or without, and not yet found.
  bool has(const std::string& name) const;

  /// The joint readings `PREFIX1SUFFIX` ... of a robot, by default in `angle` and `length`. Where there is no q1: the
  /// columns of `own_names` (the robot file's joint_name, one a joint, in any order of columns), else the first of
  /// j1, a1, joint_1, joint1, axis_1, axis1 that is there. Empty if there is none and `must` is false; InputError for a
  /// wrong number of them.
  std::vector<Column> joints(const Geometry& geometry, const Unit& angle, const Unit& length, const std::string& prefix,
                             const std::string& suffix, bool must, const std::vector<std::string>& own_names = {});

  /// The names that nobody asked for, as they are told to the user; empty if there are none.
  std::string unknown() const;
  /// All names of the header, separated by commas.
  std::string list() const;

 private:
  bool begins(const std::string& prefix, const std::string& suffix) const;
  std::vector<Column> named_joints(const Geometry& geometry, const Unit& angle, const Unit& length,
                                   const std::vector<std::string>& own_names, const std::string& suffix);

  const Csv& csv_;
  std::vector<bool> used_;
};

/// The units that a robot's files are in by default.
inline Unit length_unit(const Robot& robot) { return robot.length_in_mm ? millimetre : metre; }
inline Unit angle_unit(const Robot& robot) { return robot.angle_in_deg ? degree : radian; }

}  // namespace mdhcal::offline
