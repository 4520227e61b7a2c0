// SPDX-License-Identifier: MIT
#include "offline/output/blob_describe.hpp"
#include "offline/robot/units.hpp"

#include <array>
#include <nlohmann/json.hpp>

#include "mdhcal/self_test.hpp"
#include "offline/robot/arm_with_terms.hpp"

namespace mdhcal::offline {

namespace {

using Json = nlohmann::ordered_json;


const char* kind_name(JointKind kind) { return kind == JointKind::revolute ? "revolute" : "prismatic"; }

const char* family_name(ArmFamily family) {
  switch (family) {
    case ArmFamily::spherical_wrist: return "spherical wrist";
    case ArmFamily::parallel_axes: return "three parallel axes";
    case ArmFamily::general: break;
  }
  return "general";
}

std::string hexadecimal(const std::uint8_t* bytes, std::size_t size) {
  std::string text;
  for (std::size_t i = 0; i < size; ++i) {
    text += "0123456789abcdef"[bytes[i] >> 4];
    text += "0123456789abcdef"[bytes[i] & 15];
  }
  return text;
}

Json link_json(const Link& link) {
  return {{"alpha_deg", link.alpha_rad * deg_per_rad},
          {"a_mm", link.a_m * mm_per_m},
          {"theta_deg", link.theta_rad * deg_per_rad},
          {"d_mm", link.d_m * mm_per_m},
          {"beta_deg", link.beta_rad * deg_per_rad}};
}

Link minus(const Link& a, const Link& b) {
  return {a.alpha_rad - b.alpha_rad, a.a_m - b.a_m, a.theta_rad - b.theta_rad, a.d_m - b.d_m, a.beta_rad - b.beta_rad};
}

Json point_json(const double (&p)[3]) { return {p[0] * mm_per_m, p[1] * mm_per_m, p[2] * mm_per_m}; }

Json pose_json(const Pose<double>& pose) {
  return {{"xyz_mm", point_json(pose.position_m)}, {"quaternion_wxyz", pose.quaternion}};
}

Json optional_text(const char* text) { return text[0] == '\0' ? Json() : Json(text); }

Json joints_json(const BlobContent& model) {
  Json links = Json::array();
  for (std::int32_t i = 0; i < model.geometry.joint_count; ++i) {
    const Joint& joint = model.geometry.joint[i];
    const bool turns = joint.kind == JointKind::revolute;
    const double unit = turns ? deg_per_rad : mm_per_m;
    Json coupling = Json::array();
    for (std::int32_t j = 0; j < model.geometry.joint_count; ++j) coupling.push_back(joint.coupling[j]);
    links.push_back({{"joint", kind_name(joint.kind)},
                     {"sign", joint.sign},
                     {turns ? "min_deg" : "min_mm", joint.has_min == 1 ? Json(joint.min * unit) : Json()},
                     {turns ? "max_deg" : "max_mm", joint.has_max == 1 ? Json(joint.max * unit) : Json()},
                     {"coupling", coupling},
                     {turns ? "max_velocity_deg_s" : "max_velocity_mm_s",
                      model.max_velocity[i] > 0 ? Json(model.max_velocity[i] * unit) : Json()},
                     {"nominal", link_json(model.nominal[i])},
                     {"corrected", link_json(model.geometry.link[i])},
                     {"deviation", link_json(minus(model.geometry.link[i], model.nominal[i]))}});
  }
  return links;
}

// Readings in radians or metres, coefficients in microradians.
Json transmission_json(const BlobContent& model) {
  const Gravity& gravity = model.transmission.gravity;
  const auto joints = static_cast<std::size_t>(model.geometry.joint_count);
  Json out{{"functions", Json::array()}, {"gravity", nullptr}};
  for (std::size_t i = 0; i < joints; ++i) {
    const JointFunction& f = model.transmission.function[i];
    const bool stated = f.seen_min_rad < f.seen_max_rad;
    const bool turns = model.geometry.joint[i].kind == JointKind::revolute;
    const double unit = turns ? deg_per_rad : mm_per_m;
    Json orders = Json::array();
    for (std::size_t k = 0; k < static_cast<std::size_t>(f.order_count); ++k) {
      orders.push_back({{"order", k + 1},
                        {"cosine_urad", static_cast<double>(f.cosine_rad[k]) * 1e6},
                        {"sine_urad", static_cast<double>(f.sine_rad[k]) * 1e6}});
    }
    out["functions"].push_back({{turns ? "seen_min_deg" : "seen_min_mm", stated ? Json(f.seen_min_rad * unit) : Json()},
                                {turns ? "seen_max_deg" : "seen_max_mm", stated ? Json(f.seen_max_rad * unit) : Json()},
                                {"orders", orders}});
  }
  bool sags = false;
  Json compliance = Json::array();
  for (std::size_t i = 0; i < joints; ++i) {
    Json row = Json::array();
    for (std::size_t j = 0; j < joints; ++j) {
      row.push_back(gravity.compliance[i][j] * 1e6);
      sags = sags || gravity.compliance[i][j] < 0 || gravity.compliance[i][j] > 0;
    }
    compliance.push_back(row);
  }
  Json payload = Json::array();
  bool carries = false;
  for (std::size_t i = 0; i < joints; ++i) {
    payload.push_back(gravity.payload_compliance[i] * 1e6);
    carries = carries || gravity.payload_compliance[i] < 0 || gravity.payload_compliance[i] > 0;
  }
  if (sags || carries) {
    out["gravity"] = {{"direction", gravity.direction},
                      {"compliance_urad_per_m", compliance},
                      {"payload_kg", gravity.payload_kg},
                      {"payload_com_mm", point_json(gravity.payload_com_m)},
                      {"payload_compliance_urad_per_kg_m", carries ? payload : Json()}};
  }
  return out;
}

Json provenance_json(const BlobProvenance& from) {
  Json out{{"tool_version", from.tool_version},
           {"date", optional_text(from.date)},
           {"method", optional_text(from.method)},
           {"lambda", from.has_lambda == 1 ? Json(from.lambda) : Json()},
           {"lambda_rule", optional_text(from.lambda_rule)}};
  const std::string accepted = accepted_reason(from);
  if (!accepted.empty()) out["lambda_rule"] = nullptr;
  out["accepted"] = accepted.empty() ? Json() : Json(accepted);
  out["measurements_sha256"] = nullptr;
  out["pose_count"] = nullptr;
  out["held_out"] = nullptr;
  out["region"] = nullptr;
  if (from.has_region == 1) {
    out["region"] = {{"min_mm", point_json(from.region_min_m)},
                     {"max_mm", point_json(from.region_max_m)},
                     {"lean_mm", {from.lean_min_m * mm_per_m, from.lean_max_m * mm_per_m}}};
  }
  if (from.has_measurements == 1) {
    out["measurements_sha256"] = hexadecimal(from.measurements_sha256, sizeof from.measurements_sha256);
    out["pose_count"] = from.pose_count;
  }
  if (from.has_held_out == 1) {
    out["held_out"] = {{"pose_count", from.held_out_count},
                       {"before", {{"mean_mm", from.mean_before_m * mm_per_m}, {"max_mm", from.max_before_m * mm_per_m}}},
                       {"after", {{"mean_mm", from.mean_after_m * mm_per_m}, {"max_mm", from.max_after_m * mm_per_m}}}};
  }
  return out;
}

template <class Real>
Json vectors_json(const SelfTestVector<Real>* vectors, std::int32_t count, std::int32_t joints) {
  Json out = Json::array();
  const auto readings = [&](const Real* q) {
    Json list = Json::array();
    for (std::int32_t i = 0; i < joints; ++i) list.push_back(q[i]);
    return list;
  };
  for (std::int32_t v = 0; v < count; ++v) {
    const SelfTestVector<Real>& vector = vectors[v];
    out.push_back({{"q", readings(vector.q)},
                   {"quaternion_wxyz", vector.base_T_flange.quaternion},
                   {"position_m", vector.base_T_flange.position_m},
                   {"inverse_q", readings(vector.inverse_q)},
                   {"inverse_status", vector.inverse_status}});
  }
  return out;
}

std::uint32_t number(const Blob& bytes, std::size_t offset, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t k = size; k > 0; --k) value = value << 8U | bytes.at(offset + k - 1);
  return value;
}

template <class Real>
const char* outcome(const BlobContent& model) {
  ArmWithTerms<Real> prepared;
  if (prepare(model.geometry, model.transmission, prepared) != Status::ok) return "not run";
  switch (self_test(model, prepared.arm)) {
    case Status::ok: return "same bits";
    case Status::self_test_tolerance: return "within tolerance";
    default: return "failed";
  }
}

}  // namespace

Json describe_json(const BlobFile& file) {
  const BlobContent& model = file.model;
  Json targets = Json::array();
  for (std::int32_t i = 0; i < model.target_count; ++i) {
    targets.push_back({{"name", model.target[i].name}, {"xyz_mm", point_json(model.target[i].flange_p_m)}});
  }
  char crc[16];
  std::snprintf(crc, sizeof crc, "0x%08X", static_cast<unsigned>(number(file.bytes, blob_layout::crc, 4)));
  const Authentication& authentication = model.authentication;
  const bool is_signed = authentication.algorithm != blob_layout::algorithm_none;
  return {{"format", std::to_string(number(file.bytes, blob_layout::major, 2)) + '.' +
                         std::to_string(number(file.bytes, blob_layout::minor, 2))},
          {"crc32", crc},
          {"name", model.name},
          {"serial", optional_text(model.serial)},
          {"links", joints_json(model)},
          {"transmission", transmission_json(model)},
          {"last_T_flange", pose_json(model.geometry.last_T_flange)},
          {"tracker_T_base", model.has_base == 1 ? pose_json(model.tracker_T_base) : Json()},
          {"targets", targets},
          {"posture_family", family_name(model.family)},
          {"tolerances",
           {{"position_mm", model.tolerances.position_m * mm_per_m},
            {"rotation_deg", model.tolerances.rotation_rad * deg_per_rad},
            {"float_position_mm", static_cast<double>(model.tolerances.float_position_m) * mm_per_m},
            {"float_rotation_deg", static_cast<double>(model.tolerances.float_rotation_rad) * deg_per_rad}}},
          {"provenance", provenance_json(model.provenance)},
          {"security_counter", model.security_counter},
          {"signature",
           is_signed ? Json{{"algorithm", "Ed25519"},
                            {"key_id", hexadecimal(authentication.key_id, sizeof authentication.key_id)},
                            {"signature", hexadecimal(authentication.signature, sizeof authentication.signature)}}
                     : Json()},
          {"self_test",
           {{"arithmetic_id", model.arithmetic_id},
            {"double_here", outcome<double>(model)},
            {"float_here", outcome<float>(model)},
            {"double", vectors_json(model.double_vector, model.double_vector_count, model.geometry.joint_count)},
            {"float", vectors_json(model.float_vector, model.float_vector_count, model.geometry.joint_count)}}}};
}

}  // namespace mdhcal::offline
