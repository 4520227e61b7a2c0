// SPDX-License-Identifier: MIT
#include "offline/robot/urdf.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <sstream>

#include <pugixml.hpp>

#include "offline/base/error.hpp"
#include "offline/base/read_file.hpp"
#include "offline/base/text.hpp"
#include "offline/robot/rotation.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

std::string element(pugi::xml_node node) {
  std::string text = "<";
  text += node.name();
  text += '>';
  return text;
}

class Urdf {
 public:
  Urdf(const std::string& text, std::string path) : text_(text), path_(std::move(path)) {
    require_utf8();
    const pugi::xml_parse_result result =
        document_.load_buffer(text_.data(), text_.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!result) fail(result.offset, std::string("The file is not well-formed XML: ") + result.description() + '.');
    root_ = document_.child("robot");
    if (!root_) fail(0, "The file has no <robot> element; expected a URDF.");
    for (const pugi::xml_node node : root_.children()) {
      if (std::strncmp(node.name(), "xacro:", 6) == 0) {
        fail(node, element(node) + " is xacro, not URDF; expected the output of `xacro FILE`.");
      }
    }
    for (const pugi::xml_node link : root_.children("link")) links_.insert(attribute(link, "name"));
    for (const pugi::xml_node joint : root_.children("joint")) {
      const std::string child = attribute(required(joint, "child"), "link");
      for (const char* once : {"parent", "child", "origin", "axis", "limit", "mimic"}) {
        const pugi::xml_node again = joint.child(once).next_sibling(once);
        if (again) fail(again, "Joint \"" + attribute(joint, "name") + "\" has a second " + element(again) + "; expected one.");
      }
      if (!parent_joint_.emplace(child, joint).second) {
        fail(joint, "Link \"" + child + "\" is the child of two joints; expected a tree.");
      }
      has_child_.insert(attribute(required(joint, "parent"), "link"));
    }
  }

  std::string name() const { return text_of(root_, root_.attribute("name")); }

  /// The joints from `base` to `tip`, in that order.
  std::vector<pugi::xml_node> joints(std::string base, std::string tip) const {
    for (const std::string& link : {base, tip}) {
      if (!link.empty() && !links_.contains(link)) {
        throw InputError(path_, 0, 0, "There is no link \"" + link + "\"; expected one of " + listed(links_) + '.');
      }
    }
    if (tip.empty()) tip = only_leaf(base);
    std::vector<pugi::xml_node> path;
    for (std::string link = tip; link != base;) {
      const auto joint = parent_joint_.find(link);
      if (joint == parent_joint_.end()) {
        if (base.empty()) break;
        throw InputError(path_, 0, 0, "Link \"" + tip + "\" does not hang on link \"" + base + "\".");
      }
      path.push_back(joint->second);
      if (path.size() > parent_joint_.size()) fail(joint->second, "The joints form a ring; expected a tree.");
      link = attribute(required(joint->second, "parent"), "link");
    }
    std::reverse(path.begin(), path.end());
    return path;
  }

  bool moves(pugi::xml_node joint) const {
    const std::string type = attribute(joint, "type");
    if (type == "fixed") return false;
    if (type != "revolute" && type != "continuous" && type != "prismatic") {
      fail(joint, "Joint \"" + attribute(joint, "name") + "\" is of type \"" + type +
                      "\"; expected revolute, continuous, prismatic or fixed.");
    }
    if (const pugi::xml_node mimic = joint.child("mimic")) {
      fail(mimic, "Joint \"" + attribute(joint, "name") +
                      "\" mimics another; expected a serial chain (couplings are stated in a robot file).");
    }
    return true;
  }

  Frame<double> origin(pugi::xml_node joint) const {
    const pugi::xml_node node = joint.child("origin");
    return frame_of_xyz_rpy(triple(node, "xyz", {0, 0, 0}), triple(node, "rpy", {0, 0, 0}));
  }

  Vector3 axis(pugi::xml_node joint) const {
    const pugi::xml_node node = joint.child("axis");
    Vector3 axis = triple(node, "xyz", {1, 0, 0});  // URDF's default
    const double norm = std::hypot(axis[0], axis[1], axis[2]);
    if (!(norm > 1e-6)) fail(node, "The axis has length 0; expected a direction.");
    for (double& component : axis) component /= norm;
    return axis;
  }

  ChainJoint moving(pugi::xml_node joint) const {
    ChainJoint out;
    const std::string type = attribute(joint, "type");
    out.name = attribute(joint, "name");
    out.kind = type == "prismatic" ? JointKind::prismatic : JointKind::revolute;
    out.axis = axis(joint);
    const pugi::xml_node limit = joint.child("limit");
    if (limit && type != "continuous") {
      out.min = limit_of(limit, "lower");  // URDF's default of either limit is 0
      out.max = limit_of(limit, "upper");
      if (!(out.min <= out.max)) fail(limit, "The lower limit is above the upper one; expected lower <= upper.");
      // What the library calls a reading ends there: beyond, a limit is a way of stating none.
      out.has_min = out.min >= -max_reading;
      out.has_max = out.max <= max_reading;
      if (!(std::abs(out.min) > 0) && !(std::abs(out.max) > 0)) out.has_min = out.has_max = false;
      if (!out.has_min) out.min = 0;
      if (!out.has_max) out.max = 0;
    }
    return out;
  }

  // Where limits are stated and none are taken.
  std::string limits_note(pugi::xml_node joint, const ChainJoint& moving) const {
    const pugi::xml_node limit = joint.child("limit");
    if (!limit || attribute(joint, "type") == "continuous" || (moving.has_min && moving.has_max)) return {};
    const double lower = limit_of(limit, "lower"), upper = limit_of(limit, "upper");
    const bool zero = !(std::abs(lower) > 0) && !(std::abs(upper) > 0);
    return path_ + ":" + std::to_string(line_of(limit.offset_debug())) + ": joint \"" + moving.name + "\" has the limits " +
           shortest_decimal(lower) + " and " + shortest_decimal(upper) +
           (zero ? ", as CAD exporters write where they know none: it is read without limits. State min and max in the "
                   "robot file."
                 : ", beyond what any joint reads: " + std::string(moving.has_min || moving.has_max ? "the far one is" : "they are") +
                       " no limit.");
  }

 private:
  // One encoding, said in its own words: a parser that guesses calls other ones not well-formed, or mixes two in what it writes.
  void require_utf8() const {
    const std::size_t end = text_.find("?>");
    const std::size_t key = text_.find("encoding");
    const bool ascii = std::all_of(text_.begin(), text_.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80U; });
    if (!ascii && key < end && end != std::string::npos) {
      const std::size_t open = text_.find_first_of("\"'", key);
      const std::size_t close = open < end ? text_.find(text_[open], open + 1) : std::string::npos;
      std::string name = close < end ? text_.substr(open + 1, close - open - 1) : "";
      std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
      if (close < end && name != "UTF-8" && name != "UTF8") {
        fail(static_cast<std::ptrdiff_t>(open), "Found text in the encoding " + name + "; expected a URDF in UTF-8.");
      }
    }
    require_text(text_, path_, "a URDF");
  }

  long line_of(std::ptrdiff_t offset) const {
    const auto end = text_.begin() + std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(text_.size()));
    return 1 + std::count(text_.begin(), end, '\n');
  }

  // An infinite limit is none, and is written by some.
  double limit_of(pugi::xml_node limit, const char* key) const {
    const std::string_view text = limit.attribute(key).as_string();
    if (text == "inf" || text == "+inf" || text == "Infinity") return HUGE_VAL;
    if (text == "-inf" || text == "-Infinity") return -HUGE_VAL;
    return number(limit, key, 0);
  }

  [[noreturn]] void fail(std::ptrdiff_t offset, const std::string& message) const {
    const auto end = text_.begin() + std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(text_.size()));
    const long line = line_of(offset);
    const auto start = std::find(std::make_reverse_iterator(end), text_.rend(), '\n').base();
    throw InputError(path_, line, 1 + (end - start), message);
  }
  [[noreturn]] void fail(pugi::xml_node node, const std::string& message) const { fail(node.offset_debug(), message); }

  std::string attribute(pugi::xml_node node, const char* key) const {
    const pugi::xml_attribute found = node.attribute(key);
    if (!found || found.as_string()[0] == '\0') {
      fail(node, element(node) + " has no attribute \"" + key + "\".");
    }
    return text_of(node, found);
  }

  // XML can write any character as a number.
  std::string text_of(pugi::xml_node node, pugi::xml_attribute attribute) const {
    const std::string text = attribute.as_string();
    if (printable(text) != text) {
      fail(node, element(node) + ": found a control character in " + attribute.name() + "; expected printable text.");
    }
    return text;
  }

  pugi::xml_node required(pugi::xml_node node, const char* child) const {
    const pugi::xml_node found = node.child(child);
    if (!found) fail(node, element(node) + " has no <" + child + ">.");
    return found;
  }

  // Finite numbers, separated by white space.
  std::vector<double> numbers(pugi::xml_node node, const char* key, std::size_t count) const {
    const std::string text = node.attribute(key).as_string();
    std::istringstream words(text);
    std::vector<double> values;
    for (std::string word; words >> word;) {
      double value = 0;
      const char* first = word.data() + (word[0] == '+' ? 1 : 0);
      const auto [end, error] = std::from_chars(first, word.data() + word.size(), value);
      if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) {
        fail(node, "\"" + word + "\" in " + key + "=\"" + text + "\" is not a number.");
      }
      values.push_back(value);
    }
    if (values.size() != count) {
      fail(node, std::string(key) + "=\"" + text + "\" has " + std::to_string(values.size()) + " numbers; expected " +
                     std::to_string(count) + '.');
    }
    return values;
  }

  Vector3 triple(pugi::xml_node node, const char* key, const Vector3& otherwise) const {
    if (!node || !node.attribute(key)) return otherwise;
    const auto values = numbers(node, key, 3);
    return {values[0], values[1], values[2]};
  }

  double number(pugi::xml_node node, const char* key, double otherwise) const {
    return node.attribute(key) ? numbers(node, key, 1)[0] : otherwise;
  }

  static std::string listed(const std::set<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
  }

  std::string only_leaf(const std::string& base) const {
    std::set<std::string> leaves;
    for (const std::string& link : links_) {
      if (has_child_.contains(link)) continue;
      std::string at = link;
      for (std::size_t step = 0; at != base && parent_joint_.contains(at) && step <= links_.size(); ++step) {
        at = parent_joint_.at(at).child("parent").attribute("link").as_string();
      }
      if (base.empty() || at == base) leaves.insert(link);
    }
    if (leaves.size() != 1) {
      throw InputError(path_, 0, 0, "The chain may end at any of " + listed(leaves) + "; name its last link (--tip).");
    }
    return *leaves.begin();
  }

  const std::string& text_;
  const std::string path_;
  pugi::xml_document document_;
  pugi::xml_node root_;
  std::set<std::string> links_, has_child_;
  std::map<std::string, pugi::xml_node> parent_joint_;
};

std::string triple_text(double x, double y, double z) {
  return shortest_decimal(x + 0.0) + ' ' + shortest_decimal(y + 0.0) + ' ' + shortest_decimal(z + 0.0);
}

void set_attribute(pugi::xml_node node, const char* key, const std::string& value) {
  pugi::xml_attribute attribute = node.attribute(key);
  if (!attribute) attribute = node.append_attribute(key);
  attribute.set_value(value.c_str());
}

void set_origin(pugi::xml_node joint, const Frame<double>& frame) {
  pugi::xml_node node = joint.child("origin");
  if (!node) node = joint.prepend_child("origin");
  const Vector3 rpy = roll_pitch_yaw(frame);
  set_attribute(node, "xyz", triple_text(frame.position_m[0], frame.position_m[1], frame.position_m[2]));
  set_attribute(node, "rpy", triple_text(rpy[0], rpy[1], rpy[2]));
}

pugi::xml_node append_joint(pugi::xml_node robot, const std::string& name, const char* type, const std::string& parent,
                            const std::string& child, const Frame<double>& origin) {
  set_attribute(robot.append_child("link"), "name", child);
  pugi::xml_node joint = robot.append_child("joint");
  set_attribute(joint, "name", name);
  set_attribute(joint, "type", type);
  set_origin(joint, origin);
  set_attribute(joint.append_child("parent"), "link", parent);
  set_attribute(joint.append_child("child"), "link", child);
  return joint;
}

// One past the '>' that ends the tag whose name starts at `at`; a '>' in quotes does not end it.
std::size_t tag_end(const std::string& text, std::size_t at) {
  char quote = 0;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      return at + 1;
    }
  }
  return text.size();
}

// The text with the origin of `joint` replaced, or added, and not a byte else changed. Joints are to be treated from the
// end of the file to its beginning: the nodes' offsets are those of the text as it was parsed.
void replace_origin(std::string& text, pugi::xml_node joint, const Frame<double>& frame) {
  pugi::xml_document document;
  set_origin(document.append_child("joint"), frame);
  std::ostringstream out;
  document.child("joint").child("origin").print(out, "", pugi::format_raw);
  if (const pugi::xml_node origin = joint.child("origin")) {
    const std::size_t start = static_cast<std::size_t>(origin.offset_debug()) - 1;
    std::size_t end = tag_end(text, start);
    if (text[end - 2] != '/') end = text.find('>', text.find("</origin", end)) + 1;
    text.replace(start, end - start, out.str());
  } else {
    text.insert(tag_end(text, static_cast<std::size_t>(joint.offset_debug())), out.str());
  }
}

// base_T_i at zero readings, before beta_i: the frames on whose z axes the joints lie.
std::vector<Frame<double>> axis_frames(const Robot& robot) {
  const Chain chain = chain_of(robot, true);
  std::vector<Frame<double>> frames;
  Frame<double> at = identity_frame();
  for (const ChainJoint& joint : chain.joints) frames.push_back(at = compose(at, joint.parent_T_joint));
  return frames;
}

double distance(const Frame<double>& a, const Frame<double>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < 9; ++k) sum += std::pow(a.rotation[k] - b.rotation[k], 2);
  for (std::size_t k = 0; k < 3; ++k) sum += std::pow(a.position_m[k] - b.position_m[k], 2);
  return std::sqrt(sum);
}

// The largest difference of tip poses [m and rad, mixed] over some spread readings.
double disagreement(const Chain& a, const Chain& b) {
  double worst = 0;
  for (int k = 0; k < 8; ++k) {
    double q[max_joints];
    for (std::size_t i = 0; i < max_joints; ++i) q[i] = 2 * std::sin(1 + k * 1.7 + static_cast<double>(i) * 2.3);
    worst = std::max(worst, distance(tip(a, q), tip(b, q)));
  }
  return worst;
}

}  // namespace

Chain parse_urdf(const std::string& text, const std::string& path, const std::string& base, const std::string& tip) {
  const Urdf urdf(text, path);
  Chain chain;
  chain.name = urdf.name();
  Frame<double> since = identity_frame();
  for (const pugi::xml_node joint : urdf.joints(base, tip)) {
    since = compose(since, urdf.origin(joint));
    if (!urdf.moves(joint)) continue;
    ChainJoint moving = urdf.moving(joint);
    moving.parent_T_joint = since;
    const std::string note = urdf.limits_note(joint, moving);
    if (!note.empty()) chain.notes.push_back(note);
    chain.joints.push_back(moving);
    since = identity_frame();
  }
  chain.last_T_tip = since;
  return chain;
}

Chain read_urdf(const std::string& path, const std::string& base, const std::string& tip) {
  return parse_urdf(read_file(path, "a URDF"), path, base, tip);
}

std::string urdf_text(const Robot& robot) {
  const Chain chain = chain_of(robot, false);
  pugi::xml_document document;
  document.append_child(pugi::node_declaration).append_attribute("version") = "1.0";
  pugi::xml_node root = document.append_child("robot");
  set_attribute(root, "name", robot.name.empty() ? "robot" : robot.name);
  root.append_child(pugi::node_comment).set_value(" Effort and velocity limits are not known here: 0. ");
  if (robot.tracker_T_base) {
    set_attribute(root.append_child("link"), "name", "world");
    append_joint(root, "base", "fixed", "world", "base_link", frame_of(*robot.tracker_T_base));
  } else {
    set_attribute(root.append_child("link"), "name", "base_link");
  }
  std::string parent = "base_link";
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const ChainJoint& joint = chain.joints[i];
    const bool limited = joint.has_min || joint.has_max;
    const bool prismatic = joint.kind == JointKind::prismatic;
    const std::string child = "link_" + std::to_string(i + 1);
    const bool taken = joint.name == "base" || joint.name == "flange_joint" || joint.name == "tool_joint";
    pugi::xml_node node = append_joint(root, taken ? "joint_" + std::to_string(i + 1) : joint.name, prismatic ? "prismatic" : (limited ? "revolute" : "continuous"),
                                       parent, child, joint.parent_T_joint);
    set_attribute(node.append_child("axis"), "xyz", joint.axis[2] < 0 ? "0 0 -1" : "0 0 1");
    if (limited || prismatic) {
      pugi::xml_node limit = node.append_child("limit");
      set_attribute(limit, "lower", shortest_decimal(joint.has_min ? joint.min : -max_reading));
      set_attribute(limit, "upper", shortest_decimal(joint.has_max ? joint.max : max_reading));
      set_attribute(limit, "effort", "0");
      set_attribute(limit, "velocity", "0");
    }
    parent = child;
  }
  append_joint(root, "flange_joint", "fixed", parent, "flange", chain.last_T_tip);
  if (robot.tool_p_m) {
    const Vector3& p = *robot.tool_p_m;
    append_joint(root, "tool_joint", "fixed", "flange", "tool", frame_of_xyz_rpy(p, {0, 0, 0}));
  }
  std::ostringstream out;
  document.save(out, "  ");
  return out.str();
}

std::string corrected_urdf(const std::string& text, const std::string& path, const Robot& robot,
                           const std::string& base, const std::string& tip) {
  // What was written with ten digits and read again differs by less; a calibration moves more.
  constexpr double same = 1e-7;
  const Chain chain = parse_urdf(text, path, base, tip);
  Robot nominal = robot_from_chain(chain, path);
  Robot stated = robot;
  std::copy(robot.nominal.begin(), robot.nominal.end(), stated.geometry.link);
  stated.tracker_T_base = nominal.tracker_T_base;
  if (chain.joints.size() != static_cast<std::size_t>(robot.geometry.joint_count) ||
      disagreement(chain, chain_of(stated, true)) > same) {
    throw InputError(path, 0, 0, "The URDF's geometry is not the nominal geometry of " + robot.path +
                                     "; expected the URDF from which that robot was read, with the same --base and --tip.");
  }
  // Each link frame keeps its place relative to the frame on its joint's axis: axis_T_link.
  Robot corrected = robot;
  corrected.tracker_T_base = nominal.tracker_T_base;
  const std::vector<Frame<double>> before = axis_frames(stated), after = axis_frames(corrected);
  const Urdf urdf(text, path);
  std::map<std::ptrdiff_t, std::pair<pugi::xml_node, Frame<double>>, std::greater<>> origins;
  Frame<double> nominal_at = identity_frame(), corrected_at = identity_frame();
  std::size_t i = 0;
  for (const pugi::xml_node joint : urdf.joints(base, tip)) {
    nominal_at = compose(nominal_at, urdf.origin(joint));
    if (!urdf.moves(joint)) {
      corrected_at = compose(corrected_at, urdf.origin(joint));
      continue;
    }
    const Frame<double> axis_T_link = compose(inverted(before[i]), nominal_at);
    const Frame<double> link = compose(after[i], axis_T_link);
    origins.emplace(joint.offset_debug(), std::pair(joint, compose(inverted(corrected_at), link)));
    corrected_at = link;
    ++i;
  }
  std::string result = text;
  for (const auto& [offset, change] : origins) replace_origin(result, change.first, change.second);
  if (disagreement(parse_urdf(result, path, base, tip), chain_of(corrected, true)) > 1e-9) {
    throw Refusal(path + ": the correction changes the way from the last joint to \"" + tip +
                  "\", which joint origins cannot express");
  }
  return result;
}

}  // namespace mdhcal::offline
