// SPDX-License-Identifier: MIT
#include "offline/import/units_check.hpp"

#include <algorithm>
#include <cmath>

#include "offline/import/numbers.hpp"

namespace mdhcal::offline {

namespace {

bool is_angle(const Unit& unit) { return unit.name == "deg" || unit.name == "rad" || unit.name == "mrad" || unit.name == "gon"; }
bool is_time(const Unit& unit) { return unit.name == "s" || unit.name == "ms"; }

bool slides(const Robot& robot, const Meaning& joint) { return robot.geometry.joint[joint.index].kind == JointKind::prismatic; }

bool measures_angle(const Robot& robot, const Meaning& m) {
  return m.quantity == Quantity::rotation || (m.quantity == Quantity::spherical && m.index != 2) ||
         (m.quantity == Quantity::joint && !slides(robot, m));
}

bool measures_length(const Robot& robot, const Meaning& m) {
  return m.quantity == Quantity::position || m.quantity == Quantity::sigma || m.quantity == Quantity::expanded ||
         (m.quantity == Quantity::spherical && m.index == 2) || (m.quantity == Quantity::joint && slides(robot, m));
}

// Whether the unit that a column states is of the kind that it measures.
bool fits(const Robot& robot, const Meaning& m) {
  if (measures_angle(robot, m)) return is_angle(*m.unit);
  if (measures_length(robot, m)) return !is_angle(*m.unit) && !is_time(*m.unit);
  return m.quantity != Quantity::time || is_time(*m.unit);
}

}  // namespace

std::string question_of_units(const std::vector<Meaning>& meanings, const TextTable& table, const Robot& robot, const Profile& profile) {
  double largest = 0;
  bool stated = true;
  for (std::size_t k = 0; k < meanings.size(); ++k) {
    const Meaning& m = meanings[k];
    if (m.unit != nullptr && !fits(robot, m)) {
      return "Found the unit \"" + std::string(m.unit->name) + "\" on column " + std::to_string(k + 1) +
             ", which is of another kind than what is measured there; expected " +
             (measures_angle(robot, m) ? "deg or rad." : "mm or m.");
    }
    if (m.quantity != Quantity::joint || slides(robot, m)) continue;
    if (m.unit == nullptr && profile.joint_unit.empty()) stated = false;
    for (const TableRow& row : table.rows) {
      largest = std::max(largest, std::abs(parse_number(row.fields[k].text, table.decimal).value_or(0)));
    }
  }
  // A turn is 6.28 rad; a set of poses that spans less than that in degrees identifies nothing.
  constexpr double turn = 6.4;
  constexpr std::size_t few_rows = 4;  // of fewer nothing is identified anyway
  if (!stated && table.rows.size() >= few_rows && largest > 0 && largest <= turn) {
    return "Found joints without a unit, all of them below 6.4; expected --joint-unit rad (or deg) to say what they are in.";
  }
  return {};
}

}  // namespace mdhcal::offline
