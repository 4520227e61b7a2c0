// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "mdhcal/arm.hpp"
#include "mdhcal/kinematics.hpp"
#include "offline/base/error.hpp"
#include "offline/base/text_table.hpp"
#include "offline/output/blob_describe.hpp"
#include "offline/robot/arm_with_terms.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

using Json = nlohmann::ordered_json;

constexpr int sample_count = 1000;

bool same(double a, double b) { return !(a < b) && !(a > b); }

class Changes {
 public:
  void number(const std::string& name, double a, double b, double unit) {
    if (!same(a, b)) list_.push_back({{"name", name}, {"a", a * unit}, {"b", b * unit}, {"change", (b - a) * unit}});
  }
  void value(const std::string& name, const Json& a, const Json& b) {
    if (a != b) list_.push_back({{"name", name}, {"a", a}, {"b", b}});
  }
  Json list() const { return list_; }

 private:
  Json list_ = Json::array();
};

void link(Changes& changes, const std::string& prefix, const std::string& number, const Link& a, const Link& b) {
  changes.number(prefix + "alpha" + number + "_deg", a.alpha_rad, b.alpha_rad, deg_per_rad);
  changes.number(prefix + "a" + number + "_mm", a.a_m, b.a_m, mm_per_m);
  changes.number(prefix + "theta" + number + "_deg", a.theta_rad, b.theta_rad, deg_per_rad);
  changes.number(prefix + "d" + number + "_mm", a.d_m, b.d_m, mm_per_m);
  changes.number(prefix + "beta" + number + "_deg", a.beta_rad, b.beta_rad, deg_per_rad);
}

void pose(Changes& changes, const std::string& name, const Pose<double>& a, const Pose<double>& b) {
  const char* axes[4] = {"x", "y", "z", ""};
  for (std::size_t k = 0; k < 3; ++k) changes.number(name + '_' + axes[k] + "_mm", a.position_m[k], b.position_m[k], mm_per_m);
  const char* parts[4] = {"_qw", "_qx", "_qy", "_qz"};
  for (std::size_t k = 0; k < 4; ++k) changes.number(name + parts[k], a.quaternion[k], b.quaternion[k], 1.0);
}

void joint(Changes& changes, const std::string& number, const Joint& a, const Joint& b) {
  const bool turns = a.kind == JointKind::revolute;
  const double unit = turns ? deg_per_rad : mm_per_m;
  const char* suffix = turns ? "_deg" : "_mm";
  changes.value("sign" + number, a.sign, b.sign);
  changes.value("min" + number + suffix, a.has_min == 1 ? Json(a.min * unit) : Json(), b.has_min == 1 ? Json(b.min * unit) : Json());
  changes.value("max" + number + suffix, a.has_max == 1 ? Json(a.max * unit) : Json(), b.has_max == 1 ? Json(b.max * unit) : Json());
  for (std::size_t j = 0; j < max_joints; ++j) {
    changes.number("coupling" + number + '_' + std::to_string(j + 1), a.coupling[j], b.coupling[j], 1.0);
  }
}

// Coefficients in microradians, compliances in microradians a metre.
void transmission(Changes& changes, const BlobContent& a, const BlobContent& b) {
  constexpr double micro = 1e6;
  for (std::size_t i = 0; i < max_joints; ++i) {
    const JointFunction& from = a.transmission.function[i];
    const JointFunction& to = b.transmission.function[i];
    const std::string number = std::to_string(i + 1);
    changes.number("seen_min" + number, from.seen_min_rad, to.seen_min_rad, 1.0);
    changes.number("seen_max" + number, from.seen_max_rad, to.seen_max_rad, 1.0);
    for (std::size_t k = 0; k < max_orders; ++k) {
      const std::string order = number + "_order" + std::to_string(k + 1) + "_urad";
      changes.number("cosine" + order, static_cast<double>(from.cosine_rad[k]), static_cast<double>(to.cosine_rad[k]), micro);
      changes.number("sine" + order, static_cast<double>(from.sine_rad[k]), static_cast<double>(to.sine_rad[k]), micro);
    }
    for (std::size_t j = i; j < max_joints; ++j) {
      changes.number("compliance" + number + '_' + std::to_string(j + 1) + "_urad_m", a.transmission.gravity.compliance[i][j],
                     b.transmission.gravity.compliance[i][j], micro);
    }
    changes.number("payload_compliance" + number + "_urad_kg_m", a.transmission.gravity.payload_compliance[i],
                   b.transmission.gravity.payload_compliance[i], micro);
    changes.number("max_velocity" + number, a.max_velocity[i], b.max_velocity[i], 1.0);
  }
  const Gravity& from = a.transmission.gravity;
  const Gravity& to = b.transmission.gravity;
  const char* axes[3] = {"_x", "_y", "_z"};
  for (std::size_t k = 0; k < 3; ++k) {
    changes.number(std::string("gravity") + axes[k], from.direction[k], to.direction[k], 1.0);
    changes.number(std::string("payload_com") + axes[k] + "_mm", from.payload_com_m[k], to.payload_com_m[k], mm_per_m);
  }
  changes.number("payload_kg", from.payload_kg, to.payload_kg, 1.0);
}

void targets(Changes& changes, const BlobContent& a, const BlobContent& b) {
  const auto find = [](const BlobContent& model, const std::string& name) -> const Target* {
    const Target* end = model.target + model.target_count;
    const Target* found = std::find_if(model.target, end, [&](const Target& t) { return name == t.name; });
    return found == end ? nullptr : found;
  };
  for (std::int32_t i = 0; i < a.target_count; ++i) {
    const std::string name = std::string("target \"") + a.target[i].name + '"';
    const Target* other = find(b, a.target[i].name);
    if (other == nullptr) {
      changes.value(name, "present", "absent");
      continue;
    }
    const char* axes[3] = {"_x_mm", "_y_mm", "_z_mm"};
    for (std::size_t k = 0; k < 3; ++k) {
      changes.number(name + axes[k], a.target[i].flange_p_m[k], other->flange_p_m[k], mm_per_m);
    }
  }
  for (std::int32_t i = 0; i < b.target_count; ++i) {
    if (find(a, b.target[i].name) == nullptr) {
      changes.value(std::string("target \"") + b.target[i].name + '"', "absent", "present");
    }
  }
}

// How far the flange moves from a to b at joint vectors within a's limits, half a turn and 0.5 m where it states none.
Json movement(const BlobContent& a, const BlobContent& b) {
  ArmWithTerms<double> with_a;
  ArmWithTerms<double> with_b;
  if (prepare(a.geometry, a.transmission, with_a) != Status::ok || prepare(b.geometry, b.transmission, with_b) != Status::ok) {
    return nullptr;
  }
  const Arm<double>& arm_a = with_a.arm;
  const Arm<double>& arm_b = with_b.arm;
  std::mt19937_64 random(1);
  std::vector<double> position_mm;
  std::vector<double> rotation_deg;
  for (int sample = 0; sample < sample_count; ++sample) {
    std::array<double, max_joints> q{};
    for (std::int32_t i = 0; i < a.geometry.joint_count; ++i) {
      const Joint& limits = a.geometry.joint[i];
      const double range = limits.kind == JointKind::revolute ? std::numbers::pi : 0.5;
      const double low = limits.has_min == 1 ? limits.min : (limits.has_max == 1 ? std::min(-range, limits.max) : -range);
      const double high = limits.has_max == 1 ? limits.max : std::max(range, low);
      q.at(static_cast<std::size_t>(i)) = low + static_cast<double>(random() >> 11U) * 0x1p-53 * (high - low);
    }
    Pose<double> pose_a{};
    Pose<double> pose_b{};
    if (forward(arm_a, q.data(), pose_a) != Status::ok || forward(arm_b, q.data(), pose_b) != Status::ok) return nullptr;
    position_mm.push_back(mm_per_m * std::hypot(pose_b.position_m[0] - pose_a.position_m[0],
                                          pose_b.position_m[1] - pose_a.position_m[1],
                                          pose_b.position_m[2] - pose_a.position_m[2]));
    // |qa - qb| and |qa + qb| are the sine and cosine of a quarter of the angle, twice.
    double difference = 0;
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
      difference += std::pow(pose_a.quaternion[k] - pose_b.quaternion[k], 2);
      sum += std::pow(pose_a.quaternion[k] + pose_b.quaternion[k], 2);
    }
    rotation_deg.push_back(deg_per_rad * 4 * std::atan2(std::sqrt(std::min(difference, sum)), std::sqrt(std::max(difference, sum))));
  }
  const auto mean = [](const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
  };
  return {{"samples", sample_count},
          {"mean_mm", mean(position_mm)},
          {"max_mm", *std::max_element(position_mm.begin(), position_mm.end())},
          {"mean_deg", mean(rotation_deg)},
          {"max_deg", *std::max_element(rotation_deg.begin(), rotation_deg.end())}};
}

}  // namespace

Json difference_json(const BlobContent& a, const BlobContent& b) {
  bool comparable = a.geometry.joint_count == b.geometry.joint_count;
  for (std::int32_t i = 0; comparable && i < a.geometry.joint_count; ++i) {
    comparable = a.geometry.joint[i].kind == b.geometry.joint[i].kind;
  }
  if (!comparable) {
    throw InputError("The two blobs are of arms with other joints, expected two calibrations of one robot.");
  }
  Changes changes;
  changes.value("name", a.name, b.name);
  changes.value("serial", a.serial, b.serial);
  changes.value("tool_version", a.provenance.tool_version, b.provenance.tool_version);
  changes.value("date", a.provenance.date, b.provenance.date);
  changes.value("method", a.provenance.method, b.provenance.method);
  changes.value("lambda_rule", a.provenance.lambda_rule, b.provenance.lambda_rule);
  changes.number("lambda", a.provenance.lambda, b.provenance.lambda, 1.0);
  changes.value("pose_count", a.provenance.pose_count, b.provenance.pose_count);
  changes.value("security_counter", a.security_counter, b.security_counter);
  changes.value("signed", a.authentication.algorithm != 0, b.authentication.algorithm != 0);
  changes.number("held_out_mean_after_mm", a.provenance.mean_after_m, b.provenance.mean_after_m, mm_per_m);
  changes.number("held_out_max_after_mm", a.provenance.max_after_m, b.provenance.max_after_m, mm_per_m);
  for (std::int32_t i = 0; i < a.geometry.joint_count; ++i) {
    const std::string number = std::to_string(i + 1);
    joint(changes, number, a.geometry.joint[i], b.geometry.joint[i]);
    link(changes, "nominal ", number, a.nominal[i], b.nominal[i]);
    link(changes, "", number, a.geometry.link[i], b.geometry.link[i]);
  }
  pose(changes, "flange", a.geometry.last_T_flange, b.geometry.last_T_flange);
  changes.value("base", a.has_base == 1 ? "stated" : "not stated", b.has_base == 1 ? "stated" : "not stated");
  if (a.has_base == 1 && b.has_base == 1) pose(changes, "base", a.tracker_T_base, b.tracker_T_base);
  transmission(changes, a, b);
  targets(changes, a, b);
  return {{"changes", changes.list()}, {"flange_movement", movement(a, b)}};
}

std::string difference_text(const Json& difference) {
  if (difference["changes"].empty()) return "No difference.\n";
  const auto cell = [](const Json& value) -> std::string {
    if (value.is_number_float()) return fixed(value.get<double>(), 7);
    if (value.is_string()) return value.get<std::string>();
    return value.is_null() ? "-" : value.dump();
  };
  std::vector<std::vector<std::string>> rows{{"", "A", "B", "B - A"}};
  for (const Json& change : difference["changes"]) {
    rows.push_back({change["name"].get<std::string>(), cell(change["a"]), cell(change["b"]),
                    change.contains("change") ? cell(change["change"]) : ""});
  }
  std::string text = text_table(rows);
  const Json& movement = difference["flange_movement"];
  if (movement.is_null()) return text;
  const auto figure = [&](const char* key, int decimals) { return fixed(movement[key].get<double>(), decimals); };
  return text + "\nThe flange moves by " + figure("mean_mm", 4) + " mm and " + figure("mean_deg", 5) + " deg in the mean, " +
         figure("max_mm", 4) + " mm and " + figure("max_deg", 5) + " deg at most, over " +
         std::to_string(movement["samples"].get<int>()) + " joint vectors within A's limits.\n";
}

}  // namespace mdhcal::offline
