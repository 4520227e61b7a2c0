// SPDX-License-Identifier: MIT
#include "offline/output/result_json.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "offline/robot/units.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

using Json = nlohmann::ordered_json;


Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json figures(const Statistics& s) {
  if (s.count == 0) return nullptr;
  return {{"count", s.count},           {"mean_mm", finite(s.mean)}, {"median_mm", finite(s.median)},
          {"max_mm", finite(s.max)},    {"sd_mm", finite(s.sd)},     {"rms_mm", finite(s.rms)},
          {"p95_mm", finite(s.p95)}};
}

Json split(const SplitFigures& f) {
  return {{"before", figures(f.before)},
          {"after", figures(f.after)},
          {"before_good", figures(f.before_good)},
          {"after_good", figures(f.after_good)},
          {"outliers", f.outliers},
          {"poses", f.poses},
          {"after_mean_95_mm", {finite(f.mean.low), finite(f.mean.high)}},
          {"predicted_mean_mm", f.predicted_mean_mm > 0.0 ? finite(f.predicted_mean_mm) : Json(nullptr)}};
}

// Standard deviations of base and targets, from the same covariance as the parameters'.
Json frame_uncertainty(const Calibration& c) {
  const auto sd = [&](std::size_t first, double factor) {
    Json list = Json::array();
    for (std::size_t k = first; k < first + 3; ++k) {
      list.push_back(k < c.covariance.size ? finite(factor * std::sqrt(std::max(0.0, c.covariance.at(k, k)))) : Json(nullptr));
    }
    return list;
  };
  Json json = {{"base_rotation_sd_deg", nullptr}, {"base_sd_mm", nullptr}, {"target_sd_mm", Json::array()}};
  if (c.layout.base) {
    json["base_rotation_sd_deg"] = sd(0, 1e-3 * deg_per_rad);
    json["base_sd_mm"] = sd(3, 1.0);
  }
  for (std::size_t t = 0; c.layout.target && t < c.layout.targets; ++t) json["target_sd_mm"].push_back(sd(c.layout.base_columns() + 3 * t, 1.0));
  json["workspace_median_sd_mm"] = finite(c.accuracy.median_mm);
  json["workspace_median_sd_of_base_and_targets_mm"] = finite(c.accuracy.frames_median_mm);
  return json;
}

// The rotations of the rows that are full poses, beside the positions' figures.
void add_rotation(Json& split, const RotationFigures& rotation) {
  if (rotation.after.count == 0) return;
  const auto add = [](Json& json, const Statistics& s) {
    json["rotation_count"] = s.count;
    json["rotation_mean_deg"] = finite(s.mean);
    json["rotation_max_deg"] = finite(s.max);
  };
  add(split["before"], rotation.before);
  add(split["after"], rotation.after);
}

Json vector_mm(const Vector3& v) { return {finite(v[0]), finite(v[1]), finite(v[2])}; }

Json spectrum(const Spectrum& s) {
  Json json;
  json["singular_values"] = Json::array();
  for (double value : s.singular_values) json["singular_values"].push_back(finite(value));
  json["rank"] = s.rank;
  json["condition"] = s.rank > 0 ? finite(s.condition) : Json(nullptr);
  for (std::size_t k = 0; k < s.observability.size(); ++k) {
    json["O" + std::to_string(k + 1)] = s.rank > 0 ? finite(s.observability[k]) : Json(nullptr);
  }
  return json;
}

Json parameter(const EstimatedParameter& p) {
  const bool angle = is_angle(p.id);
  const std::string unit = angle ? "_deg" : "_mm";
  const double factor = angle ? deg_per_rad : 1e3;
  Json json;
  json["name"] = name(p.id);
  json["unit"] = angle ? "deg" : "mm";
  json["nominal"] = finite(p.nominal * factor);
  json["deviation"] = finite(p.deviation * factor);
  json["standard_deviation"] = finite(p.standard_deviation * factor);
  json["interval_95"] = {finite(p.low * factor), finite(p.high * factor)};
  json["nominal" + unit] = finite(p.nominal * factor);
  json["deviation" + unit] = finite(p.deviation * factor);
  json["standard_deviation" + unit] = finite(p.standard_deviation * factor);
  json["prior" + unit] = finite(p.prior * factor);
  json["resolution"] = finite(p.resolution);
  json["identifiable"] = p.identifiable;
  return json;
}

Json lambda(const LambdaReport& report) {
  Json json;
  json["rule"] = report.rule;
  json["value"] = finite(report.lambda);
  json["note"] = report.note.empty() ? Json(nullptr) : Json(report.note);
  json["corner"] = report.corner ? finite(*report.corner) : Json(nullptr);
  const auto curve = [](const std::vector<LambdaReport::Point>& points, const char* criterion) {
    Json list = Json::array();
    for (const LambdaReport::Point& p : points) {
      list.push_back({{"lambda", finite(p.lambda)},
                      {"residual_norm", finite(p.residual_norm)},
                      {"solution_norm", finite(p.solution_norm)},
                      {criterion, finite(p.criterion)}});
    }
    return list;
  };
  json["curve"] = curve(report.curve, "criterion");
  json["l_curve"] = curve(report.l_curve, "curvature");
  return json;
}

Json bootstrap_json(const Calibration& c, const Bootstrap& b) {
  Json json = {{"resamples", b.resamples}, {"parameters", Json::array()}};
  for (std::size_t p = 0; p < c.parameters.size(); ++p) {
    const bool angle = is_angle(c.parameters[p].id);
    const double factor = angle ? deg_per_rad : 1e3;
    json["parameters"].push_back({{"name", name(c.parameters[p].id)},
                                  {"unit", angle ? "deg" : "mm"},
                                  {"standard_deviation", finite(b.standard_deviation[p] * factor)},
                                  {"interval_95", {finite(b.low[p] * factor), finite(b.high[p] * factor)}}});
  }
  return json;
}

Json frame(const Frame<double>& f) {
  const double* r = f.rotation;
  Json rows = Json::array();
  for (int i = 0; i < 3; ++i) rows.push_back({finite(r[3 * i]), finite(r[3 * i + 1]), finite(r[3 * i + 2])});
  return {{"xyz_mm",
           {finite(1e3 * f.position_m[0]), finite(1e3 * f.position_m[1]), finite(1e3 * f.position_m[2])}},
          {"rotation_matrix", rows}};
}

Json residual_json(const Residual& r) { return {{"scale_mm", finite(r.scale_mm)}, {"mean_mm", finite(r.mean_mm)}}; }

Json model_json(const ModelReport& m) {
  Json json = {{"asked", m.asked}, {"chosen", m.candidates.empty() ? "geometry alone" : m.candidates[m.chosen].name}};
  json["families"] = Json::array();
  for (const ModelReport::Family& f : m.families) json["families"].push_back({{"name", f.name}, {"prior_sd", finite(f.sd)}, {"unit", f.unit}});
  json["candidates"] = Json::array();
  for (const ModelReport::Candidate& c : m.candidates) {
    json["candidates"].push_back({{"name", c.name}, {"cross_validated_mean_mm", finite(c.error_mm)}});
  }
  json["left_out"] = m.left_out;
  return json;
}

// Joint functions and sag as they are used.
Json transmission_json(const Robot& robot) {
  const Transmission& t = robot.transmission;
  Json json = {{"joint_functions", Json::array()}, {"sag", Json::array()}};
  for (std::int32_t i = 0; i < robot.geometry.joint_count; ++i) {
    const JointFunction& f = t.function[i];
    if (f.order_count > 0) {
      Json cosine = Json::array(), sine = Json::array();
      for (std::int32_t k = 0; k < f.order_count; ++k) {
        cosine.push_back(1e3 * static_cast<double>(f.cosine_rad[k]));
        sine.push_back(1e3 * static_cast<double>(f.sine_rad[k]));
      }
      json["joint_functions"].push_back({{"joint", i + 1},
                                         {"range_deg", {finite(f.seen_min_rad * deg_per_rad), finite(f.seen_max_rad * deg_per_rad)}},
                                         {"cosine_mrad", cosine},
                                         {"sine_mrad", sine}});
    }
    for (std::int32_t j = i; j < robot.geometry.joint_count; ++j) {
      const double k = t.gravity.compliance[i][j];
      if (std::fabs(k) > 0.0) json["sag"].push_back({{"joint", i + 1}, {"link", j + 1}, {"compliance_mrad_per_m", finite(1e3 * k)}});
    }
  }
  return json;
}

Json diagnosis_json(const Diagnosis& d) {
  Json json = {{"named", d.named()}, {"sentence", d.sentence}, {"tried", d.tried}, {"as_given", residual_json(d.as_given)}};
  json["hypotheses"] = Json::array();
  for (const Finding& f : d.findings) {
    json["hypotheses"].push_back({{"kinds", f.kinds},
                                  {"what", f.what},
                                  {"cure", f.cure},
                                  {"residual", residual_json(f.residual)},
                                  {"offered", f.offered}});
  }
  return json;
}

}  // namespace

std::string result_json(const Calibration& c, const Assessment& assessment) {
  Json json;
  json["tool"] = MDHCAL_TOOL_VERSION;
  json["robot"] = c.robot.name;
  json["serial"] = c.robot.serial.empty() ? Json(nullptr) : Json(c.robot.serial);
  json["measurements_sha256"] = c.training.digest_sha256;
  json["method"] = c.method;
  json["usable"] = c.usable();
  json["reasons"] = c.reasons;
  json["accepted"] = c.accepted.empty() ? Json(nullptr) : Json(c.accepted);
  json["verdict"] = c.verdict;
  json["converged"] = c.converged;
  json["iterations"] = c.iterations;
  json["train"] = split(c.train);
  json["test"] = c.test ? split(*c.test) : Json(nullptr);
  add_rotation(json["train"], c.train_rotation);
  if (c.test) add_rotation(json["test"], c.test_rotation);
  json["outliers"] = c.train.outliers;
  json["outlier_threshold_mm"] = finite(c.outlier_threshold_mm);
  json["residual_scale_mm"] = finite(c.scale_mm);
  json["noise_sigma_mm"] = finite(c.covariance.sigma * c.residual_unit_mm);
  if (c.train_rotation.after.count > 0) {
    json["rotation_sigma_mrad"] = finite(1e3 * c.covariance.sigma * c.residual_unit_mm / c.training.rotation_lever_mm);
  }
  json["lambda"] = lambda(c.lambda);
  json["model"] = model_json(c.model);
  json["transmission"] = transmission_json(c.corrected);
  json["parameters"] = Json::array();
  for (const EstimatedParameter& p : c.parameters) json["parameters"].push_back(parameter(p));
  json["tracker_T_base"] = frame(c.estimate.tracker_T_base);
  json["targets"] = Json::array();
  for (std::size_t t = 0; t < c.estimate.flange_p_m.size(); ++t) {
    const Vector3& p = c.estimate.flange_p_m[t];
    json["targets"].push_back({{"name", t < c.training.targets.size() ? c.training.targets[t] : std::string()},
                               {"xyz_mm", vector_mm({1e3 * p[0], 1e3 * p[1], 1e3 * p[2]})}});
    if (std::find(c.layout.probes.begin(), c.layout.probes.end(), t) == c.layout.probes.end()) continue;
    const Vector3 turn = log_of_rotation(c.estimate.flange_R_probe[t]);
    json["targets"].back()["rotation_vector_deg"] = {finite(deg_per_rad * turn[0]), finite(deg_per_rad * turn[1]),
                                                     finite(deg_per_rad * turn[2])};
  }
  Json& identifiability = json["identifiability"];
  identifiability["before"] = spectrum(c.identifiability.before);
  identifiability["after"] = spectrum(c.identifiability.after);
  identifiability["condition_regularized"] = finite(c.identifiability.condition_regularized);
  identifiability["scalar_measurements"] = c.identifiability.after.scalar_rows;
  identifiability["base_and_target_unknowns"] = c.identifiability.frame_unknowns;
  identifiability["base_and_target_rank"] = c.identifiability.frame_rank;
  identifiability["weak_directions"] = Json::array();
  for (const WeakDirection& w : c.identifiability.weak) {
    identifiability["weak_directions"].push_back({{"parameters", w.members},
                                                  {"relative_singular_value", finite(w.relative_singular_value)},
                                                  {"advice", w.advice}});
  }
  json["uncertainty"] = {{"prior_scale", finite(c.covariance.prior_scale)},
                         {"degrees_of_freedom", finite(c.covariance.freedom)},
                         {"coverage_factor", finite(c.covariance.coverage_factor)},
                         {"base_and_targets", frame_uncertainty(c)}};
  json["zero_offsets"] = Json::array();
  for (const ZeroOffset& zero : c.zeros) {
    const bool angle = c.robot.geometry.joint[zero.link].kind == JointKind::revolute;
    json["zero_offsets"].push_back({{"link", zero.link + 1}, {angle ? "offset_deg" : "offset_mm", zero.offset * (angle ? deg_per_rad : 1e3)}});
  }
  json["bootstrap"] = assessment.bootstrap ? bootstrap_json(c, *assessment.bootstrap) : Json(nullptr);
  json["cross_validation"] = nullptr;
  if (c.cross_validation) {
    json["cross_validation"] = split(c.cross_validation->figures);
    add_rotation(json["cross_validation"], c.cross_validation->rotation);
    json["cross_validation"]["folds"] = c.cross_validation->folds;
    json["cross_validation"]["misfit"] = finite(c.cross_validation->misfit);
  }
  if (assessment.cross_validation) {
    const RepeatedCrossValidation& cv = *assessment.cross_validation;
    json["cross_validation"] = {{"folds", cv.folds}, {"before", figures(cv.before)}, {"after", figures(cv.after)}};
  }
  json["diagnosis"] = assessment.diagnosis ? diagnosis_json(*assessment.diagnosis) : Json(nullptr);
  json["dependences"] = Json::array();
  for (const Dependence& d : c.dependences) {
    json["dependences"].push_back({{"quantity", d.quantity},
                                   {"count", d.count},
                                   {"mean_residual_mm", vector_mm(d.mean_residual_mm)},
                                   {"correlation", finite(d.correlation)},
                                   {"p_value", finite(d.p_value)}});
  }
  json["decisions"] = c.decisions;
  json["notes"] = c.notes;
  json["details"] = c.details;
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace mdhcal::offline
