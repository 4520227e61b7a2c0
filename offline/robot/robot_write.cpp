// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdio>
#include <cstring>

#include "offline/robot/robot.hpp"
#include "offline/robot/rotation.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

std::string toml_string(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

template <class Values>
std::string array_of(const Values& values, const Unit& unit) {
  std::string out = "[";
  for (const double value : values) out += (out.size() > 1 ? ", " : "") + shortest_decimal(unit.from_si(value));
  return out + ']';
}

class Writer {
 public:
  explicit Writer(const Robot& robot)
      : robot_(robot),
        length_(robot.length_in_mm ? millimetre : metre),
        angle_(robot.angle_in_deg ? degree : radian) {}

  std::string write() {
    line("name", toml_string(robot_.name));
    if (!robot_.serial.empty()) line("serial", toml_string(robot_.serial));
    if (!robot_.kinematics_hash.empty()) line("kinematics_hash", toml_string(robot_.kinematics_hash));
    line("convention", "\"modified\"");
    line("length_unit", toml_string(std::string(length_.name)));
    line("angle_unit", toml_string(std::string(angle_.name)));
    const auto count = static_cast<std::size_t>(robot_.geometry.joint_count);
    for (std::size_t i = 0; i < count; ++i) write_link(i);
    for (std::size_t of = 0; of < count; ++of) {
      for (std::size_t by = 0; by < count; ++by) write_coupling(of, by);
    }
    write_pose("flange", robot_.geometry.last_T_flange);
    if (robot_.tool_p_m) {
      text_ += "[tool]\n";
      line("xyz", array_of(*robot_.tool_p_m, length_));
      if (robot_.tool_quaternion) write_rotation(*robot_.tool_quaternion);
    }
    if (robot_.tracker_T_base) write_pose("base", *robot_.tracker_T_base);
    for (const TargetPoint& target : robot_.targets) {
      text_ += "[[target]]\n";
      line("name", toml_string(target.name));
      line("xyz", array_of(target.flange_p_m, length_));
      if (target.quaternion) write_rotation(*target.quaternion);
    }
    write_transmission();
    if (!robot_.prior.empty()) text_ += "[prior]\n";
    for (const auto& [name, sd] : robot_.prior) {
      const bool is_length = name[0] == 'd' || name.find_first_of("0123456789") == 1;
      line(name, shortest_decimal((is_length ? length_ : angle_).from_si(sd)));
    }
    return text_;
  }

 private:
  void line(const std::string& key, const std::string& value) { text_ += key + " = " + value + '\n'; }

  std::string number(double si, const Unit& unit) const { return shortest_decimal(unit.from_si(si)); }

  const Unit& unit_of_reading(std::size_t joint) const {
    return robot_.geometry.joint[joint].kind == JointKind::prismatic ? length_ : angle_;
  }

  void write_link(std::size_t i) {
    const Joint& joint = robot_.geometry.joint[i];
    const Link& link = robot_.geometry.link[i];
    const Link& nominal = robot_.nominal[i];
    text_ += "[[link]]\n";
    if (joint.kind == JointKind::prismatic) line("joint", "\"prismatic\"");
    if (!robot_.joint_name[i].empty()) line("joint_name", toml_string(robot_.joint_name[i]));
    line("alpha", number(link.alpha_rad, angle_));
    line("a", number(link.a_m, length_));
    line("d", number(link.d_m, length_));
    line("theta", number(link.theta_rad, angle_));
    line("beta", number(link.beta_rad, angle_));
    if (std::memcmp(&link, &nominal, sizeof link) != 0) {
      line("nominal", "{alpha = " + number(nominal.alpha_rad, angle_) + ", a = " + number(nominal.a_m, length_) +
                          ", d = " + number(nominal.d_m, length_) + ", theta = " + number(nominal.theta_rad, angle_) +
                          ", beta = " + number(nominal.beta_rad, angle_) + "}");
    }
    if (joint.sign < 0) line("sign", "-1");
    if (joint.has_min == 1) line("min", number(joint.min, unit_of_reading(i)));
    if (joint.has_max == 1) line("max", number(joint.max, unit_of_reading(i)));
  }

  void write_coupling(std::size_t of, std::size_t by) {
    const double ratio = robot_.geometry.joint[of].coupling[by];
    if (!(ratio > 0 || ratio < 0)) return;
    text_ += "[[coupling]]\n";
    line("of", std::to_string(of + 1));
    line("by", std::to_string(by + 1));
    line("ratio", number(ratio, coupling_unit(unit_of_reading(of), unit_of_reading(by))));
  }

  void write_pose(const std::string& section, const Pose<double>& pose) {
    text_ += '[' + section + "]\n";
    line("xyz", array_of(pose.position_m, length_));
    write_rotation({pose.quaternion[0], pose.quaternion[1], pose.quaternion[2], pose.quaternion[3]});
  }

  void write_transmission() {
    const Gravity& gravity = robot_.transmission.gravity;
    const Vector3& down = robot_.gravity_direction;
    const bool has_sag = std::abs(gravity.direction[0]) > 0 || std::abs(gravity.direction[1]) > 0 || std::abs(gravity.direction[2]) > 0;
    const bool as_default = !(std::abs(down[0]) > 0) && !(std::abs(down[1]) > 0) && down[2] < 0;
    if (has_sag || !as_default) {
      text_ += "[gravity]\n";
      line("xyz", array_of(down, plain_number));
    }
    const double* com = gravity.payload_com_m;
    if (gravity.payload_kg > 0 || std::abs(com[0]) > 0 || std::abs(com[1]) > 0 || std::abs(com[2]) > 0) {
      text_ += "[payload]\n";
      line("mass_kg", shortest_decimal(gravity.payload_kg));
      line("com", array_of(gravity.payload_com_m, length_));
    }
    const auto count = static_cast<std::size_t>(robot_.geometry.joint_count);
    for (std::size_t i = 0; i < count; ++i) write_function(i);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i; j < count; ++j) {
        if (!(std::abs(gravity.compliance[i][j]) > 0)) continue;
        text_ += "[[sag]]\n";
        line("joint", std::to_string(i + 1));
        line("link", std::to_string(j + 1));
        line("compliance_rad_per_m", shortest_decimal(gravity.compliance[i][j]));
      }
      if (!(std::abs(gravity.payload_compliance[i]) > 0)) continue;
      text_ += "[[sag]]\n";
      line("joint", std::to_string(i + 1));
      line("payload_compliance_rad_per_kg_m", shortest_decimal(gravity.payload_compliance[i]));
    }
  }

  // Coefficients are float: nine digits of one read back as its bits whatever the unit.
  void write_function(std::size_t i) {
    const JointFunction& function = robot_.transmission.function[i];
    if (!(function.seen_max_rad > function.seen_min_rad)) return;
    text_ += "[[joint_function]]\n";
    line("joint", std::to_string(i + 1));
    line("range", array_of(std::array<double, 2>{function.seen_min_rad, function.seen_max_rad}, angle_));
    const auto list = [&](const float* coefficients) {
      std::string out = "[";
      for (std::int32_t k = 0; k < function.order_count; ++k) {
        char word[32];
        std::snprintf(word, sizeof word, "%s%.9e", k > 0 ? ", " : "", angle_.from_si(static_cast<double>(coefficients[k])));
        out += word;
      }
      return out + ']';
    };
    line("cosine", list(function.cosine_rad));
    line("sine", list(function.sine_rad));
  }

  // The rotation vector where it leads back to the same bits, else the quaternion itself.
  void write_rotation(const std::array<double, 4>& q) {
    Vector3 vector = rotation_vector_of(q);
    for (double& component : vector) component = angle_.expressible(component);
    const std::array<double, 4> again = quaternion_of(vector);
    if (std::memcmp(q.data(), again.data(), sizeof q) == 0) {
      line("rxryrz", array_of(vector, angle_));
    } else {
      line("quaternion", array_of(q, plain_number));
    }
  }

  const Robot& robot_;
  Unit length_;
  Unit angle_;
  std::string text_;
};

}  // namespace

std::string write_robot(const Robot& robot) { return Writer(robot).write(); }

}  // namespace mdhcal::offline
