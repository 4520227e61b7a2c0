// SPDX-License-Identifier: MIT
#include "offline/import/rows.hpp"

#include <algorithm>
#include <cmath>

#include "offline/base/error.hpp"
#include "offline/import/meaning.hpp"
#include "offline/import/numbers.hpp"
#include "offline/import/program.hpp"
#include "offline/import/table.hpp"
#include "offline/import/text.hpp"
#include "offline/import/units_check.hpp"
#include "offline/measure/rotations.hpp"

namespace mdhcal::offline {

namespace {

bool has_digit(std::string_view text) { return text.find_first_of("0123456789") != std::string_view::npos; }

// A time without a unit since 1970 in seconds, ms, us or ns: they differ by a thousand each, and no log is of the year 5138.
double in_seconds(double time) {
  for (const double bound : {1e17, 1e14, 1e11}) {
    if (time >= bound) return time / (bound * 1e-8);
  }
  return time;
}

std::string in_list(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t k = 0; k < names.size() && k < 20; ++k) text += (k == 0 ? "\"" : ", \"") + names[k] + '"';
  return names.size() > 20 ? text + ", ..." : text;
}

// What the options and the profile say wins over what a recognised profile says.
Profile merged(const Profile& stated, Profile found) {
  if (!stated.encoding.empty()) found.encoding = stated.encoding;
  if (stated.delimiter != 0) found.delimiter = stated.delimiter;
  if (stated.decimal != 0) found.decimal = stated.decimal;
  if (!stated.names.empty()) found.names = stated.names;
  if (!stated.rotation.empty()) found.rotation = stated.rotation;
  if (!stated.length_unit.empty()) found.length_unit = stated.length_unit;
  if (!stated.angle_unit.empty()) found.angle_unit = stated.angle_unit;
  if (!stated.joint_unit.empty()) found.joint_unit = stated.joint_unit;
  if (!stated.targets.empty()) found.targets = stated.targets;
  if (!stated.joints.empty()) found.joints = stated.joints;
  return found;
}

class TableReader {
 public:
  TableReader(const std::string& text, const std::string& path, const Profile& profile, const Robot& robot)
      : text_(text), profile_(profile), robot_(robot), table_(read_text_table(text, path, profile)) {
    out_.path = path;
  }

  SourceTable read() {
    find_meanings();
    find_points();
    const std::string question = question_of_units(meanings_, table_, robot_, profile_);
    if (!question.empty()) ask(question);
    for (std::size_t k = 0; k < table_.rows.size(); ++k) read_row(table_.rows[k], k);
    out_.row_count = table_.rows.size();
    add_notes();
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const TableRow& row, std::size_t column, const std::string& message) const {
    throw InputError(table_.path, row.line, row.fields[column].column, message);
  }

  // Asks what the file does not tell.
  [[noreturn]] void ask(const std::string& question) const {
    throw InputError(table_.path, table_.rows.front().line, 1, question + " The file's first lines:" + first_lines(text_, 5));
  }

  std::size_t joint_count() const { return static_cast<std::size_t>(robot_.geometry.joint_count); }

  bool any(Quantity quantity) const {
    return std::any_of(meanings_.begin(), meanings_.end(), [&](const Meaning& m) { return m.quantity == quantity; });
  }

  // The columns of a quantity by index; the last such column where `object` does not matter.
  std::map<std::size_t, std::size_t> columns(Quantity quantity, const std::string* object = nullptr) const {
    std::map<std::size_t, std::size_t> found;
    for (std::size_t k = 0; k < meanings_.size(); ++k) {
      if (meanings_[k].quantity == quantity && (object == nullptr || meanings_[k].object == *object)) found.emplace(meanings_[k].index, k);
    }
    return found;
  }

  void find_meanings() {
    if (!profile_.columns.empty()) {
      if (profile_.columns.size() != table_.columns()) {
        ask("Found " + std::to_string(table_.columns()) + " columns; expected " + std::to_string(profile_.columns.size()) +
            (profile_.name.empty() ? " as --columns says." : " as the profile " + profile_.name + " says."));
      }
      for (const std::string& word : profile_.columns) meanings_.push_back(*meaning_of_word(word));
    } else {
      if (!table_.header.empty()) meanings_ = meanings_of_header(table_.header, profile_, robot_, table_.path);
      if (table_.header_in_comment && !heads_numbers()) table_.header.clear();
      if (table_.header.empty()) guess_meanings();
    }
    const bool spherical = any(Quantity::spherical);
    out_.measures = any(Quantity::position) || spherical;
    out_.has_joints = any(Quantity::joint);
    if (!out_.measures && !out_.has_joints) {
      ask("Found neither a measured point nor the robot's " + std::to_string(joint_count()) + " joints in the columns " + in_list(table_.header) +
          "; expected x, y, z or q1, q2, ...: which column is what? Say it by --columns with a word for each column (such as id,x_mm,y_mm,z_mm; - for "
          "one that is not used) or by [rename] in a profile.");
    }
    std::vector<bool> joint_seen(max_joints, false);
    for (const Meaning& m : meanings_) {
      if (m.quantity != Quantity::joint) continue;
      if (m.index >= joint_count() || joint_seen[m.index]) ask("Found joint " + std::to_string(m.index + 1) + " twice, or beyond the robot's " + std::to_string(joint_count()) + "; expected each joint once.");
      joint_seen[m.index] = true;
    }
    if (out_.has_joints && columns(Quantity::joint).size() != joint_count()) ask("Found " + std::to_string(columns(Quantity::joint).size()) + " joints; expected the robot's " + std::to_string(joint_count()) + '.');
  }

  // Whether a comment taken for the header has a meaning for numbers above numbers only, and some meaning at all.
  bool heads_numbers() const {
    bool some = false;
    for (std::size_t k = 0; k < meanings_.size(); ++k) {
      const bool measured = meanings_[k].quantity == Quantity::position || meanings_[k].quantity == Quantity::joint;
      if (measured && !may_be_number(table_.rows.front().fields[k].text)) return false;
      some = some || measured;
    }
    return some;
  }

  // A table without a header: words in front are names; three numbers behind them are a point, as many as the robot has joints
  // are joints.
  void guess_meanings() {
    std::vector<bool> numeric(table_.columns(), true);
    for (const TableRow& row : table_.rows) {
      for (std::size_t k = 0; k < row.fields.size(); ++k) {
        if (!parse_number(row.fields[k].text, table_.decimal) && !is_missing_mark(row.fields[k].text)) numeric[k] = false;
      }
    }
    const auto names = static_cast<std::size_t>(std::find(numeric.begin(), numeric.end(), true) - numeric.begin());
    const std::size_t numbers = numeric.size() - names;
    const bool all = static_cast<std::size_t>(std::count(numeric.begin(), numeric.end(), true)) == numbers;
    const std::string question = "Found no header above " + std::to_string(numeric.size()) +
                                 " columns; expected to be told what they are: --columns with a word for each (such as id,x_mm,y_mm,z_mm; - for one that is "
                                 "not used), or --profile with one of the built-in layouts.";
    if (!all || names > 3 || (numbers != 3 && numbers != joint_count()) || joint_count() == 3) ask(question);
    if (numbers == 3 && may_be_spherical(names)) {
      ask("Found three numbers a row without a header that may be two angles and a range; expected --columns id,x_mm,y_mm,z_mm or "
          "id,azimuth_deg,zenith_deg,range_mm to say which.");
    }
    meanings_.clear();
    static const char* const parts[3][3] = {{"id", "", ""}, {"group", "id", ""}, {"collection", "group", "id"}};
    for (std::size_t k = 0; k < names; ++k) meanings_.push_back(*meaning_of_word(parts[names - 1][k]));
    for (std::size_t k = 0; k < numbers; ++k) {
      Meaning m;
      m.quantity = numbers == 3 ? Quantity::position : Quantity::joint;
      m.index = k;
      meanings_.push_back(m);
    }
    out_.notes.push_back(table_.path + ": without a header, its columns are taken for " + (names > 0 ? "names and " : "") +
                         (numbers == 3 ? "x, y, z." : "the joints in order."));
  }

  // Whether the three numbers behind the names could be an azimuth, a zenith angle and a range in every row.
  bool may_be_spherical(std::size_t names) const {
    for (const TableRow& row : table_.rows) {
      std::array<double, 3> v{};
      for (std::size_t k = 0; k < 3; ++k) {
        const auto number = parse_number(row.fields[names + k].text, table_.decimal);
        if (!number) return false;
        v[k] = *number;
      }
      if (!(std::abs(v[0]) <= 360.0 && v[1] >= 0.0 && v[1] <= 180.0 && v[2] > 0.0)) return false;
    }
    return true;
  }

  void find_points() {
    for (const Meaning& m : meanings_) {
      if (m.quantity == Quantity::position && std::find(objects_.begin(), objects_.end(), m.object) == objects_.end()) objects_.push_back(m.object);
    }
    // A body with a rotation among single markers is what is measured.
    std::vector<std::string> turned;
    for (const std::string& object : objects_) {
      if (columns(Quantity::quaternion, &object).size() == 4) turned.push_back(object);
    }
    if (turned.size() == 1 && objects_.size() > 1) objects_ = turned;
    for (const std::string& object : objects_) {
      if (columns(Quantity::position, &object).size() != 3) {
        ask("Found x, y, z of a point in part" + (object.empty() ? std::string() : " (\"" + object + "\")") + "; expected all three, each once.");
      }
    }
    if (objects_.size() > 1) {
      out_.points = profile_.targets;
      const bool numbered = std::all_of(objects_.begin(), objects_.end(), [](const std::string& o) { return o.find_first_not_of("0123456789") == std::string::npos; });
      if (out_.points.empty() && numbered && robot_.targets.size() == objects_.size()) {
        for (const TargetPoint& target : robot_.targets) out_.points.push_back(target.name);
        out_.notes.push_back(table_.path + ": the " + std::to_string(objects_.size()) + " points of a row are the robot file's targets, in order.");
      }
      if (out_.points.empty()) out_.points = objects_;
      if (out_.points.size() != objects_.size()) {
        ask("Found " + std::to_string(objects_.size()) + " points in a row (" + in_list(objects_) + "); expected a name for each, --targets A,B,...");
      }
    } else if (objects_.empty()) {
      objects_.emplace_back();
    }
    const auto rotation = columns(Quantity::rotation);
    if (rotation.empty() || !out_.measures || profile_.rotation == "none" || columns(Quantity::quaternion).size() == 4) return;
    if (profile_.rotation.empty()) {
      std::vector<std::string> names;
      for (const auto& [index, column] : rotation) names.push_back(column < table_.header.size() ? table_.header[column] : profile_.columns[column]);
      ask("Found " + in_list(names) + " beside the point, which state a rotation; expected --rotation with the convention (such as rpy, kuka, fanuc, zyx, "
          "vector), or --rotation none to leave it out.");
    }
    convention_ = require_rotation_convention(profile_.rotation, "--rotation");
    by_axis_ = rotation.begin()->first >= 3;
    if (rotation.size() != 3 || convention_->count() != 3 || rotation.rbegin()->first - rotation.begin()->first != 2) {
      ask("Found " + std::to_string(rotation.size()) + " columns of a rotation; expected three angles for --rotation " + profile_.rotation + '.');
    }
  }

  const Unit& unit_of(const Meaning& m, const std::string& stated, const Unit& fallback) const {
    if (m.unit != nullptr) return *m.unit;
    const Unit* unit = unit_of_word(stated);
    return unit != nullptr ? *unit : fallback;
  }

  const Unit& joint_unit(const Meaning& m) const {
    const bool prismatic = robot_.geometry.joint[m.index].kind == JointKind::prismatic;
    return prismatic ? unit_of(m, profile_.length_unit, millimetre) : unit_of(m, profile_.joint_unit, degree);
  }

  double number(const TableRow& row, std::size_t column, const Unit& unit, double bound) const {
    const std::string& field = row.fields[column].text;
    const auto value = parse_number(field, table_.decimal);
    if (!value) fail(row, column, "Found \"" + field.substr(0, 40) + "\"; expected a number.");
    const double si = unit.to_si(*value);
    if (!(std::abs(si) <= bound)) fail(row, column, "Found " + field.substr(0, 40) + ' ' + std::string(unit.name) + "; expected a smaller number (wrong unit?).");
    return si;
  }

  // The three columns of a point; nothing where it was not measured.
  std::optional<Vector3> point(const TableRow& row, const std::string& object) {
    const auto position = columns(Quantity::position, &object);
    const auto angles = columns(Quantity::spherical);
    const auto& from = position.empty() ? angles : position;
    if (from.empty()) return {};
    if (std::none_of(from.begin(), from.end(), [&](const auto& c) { return has_digit(row.fields[c.second].text); })) return {};
    // NDI writes -3.7e28 for what it did not see.
    if (std::any_of(from.begin(), from.end(), [&](const auto& c) { return std::abs(parse_number(row.fields[c.second].text, table_.decimal).value_or(0)) > 1e20; })) return {};
    Vector3 p{};
    if (!position.empty()) {
      for (const auto& [axis, column] : position) {
        p[axis] = number(row, column, unit_of(meanings_[column], profile_.length_unit, robot_.length_in_mm ? millimetre : metre), 1e5);
      }
      // Trackers write zeros for a point that they did not see: it would be the tracker itself.
      if (std::abs(p[0]) > 0 || std::abs(p[1]) > 0 || std::abs(p[2]) > 0) return p;
      zeros_ += (zeros_.empty() ? "" : ", ") + std::to_string(row.line);
      return {};
    }
    const bool zenith = angles.count(1) != 0;
    if (angles.count(0) == 0 || angles.count(2) == 0 || zenith == (angles.count(3) != 0)) ask("Found angles and a range in part; expected azimuth, range and either zenith or elevation.");
    const auto angle = [&](std::size_t index) { return number(row, angles.at(index), unit_of(meanings_[angles.at(index)], profile_.angle_unit, degree), 100.0); };
    const double azimuth = angle(0), polar = zenith ? angle(1) : 0.5 * pi - angle(3);
    const double range = number(row, angles.at(2), unit_of(meanings_[angles.at(2)], profile_.length_unit, millimetre), 1e5);
    return Vector3{range * std::sin(polar) * std::cos(azimuth), range * std::sin(polar) * std::sin(azimuth), range * std::cos(polar)};
  }

  std::optional<std::array<double, 4>> rotation(const TableRow& row, const std::string& object) const {
    const auto quaternion = columns(Quantity::quaternion, objects_.size() > 1 || !object.empty() ? &object : nullptr);
    std::array<double, 4> n{};
    const auto empty = [&](const auto& c) { return is_missing_mark(row.fields[c.second].text); };
    if (quaternion.size() == 4 && profile_.rotation != "none") {
      if (std::all_of(quaternion.begin(), quaternion.end(), empty)) return {};
      double norm = 0;
      for (const auto& [index, column] : quaternion) {
        n[index] = number(row, column, plain_number, 2.0);
        norm += n[index] * n[index];
      }
      // Files carry a few digits; more than this is no rounding.
      if (!(std::abs(std::sqrt(norm) - 1.0) <= 1e-3)) fail(row, quaternion.at(0), "Found a quaternion of norm " + shortest_decimal(std::sqrt(norm)) + "; expected 1.");
      return quaternion_from(*rotation_convention("quaternion"), n);
    }
    if (!convention_) return {};
    const auto angles = columns(Quantity::rotation);
    if (std::all_of(angles.begin(), angles.end(), empty)) return {};
    const std::size_t first = by_axis_ ? 3 : 0;
    for (const auto& [index, column] : angles) n[index - first] = number(row, column, unit_of(meanings_[column], profile_.angle_unit, convention_->radians ? radian : degree), 1e3);
    return quaternion_from(*convention_, ordered(*convention_, by_axis_, n));
  }

  std::optional<Vector3> sigma(const TableRow& row, const std::string& object) const {
    for (const Quantity quantity : {Quantity::sigma, Quantity::expanded}) {
      auto found = columns(quantity, objects_.size() > 1 ? &object : nullptr);
      if (found.empty()) continue;
      const bool one = found.count(3) != 0;
      if (!one && (found.count(0) == 0 || found.count(1) == 0 || found.count(2) == 0)) continue;
      Vector3 s{};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t column = found.at(one ? 3 : k);
        if (is_missing_mark(row.fields[column].text)) return {};
        s[k] = number(row, column, unit_of(meanings_[column], profile_.length_unit, robot_.length_in_mm ? millimetre : metre), 1.0) /
               (quantity == Quantity::expanded ? profile_.coverage : 1.0);
        if (s[k] < 0) fail(row, column, "Found a negative uncertainty; expected one that is not.");
      }
      return s;
    }
    return {};
  }

  void read_row(const TableRow& row, std::size_t index) {
    SourceRow base;
    base.index = index;
    base.line = row.line;
    for (std::size_t k = 0; k < meanings_.size(); ++k) {
      const Meaning& m = meanings_[k];
      const std::string& field = row.fields[k].text;
      if (m.quantity == Quantity::name && !field.empty()) add_name(m.part, field, row, k, base);
      if (m.quantity == Quantity::time && !field.empty()) {
        base.time_s = parse_time(field, table_.decimal);
        if (base.time_s) base.time_s = m.unit != nullptr ? m.unit->to_si(*base.time_s) : in_seconds(*base.time_s);
      }
      if (m.quantity == Quantity::joint) {
        if (!base.joints) base.joints.emplace();
        (*base.joints)[m.index] = number(row, k, joint_unit(m), max_reading);
      }
      if (m.quantity == Quantity::temperature && !field.empty()) {
        const auto value = parse_number(field, table_.decimal);
        if (value) base.extra["temperature"] = shortest_decimal(*value);
      }
      if (m.quantity == Quantity::payload && !field.empty()) base.extra["payload"] = shortest_decimal(number(row, k, plain_number, 1e5));
      if (m.quantity == Quantity::direction && !field.empty()) base.extra["direction"] = field;
    }
    if (!out_.measures) {
      out_.rows.push_back(std::move(base));
      return;
    }
    for (std::size_t k = 0; k < objects_.size(); ++k) {
      SourceRow each = base;
      if (objects_.size() > 1) each.point = out_.points[k];
      each.position_m = point(row, objects_[k]);
      if (each.position_m) {
        each.quaternion = rotation(row, objects_[k]);
        each.sigma_m = sigma(row, objects_[k]);
      } else {
        missing_ += (missing_.empty() ? "" : ", ") + std::to_string(row.line);
      }
      out_.rows.push_back(std::move(each));
    }
  }

  void add_name(const std::string& part, const std::string& field, const TableRow& row, std::size_t column, SourceRow& base) const {
    if (part != "id" || (profile_.names.empty() && field.find("::") == std::string::npos)) {
      base.parts[part] = field;
      return;
    }
    // Names of SpatialAnalyzer, whole.
    const bool three = field.find("::") != field.rfind("::");
    const std::string pattern = !profile_.names.empty() ? profile_.names : three ? "{collection}::{group}::{id}" : "{group}::{id}";
    const auto parts = parts_of_name(field, pattern);
    if (!parts) fail(row, column, "Found the name \"" + field.substr(0, 60) + "\"; expected one of the form " + pattern + '.');
    for (const auto& [key, value] : *parts) base.parts[key] = value;
  }

  void add_notes() {
    std::vector<std::string> unused;
    for (std::size_t k = 0; k < meanings_.size() && k < table_.header.size(); ++k) {
      const Meaning& m = meanings_[k];
      const bool other = m.quantity == Quantity::position && std::find(objects_.begin(), objects_.end(), m.object) == objects_.end();
      if ((m.quantity == Quantity::unused || other) && !table_.header[k].empty()) unused.push_back(table_.header[k]);
    }
    if (!unused.empty()) out_.notes.push_back(table_.path + ": not used: the columns " + in_list(unused) + '.');
    if (!zeros_.empty()) out_.notes.push_back(table_.path + ": points of 0, 0, 0 are taken for not measured: line " + zeros_ + '.');
    if (!missing_.empty()) out_.notes.push_back(table_.path + ": left out, since nothing was measured: line " + missing_ + '.');
  }

  const std::string& text_;
  const Profile& profile_;
  const Robot& robot_;
  TextTable table_;
  SourceTable out_;
  std::vector<Meaning> meanings_;
  std::vector<std::string> objects_;
  std::optional<RotationConvention> convention_;
  bool by_axis_ = false;
  std::string zeros_, missing_;
};

// The joint positions of a program.
SourceTable read_positions(const std::string& text, const std::string& path, ProgramLanguage language, const Profile& profile, const Robot& robot,
                           const std::vector<double>& pulses_per_unit) {
  const auto count = static_cast<std::size_t>(robot.geometry.joint_count);
  SourceTable out;
  out.path = path;
  out.has_joints = true;
  std::size_t poses = 0;
  const auto positions = read_program(text, language, path);
  for (const ProgramPosition& position : positions) {
    if (position.kind == ProgramPositionKind::pose) {
      ++poses;
      continue;
    }
    const long line = line_of(text, position.begin);
    std::vector<double> values;
    for (const ProgramNumber& number : position.numbers) values.push_back(number.value);
    if (!position.joint_names.empty()) {
      std::vector<std::string> header = position.joint_names;
      const auto meanings = meanings_of_header(header, profile, robot, path);
      std::vector<double> sorted(count);
      std::size_t found = 0;
      for (std::size_t k = 0; k < meanings.size(); ++k) {
        if (meanings[k].quantity != Quantity::joint) continue;
        sorted[meanings[k].index] = values[k];
        ++found;
      }
      if (found != count) {
        throw InputError(path, line, 1, "Found the joints " + in_list(header) + "; expected the names of the robot's " + std::to_string(count) +
                                            " joints: joint_name in the robot file, or \"joints\" in a profile (--log-profile), joint 1 first.");
      }
      values = sorted;
    }
    if (values.size() < count) throw InputError(path, line, 1, "Found " + std::to_string(values.size()) + " joints; expected the robot's " + std::to_string(count) + '.');
    SourceRow row;
    row.parts["id"] = position.name;
    row.index = out.rows.size();
    row.line = line;
    row.time_s = position.time_s;
    Joints q{};
    for (std::size_t j = 0; j < count; ++j) {
      const bool prismatic = robot.geometry.joint[j].kind == JointKind::prismatic;
      double value = values[j];
      if (position.kind == ProgramPositionKind::pulses) {
        if (pulses_per_unit.size() != count) {
          throw InputError(path, line, 1, "Found joints in pulses; expected --pulses-per-degree with a number for each of the " + std::to_string(count) + " joints.");
        }
        value /= pulses_per_unit[j];
      }
      const Unit& unit = prismatic ? (position.radians ? metre : millimetre) : position.radians ? radian : degree;
      q[j] = unit.to_si(value);
      if (!(std::abs(q[j]) <= max_reading)) throw InputError(path, line, 1, "Found a joint reading of " + shortest_decimal(value) + "; expected a smaller one.");
    }
    row.joints = q;
    out.rows.push_back(std::move(row));
  }
  if (out.rows.empty()) {
    throw InputError(path, 1, 1, "Found " + language_name(language) + " with " + (poses == 0 ? "no position" : std::to_string(poses) + " Cartesian positions and no joints") +
                                     "; expected joint positions, since only they say where the robot's joints were.");
  }
  out.row_count = out.rows.size();
  out.notes.push_back(path + ": read as " + language_name(language) + ", " + std::to_string(out.rows.size()) + " joint positions" +
                      (poses == 0 ? "." : "; " + std::to_string(poses) + " Cartesian ones are not used."));
  return out;
}

}  // namespace

SourceTable read_source(const std::string& bytes, const std::string& path, const Profile& profile, const Robot& robot,
                        const std::vector<double>& pulses_per_unit) {
  const DecodedText decoded = decode_text(bytes, path, profile.encoding);
  if (const auto language = program_language(decoded.text); language && profile.columns.empty()) {
    return read_positions(decoded.text, path, *language, profile, robot, pulses_per_unit);
  }
  Profile used = profile;
  std::string recognised;
  if (profile.name.empty() && profile.columns.empty()) {
    std::vector<std::string_view> lines = lines_of(decoded.text);
    lines.resize(std::min<std::size_t>(lines.size(), 40));
    if (auto found = recognised_profile(lines)) {
      recognised = found->name;
      used = merged(profile, std::move(*found));
    }
  }
  SourceTable table = TableReader(decoded.text, path, used, robot).read();
  if (!recognised.empty()) table.notes.insert(table.notes.begin(), path + ": read by the profile " + recognised + " (" + used.about + ").");
  if (decoded.encoding != "utf-8") table.notes.insert(table.notes.begin(), path + ": read as " + (decoded.encoding == "utf-16" ? "UTF-16." : "Latin-1."));
  return table;
}

}  // namespace mdhcal::offline
