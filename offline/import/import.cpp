// SPDX-License-Identifier: MIT
#include "offline/import/import.hpp"

#include <algorithm>
#include <set>

#include "offline/base/error.hpp"
#include "offline/base/read_file.hpp"
#include "offline/measure/joint_file.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

std::string in_mm(double metres) { return shortest_decimal(millimetre.from_si(metres)); }

// A note of a file's name in a comment: one line, whatever the name holds.
std::string one_line(const std::string& text) {
  std::string out;
  for (const char c : text) out += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c;
  return out;
}

std::string text_of_rows(const Joined& joined, const Robot& robot, const std::string& heading) {
  bool target = false, sigma = false, rotation = false;
  std::set<std::string> extra;
  for (const JoinedRow& row : joined.rows) {
    target = target || !row.target.empty();
    sigma = sigma || row.measured->sigma_m.has_value();
    rotation = rotation || row.measured->quaternion.has_value();
    for (const auto& [name, value] : row.measured->extra) extra.insert(name);
  }
  // A column that only some rows fill would be refused, or mean something else there.
  for (auto name = extra.begin(); name != extra.end();) {
    const bool whole = std::all_of(joined.rows.begin(), joined.rows.end(), [&](const JoinedRow& row) { return row.measured->extra.count(*name) != 0; });
    name = whole ? std::next(name) : extra.erase(name);
  }
  std::string text = heading + "id" + (target ? ",target" : "") + ',' + joint_header(robot.geometry, "q") + ",x_mm,y_mm,z_mm" +
                     (sigma ? ",sx_mm,sy_mm,sz_mm" : "") + (rotation ? ",qw,qx,qy,qz" : "");
  for (const std::string& name : extra) text += ',' + name;
  text += '\n';
  for (const JoinedRow& row : joined.rows) {
    const SourceRow& m = *row.measured;
    text += csv_field(row.id) + (target ? ',' + csv_field(row.target) : "");
    for (std::int32_t j = 0; j < robot.geometry.joint_count; ++j) {
      const Unit& unit = robot.geometry.joint[j].kind == JointKind::prismatic ? millimetre : degree;
      text += ',' + shortest_decimal(unit.from_si(row.joints[static_cast<std::size_t>(j)]));
    }
    for (const double p : *m.position_m) text += ',' + in_mm(p);
    if (sigma) {
      for (std::size_t k = 0; k < 3; ++k) text += ',' + (m.sigma_m ? in_mm((*m.sigma_m)[k]) : "");
    }
    if (rotation) {
      for (std::size_t k = 0; k < 4; ++k) text += ',' + (m.quaternion ? shortest_decimal((*m.quaternion)[k]) : "");
    }
    for (const std::string& name : extra) text += ',' + csv_field(m.extra.at(name));
    text += '\n';
  }
  return text;
}

}  // namespace

Imported import_measurements(const ImportOptions& options, const Robot& robot) {
  if (options.exports.empty()) throw InputError("Found no file of a tracker; expected at least one.");
  std::vector<SourceTable> exports;
  Imported out;
  std::string heading = "# mdhcal import:";
  for (const std::string& path : options.exports) {
    exports.push_back(read_source(read_file(path, "a tracker's export"), path, options.profile, robot, options.pulses_per_unit));
    heading += ' ' + one_line(path);
  }
  SourceTable log;
  if (!options.log.empty()) {
    log = read_source(read_file(options.log, "a log of joints"), options.log, options.log_profile, robot, options.pulses_per_unit);
    heading += ", joints of " + one_line(options.log);
  }
  const Joined joined = join(exports, options.log.empty() ? nullptr : &log, robot, options.join, options.profile.targets);
  for (const SourceTable& table : exports) out.notes.insert(out.notes.end(), table.notes.begin(), table.notes.end());
  out.notes.insert(out.notes.end(), log.notes.begin(), log.notes.end());
  out.notes.insert(out.notes.end(), joined.notes.begin(), joined.notes.end());
  out.rows = joined.rows.size();
  out.text = text_of_rows(joined, robot, heading + '\n');
  return out;
}

}  // namespace mdhcal::offline
