// SPDX-License-Identifier: MIT
#include "offline/output/result_files.hpp"

#include <algorithm>
#include <cstdio>

#include "offline/base/sentences.hpp"

namespace mdhcal::offline {

namespace {

std::string line_of(const char* label, const Statistics& s) {
  char text[160];
  std::snprintf(text, sizeof text, "%-22s %6zu %9.4f %9.4f %9.4f %9.4f %9.4f %9.4f\n", label, s.count, s.mean, s.median,
                s.max, s.sd, s.rms, s.p95);
  return text;
}

}  // namespace

Provenance provenance_of(const Calibration& c, const std::string& date) {
  Provenance out;
  out.date = date;
  out.method = c.method;
  out.lambda_rule = c.lambda.rule;
  out.measurements_sha256 = c.training.digest_sha256;
  out.pose_count = static_cast<std::uint32_t>(std::min<std::size_t>(c.training_rows.size(), 0xFFFFFFFFU));
  if (c.lambda.rule != "none") out.lambda = c.lambda.lambda;
  if (c.test && c.test->after.count > 0) {
    Provenance::HeldOut held;
    held.pose_count = static_cast<std::uint32_t>(std::min<std::size_t>(c.test->after.count, 0xFFFFFFFFU));
    held.mean_before_m = 1e-3 * c.test->before.mean;
    held.max_before_m = 1e-3 * c.test->before.max;
    held.mean_after_m = 1e-3 * c.test->after.mean;
    held.max_after_m = 1e-3 * c.test->after.max;
    out.held_out = held;
  }
  return out;
}

std::string corrected_toml(const Calibration& c) { return write_robot(c.corrected); }

Blob calibration_blob(const Calibration& c, const std::string& date) {
  return make_blob(parse_robot(corrected_toml(c), "corrected.toml"), provenance_of(c, date));
}

std::string estimated_text(const Calibration& c) {
  std::vector<std::string> betas;
  for (const EstimatedParameter& p : c.parameters) {
    if (p.id.key == ParameterKey::beta) betas.push_back(name(p.id));
  }
  return std::to_string(c.parameters.size()) + " parameters are estimated" +
         (betas.empty() ? std::string() : ", " + joined(betas) + " of parallel axes among them") + ".";
}

std::string choice_text(const Calibration& c) {
  const Spectrum& before = c.identifiability.before;
  const Spectrum& after = c.identifiability.after;
  std::string out = "Method " + c.method + ", " + std::to_string(c.iterations) + " iterations";
  if (c.lambda.rule != "none") out += "; lambda " + number(c.lambda.lambda) + " by the rule " + c.lambda.rule;
  out += "; residual scale " + number(c.scale_mm) + " mm an axis, outliers beyond " + number(c.outlier_threshold_mm) +
         " mm. Rank " + std::to_string(after.rank) + " of " + std::to_string(after.singular_values.size()) +
         ", condition number " + number(before.condition) + " before, " + number(after.condition) + " after, " +
         number(c.identifiability.condition_regularized) + " with the penalty.";
  for (std::size_t k = 0; k < after.observability.size(); ++k) {
    out += (k == 0 ? " Observability " : ", ") + std::string("O") + std::to_string(k + 1) + " " +
           number(before.observability[k]) + " before, " + number(after.observability[k]) + " after";
  }
  return out + ".";
}

std::string figures_text(const Calibration& c) {
  std::string out = "position error [mm]         n      mean    median       max        sd       rms       p95\n";
  out += line_of("train, nominal", c.train.before);
  out += line_of("train, calibrated", c.train.after);
  if (!c.train.outliers.empty()) out += line_of("  without outliers", c.train.after_good);
  if (c.test) {
    out += line_of("test, nominal", c.test->before);
    out += line_of("test, calibrated", c.test->after);
    if (!c.test->outliers.empty()) out += line_of("  without outliers", c.test->after_good);
  }
  return out;
}

}  // namespace mdhcal::offline
