// SPDX-License-Identifier: MIT
#include "offline/measure/rotation_columns.hpp"

#include <algorithm>
#include <cmath>

namespace mdhcal::offline {

namespace {

struct Group {
  std::vector<std::string> names;
  bool by_axis = false;  // in the order x, y, z
};

const std::vector<Group>& three_numbers() {
  static const std::vector<Group> groups{
      {{"rx", "ry", "rz"}, true}, {{"roll", "pitch", "yaw"}, true}, {{"ex", "ey", "ez"}, true},
      {{"a", "b", "c"}},          {{"w", "p", "r"}},                {{"o", "a", "t"}},
      {{"u", "v", "w"}},          {{"a", "e", "r"}},                {{"e1", "e2", "e3"}}};
  return groups;
}

const std::vector<Group>& four_numbers() {
  static const std::vector<Group> groups{
      {{"qw", "qx", "qy", "qz"}}, {{"q0", "q1", "q2", "q3"}}, {{"q1", "q2", "q3", "q4"}}};
  return groups;
}

std::string names_listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

bool all_there(const Columns& columns, const Group& group) {
  for (const std::string& name : group.names) {
    if (!columns.has(name)) return false;
  }
  return true;
}

// q0, q1, ... are joint readings (counted from 0 or 1) unless these stand under another name, or stop at q3.
bool are_joints(const Columns& columns, const Group& group) {
  if (group.names[0] != "q0" && group.names[0] != "q1") return false;
  for (const char* other : {"j1", "a1", "joint_1", "joint1", "axis_1", "axis1"}) {
    if (columns.has(other)) return false;
  }
  return group.names[0] == "q1" || columns.has("q4");
}

bool by_place(const Column& a, const Column& b) { return a.index < b.index; }

}  // namespace

RotationColumns::RotationColumns(const Csv& csv, Columns& columns, const Unit& angle, const std::string& named) : csv_(csv) {
  if (named == "none") {
    for (const auto* groups : {&four_numbers(), &three_numbers()}) {
      for (const Group& group : *groups) {
        if (all_there(columns, group) && !are_joints(columns, group)) {
          for (const std::string& name : group.names) (void)columns.find(name, angle);
        }
      }
    }
    return;
  }
  if (named.empty()) {
    find_unnamed(columns, angle);
  } else {
    convention_ = require_rotation_convention(named, "--rotation");
    find_named(columns, angle);
  }
  for (const Column& column : columns_) unit_stated_ = unit_stated_ && (columns_.size() == 4 || column.unit_stated);
}

void RotationColumns::find_unnamed(Columns& columns, const Unit& angle) {
  columns_ = columns.find_all({"qw", "qx", "qy", "qz"}, plain_number);
  const std::vector<Column> vector = columns.find_all({"rx", "ry", "rz"}, angle);
  if (!columns_.empty() && !vector.empty()) {
    csv_.fail_header(vector[0].index, "found beside qw, qx, qy, qz; expected one kind of rotation.");
  }
  convention_ = *rotation_convention(vector.empty() ? "quaternion" : "vector");
  // Kept in the order in which they stand, so that they can be read again under another name.
  if (!columns_.empty() && by_place(columns_[1], columns_[2]) && by_place(columns_[2], columns_[3]) && by_place(columns_[3], columns_[0])) {
    std::sort(columns_.begin(), columns_.end(), by_place);
    convention_ = *rotation_convention("quaternion-xyzw");
  }
  by_axis_ = !vector.empty();
  if (columns_.empty()) columns_ = vector;
  if (!columns_.empty()) return;
  for (const auto* groups : {&three_numbers(), &four_numbers()}) {
    for (const Group& group : *groups) {
      if (!all_there(columns, group) || are_joints(columns, group)) continue;
      const Column first = columns.find(group.names[0], angle);
      csv_.fail_header(first.index, "found " + names_listed(group.names) +
                                        ", which look like a rotation; expected --rotation with their convention (" +
                                        (group.names.size() == 4 ? "quaternion or quaternion-xyzw"
                                                                 : "kuka, fanuc, staubli, abb, yaskawa, rpy, an order "
                                                                   "such as zyx or zyx-extrinsic, ...") +
                                        "), or --rotation none to leave them out.");
    }
  }
}

void RotationColumns::find_named(Columns& columns, const Unit& angle) {
  const bool quaternion = convention_.form == RotationForm::quaternion;
  const auto& groups = quaternion ? four_numbers() : three_numbers();
  const Unit unit = quaternion ? plain_number : convention_.radians ? radian : angle;
  std::string known;
  for (const Group& group : groups) {
    known += (known.empty() ? "" : " or ") + names_listed(group.names);
    if (!all_there(columns, group) || are_joints(columns, group)) continue;
    if (!columns_.empty()) {
      csv_.fail_header(columns.find(group.names[0], unit).index, "found beside another rotation; expected one.");
    }
    for (const std::string& name : group.names) columns_.push_back(columns.find(name, unit));
    by_axis_ = group.by_axis;
  }
  // The convention says what stands first, whatever the columns are called.
  if (quaternion) std::sort(columns_.begin(), columns_.end(), by_place);
  if (columns_.empty()) {
    csv_.fail_header("No columns of a rotation were found although --rotation " + convention_.name +
                     " is asked for; expected " + known + "; found the columns " + columns.list() + ".");
  }
}

bool RotationColumns::empty() const {
  for (const Column& column : columns_) {
    if (!column.empty(csv_)) return false;
  }
  return true;
}

std::array<double, 4> RotationColumns::numbers() const {
  std::array<double, 4> q{};
  if (columns_.size() == 3) {
    for (std::size_t k = 0; k < 3; ++k) q[k] = columns_[k].read(csv_);
    return q;
  }
  double norm = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    q[k] = columns_[k].read(csv_, 2.0);
    norm += q[k] * q[k];
  }
  norm = std::sqrt(norm);
  // Files carry a few digits; more than this is no rounding.
  if (!(std::abs(norm - 1.0) <= 1e-3)) {
    csv_.fail(columns_[0].index, "found a quaternion of norm " + shortest_decimal(norm) + "; expected a norm of 1.");
  }
  return q;
}

}  // namespace mdhcal::offline
