// SPDX-License-Identifier: MIT
#include "offline/measure/joint_file.hpp"

#include <charconv>

#include "offline/base/error.hpp"
#include "offline/base/read_file.hpp"
#include "offline/base/text.hpp"
#include "offline/measure/columns.hpp"
#include "offline/measure/rotation_columns.hpp"
#include "offline/robot/rotation.hpp"

namespace mdhcal::offline {

namespace {

std::string id_of(const Csv& csv, const Column& column, std::size_t count) {
  return column && !column.empty(csv) ? std::string(csv.field(column.index)) : std::to_string(count + 1);
}

Joints joints_of(const Csv& csv, const std::vector<Column>& columns) {
  Joints q{};
  for (std::size_t j = 0; j < columns.size(); ++j) q[j] = columns[j].read(csv, max_reading);
  return q;
}

// What a spreadsheet would compute rather than show. A plain number is shown as it is.
bool is_formula(const std::string& text) {
  if (text.empty() || std::string_view("=+-@").find(text[0]) == std::string_view::npos) return false;
  double number = 0;
  const char* first = text.data() + (text[0] == '+' ? 1 : 0);
  const char* end = text.data() + text.size();
  const bool signs = text.size() > 1 && text[0] == '+' && (text[1] == '-' || text[1] == '+');
  return signs || std::from_chars(first, end, number).ptr != end;
}

template <class Row>
void finish(const Csv& csv, const Columns& columns, Table<Row>& table) {
  const std::string unknown = columns.unknown();
  if (!unknown.empty()) table.notes.push_back(csv.path() + ": unknown columns are ignored: " + unknown + ".");
}

}  // namespace

Table<JointRow> read_joint_file(const std::string& path, const Geometry& geometry) {
  const std::string text = read_file(path, "a table of joints");
  Csv csv(text, path, "a table of joints");
  Columns columns(csv);
  const Column id = columns.find_text("id");
  const auto q = columns.joints(geometry, degree, millimetre, "q", "", true);
  Table<JointRow> table;
  finish(csv, columns, table);
  while (csv.next()) table.rows.push_back({id_of(csv, id, table.rows.size()), joints_of(csv, q)});
  return table;
}

Table<PoseRow> read_pose_file(const std::string& path, const Geometry& geometry, const std::string& rotation_name) {
  const std::string text = read_file(path, "a table of poses");
  Csv csv(text, path, "a table of poses");
  Columns columns(csv);
  const Column id = columns.find_text("id");
  std::vector<Column> position;
  for (const char* name : {"x", "y", "z"}) position.push_back(columns.require(name, millimetre, "with the position"));
  RotationColumns rotation(csv, columns, degree, rotation_name);
  if (!rotation.found()) (void)columns.require("qw", plain_number, "with the rotation (or rx, ry, rz)");
  const auto seed = columns.joints(geometry, degree, millimetre, "s", "", false);
  Table<PoseRow> table;
  finish(csv, columns, table);
  while (csv.next()) {
    PoseRow row;
    row.id = id_of(csv, id, table.rows.size());
    for (std::size_t k = 0; k < 3; ++k) row.pose.position_m[k] = position[k].read(csv);
    const std::array<double, 4> q = rotation.quaternion(rotation.numbers());
    for (std::size_t k = 0; k < 4; ++k) row.pose.quaternion[k] = q[k];
    bool has_seed = !seed.empty();
    for (const Column& column : seed) has_seed = has_seed && !column.empty(csv);
    if (has_seed) row.seed = joints_of(csv, seed);
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string joint_header(const Geometry& geometry, const std::string& prefix) {
  std::string header;
  for (std::int32_t j = 0; j < geometry.joint_count; ++j) {
    if (j > 0) header += ',';
    header += prefix + std::to_string(j + 1) + (geometry.joint[j].kind == JointKind::prismatic ? "_mm" : "_deg");
  }
  return header;
}

std::string joint_fields(const Geometry& geometry, const double* q) {
  std::string fields;
  for (std::int32_t j = 0; j < geometry.joint_count; ++j) {
    const Unit& unit = geometry.joint[j].kind == JointKind::prismatic ? millimetre : degree;
    fields += ',' + csv_number(unit.from_si(q[j]));
  }
  return fields;
}

std::string csv_field(const std::string& text) {
  std::string shown = printable(text);
  if (is_formula(shown)) shown.insert(0, 1, '\'');
  if (shown.find_first_of(",;\t\"\n#") == std::string::npos) return shown;
  std::string field = "\"";
  for (const char c : shown) {
    if (c == '"') field += '"';
    field += c;
  }
  return field + '"';
}

std::string csv_number(double value) {
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 17);
  return {text.data(), end.ptr};
}

}  // namespace mdhcal::offline
