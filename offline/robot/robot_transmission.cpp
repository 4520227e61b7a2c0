// SPDX-License-Identifier: MIT
// [gravity], [payload], [[joint_function]] and [[sag]] of a robot file.
#include "offline/robot/robot_reader.hpp"

namespace mdhcal::offline {

void RobotReader::read_gravity() {
  robot_.gravity_direction = {0, 0, -1};
  const toml::table* table = section("gravity");
  if (table == nullptr) return;
  allow(*table, "[gravity]", {"xyz"});
  const toml::node* node = table->get("xyz");
  if (node == nullptr) fail(table->source(), "[gravity] has no key \"xyz\"; expected the direction in which things fall, in the base frame.");
  const std::array<double, 3> xyz = numbers<3>(*node, "xyz", plain_number, 1e9);
  const double length = std::hypot(xyz[0], xyz[1], xyz[2]);
  if (!(length > 0)) {
    fail(node->source(), "Key \"xyz\": found a direction of gravity of length zero; expected the direction in which things fall, such as [0, 0, -1].");
  }
  // What was written as a unit vector keeps its bits.
  const bool is_unit = std::abs(length - 1) <= 1e-12;
  for (std::size_t k = 0; k < 3; ++k) robot_.gravity_direction[k] = is_unit ? xyz[k] : xyz[k] / length;
}

void RobotReader::read_payload() {
  const toml::table* table = section("payload");
  if (table == nullptr) return;
  allow(*table, "[payload]", {"mass_kg", "com"});
  Gravity& gravity = robot_.transmission.gravity;
  if (const toml::node* node = table->get("mass_kg")) {
    gravity.payload_kg = number(*node, "mass_kg", plain_number, 10000.0);
    if (gravity.payload_kg < 0) fail(node->source(), named("mass_kg") + kind_of(*node) + "; expected a mass that is not negative.");
  }
  if (const toml::node* node = table->get("com")) {
    const std::array<double, 3> com = numbers<3>(*node, "com", length_, max_length_m);
    std::copy(com.begin(), com.end(), gravity.payload_com_m);
  }
}

void RobotReader::read_joint_functions() {
  const auto tables = sections("joint_function", max_joints);
  for (std::size_t k = 0; k < tables.size(); ++k) {
    const toml::table& table = *tables[k];
    const std::string where = "[[joint_function]] " + std::to_string(k + 1);
    allow(table, where, {"joint", "range", "cosine", "sine"});
    const std::int32_t joint = joint_number(table, where, "joint");
    JointFunction& function = robot_.transmission.function[joint];
    if (function.order_count > 0 || function.seen_max_rad > function.seen_min_rad) {
      fail(table.source(), where + " repeats the function of joint " + std::to_string(joint + 1) + "; expected each joint once.");
    }
    const toml::node* range = table.get("range");
    if (range == nullptr) fail(table.source(), where + " has no key \"range\"; expected the readings that were seen, [from, to].");
    const std::array<double, 2> seen = numbers<2>(*range, "range", angle_, max_reading);
    if (!(seen[0] < seen[1])) fail(range->source(), named("range") + "readings that do not rise; expected [from, to].");
    function.seen_min_rad = seen[0];
    function.seen_max_rad = seen[1];
    const auto coefficients = [&](std::string_view key, float* out) {
      const toml::node* node = table.get(key);
      const toml::array* array = node == nullptr ? nullptr : node->as_array();
      if (array == nullptr || array->size() > max_orders) {
        fail(node == nullptr ? table.source() : node->source(), where + " needs an array " + in_quotes(key) + " of at most " +
                                                                    std::to_string(max_orders) + " numbers, one an order.");
      }
      for (std::size_t i = 0; i < array->size(); ++i) out[i] = static_cast<float>(number(*array->get(i), key, angle_, max_angle_rad));
      return static_cast<std::int32_t>(array->size());
    };
    function.order_count = coefficients("cosine", function.cosine_rad);
    if (coefficients("sine", function.sine_rad) != function.order_count) {
      fail(table.source(), where + " has not as many sines as cosines; expected one of each an order.");
    }
  }
}

void RobotReader::read_sags() {
  Gravity& gravity = robot_.transmission.gravity;
  const auto tables = sections("sag", max_joints * (max_joints + 1));
  for (std::size_t k = 0; k < tables.size(); ++k) {
    const toml::table& table = *tables[k];
    const std::string where = "[[sag]] " + std::to_string(k + 1);
    allow(table, where, {"joint", "link", "compliance_rad_per_m", "payload_compliance_rad_per_kg_m"});
    const std::int32_t joint = joint_number(table, where, "joint");
    const bool of_payload = table.contains("payload_compliance_rad_per_kg_m");
    if (of_payload == table.contains("compliance_rad_per_m") || of_payload == table.contains("link")) {
      fail(table.source(), where + " needs either \"link\" and \"compliance_rad_per_m\" or \"payload_compliance_rad_per_kg_m\".");
    }
    if (of_payload) {
      gravity.payload_compliance[joint] = required(table, where, "payload_compliance_rad_per_kg_m", plain_number, 1.0);
      continue;
    }
    const std::int32_t link = joint_number(table, where, "link");
    if (link < joint) fail(table.get("link")->source(), where + " lets a joint sag by a link before it; expected link >= joint.");
    gravity.compliance[joint][link] = required(table, where, "compliance_rad_per_m", plain_number, 1.0);
  }
  if (!tables.empty()) std::copy(robot_.gravity_direction.begin(), robot_.gravity_direction.end(), gravity.direction);
}

void RobotReader::read_transmission() {
  read_gravity();
  read_payload();
  read_joint_functions();
  read_sags();
  const Status status = check_transmission(robot_.geometry, robot_.transmission);
  if (status == Status::ok) return;
  throw InputError(path_, 1, 1,
                   status == Status::blob_deviation
                       ? "Found joint functions or a sag beyond what a controller accepts (5 mrad and a slope of 0.1, 20 mrad of sag); expected less."
                       : "Found joint functions, a sag or a payload that do not fit this arm; expected them of joints that turn, and finite.");
}

}  // namespace mdhcal::offline
