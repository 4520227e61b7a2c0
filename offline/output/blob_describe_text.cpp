// SPDX-License-Identifier: MIT
#include <cmath>
#include <nlohmann/json.hpp>

#include "offline/base/text_table.hpp"
#include "offline/output/blob_describe.hpp"

namespace mdhcal::offline {

namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<std::vector<std::string>>;

constexpr int length_decimals = 6;  // nanometres
constexpr int angle_decimals = 7;

std::string word(const Json& value, const char* otherwise) {
  return value.is_null() ? otherwise : value.get<std::string>();
}

std::string numbers(const Json& list, int decimals) {
  std::string text;
  for (const Json& value : list) text += (text.empty() ? "" : " ") + fixed(value.get<double>(), decimals);
  return text;
}

std::string pose_text(const Json& pose) {
  return "xyz " + numbers(pose["xyz_mm"], length_decimals) + " mm, quaternion wxyz " + numbers(pose["quaternion_wxyz"], 9);
}

std::string short_number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string joints_text(const Json& blob) {
  Rows rows{{"link", "joint", "sign", "min", "max", "coupling"}};
  std::size_t number = 1;
  for (const Json& link : blob["links"]) {
    const bool turns = link["joint"] == "revolute";
    const auto limit = [&](const char* degrees, const char* millimetres) -> std::string {
      const Json& value = link[turns ? degrees : millimetres];
      return value.is_null() ? "-" : fixed(value.get<double>(), 4) + (turns ? " deg" : " mm");
    };
    std::string coupling;
    std::size_t by = 1;
    for (const Json& ratio : link["coupling"]) {
      if (ratio.get<double>() < 0.0 || ratio.get<double>() > 0.0) {
        coupling += (coupling.empty() ? "" : ", ") + short_number(ratio.get<double>()) + " of " + std::to_string(by);
      }
      ++by;
    }
    rows.push_back({std::to_string(number++), link["joint"].get<std::string>(), link["sign"] == 1 ? "+" : "-",
                    limit("min_deg", "min_mm"), limit("max_deg", "max_mm"), coupling.empty() ? "-" : coupling});
  }
  return text_table(rows);
}

std::string links_text(const Json& blob) {
  std::string text;
  for (const char* which : {"nominal", "corrected", "deviation"}) {
    Rows rows{{which, "alpha_deg", "a_mm", "theta_deg", "d_mm", "beta_deg"}};
    std::size_t number = 1;
    for (const Json& link : blob["links"]) {
      const Json& values = link[which];
      rows.push_back({"link " + std::to_string(number++), fixed(values["alpha_deg"].get<double>(), angle_decimals),
                      fixed(values["a_mm"].get<double>(), length_decimals),
                      fixed(values["theta_deg"].get<double>(), angle_decimals),
                      fixed(values["d_mm"].get<double>(), length_decimals),
                      fixed(values["beta_deg"].get<double>(), angle_decimals)});
    }
    text += '\n' + text_table(rows);
  }
  return text;
}

// A row a joint: where readings were seen, the strongest order, what all orders come to; then gravity.
std::string transmission_text(const Json& blob) {
  Rows rows{{"link", "seen", "orders", "strongest", "amplitude"}};
  std::size_t number = 1;
  bool any = false;
  for (const Json& f : blob["transmission"]["functions"]) {
    const bool turns = f.contains("seen_min_deg");
    const Json& low = f[turns ? "seen_min_deg" : "seen_min_mm"];
    const Json& high = f[turns ? "seen_max_deg" : "seen_max_mm"];
    double most = 0;
    std::size_t strongest = 0;
    for (const Json& order : f["orders"]) {
      const double size = std::hypot(order["cosine_urad"].get<double>(), order["sine_urad"].get<double>());
      if (size > most) {
        most = size;
        strongest = order["order"].get<std::size_t>();
      }
    }
    any = any || !low.is_null();
    rows.push_back({std::to_string(number++),
                    low.is_null() ? "-" : fixed(low.get<double>(), 1) + " to " + fixed(high.get<double>(), 1) + (turns ? " deg" : " mm"),
                    f["orders"].empty() ? "-" : "1 to " + std::to_string(f["orders"].size()),
                    strongest == 0 ? "-" : std::to_string(strongest), strongest == 0 ? "-" : fixed(most, 1) + " urad"});
  }
  std::string text = any ? "\njoint functions, and the readings that the calibration saw\n" + text_table(rows) : std::string();
  const Json& gravity = blob["transmission"]["gravity"];
  if (gravity.is_null()) return text;
  Rows sag{{"sag", "of the weight at the end of each link, urad/m"}};
  number = 1;
  for (const Json& row : gravity["compliance_urad_per_m"]) sag.push_back({"link " + std::to_string(number++), numbers(row, 2)});
  text += "\ngravity falls along " + numbers(gravity["direction"], 4) + "; the calibration holds for a payload of " +
          fixed(gravity["payload_kg"].get<double>(), 3) + " kg" +
          (gravity["payload_compliance_urad_per_kg_m"].is_null() ? ", and tells nothing of another\n" : "\n") + text_table(sag);
  if (!gravity["payload_compliance_urad_per_kg_m"].is_null()) {
    text += "of another payload, urad/(kg m): " + numbers(gravity["payload_compliance_urad_per_kg_m"], 2) + '\n';
  }
  return text;
}

std::string origin_text(const Json& blob) {
  const Json& from = blob["provenance"];
  std::string text = "written by      " + from["tool_version"].get<std::string>() + ", " + word(from["date"], "no date") + '\n';
  if (!from["method"].is_null()) text += "method          " + from["method"].get<std::string>() + '\n';
  if (!from["lambda"].is_null()) {
    text += "lambda          " + short_number(from["lambda"].get<double>()) + ", rule " + word(from["lambda_rule"], "not stated") + '\n';
  }
  if (!from["accepted"].is_null()) {
    text += "accepted        against the reasons of result.json: " + from["accepted"].get<std::string>() + '\n';
  }
  if (from["pose_count"].is_null()) {
    text += "measurements    none: not identified by this program\n";
  } else {
    text += "measurements    " + std::to_string(from["pose_count"].get<unsigned>()) + " poses, SHA-256 " +
            from["measurements_sha256"].get<std::string>() + '\n';
  }
  if (!from["region"].is_null()) {
    const Json& region = from["region"];
    text += "measured        flange from " + numbers(region["min_mm"], 0) + " to " + numbers(region["max_mm"], 0) + " mm, leaning out " +
            numbers(region["lean_mm"], 0) + " mm\n";
  }
  if (from["held_out"].is_null()) return text + "judged on       nothing\n";
  const Json& held_out = from["held_out"];
  const auto change = [&](const char* key) {
    return fixed(held_out["before"][key].get<double>(), 4) + " -> " + fixed(held_out["after"][key].get<double>(), 4) + " mm";
  };
  return text + "judged on       " + std::to_string(held_out["pose_count"].get<unsigned>()) + " poses, mean " +
         change("mean_mm") + ", max " + change("max_mm") + '\n';
}

std::string trust_text(const Json& blob) {
  const Json& signature = blob["signature"];
  std::string text = "signature       ";
  text += signature.is_null() ? std::string("none") : "Ed25519, key id " + signature["key_id"].get<std::string>();
  text += "\ncounter         " + std::to_string(blob["security_counter"].get<unsigned>()) + '\n';
  const Json& self_test = blob["self_test"];
  text += "self-test       arithmetic id " + std::to_string(self_test["arithmetic_id"].get<unsigned>()) + ", " +
          std::to_string(self_test["double"].size()) + " vectors in double: " + self_test["double_here"].get<std::string>() +
          " here, " + std::to_string(self_test["float"].size()) + " in float: " + self_test["float_here"].get<std::string>() +
          " here\n";
  return text;
}

std::string vectors_text(const Json& blob) {
  std::string text;
  for (const char* precision : {"double", "float"}) {
    const int decimals = precision[0] == 'd' ? 12 : 6;
    std::size_t number = 1;
    for (const Json& vector : blob["self_test"][precision]) {
      text += "self-test vector " + std::to_string(number++) + " in " + precision + ", status of the inverse " +
              std::to_string(vector["inverse_status"].get<int>()) + '\n' + text_table({
                  {"  readings (rad, m)", numbers(vector["q"], decimals)},
                  {"  inverse (rad, m)", numbers(vector["inverse_q"], decimals)},
                  {"  position (m)", numbers(vector["position_m"], decimals)},
                  {"  quaternion wxyz", numbers(vector["quaternion_wxyz"], decimals)},
              });
    }
  }
  return text;
}

}  // namespace

std::string describe_text(const Json& blob) {
  const Json& tolerances = blob["tolerances"];
  std::string text = "robot           " + blob["name"].get<std::string>() + ", serial " + word(blob["serial"], "not stated") +
                     "\nformat          " + blob["format"].get<std::string>() + ", CRC-32 " + blob["crc32"].get<std::string>() + '\n' +
                     origin_text(blob) + trust_text(blob) + "posture family  " +
                     blob["posture_family"].get<std::string>() + "\ntolerances      " +
                     short_number(tolerances["position_mm"].get<double>()) + " mm and " +
                     short_number(tolerances["rotation_deg"].get<double>()) + " deg; in float " +
                     short_number(tolerances["float_position_mm"].get<double>()) + " mm and " +
                     short_number(tolerances["float_rotation_deg"].get<double>()) + " deg\n" + "last_T_flange   " +
                     pose_text(blob["last_T_flange"]) + "\ntracker_T_base  " +
                     (blob["tracker_T_base"].is_null() ? "not stated" : pose_text(blob["tracker_T_base"])) + '\n';
  for (const Json& target : blob["targets"]) {
    text += "target          \"" + target["name"].get<std::string>() + "\": " + numbers(target["xyz_mm"], length_decimals) + " mm\n";
  }
  return text + '\n' + joints_text(blob) + links_text(blob) + transmission_text(blob) + '\n' + vectors_text(blob);
}

}  // namespace mdhcal::offline
