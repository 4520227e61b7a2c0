// SPDX-License-Identifier: MIT
// Private to offline/robot: the reader of a robot file.
#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include "offline/base/error.hpp"
#include "offline/base/text.hpp"
#include "offline/robot/robot.hpp"
#include "offline/robot/toml_text.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

inline std::string in_quotes(std::string_view text) { return '"' + std::string(text) + '"'; }

inline std::string kind_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table: return "a table";
    case toml::node_type::array: return "an array";
    case toml::node_type::string: return "the text " + in_quotes(node.as_string()->get());
    case toml::node_type::boolean: return node.as_boolean()->get() ? "true" : "false";
    case toml::node_type::integer: return std::to_string(node.as_integer()->get());
    case toml::node_type::floating_point: return shortest_decimal(node.as_floating_point()->get());
    default: return "a date or time";
  }
}

/// The reader: every method throws InputError at the place of the node that it looks at.
class RobotReader {
 public:
  RobotReader(const std::string& text, const std::string& path, const ReadAs& as = {})
      : path_(path), as_(as), root_(parse_toml(text, path)) {
    robot_.text = text;
  }

  Robot read();

 private:
  [[noreturn]] void fail(const toml::source_region& at, const std::string& message) const {
    throw InputError(path_, static_cast<long>(at.begin.line), static_cast<long>(at.begin.column), message);
  }

  // Refuses keys outside `keys`. `where`: "[[link]] 2", or empty for the top level.
  void allow(const toml::table& table, const std::string& where, std::initializer_list<std::string_view> keys) const {
    for (auto&& [key, value] : table) {
      if (std::find(keys.begin(), keys.end(), key.str()) != keys.end()) continue;
      std::string expected;
      for (const std::string_view known : keys) expected += (expected.empty() ? "" : ", ") + std::string(known);
      fail(key.source(), "Unknown key " + in_quotes(key.str()) + (where.empty() ? "" : " in " + where) + "; expected " +
                             expected + ".");
    }
  }

  std::string text_of(const toml::table& table, std::string_view key, const std::string& fallback,
                      std::size_t most_bytes) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return fallback;
    if (!node->is_string()) fail(node->source(), named(key) + kind_of(*node) + "; expected a text in quotes.");
    std::string text = node->as_string()->get();
    if (text.size() > most_bytes) {
      fail(node->source(), named(key) + "a text of " + std::to_string(text.size()) + " bytes; expected at most " +
                               std::to_string(most_bytes) + ".");
    }
    if (printable(text) != text || text.find_first_of("\t\n") != std::string::npos) {
      fail(node->source(), named(key) + "a control character; expected printable text.");
    }
    return text;
  }

  static std::string named(std::string_view key) { return "Key " + in_quotes(key) + ": found "; }

  // One of the words; their index. The first is the default.
  std::size_t choice(const toml::table& table, std::string_view key,
                     std::initializer_list<std::string_view> words) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return 0;
    std::string expected;
    for (const std::string_view word : words) expected += (expected.empty() ? "" : " or ") + in_quotes(word);
    if (node->is_string()) {
      const auto found = std::find(words.begin(), words.end(), node->as_string()->get());
      if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
    }
    fail(node->source(), named(key) + kind_of(*node) + "; expected " + expected + ".");
  }

  // A finite number of the file in SI units, |SI value| <= bound.
  double number(const toml::node& node, std::string_view key, const Unit& unit, double bound) const {
    double value = 0;
    if (node.is_integer()) {
      value = static_cast<double>(node.as_integer()->get());
    } else if (node.is_floating_point()) {
      value = node.as_floating_point()->get();
    } else {
      fail(node.source(), named(key) + kind_of(node) + "; expected a number.");
    }
    const double si = unit.to_si(value);
    if (!std::isfinite(value)) fail(node.source(), named(key) + kind_of(node) + "; expected a finite number.");
    if (!(std::abs(si) <= bound)) {
      const std::string name = unit.name.empty() ? "" : " " + std::string(unit.name);
      fail(node.source(), named(key) + kind_of(node) + name + "; expected at most " +
                              shortest_decimal(unit.from_si(bound)) + name + " in size (wrong unit?).");
    }
    return si;
  }

  double number(const toml::table& table, std::string_view key, const Unit& unit, double bound,
                double fallback) const {
    const toml::node* node = table.get(key);
    return node == nullptr ? fallback : number(*node, key, unit, bound);
  }

  double required(const toml::table& table, const std::string& where, std::string_view key, const Unit& unit,
                  double bound) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) fail(table.source(), where + " has no key " + in_quotes(key) + "; expected a number.");
    return number(*node, key, unit, bound);
  }

  std::int32_t joint_number(const toml::table& table, const std::string& where, std::string_view key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) fail(table.source(), where + " has no key " + in_quotes(key) + "; expected a joint's number.");
    if (!node->is_integer() || node->as_integer()->get() < 1 || node->as_integer()->get() > robot_.geometry.joint_count) {
      fail(node->source(), named(key) + kind_of(*node) + "; expected the number of a joint, 1 to " +
                               std::to_string(robot_.geometry.joint_count) + ".");
    }
    return static_cast<std::int32_t>(node->as_integer()->get()) - 1;
  }

  // `size` numbers in an array.
  template <std::size_t size>
  std::array<double, size> numbers(const toml::node& node, std::string_view key, const Unit& unit, double bound) const {
    std::array<double, size> values{};
    const toml::array* array = node.as_array();
    if (array == nullptr || array->size() != size) {
      fail(node.source(), named(key) +
                              (array == nullptr ? kind_of(node) : "an array of " + std::to_string(array->size())) +
                              "; expected an array of " + std::to_string(size) + " numbers.");
    }
    for (std::size_t k = 0; k < size; ++k) values[k] = number(*array->get(k), key, unit, bound);
    return values;
  }

  Vector3 point(const toml::table& table, const std::string& where, bool must) const {
    const toml::node* node = table.get("xyz");
    if (node == nullptr) {
      if (must) fail(table.source(), where + " has no key \"xyz\"; expected an array of 3 numbers.");
      return {};
    }
    return numbers<3>(*node, "xyz", length_, max_length_m);
  }

  const toml::table* section(std::string_view key) const {
    const toml::node* node = root_.get(key);
    if (node == nullptr) return nullptr;
    if (!node->is_table()) {
      fail(node->source(), named(key) + kind_of(*node) + "; expected a section [" + std::string(key) + "].");
    }
    return node->as_table();
  }

  // The tables of [[key]].
  std::vector<const toml::table*> sections(std::string_view key, std::size_t most) const {
    std::vector<const toml::table*> tables;
    const toml::node* node = root_.get(key);
    if (node == nullptr) return tables;
    const std::string expected = "; expected sections [[" + std::string(key) + "]].";
    if (!node->is_array()) fail(node->source(), named(key) + kind_of(*node) + expected);
    for (const toml::node& element : *node->as_array()) {
      if (!element.is_table()) fail(element.source(), named(key) + kind_of(element) + expected);
      tables.push_back(element.as_table());
      if (tables.size() > most) {
        fail(element.source(), "Found more than " + std::to_string(most) + " sections [[" + std::string(key) +
                                   "]]; expected at most " + std::to_string(most) + ".");
      }
    }
    return tables;
  }

  Unit unit_of_reading(std::size_t joint) const {
    return robot_.geometry.joint[joint].kind == JointKind::prismatic ? length_ : angle_;
  }

  Pose<double> pose(const toml::table& table, const std::string& where) const;
  TargetPoint target(const toml::table& table, const std::string& where) const;
  Link link(const toml::table& table, const std::string& where, double length_bound) const;
  void read_joint(const toml::table& table, std::size_t index);
  void read_joint_name(const toml::table& table, const std::string& where, std::size_t index);
  void read_links();
  void read_couplings();
  void read_targets();
  void read_priors();
  void read_gravity();
  void read_payload();
  void read_joint_functions();
  void read_sags();
  void read_transmission();
  void convert_standard();
  void make_expressible();

  std::string path_;
  ReadAs as_;
  toml::table root_;
  Robot robot_;
  Unit length_ = millimetre;
  Unit angle_ = degree;
  bool standard_ = false;
};

}  // namespace mdhcal::offline
