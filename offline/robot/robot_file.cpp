// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include "offline/base/read_file.hpp"
#include "offline/robot/convention.hpp"
#include "offline/robot/robot_reader.hpp"
#include "offline/robot/rotation.hpp"

namespace mdhcal::offline {

// A point and, where it is stated, the turn of its probe; the name is the caller's.
TargetPoint RobotReader::target(const toml::table& table, const std::string& where) const {
  (void)point(table, where, true);
  const Pose<double> stated = pose(table, where);
  TargetPoint out{"", {stated.position_m[0], stated.position_m[1], stated.position_m[2]}, {}};
  if (table.contains("rxryrz") || table.contains("quaternion")) {
    const double* q = stated.quaternion;
    out.quaternion = {q[0], q[1], q[2], q[3]};
  }
  return out;
}

Pose<double> RobotReader::pose(const toml::table& table, const std::string& where) const {
  if (where.starts_with("[[target]]")) {
    allow(table, where, {"name", "xyz", "rxryrz", "quaternion"});
  } else {
    allow(table, where, {"xyz", "rxryrz", "quaternion"});
  }
  const Vector3 xyz = point(table, where, false);
  std::array<double, 4> q{1, 0, 0, 0};
  const toml::node* vector = table.get("rxryrz");
  const toml::node* quaternion = table.get("quaternion");
  if (vector != nullptr && quaternion != nullptr) {
    fail(quaternion->source(), where + " has both \"rxryrz\" and \"quaternion\"; expected one of them.");
  }
  if (vector != nullptr) q = quaternion_of(numbers<3>(*vector, "rxryrz", angle_, max_angle_rad));
  if (quaternion != nullptr) {
    q = numbers<4>(*quaternion, "quaternion", plain_number, 2.0);
    const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
    // The library's own bound on the square is 1e-9. The bits are kept: a blob packed from here is the same each time.
    if (!(std::abs(norm - 1.0) <= 1e-10)) {
      fail(quaternion->source(), "Key \"quaternion\": found the norm " + shortest_decimal(norm) +
                                     "; expected a unit quaternion w, x, y, z.");
    }
    if (q[0] < 0) {
      for (double& c : q) c = -c;
    }
  }
  return {{q[0], q[1], q[2], q[3]}, {xyz[0], xyz[1], xyz[2]}};
}

Link RobotReader::link(const toml::table& table, const std::string& where, double length_bound) const {
  Link link{};
  link.alpha_rad = required(table, where, "alpha", angle_, max_angle_rad);
  link.a_m = required(table, where, "a", length_, length_bound);
  link.d_m = required(table, where, "d", length_, length_bound);
  link.theta_rad = number(table, "theta", angle_, max_angle_rad, 0.0);
  link.beta_rad = number(table, "beta", angle_, max_angle_rad, 0.0);
  return link;
}

void RobotReader::read_joint(const toml::table& table, std::size_t index) {
  Joint& joint = robot_.geometry.joint[index];
  joint.kind = choice(table, "joint", {"revolute", "prismatic"}) == 1 ? JointKind::prismatic : JointKind::revolute;
  joint.sign = 1;
  if (const toml::node* node = table.get("sign")) {
    const double sign = number(*node, "sign", plain_number, 1e9);
    if (std::abs(std::abs(sign) - 1.0) > 0) {
      fail(node->source(), named("sign") + kind_of(*node) + "; expected 1 or -1.");
    }
    joint.sign = sign > 0 ? 1 : -1;
  }
  const Unit unit = unit_of_reading(index);
  joint.has_min = table.contains("min") ? 1 : 0;
  joint.has_max = table.contains("max") ? 1 : 0;
  joint.min = number(table, "min", unit, max_reading, 0.0);
  joint.max = number(table, "max", unit, max_reading, 0.0);
  if (joint.has_min == 1 && joint.has_max == 1 && joint.min > joint.max) {
    fail(table.get("min")->source(), named("min") + kind_of(*table.get("min")) + ", which is more than max (" +
                                         kind_of(*table.get("max")) + "); expected min <= max.");
  }
}

void RobotReader::read_joint_name(const toml::table& table, const std::string& where, std::size_t index) {
  const std::string name = text_of(table, "joint_name", "", most_joint_name_bytes);
  const auto end = robot_.joint_name.begin() + static_cast<std::ptrdiff_t>(index);
  if (!name.empty() && std::find(robot_.joint_name.begin(), end, name) != end) {
    fail(table.get("joint_name")->source(), where + " repeats the joint_name " + in_quotes(name) +
                                                "; expected each name once.");
  }
  robot_.joint_name[index] = name;
}

void RobotReader::read_links() {
  const auto tables = sections("link", max_joints);
  if (tables.empty()) throw InputError(path_, 1, 1, "Found no section [[link]]; expected one a joint, base to flange.");
  robot_.geometry.joint_count = static_cast<std::int32_t>(tables.size());
  // A standard table may hold lengths that cancel; what comes out of the conversion is held to the library's bound.
  const double length_bound = standard_ ? 1e6 : max_length_m;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const toml::table& table = *tables[i];
    const std::string where = "[[link]] " + std::to_string(i + 1);
    allow(table, where, {"joint", "alpha", "a", "d", "theta", "beta", "sign", "min", "max", "joint_name", "nominal"});
    read_joint(table, i);
    read_joint_name(table, where, i);
    robot_.geometry.link[i] = link(table, where, length_bound);
    robot_.nominal[i] = robot_.geometry.link[i];
    for (const std::string_view key : {"beta", "nominal"}) {
      if (standard_ && table.contains(key)) {
        fail(table.get(key)->source(), "Found the key " + in_quotes(key) + " in " + where +
                                           " of a file in the standard convention; expected it only with convention = "
                                           "\"modified\".");
      }
    }
    if (const toml::node* nominal = table.get("nominal")) {
      const std::string inner = where + ".nominal";
      if (!nominal->is_table()) {
        fail(nominal->source(), named("nominal") + kind_of(*nominal) + "; expected an inline table.");
      }
      allow(*nominal->as_table(), inner, {"alpha", "a", "d", "theta", "beta"});
      robot_.nominal[i] = link(*nominal->as_table(), inner, max_length_m);
    }
  }
}

void RobotReader::read_couplings() {
  const auto tables = sections("coupling", max_joints * max_joints);
  for (std::size_t k = 0; k < tables.size(); ++k) {
    const toml::table& table = *tables[k];
    const std::string where = "[[coupling]] " + std::to_string(k + 1);
    allow(table, where, {"of", "by", "ratio"});
    const auto of = static_cast<std::size_t>(joint_number(table, where, "of"));
    const auto by = static_cast<std::size_t>(joint_number(table, where, "by"));
    if (of == by) fail(table.get("by")->source(), where + " couples a joint to itself; expected two different joints.");
    double& ratio = robot_.geometry.joint[of].coupling[by];
    if (std::abs(ratio) > 0) {
      fail(table.source(), where + " repeats the coupling of joint " + std::to_string(of + 1) + " by joint " +
                               std::to_string(by + 1) + "; expected each pair once.");
    }
    ratio = required(table, where, "ratio", coupling_unit(unit_of_reading(of), unit_of_reading(by)), max_coupling);
    if (!(std::abs(ratio) > 0)) ratio = 0.0;  // -0 is no coupling either, and is not written back
  }
}

void RobotReader::read_targets() {
  const auto tables = sections("target", 8);
  for (std::size_t k = 0; k < tables.size(); ++k) {
    const toml::table& table = *tables[k];
    const std::string where = "[[target]] " + std::to_string(k + 1);
    TargetPoint point = target(table, where);
    point.name = text_of(table, "name", "", 15);
    for (const TargetPoint& other : robot_.targets) {
      if (other.name == point.name) {
        const toml::node* name = table.get("name");
        fail(name != nullptr ? name->source() : table.source(),
             where + " repeats the name " + in_quotes(point.name) + "; expected each target once.");
      }
    }
    robot_.targets.push_back(std::move(point));
  }
}

void RobotReader::read_priors() {
  const toml::table* table = section("prior");
  if (table == nullptr) return;
  for (auto&& [key, value] : *table) {
    const std::string name(key.str());
    const std::size_t digit = name.find_first_of("0123456789");
    const std::string word = name.substr(0, digit);
    const bool is_length = word == "a" || word == "d";
    const bool is_angle = word == "alpha" || word == "theta" || word == "beta";
    const std::string number_text = digit == std::string::npos ? "" : name.substr(digit);
    const bool in_range = number_text.size() == 1 && number_text[0] >= '1' &&
                          number_text[0] - '0' <= robot_.geometry.joint_count;
    if (!(is_length || is_angle) || !in_range) {
      fail(key.source(), "Unknown key " + in_quotes(name) +
                             " in [prior]; expected alpha, a, d, theta or beta with the number of a link, 1 to " +
                             std::to_string(robot_.geometry.joint_count) + ".");
    }
    const double sd = number(value, name, is_length ? length_ : angle_, is_length ? max_length_m : max_angle_rad);
    if (!(sd > 0)) fail(value.source(), named(name) + kind_of(value) + "; expected a standard deviation above 0.");
    robot_.prior[name] = sd;
  }
}

void RobotReader::convert_standard() {
  Geometry& g = robot_.geometry;
  const auto count = static_cast<std::size_t>(g.joint_count);
  std::vector<StandardLink> table;
  for (std::size_t i = 0; i < count; ++i) {
    table.push_back({g.link[i].theta_rad, g.link[i].d_m, g.link[i].a_m, g.link[i].alpha_rad});
  }
  const ModifiedChain chain = mdh_from_standard(table);
  const auto links = sections("link", max_joints);
  for (std::size_t i = 0; i < count; ++i) {
    g.link[i] = chain.links[i];
    if (!(std::abs(g.link[i].a_m) <= max_length_m && std::abs(g.link[i].d_m) <= max_length_m)) {
      fail(links[i]->source(), "[[link]] " + std::to_string(i + 1) + " has a length of more than " +
                                   shortest_decimal(length_.from_si(max_length_m)) + " " + std::string(length_.name) +
                                   " in the modified convention; expected a shorter one.");
    }
  }
  // The last a and alpha; a flange that they do not move keeps its bits.
  if (std::abs(table.back().a_m) > 0 || std::abs(table.back().alpha_rad) > 0) {
    g.last_T_flange = pose_of(compose(chain.last_T_flange, frame_of(g.last_T_flange)));
  }
}

// Moves what was computed, by an ulp, to numbers that this file's units can express: writing and reading it again then
// gives the same bits.
void RobotReader::make_expressible() {
  Geometry& g = robot_.geometry;
  for (std::size_t i = 0; i < static_cast<std::size_t>(g.joint_count); ++i) {
    Link& link = g.link[i];
    for (double* angle : {&link.alpha_rad, &link.theta_rad, &link.beta_rad}) *angle = angle_.expressible(*angle);
    for (double* length : {&link.a_m, &link.d_m}) *length = length_.expressible(*length);
    robot_.nominal[i] = link;
  }
  for (double& p : g.last_T_flange.position_m) p = length_.expressible(p);
}

Robot RobotReader::read() {
  allow(root_, "", {"name", "serial", "convention", "length_unit", "angle_unit", "link", "coupling", "flange", "tool",
                    "base", "target", "prior", "kinematics_hash", "gravity", "payload", "joint_function", "sag"});
  robot_.path = path_;
  std::string stem = path_.substr(path_.find_last_of('/') + 1);
  stem = stem.substr(0, stem.find_last_of('.'));
  robot_.name = text_of(root_, "name", std::string(begin_of(printable(stem), 63)), 63);
  robot_.serial = text_of(root_, "serial", "", 31);
  robot_.kinematics_hash = text_of(root_, "kinematics_hash", "", 127);
  standard_ = as_.standard.value_or(choice(root_, "convention", {"modified", "standard"}) == 1);
  robot_.standard = standard_;
  robot_.length_in_mm = as_.length_in_mm.value_or(choice(root_, "length_unit", {"mm", "m"}) == 0);
  robot_.angle_in_deg = as_.angle_in_deg.value_or(choice(root_, "angle_unit", {"deg", "rad"}) == 0);
  length_ = robot_.length_in_mm ? millimetre : metre;
  angle_ = robot_.angle_in_deg ? degree : radian;
  robot_.geometry.last_T_flange.quaternion[0] = 1;
  read_links();
  read_couplings();
  if (const toml::table* flange = section("flange")) robot_.geometry.last_T_flange = pose(*flange, "[flange]");
  if (const toml::table* base = section("base")) robot_.tracker_T_base = pose(*base, "[base]");
  if (const toml::table* tool = section("tool")) {
    const TargetPoint point = target(*tool, "[tool]");
    robot_.tool_p_m = point.flange_p_m;
    robot_.tool_quaternion = point.quaternion;
  }
  read_targets();
  read_priors();
  if (standard_) {
    convert_standard();
    make_expressible();
  }
  if (check_geometry(robot_.geometry) != Status::ok) {
    throw InputError(path_, 1, 1, "Found a geometry outside the library's valid range; expected lengths and angles within it.");
  }
  read_transmission();
  return robot_;
}

Robot parse_robot(const std::string& text, const std::string& path) { return RobotReader(text, path).read(); }

std::optional<Robot> read_as(const Robot& robot, const ReadAs& as) {
  try {
    // What was read another way before stays so.
    const ReadAs all{as.standard.value_or(robot.standard), as.length_in_mm.value_or(robot.length_in_mm),
                     as.angle_in_deg.value_or(robot.angle_in_deg)};
    return RobotReader(robot.text, robot.path, all).read();
  } catch (const InputError&) {
    return std::nullopt;
  }
}

Robot read_robot(const std::string& path) { return parse_robot(read_file(path, "a robot file"), path); }

}  // namespace mdhcal::offline
