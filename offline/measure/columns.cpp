// SPDX-License-Identifier: MIT
#include "offline/measure/columns.hpp"

#include <algorithm>
#include <cmath>

namespace mdhcal::offline {

namespace {

constexpr std::size_t most_listed = 50;  // columns named in a message: one screen

bool is_length(const Unit& unit) { return unit.name == millimetre.name || unit.name == metre.name; }
bool is_angle(const Unit& unit) { return unit.name == degree.name || unit.name == radian.name; }

bool is_degree(std::string_view suffix) { return suffix == "deg" || suffix == "\xC2\xB0"; }  // or a degree sign

// What follows `name` and an underscore in a column's name; empty if that is another one.
std::string_view suffix_behind(std::string_view column, std::string_view name) {
  if (column.size() <= name.size() + 1 || !column.starts_with(name) || column[name.size()] != '_') return {};
  return column.substr(name.size() + 1);
}

std::string in_small_letters(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

// What other systems put before a joint's number.
constexpr std::string_view other_prefixes[] = {"j", "a", "joint_", "joint", "axis_", "axis"};

}  // namespace

double Column::read(const Csv& csv, double bound) const {
  const double si = unit.to_si(csv.number(index));
  if (!(std::abs(si) <= bound)) {
    csv.fail(index, "found " + std::string(csv.field(index)) + "; expected at most " +
                        shortest_decimal(unit.from_si(bound)) + (unit.name.empty() ? "" : std::string(" ").append(unit.name)) +
                        " in size (wrong unit?).");
  }
  return si;
}

Column Columns::find(const std::string& name, const Unit& unit) {
  Column column;
  const auto& names = csv_.names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (used_[i]) continue;
    const std::string_view suffix = suffix_behind(names[i], name);
    Unit stated = unit;
    if (names[i] != name) {
      if (is_length(unit) && suffix == "mm") {
        stated = millimetre;
      } else if (is_length(unit) && suffix == "m") {
        stated = metre;
      } else if (is_angle(unit) && is_degree(suffix)) {
        stated = degree;
      } else if (is_angle(unit) && suffix == "rad") {
        stated = radian;
      } else {
        continue;
      }
    }
    if (column.found) csv_.fail_header(i, "found \"" + name + "\" a second time; expected each column once.");
    column = {i, stated, true, names[i] != name};
  }
  if (column.found) used_[column.index] = true;
  return column;
}

bool Columns::has(const std::string& name) const {
  const auto& names = csv_.names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string_view suffix = suffix_behind(names[i], name);
    if (!used_[i] && (names[i] == name || is_degree(suffix) || suffix == "rad" || suffix == "mm" || suffix == "m")) return true;
  }
  return false;
}

Column Columns::require(const std::string& name, const Unit& unit, const std::string& purpose) {
  const Column column = find(name, unit);
  if (!column) {
    csv_.fail_header("The column \"" + name + "\" is missing; expected it " + purpose + "; found the columns " + list() +
                     ".");
  }
  return column;
}

std::vector<Column> Columns::find_all(std::initializer_list<std::string> names, const Unit& unit) {
  std::vector<Column> columns;
  std::string all, missing;
  for (const std::string& name : names) {
    const Column column = find(name, unit);
    if (column) columns.push_back(column);
    if (!column && missing.empty()) missing = name;
    all += (all.empty() ? "" : ", ") + name;
  }
  if (!columns.empty() && !missing.empty()) {
    csv_.fail_header("The column \"" + missing + "\" is missing; expected all of " + all + "; found the columns " +
                     list() + ".");
  }
  return columns;
}

bool Columns::begins(const std::string& prefix, const std::string& suffix) const {
  const std::string first = prefix + '1' + suffix;
  const auto& names = csv_.names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!used_[i] && (names[i] == first || names[i].starts_with(first + '_'))) return true;
  }
  return false;
}

// All of them or none: a part is refused with the name that is missing.
std::vector<Column> Columns::named_joints(const Geometry& geometry, const Unit& angle, const Unit& length,
                                          const std::vector<std::string>& own_names, const std::string& suffix) {
  std::vector<Column> columns;
  std::string missing;
  for (std::size_t i = 0; i < own_names.size() && i < static_cast<std::size_t>(geometry.joint_count); ++i) {
    if (own_names[i].empty()) return {};
    const Unit unit = geometry.joint[i].kind == JointKind::prismatic ? length : angle;
    const Column column = find(in_small_letters(own_names[i]) + suffix, unit);
    if (column) columns.push_back(column);
    if (!column && missing.empty()) missing = own_names[i];
  }
  if (!columns.empty() && !missing.empty()) {
    csv_.fail_header("The column \"" + missing + suffix + "\" is missing; expected a column of each joint_name of the "
                     "robot file; found the columns " + list() + ".");
  }
  return columns;
}

std::vector<Column> Columns::joints(const Geometry& geometry, const Unit& angle, const Unit& length,
                                    const std::string& prefix, const std::string& suffix, bool must,
                                    const std::vector<std::string>& own_names) {
  if (prefix == "q" && !begins("q", suffix)) {
    std::vector<Column> named = named_joints(geometry, angle, length, own_names, suffix);
    if (!named.empty()) return named;
    for (const std::string_view other : other_prefixes) {
      if (begins(std::string(other), suffix)) return joints(geometry, angle, length, std::string(other), suffix, must);
    }
    if (must) {
      csv_.fail_header("The column \"q1\" is missing; expected the readings of the robot's " +
                       std::to_string(geometry.joint_count) + (geometry.joint_count == 1 ? " joint" : " joints") +
                       " in q1, q2, ... (or j1, a1, joint_1, axis_1 and so on, or under the names that the robot file "
                       "states by joint_name in each [[link]]); found the columns " + list() + ".");
    }
    return {};
  }
  const auto count = static_cast<std::size_t>(geometry.joint_count);
  std::vector<Column> columns;
  for (std::size_t i = 0; i < count; ++i) {
    const Unit unit = geometry.joint[i].kind == JointKind::prismatic ? length : angle;
    const Column column = find(prefix + std::to_string(i + 1) + suffix, unit);
    if (column) columns.push_back(column);
    if (!column && (must || !columns.empty())) {
      (void)require(prefix + std::to_string(i + 1) + suffix, unit,
                    "because the robot has " + std::to_string(count) + (count == 1 ? " joint" : " joints"));
    }
  }
  const Column beyond = find(prefix + std::to_string(count + 1) + suffix, angle);
  const Column beyond_in_length = beyond ? beyond : find(prefix + std::to_string(count + 1) + suffix, length);
  if (beyond_in_length) {
    csv_.fail_header(beyond_in_length.index, "found a reading of joint " + std::to_string(count + 1) +
                                                 "; expected as many as the robot has joints, " +
                                                 std::to_string(count) + ".");
  }
  return columns;
}

std::string Columns::unknown() const {
  std::string names;
  std::size_t count = 0;
  for (std::size_t i = 0; i < used_.size(); ++i) {
    if (used_[i]) continue;
    if (++count > most_listed) return names + ", ...";
    names += names.empty() ? "\"" : ", \"";
    names += csv_.names()[i];
    names += '"';
  }
  return names;
}

std::string Columns::list() const {
  std::string names;
  const auto& all = csv_.names();
  for (std::size_t i = 0; i < std::min(all.size(), most_listed); ++i) names += (i == 0 ? "" : ", ") + all[i];
  return all.size() > most_listed ? names + ", ..." : names;
}

}  // namespace mdhcal::offline
