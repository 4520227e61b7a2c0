// SPDX-License-Identifier: MIT
#include "offline/robot/ur_factory.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <span>

#include <yaml-cpp/yaml.h>

#include "offline/base/error.hpp"
#include "offline/base/text.hpp"
#include "offline/robot/convention.hpp"
#include "offline/robot/rotation.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

constexpr std::size_t ur_joints = 6;
// A thousand times what eight joints of six numbers take, comments and all.
constexpr std::size_t most_kinematics_bytes = std::size_t{1} << 20;
constexpr std::array<const char*, ur_joints> ur_names{"shoulder", "upper_arm", "forearm",
                                                      "wrist_1",  "wrist_2",   "wrist_3"};
// What the ROS driver calls the joints in its joint states.
constexpr std::array<const char*, ur_joints> ur_joint_names{"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
                                                            "wrist_1_joint",      "wrist_2_joint",       "wrist_3_joint"};
constexpr std::array<const char*, 6> coordinates{"x", "y", "z", "roll", "pitch", "yaw"};

// The lengths by which the models differ: d1, a2, a3, d4, d5, d6 [m]. All share the twists. From Universal Robots' support
// article "DH Parameters for calculations of kinematics and dynamics" (UR3e, UR5e, UR10e, UR20) and the
// default_kinematics.yaml of each arm in ROS-Industrial's ur_description (UR3, UR5, UR10, UR16e, UR30).
struct UrModel {
  const char* name;
  double d1, a2, a3, d4, d5, d6;
};
constexpr UrModel models[] = {
    {"ur3", 0.1519, -0.24365, -0.21325, 0.11235, 0.08535, 0.0819},
    {"ur5", 0.089159, -0.425, -0.39225, 0.10915, 0.09465, 0.0823},
    {"ur10", 0.1273, -0.612, -0.5723, 0.163941, 0.1157, 0.0922},
    {"ur3e", 0.15185, -0.24355, -0.2132, 0.13105, 0.08535, 0.0921},
    {"ur5e", 0.1625, -0.425, -0.3922, 0.1333, 0.0997, 0.0996},
    {"ur10e", 0.1807, -0.6127, -0.57155, 0.17415, 0.11985, 0.11655},
    {"ur16e", 0.1807, -0.4784, -0.36, 0.17415, 0.11985, 0.11655},
    {"ur20", 0.2363, -0.862, -0.7287, 0.201, 0.1593, 0.1543},
    {"ur30", 0.2363, -0.637, -0.5037, 0.201, 0.1593, 0.1543},
};

std::array<StandardLink, ur_joints> standard_table(const std::string& name) {
  constexpr double right = std::numbers::pi / 2;
  for (const UrModel& m : models) {
    if (name == m.name) {
      return {{{0, m.d1, 0, right}, {0, 0, m.a2, 0}, {0, 0, m.a3, 0}, {0, m.d4, 0, right}, {0, m.d5, 0, -right},
               {0, m.d6, 0, 0}}};
    }
  }
  std::string known;
  for (const std::string& each : ur_models()) known += (known.empty() ? "" : ", ") + each;
  throw InputError("There is no UR model \"" + name + "\"; expected one of " + known + '.');
}

void set_links(Robot& robot, std::span<const StandardLink> table) {
  const ModifiedChain chain = mdh_from_standard(table);
  robot.geometry.joint_count = static_cast<std::int32_t>(table.size());
  for (std::size_t i = 0; i < table.size(); ++i) {
    robot.geometry.link[i] = chain.links[i];
    robot.geometry.joint[i].sign = 1;
  }
  robot.geometry.last_T_flange = pose_of(chain.last_T_flange);
}

// The list in one line of calibration.conf: key = [a, b, c, d, e, f].
std::array<double, ur_joints> parse_list(std::string_view line, const std::string& path, long number) {
  const std::size_t open = line.find('['), close = line.find(']');
  const auto column = [](std::size_t at) { return static_cast<long>(at) + 1; };
  if (open == std::string_view::npos || close == std::string_view::npos || close < open) {
    throw InputError(path, number, column(line.size()), "The list has no [ or no ]; expected [six numbers].");
  }
  std::array<double, ur_joints> values{};
  std::size_t at = open + 1;
  for (std::size_t i = 0; i < ur_joints; ++i) {
    at = line.find_first_not_of(" \t", at);
    const auto [end, error] = std::from_chars(line.data() + at, line.data() + close, values[i]);
    if (error != std::errc{} || !std::isfinite(values[i])) {
      throw InputError(path, number, column(at), "Entry " + std::to_string(i + 1) +
                                                     " of the list is no number; expected six numbers.");
    }
    at = line.find_first_not_of(" \t", static_cast<std::size_t>(end - line.data()));
    if (line[at] != (i + 1 < ur_joints ? ',' : ']')) {
      throw InputError(path, number, column(at), "Found \"" + std::string(1, line[at]) + "\" after entry " +
                                                     std::to_string(i + 1) + "; expected six numbers, separated by commas.");
    }
    ++at;
  }
  return values;
}

// A map that names a key twice would let one of the two win silently.
void refuse_repeats(const YAML::Node& map, const std::string& path) {
  std::set<std::string> keys;
  for (const auto& entry : map) {
    if (!entry.first.IsScalar() || keys.insert(entry.first.Scalar()).second) continue;
    const YAML::Mark mark = entry.first.Mark();
    throw InputError(path, mark.line + 1, mark.column + 1,
                     "Found \"" + entry.first.Scalar() + "\" a second time; expected each key once.");
  }
}

// As it stands where nothing in it means something to YAML, else in quotes.
std::string yaml_text(const std::string& text) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.' || c == '-';
  };
  if (std::all_of(text.begin(), text.end(), plain) && text.front() != '-' && text.front() != '.') return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

double coordinate(const YAML::Node& joint, const std::string& name, const char* key, const std::string& path) {
  const YAML::Mark mark = joint.Mark();
  const YAML::Node node = joint[key];
  if (!node) throw InputError(path, mark.line + 1, mark.column + 1, '"' + name + "\" has no \"" + key + "\".");
  double value = 0;
  const std::string text = node.IsScalar() ? node.Scalar() : "";
  const char* first = text.data() + (!text.empty() && text[0] == '+' ? 1 : 0);
  const auto [end, error] = std::from_chars(first, text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
    throw InputError(path, node.Mark().line + 1, node.Mark().column + 1,
                     '"' + text + "\" is not a number; expected " + key + " of " + name + " in metres or radians.");
  }
  return value;
}

Frame<double> frame_of_node(const YAML::Node& joint, const std::string& name, const std::string& path) {
  refuse_repeats(joint, path);
  std::array<double, 6> v{};
  for (std::size_t k = 0; k < v.size(); ++k) v[k] = coordinate(joint, name, coordinates[k], path);
  return frame_of_xyz_rpy({v[0], v[1], v[2]}, {v[3], v[4], v[5]});
}

}  // namespace

const std::vector<std::string>& ur_models() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const UrModel& model : models) list.emplace_back(model.name);
    return list;
  }();
  return names;
}

Robot ur_nominal(const std::string& model) {
  Robot robot;
  robot.path = robot.name = model;
  set_links(robot, standard_table(model));
  std::copy(std::begin(robot.geometry.link), std::end(robot.geometry.link), robot.nominal.begin());
  return robot;
}

Chain parse_ros_kinematics(const std::string& text, const std::string& path) {
  if (text.size() > most_kinematics_bytes) {
    throw InputError(path, 0, 0, "Found " + std::to_string(text.size()) + " bytes; expected ROS kinematics of at most " +
                                     std::to_string(most_kinematics_bytes) + ".");
  }
  require_text(text, path, "ROS kinematics (YAML)");
  YAML::Node document;
  try {
    document = YAML::Load(text);
  } catch (const YAML::ParserException& error) {
    throw InputError(path, error.mark.line + 1, error.mark.column + 1, "The file is not YAML: " + error.msg + '.');
  }
  const YAML::Node kinematics = document.IsMap() ? document["kinematics"] : YAML::Node();
  if (!kinematics || !kinematics.IsMap()) {
    throw InputError(path, 1, 1, "There is no map \"kinematics\"; expected one with a frame a joint.");
  }
  refuse_repeats(document, path);
  refuse_repeats(kinematics, path);
  std::vector<std::pair<std::string, YAML::Node>> nodes;
  const bool ur = static_cast<bool>(kinematics[ur_names[0]]);
  if (ur) {
    for (const char* name : ur_names) {
      const YAML::Node node = kinematics[name];
      if (!node) {
        throw InputError(path, kinematics.Mark().line + 1, kinematics.Mark().column + 1,
                         "There is no \"" + std::string(name) + "\"; expected the six joints of a UR arm.");
      }
      nodes.emplace_back(name, node);
    }
  } else {
    for (const auto& entry : kinematics) {
      if (entry.second.IsMap() && entry.first.Scalar() != "flange") nodes.emplace_back(entry.first.Scalar(), entry.second);
    }
  }
  Chain chain;
  chain.name = ur ? "UR" : "robot";
  for (const auto& [name, node] : nodes) {
    if (!node.IsMap()) {
      throw InputError(path, node.Mark().line + 1, node.Mark().column + 1,
                       '"' + name + "\" is not a map; expected x, y, z, roll, pitch and yaw.");
    }
    ChainJoint joint;
    joint.name = ur ? ur_joint_names[chain.joints.size()] : name;
    joint.parent_T_joint = frame_of_node(node, name, path);
    chain.joints.push_back(joint);
  }
  const YAML::Node hash = kinematics["hash"];
  if (hash) {
    if (!hash.IsScalar() || hash.Scalar().size() > 127 ||
        std::any_of(hash.Scalar().begin(), hash.Scalar().end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; })) {
      throw InputError(path, hash.Mark().line + 1, hash.Mark().column + 1,
                       "\"hash\" is not a line of at most 127 bytes; expected what names the factory calibration.");
    }
    chain.kinematics_hash = hash.Scalar();
  }
  const YAML::Node flange = kinematics["flange"];
  chain.last_T_tip = flange ? frame_of_node(flange, "flange", path) : identity_frame();
  return chain;
}

Robot parse_ur_calibration(const std::string& text, const std::string& path, const std::string& model) {
  require_text(text, path, "a UR calibration");
  std::map<std::string, std::array<double, ur_joints>> deltas;
  long number = 0;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    std::string_view line(text.data() + start, end - start);
    start = end + 1;
    ++number;
    line = line.substr(0, line.find('#'));
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) continue;
    std::string key(line.substr(0, equals));
    key.erase(key.find_last_not_of(" \t") + 1);
    key.erase(0, key.find_first_not_of(" \t"));
    if (!key.starts_with("delta_")) continue;
    if (!deltas.emplace(key, parse_list(line, path, number)).second) {
      throw InputError(path, number, 1, "Found \"" + key + "\" a second time; expected each list once.");
    }
  }
  auto table = standard_table(model);
  Robot robot = ur_nominal(model);
  robot.path = path;
  const auto delta = [&](const char* key) {
    const auto found = deltas.find(key);
    if (found == deltas.end()) {
      throw InputError(path, number, 1,
                       "There is no \"" + std::string(key) + "\"; expected delta_theta, delta_a, delta_d and delta_alpha.");
    }
    return found->second;
  };
  const auto theta = delta("delta_theta"), a = delta("delta_a"), d = delta("delta_d"), alpha = delta("delta_alpha");
  for (std::size_t i = 0; i < ur_joints; ++i) {
    table[i].theta_rad += theta[i];
    table[i].a_m += a[i];
    table[i].d_m += d[i];
    table[i].alpha_rad += alpha[i];
  }
  set_links(robot, table);
  if (check_geometry(robot.geometry) != Status::ok) {
    throw InputError(path, 0, 0, "The corrected lengths or angles lie outside the valid range.");
  }
  return robot;
}

std::string ros_kinematics_text(const Robot& robot) {
  Chain chain = chain_of(robot, false);
  // The form has no axis: every joint turns about +z. A joint that turns the other way gets its frame turned over.
  const Frame<double> over{{1, 0, 0, 0, -1, 0, 0, 0, -1}, {0, 0, 0}};
  Frame<double> before = identity_frame();
  std::string text = "kinematics:\n";
  const auto entry = [&](const std::string& name, const Frame<double>& frame) {
    const Vector3 rpy = roll_pitch_yaw(frame);
    const double values[6] = {frame.position_m[0], frame.position_m[1], frame.position_m[2], rpy[0], rpy[1], rpy[2]};
    text += "  " + name + ":\n";
    for (std::size_t k = 0; k < 6; ++k) {
      text += "    " + std::string(coordinates[k]) + ": " + shortest_decimal(values[k] + 0.0) + '\n';
    }
  };
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const ChainJoint& joint = chain.joints[i];
    if (joint.kind != JointKind::revolute) {
      throw Refusal("joint " + std::to_string(i + 1) + " slides, which the kinematics form cannot express");
    }
    const Frame<double> turn = joint.axis[2] < 0 ? over : identity_frame();
    const bool usable = joint.name != "flange" && joint.name != "hash" && yaml_text(joint.name) == joint.name;
    entry(chain.joints.size() == ur_joints ? ur_names[i] : usable ? joint.name : "joint_" + std::to_string(i + 1),
          compose(compose(before, joint.parent_T_joint), turn));
    before = turn;  // its own inverse
  }
  const Frame<double> flange = compose(before, chain.last_T_tip);
  bool differs = false;
  for (std::size_t k = 0; k < 9; ++k) differs |= std::abs(flange.rotation[k] - identity_frame().rotation[k]) > 0;
  for (const double coordinate : flange.position_m) differs |= std::abs(coordinate) > 0;
  if (differs) entry("flange", flange);
  if (!robot.kinematics_hash.empty()) text += "  hash: " + yaml_text(robot.kinematics_hash) + '\n';
  return text;
}

}  // namespace mdhcal::offline
