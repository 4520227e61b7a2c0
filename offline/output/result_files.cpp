// SPDX-License-Identifier: MIT
#include "offline/output/result_files.hpp"

#include <algorithm>
#include <cstdio>

#include "offline/base/error.hpp"
#include "offline/base/sentences.hpp"
#include "offline/output/blob_file.hpp"

namespace mdhcal::offline {

namespace {

std::string line_of(const char* label, const Statistics& s) {
  char text[160];
  std::snprintf(text, sizeof text, "%-22s %6zu %9.4f %9.4f %9.4f %9.4f %9.4f %9.4f\n", label, s.count, s.mean, s.median,
                s.max, s.sd, s.rms, s.p95);
  return text;
}

// As much of a text as `size` bytes hold, cut between characters of UTF-8, line breaks and the like as blanks.
std::string fitting(std::string text, std::size_t size) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  }
  if (text.size() <= size) return text;
  while (size > 0 && (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U) --size;
  return text.substr(0, size);
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
  if (!c.usable()) out.lambda_rule = fitting(std::string(accepted_mark) + c.accepted, sizeof BlobProvenance{}.lambda_rule - 1);
  const SplitFigures& judged = c.judged();
  if ((c.test || c.cross_validation) && judged.after.count > 0) {
    Provenance::HeldOut held;
    held.pose_count = static_cast<std::uint32_t>(std::min<std::size_t>(judged.after.count, 0xFFFFFFFFU));
    held.mean_before_m = 1e-3 * judged.before.mean;
    held.max_before_m = 1e-3 * judged.before.max;
    held.mean_after_m = 1e-3 * judged.after.mean;
    held.max_after_m = 1e-3 * judged.after.max;
    out.held_out = held;
  }
  return out;
}

std::string corrected_toml(const Calibration& c) { return write_robot(c.corrected); }

Blob calibration_blob(const Calibration& c, const std::string& date) {
  return make_blob(parse_robot(corrected_toml(c), "corrected.toml"), provenance_of(c, date));
}

std::string refusal_of_blob(const Calibration& c) {
  try {
    (void)calibration_blob(c, "");
  } catch (const Refusal& refusal) {
    return refusal.what();
  }
  return "";
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
  const auto without = [&](const SplitFigures& figures) {
    if (!figures.outliers.empty() && figures.after_good.count > 0) out += line_of("  without rows named", figures.after_good);
  };
  without(c.train);
  if (c.cross_validation && !c.test) {
    out += line_of("left out, nominal", c.cross_validation->figures.before);
    out += line_of("left out, calibrated", c.cross_validation->figures.after);
    without(c.cross_validation->figures);
  }
  if (c.test) {
    out += line_of("test, nominal", c.test->before);
    out += line_of("test, calibrated", c.test->after);
    without(*c.test);
  }
  return out;
}

}  // namespace mdhcal::offline
