// SPDX-License-Identifier: MIT
#include "offline/import/meaning.hpp"

#include <algorithm>
#include <array>

#include "offline/base/error.hpp"

namespace mdhcal::offline {

namespace {

constexpr Unit micrometre{"um", 1.0, 1e6};
constexpr Unit inch{"in", 254.0, 10000.0};
constexpr Unit milliradian{"mrad", 1.0, 1000.0};
constexpr Unit gon{"gon", pi, 200.0};
constexpr Unit whole_second{"s", 1.0, 1.0};
constexpr Unit thousandth_second{"ms", 1.0, 1000.0};

struct UnitWord {
  std::string_view word;
  const Unit* unit;
};

constexpr UnitWord unit_words[] = {
    {"mm", &millimetre}, {"millimeter", &millimetre}, {"millimeters", &millimetre}, {"m", &metre}, {"meter", &metre}, {"meters", &metre},
    {"um", &micrometre}, {"\xC2\xB5m", &micrometre}, {"\xCE\xBCm", &micrometre}, {"in", &inch}, {"inch", &inch}, {"inches", &inch},
    {"deg", &degree}, {"degree", &degree}, {"degrees", &degree}, {"\xC2\xB0", &degree}, {"gon", &gon}, {"grad", &degree}, {"rad", &radian},
    {"radian", &radian}, {"radians", &radian}, {"mrad", &milliradian}, {"s", &whole_second}, {"sec", &whole_second}, {"seconds", &whole_second}, {"ms", &thousandth_second}};

std::string in_lower_case(std::string_view text) {
  std::string out;
  for (const char c : text) out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

// Words of a name, in small letters: letters and digits, and what is not ASCII.
std::vector<std::string> words_of_name(std::string_view name) {
  std::vector<std::string> terms(1);
  for (const char c : in_lower_case(name)) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || static_cast<unsigned char>(c) >= 0x80U;
    if (letter) {
      terms.back() += c;
    } else if (!terms.back().empty()) {
      terms.emplace_back();
    }
  }
  if (terms.back().empty()) terms.pop_back();
  return terms;
}

bool one_of(std::string_view word, std::initializer_list<std::string_view> terms) {
  return std::find(terms.begin(), terms.end(), word) != terms.end();
}

bool all_digits(std::string_view text) { return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos && text.size() < 4; }

// "X [mm]": the name without its unit, and the unit.
std::string_view without_unit(std::string_view name, const Unit*& unit) {
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    const std::size_t end = name.rfind(close), begin = name.rfind(open);
    if (begin == std::string_view::npos || end == std::string_view::npos || end < begin || begin == 0) continue;
    if (name.substr(end + 1).find_first_not_of(' ') != std::string_view::npos) continue;
    const Unit* found = unit_of_word(name.substr(begin + 1, end - begin - 1));
    if (found == nullptr) continue;
    unit = found;
    return name.substr(0, begin);
  }
  const std::size_t mark = name.find_last_of("_ ");
  if (mark != std::string_view::npos && mark > 0) {
    const std::string last = in_lower_case(name.substr(mark + 1));
    if (one_of(last, {"mm", "um", "deg", "rad", "mrad", "\xC2\xB0", "ms"}) || (name[mark] == '_' && one_of(last, {"m", "s", "in"}))) {
      unit = unit_of_word(last);
      return name.substr(0, mark);
    }
  }
  return name;
}

// Classes of words in a column's name.
struct NameClass {
  bool unused = false, expanded = false, sigma = false, rotation = false, quaternion = false, commanded = false;
  std::string axis;           // "x", "y", "z", "w"
  std::vector<std::string> rest;
};

NameClass classed(const std::vector<std::string>& terms) {
  NameClass c;
  for (const std::string& word : terms) {
    const char last = word.back();
    const std::string_view front = std::string_view(word).substr(0, word.size() - 1);
    if (one_of(word, {"x", "y", "z", "w"})) {
      c.axis = word;
    } else if ((last == 'x' || last == 'y' || last == 'z') && one_of(front, {"pos", "position", "p", "t", "m", "meas", "actual", "act", "tcp", "trans", "point"})) {
      c.axis = last;
    } else if ((last == 'x' || last == 'y' || last == 'z') && one_of(front, {"r", "rot"})) {
      c.axis = last;
      c.rotation = true;
    } else if ((last == 'x' || last == 'y' || last == 'z' || last == 'w') && front == "q") {
      c.axis = last;
      c.quaternion = true;
    } else if ((last == 'x' || last == 'y' || last == 'z') && one_of(front, {"u", "u95"})) {
      c.axis = last;
      c.expanded = true;
    } else if ((last == 'x' || last == 'y' || last == 'z') && one_of(front, {"s", "sigma", "std"})) {
      c.axis = last;
      c.sigma = true;
    } else if (one_of(front, {"x", "y", "z"}) && all_digits(std::string_view(word).substr(1))) {
      c.axis = front;
      c.rest.emplace_back(word.substr(1));
    } else if (one_of(word, {"nominal", "nom", "soll", "ref", "reference", "theo", "theoretical", "design", "dev", "deviation", "delta", "d",
                             "diff", "error", "err", "tol", "tolerance", "normal", "lower", "upper", "velocity", "vel", "force", "torque", "abweichung"})) {
      c.unused = true;
    } else if (one_of(word, {"u95", "u", "unc", "uncertainty", "uncert"})) {
      c.expanded = true;
    } else if (one_of(word, {"sigma", "std", "stddev", "sd"})) {
      c.sigma = true;
    } else if (one_of(word, {"rotation", "rot", "orientation", "angle", "euler", "angles"})) {
      c.rotation = true;
    } else if (one_of(word, {"quaternion", "quat"})) {
      c.quaternion = true;
    } else if (one_of(word, {"cmd", "commanded", "set", "desired"})) {
      c.commanded = true;
    } else if (!one_of(word, {"position", "pos", "translation", "trans", "t", "p", "measured", "meas", "actual", "act", "ist", "measurement", "coord",
                              "coordinate", "center", "centre", "pose", "field", "msg", "95", "of", "in", "point", "transform", "tcp"})) {
      c.rest.push_back(word);
    }
  }
  return c;
}

std::size_t axis_index(std::string_view axis) { return axis == "x" ? 0 : axis == "y" ? 1 : axis == "z" ? 2 : 3; }

std::string joined(const std::vector<std::string>& terms) {
  std::string text;
  for (const std::string& word : terms) text += (text.empty() ? "" : " ") + word;
  return text;
}

Meaning named_part(const std::string& part) {
  Meaning m;
  m.quantity = Quantity::name;
  m.part = part;
  return m;
}

// What a column's own words say; joints apart.
Meaning told_meaning(const std::string& name) {
  Meaning m;
  const std::string_view bare = without_unit(name, m.unit);
  const std::vector<std::string> terms = words_of_name(bare);
  if (terms.empty()) return m;
  const std::string whole = joined(terms);
  const auto is = [&](Quantity quantity, std::size_t index) {
    m.quantity = quantity;
    m.index = index;
    return m;
  };
  if (one_of(whole, {"collection"})) return named_part("collection");
  if (one_of(whole, {"group", "point group", "gruppe", "configuration"})) return named_part("group");
  if (one_of(whole, {"target", "reflector", "smr", "prism", "target name", "targetname"})) return named_part("target");
  if (one_of(whole, {"id", "name", "point", "point name", "pointname", "punkt", "tag", "pose", "no", "nr", "number", "index", "frame", "sample",
                     "feature", "label", "point id", "pointid", "item", "object", "station", "seq", "header seq", "field header seq", "row", "pt"})) {
    return named_part("id");
  }
  if (one_of(whole, {"time", "t", "timestamp", "time stamp", "stamp", "date time", "datetime", "date", "rosbagtimestamp", "header stamp", "t s", "zeit",
                     "time seconds", "elapsed time", "time s"})) {
    return is(Quantity::time, 0);
  }
  if (one_of(whole, {"azimuth", "az", "horizontal", "hz", "horizontal angle", "h angle"})) return is(Quantity::spherical, 0);
  if (one_of(whole, {"zenith", "zen", "vertical", "v angle", "vertical angle", "zenith angle"})) return is(Quantity::spherical, 1);
  if (one_of(whole, {"range", "slope distance", "r", "radial distance"})) return is(Quantity::spherical, 2);
  if (one_of(whole, {"elevation", "el"})) return is(Quantity::spherical, 3);
  if (one_of(whole, {"temperature", "temp", "temperatur"})) return is(Quantity::temperature, 0);
  if (one_of(whole, {"roll", "pitch", "yaw"})) return is(Quantity::rotation, whole == "roll" ? 3 : whole == "pitch" ? 4 : 5);
  if (one_of(whole, {"direction"})) return is(Quantity::direction, 0);
  if (one_of(whole, {"payload"})) return is(Quantity::payload, 0);
  if (one_of(whole, {"q0", "quaternion 0"})) return is(Quantity::quaternion, 0);
  const NameClass c = classed(terms);
  if (c.unused || c.commanded || c.axis.empty()) return m;
  m.object = joined(c.rest);
  if (c.expanded) return c.axis == "w" ? m : is(Quantity::expanded, axis_index(c.axis));
  if (c.sigma) return c.axis == "w" ? m : is(Quantity::sigma, axis_index(c.axis));
  if (c.quaternion || (c.rotation && c.axis == "w")) return is(Quantity::quaternion, c.axis == "w" ? 0 : 1 + axis_index(c.axis));
  if (c.rotation) return is(Quantity::rotation, 3 + axis_index(c.axis));
  if (c.axis == "w") {
    m.object.clear();
    return m;
  }
  // Messages of ROS are in metres (REP 103).
  if (m.unit == nullptr && (name.find(".position.") != std::string::npos || name.find(".translation.") != std::string::npos)) m.unit = &metre;
  return is(Quantity::position, axis_index(c.axis));
}

// The joints by their names. Empty if a joint has no column.
std::vector<std::size_t> named_columns(const std::vector<std::string>& header, const std::vector<std::string>& names, bool as_ending) {
  std::vector<std::size_t> found;
  for (const std::string& name : names) {
    const std::string wanted = joined(words_of_name(name));
    std::size_t at = header.size();
    for (std::size_t k = 0; k < header.size(); ++k) {
      const Unit* ignored = nullptr;
      const std::string have = joined(words_of_name(without_unit(header[k], ignored)));
      const bool ending = as_ending && have.size() > wanted.size() && have.ends_with(wanted) && have[have.size() - wanted.size() - 1] == ' ';
      if (have == wanted || ending) {
        if (at != header.size()) return {};
        at = k;
      }
    }
    if (wanted.empty() || at == header.size()) return {};
    found.push_back(at);
  }
  return found;
}

// A joint's number in a column's name, and what stands before it: "a1", "joint_1", "actual q 0". -1 if there is none.
int joint_number(const std::string& name, std::string& before) {
  const Unit* ignored = nullptr;
  std::vector<std::string> terms = words_of_name(without_unit(name, ignored));
  while (!terms.empty() && one_of(terms.back(), {"actual", "act", "meas", "measured", "position", "pos", "ist", "angle"})) terms.pop_back();
  if (terms.empty()) return -1;
  std::string letters = terms.back();
  std::string digits;
  while (!letters.empty() && letters.back() >= '0' && letters.back() <= '9') {
    digits.insert(digits.begin(), letters.back());
    letters.pop_back();
  }
  terms.pop_back();
  if (letters.empty() && !terms.empty()) {
    letters = terms.back();
    terms.pop_back();
  }
  if (!all_digits(digits) || !one_of(letters, {"q", "j", "a", "joint", "axis", "achse", "jnt", "ax", "theta", "axe"})) return -1;
  for (const std::string& word : terms) {
    if (one_of(word, {"cmd", "commanded", "target", "set", "desired", "soll", "nominal", "velocity", "vel", "qd", "current", "torque", "effort", "temp"})) return -1;
  }
  before = joined(terms) + ' ' + letters;
  return std::stoi(digits);
}

std::vector<std::size_t> numbered_columns(const std::vector<std::string>& header, std::size_t count) {
  std::map<std::string, std::map<int, std::size_t>> sets;
  for (std::size_t k = 0; k < header.size(); ++k) {
    std::string before;
    const int number = joint_number(header[k], before);
    if (number < 0) continue;
    if (!sets[before].emplace(number, k).second) sets[before][-1] = k;  // twice: not this set
  }
  // Names that are joints' first: a quaternion may stand in q1 ... q4 beside j1 ... j6.
  std::vector<std::size_t> found;
  for (const auto& [before, set] : sets) {
    const int first = set.count(0) != 0 ? 0 : 1;
    const bool whole = set.size() == count && set.begin()->first == first && set.rbegin()->first == first + static_cast<int>(count) - 1;
    if (!whole) continue;
    if (!found.empty()) return {};
    for (const auto& [number, column] : set) found.push_back(column);
  }
  return found;
}

void find_joints(const std::vector<std::string>& header, const Profile& profile, const Robot& robot, std::vector<Meaning>& meanings) {
  const auto count = static_cast<std::size_t>(robot.geometry.joint_count);
  static const std::vector<std::string> ros_ur{"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"};
  static const std::vector<std::string> yaskawa{"S", "L", "U", "R", "B", "T"};
  std::vector<std::size_t> columns;
  bool ros = false;
  if (profile.joints.size() == count) columns = named_columns(header, profile.joints, false);
  if (columns.empty() && count == ros_ur.size()) {
    columns = named_columns(header, ros_ur, true);
    ros = !columns.empty();
  }
  if (columns.empty() && count == yaskawa.size()) columns = named_columns(header, yaskawa, false);
  if (columns.empty()) columns = numbered_columns(header, count);
  for (std::size_t j = 0; j < columns.size(); ++j) {
    Meaning m;
    m.quantity = Quantity::joint;
    m.index = j;
    (void)without_unit(header[columns[j]], m.unit);
    // ROS states joints in radians and metres (REP 103).
    if (m.unit == nullptr && ros) m.unit = &radian;
    meanings[columns[j]] = m;
  }
}

}  // namespace

const Unit* unit_of_word(std::string_view word) {
  while (!word.empty() && one_of(word.substr(0, 1), {"[", "(", " "})) word.remove_prefix(1);
  while (!word.empty() && one_of(word.substr(word.size() - 1), {"]", ")", " "})) word.remove_suffix(1);
  const std::string small = in_lower_case(word);
  for (const UnitWord& each : unit_words) {
    if (each.word == small) return each.unit;
  }
  return nullptr;
}

std::string meaning_words() {
  return "id, group, target, collection, t, x, y, z (x1, y1, z1, x2, ... of several points), sx, sy, sz, sigma, ux, uy, uz, azimuth, zenith, "
         "elevation, range, qw, qx, qy, qz, rx, ry, rz, r1, r2, r3, q1 to q8, temperature, direction, payload or - (unused), with _mm, _m, "
         "_um, _in, _deg, _rad, _s or _ms for the unit";
}

std::optional<Meaning> meaning_of_word(const std::string& word) {
  Meaning m;
  std::string base = word;
  const std::size_t mark = word.rfind('_');
  if (mark != std::string::npos) {
    const std::string_view suffix = std::string_view(word).substr(mark + 1);
    if (!one_of(suffix, {"mm", "m", "um", "in", "deg", "rad", "s", "ms"})) return {};
    m.unit = unit_of_word(suffix);
    base = word.substr(0, mark);
  }
  const auto is = [&](Quantity quantity, std::size_t index) -> std::optional<Meaning> {
    m.quantity = quantity;
    m.index = index;
    return m;
  };
  if (base == "-") return m;
  if (one_of(base, {"id", "group", "target", "collection"})) return named_part(base);
  if (base == "t") return is(Quantity::time, 0);
  if (base == "azimuth") return is(Quantity::spherical, 0);
  if (base == "zenith") return is(Quantity::spherical, 1);
  if (base == "range") return is(Quantity::spherical, 2);
  if (base == "elevation") return is(Quantity::spherical, 3);
  if (base == "sigma") return is(Quantity::sigma, 3);
  if (base == "temperature") return is(Quantity::temperature, 0);
  if (base == "direction") return is(Quantity::direction, 0);
  if (base == "payload") return is(Quantity::payload, 0);
  if (base.empty()) return {};
  const std::string_view rest = std::string_view(base).substr(1);
  const bool axis = one_of(rest, {"x", "y", "z"});
  if (one_of(base.substr(0, 1), {"x", "y", "z"}) && (rest.empty() || all_digits(rest))) {
    m.object = rest;
    return is(Quantity::position, axis_index(base.substr(0, 1)));
  }
  if (base[0] == 's' && axis) return is(Quantity::sigma, axis_index(rest));
  if (base[0] == 'u' && axis) return is(Quantity::expanded, axis_index(rest));
  if (base[0] == 'r' && axis) return is(Quantity::rotation, 3 + axis_index(rest));
  if (base[0] == 'r' && one_of(rest, {"1", "2", "3"})) return is(Quantity::rotation, static_cast<std::size_t>(rest[0] - '1'));
  if (base == "qw") return is(Quantity::quaternion, 0);
  if (base[0] == 'q' && axis) return is(Quantity::quaternion, 1 + axis_index(rest));
  if (base[0] == 'q' && rest.size() == 1 && rest[0] >= '1' && rest[0] <= '8') return is(Quantity::joint, static_cast<std::size_t>(rest[0] - '1'));
  return {};
}

std::vector<Meaning> meanings_of_header(const std::vector<std::string>& header, const Profile& profile, const Robot& robot,
                                        const std::string& path) {
  std::vector<Meaning> meanings(header.size());
  std::vector<bool> said(header.size(), false);
  for (const auto& [word, pattern] : profile.rename) {
    bool found = false;
    for (std::size_t k = 0; k < header.size() && !found; ++k) {
      if (said[k] || !fits(header[k], pattern)) continue;
      const Unit* unit = nullptr;
      (void)without_unit(header[k], unit);
      meanings[k] = *meaning_of_word(word);
      if (meanings[k].unit == nullptr) meanings[k].unit = unit;
      found = said[k] = true;
    }
    if (!found) {
      std::string names;
      for (const std::string& name : header) names += (names.empty() ? "\"" : ", \"") + name + '"';
      throw InputError(path, 1, 1, "The profile " + profile.name + " says that \"" + word + "\" is the column \"" + pattern +
                                       "\", which is not there; found the columns " + names + ".");
    }
  }
  std::vector<Meaning> joints(header.size());
  find_joints(header, profile, robot, joints);
  const bool told_joints = std::any_of(joints.begin(), joints.end(), [](const Meaning& m) { return m.quantity == Quantity::joint; });
  for (std::size_t k = 0; k < header.size(); ++k) {
    if (said[k]) continue;
    meanings[k] = joints[k].quantity == Quantity::joint ? joints[k] : told_meaning(header[k]);
    if (meanings[k].quantity == Quantity::name) {
      // A second column of names: it may be the reflector, or say nothing.
      const bool again = std::any_of(meanings.begin(), meanings.begin() + static_cast<std::ptrdiff_t>(k),
                                     [&](const Meaning& m) { return m.quantity == Quantity::name && m.part == meanings[k].part; });
      if (again || profile.rename.count(meanings[k].part) != 0) meanings[k] = {};
    }
  }
  // "Rotation X, Y, Z, W": with a fourth number it is a quaternion.
  for (const Meaning& fourth : meanings) {
    if (fourth.quantity != Quantity::quaternion || fourth.index != 0) continue;
    for (std::size_t k = 0; k < header.size(); ++k) {
      Meaning& m = meanings[k];
      if (said[k] || m.quantity != Quantity::rotation || m.index < 3 || m.object != fourth.object) continue;
      m.quantity = Quantity::quaternion;
      m.index -= 2;
    }
  }
  if (told_joints) return meanings;
  // q0 ... q3 are a quaternion where all four are there and they are no joints.
  for (std::size_t k = 0; k < header.size(); ++k) {
    const std::string whole = joined(words_of_name(header[k]));
    if (said[k] || !one_of(whole, {"q1", "q2", "q3"})) continue;
    const bool with_first = std::any_of(header.begin(), header.end(), [](const std::string& name) { return joined(words_of_name(name)) == "q0"; });
    if (with_first) {
      meanings[k] = {};
      meanings[k].quantity = Quantity::quaternion;
      meanings[k].index = static_cast<std::size_t>(whole[1] - '0');
    }
  }
  return meanings;
}

std::optional<std::map<std::string, std::string>> parts_of_name(std::string_view name, const std::string& pattern, bool check_only) {
  std::map<std::string, std::string> parts;
  std::size_t at = 0, terms = 0;
  for (std::size_t p = 0; p < pattern.size();) {
    if (pattern[p] != '{') {
      if (!check_only && (at >= name.size() || name[at] != pattern[p])) return {};
      ++at;
      ++p;
      continue;
    }
    const std::size_t close = pattern.find('}', p);
    if (close == std::string::npos) return {};
    const std::string word = pattern.substr(p + 1, close - p - 1);
    if (!word.empty() && !one_of(word, {"id", "group", "target", "collection"})) return {};
    ++terms;
    p = close + 1;
    // As far as the text behind the brace; to the end if there is none.
    const std::string behind = pattern.substr(p, std::min(pattern.find('{', p), pattern.size()) - p);
    if (behind.empty() && p < pattern.size()) return {};
    if (check_only) continue;
    const std::size_t end = behind.empty() ? name.size() : name.find(behind, at);
    if (end == std::string_view::npos) return {};
    if (!word.empty()) parts[word] = name.substr(at, end - at);
    at = end;
  }
  if (terms == 0 || (!check_only && at != name.size())) return {};
  return parts;
}

}  // namespace mdhcal::offline
