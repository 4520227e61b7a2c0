// SPDX-License-Identifier: MIT
#include "offline/measure/columns.hpp"

#include <algorithm>
#include <cmath>

namespace mdhcal::offline {

namespace {

constexpr std::size_t most_listed = 50;  // columns named in a message: one screen

bool is_length(const Unit& unit) { return unit.name == millimetre.name || unit.name == metre.name; }
bool is_angle(const Unit& unit) { return unit.name == degree.name || unit.name == radian.name; }

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
    Unit stated = unit;
    if (names[i] != name) {
      if (names[i].size() <= name.size() + 1 || names[i].compare(0, name.size(), name) != 0 ||
          names[i][name.size()] != '_') {
        continue;
      }
      const std::string_view suffix = std::string_view(names[i]).substr(name.size() + 1);
      if (is_length(unit) && suffix == "mm") {
        stated = millimetre;
      } else if (is_length(unit) && suffix == "m") {
        stated = metre;
      } else if (is_angle(unit) && (suffix == "deg" || suffix == "\xC2\xB0")) {  // or a degree sign
        stated = degree;
      } else if (is_angle(unit) && suffix == "rad") {
        stated = radian;
      } else {
        continue;
      }
    }
    if (column.found) csv_.fail_header(i, "found \"" + name + "\" a second time; expected each column once.");
    column = {i, stated, true, names[i] != name};
    used_[i] = true;
  }
  return column;
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

std::vector<Column> Columns::joints(const Geometry& geometry, const Unit& angle, const Unit& length,
                                    const std::string& prefix, const std::string& suffix, bool must) {
  const auto begins = [&](const std::string& letter) {
    const std::string first = letter + '1' + suffix;
    return std::any_of(csv_.names().begin(), csv_.names().end(),
                       [&](const std::string& name) { return name == first || name.starts_with(first + '_'); });
  };
  if (prefix == "q" && !begins("q") && begins("j")) return joints(geometry, angle, length, "j", suffix, must);
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
