// SPDX-License-Identifier: MIT
#include "offline/identify/figures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "offline/identify/reduction.hpp"
#include "offline/identify/rigid.hpp"
#include "offline/identify/robust.hpp"

namespace mdhcal::offline {

namespace {

std::string number(double value, const char* format = "%.3g") {
  char text[40];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    out += i == 0 ? "" : i + 1 == words.size() ? " and " : ", ";
    out += words[i];
  }
  return out;
}

Vector3 leading(const double* residual, std::size_t count) {
  if (count == 1) return {residual[0], 0.0, 0.0};
  return {residual[0], residual[1], residual[2]};
}

}  // namespace

double outlier_error_norm(double scale) {
  const double unit[3] = {1.0, 0.0, 0.0};
  return outlier_threshold * scale / standard_error_norm(unit, 3);
}

SplitFigures judge_rows(const RowJudge& judge, const Dataset& data, const std::vector<std::size_t>& rows, bool test,
                        std::vector<RowResult>& results) {
  SplitFigures out;
  const Model before(judge.before);
  const Model after(judge.after);
  std::vector<double> errors_before;
  std::vector<double> errors_after;
  std::vector<double> good;
  for (std::size_t row : rows) {
    double residual[max_row_residuals];
    double scale[max_row_residuals];
    RowResult result;
    result.row = row;
    result.test = test;
    std::size_t count = before.residual(data, row, residual);
    result.before_mm = leading(residual, count);
    count = after.residual(data, row, residual);
    result.after_mm = leading(residual, count);
    residual_scale(data, row, judge.noise_mm, judge.any_sigma, scale);
    for (std::size_t k = 0; k < count; ++k) residual[k] *= scale[k];
    result.outlier = standard_error_norm(residual, count) > outlier_threshold * judge.scale;
    errors_before.push_back(norm(result.before_mm));
    errors_after.push_back(norm(result.after_mm));
    if (result.outlier) {
      const Measurement& m = data.rows[row];
      out.outliers.push_back(data.targets.size() > 1 ? m.id + "/" + data.targets[m.target] : m.id);
    } else {
      good.push_back(errors_after.back());
    }
    results.push_back(result);
  }
  out.before = statistics(errors_before);
  out.after = statistics(errors_after);
  out.after_good = statistics(good);
  return out;
}

Dependence temperature_dependence(const Dataset& data, const std::vector<RowResult>& results) {
  Dependence out;
  out.quantity = "temperature";
  double sum_t = 0, sum_e = 0, sum_tt = 0, sum_ee = 0, sum_te = 0;
  for (const RowResult& r : results) {
    if (r.test || r.outlier || r.row >= data.temperature.size()) continue;
    const double t = data.temperature[r.row];
    if (!std::isfinite(t)) continue;
    const double e = norm(r.after_mm);
    ++out.count;
    for (std::size_t k = 0; k < 3; ++k) out.mean_residual_mm[k] += r.after_mm[k];
    sum_t += t, sum_e += e, sum_tt += t * t, sum_ee += e * e, sum_te += t * e;
  }
  if (out.count == 0) return out;
  const auto n = static_cast<double>(out.count);
  for (double& c : out.mean_residual_mm) c /= n;
  const double spread = (sum_tt - sum_t * sum_t / n) * (sum_ee - sum_e * sum_e / n);
  if (spread > 0.0) out.correlation = (sum_te - sum_t * sum_e / n) / std::sqrt(spread);
  return out;
}

std::vector<Dependence> direction_dependences(const Dataset& data, const std::vector<RowResult>& results) {
  std::map<std::string, Dependence> classes;
  for (const RowResult& r : results) {
    if (r.test || r.outlier || r.row >= data.direction.size()) continue;
    Dependence& one = classes[data.direction[r.row]];
    ++one.count;
    for (std::size_t k = 0; k < 3; ++k) one.mean_residual_mm[k] += r.after_mm[k];
  }
  std::vector<Dependence> out;
  for (auto& [word, one] : classes) {
    one.quantity = "direction " + word;
    for (double& c : one.mean_residual_mm) c /= static_cast<double>(one.count);
    out.push_back(one);
  }
  return out;
}

void add_standing_notes(const Dataset& data, Calibration& c) {
  std::size_t scalars = 0;
  for (std::size_t row : c.training_rows) scalars += residual_count(data.rows[row].kind);
  const std::size_t unknowns = c.layout.columns();
  if (scalars < unknowns) {
    c.notes.push_back("There are fewer scalar measurements (" + std::to_string(scalars) + ") than unknowns (" +
                      std::to_string(unknowns) + "): the penalty decides what the measurements leave open.");
  }
  if (c.identifiability.frame_rank < c.identifiability.frame_unknowns) {
    c.notes.push_back("Base frame and targets have " + std::to_string(c.identifiability.frame_unknowns) +
                      " unknowns, of which these poses tell " + std::to_string(c.identifiability.frame_rank) +
                      ": the rest keeps its starting value, and positions away from the measured ones are not to be "
                      "trusted. Measure with more orientations.");
  }
  std::vector<std::string> lost;
  std::vector<std::string> far;
  for (const EstimatedParameter& p : c.parameters) {
    if (!p.identifiable) lost.push_back(name(p.id));
    if (std::fabs(p.deviation) > 15.0 * p.prior) far.push_back(name(p.id));
  }
  if (!lost.empty()) {
    c.notes.push_back(joined(lost) + (lost.size() == 1 ? " is" : " are") +
                      " not identifiable from these poses (alone or at all).");
  }
  for (const WeakDirection& w : c.identifiability.weak) {
    const bool gone = !(w.relative_singular_value > 0.0);
    const std::string which =
        w.members.size() == 1 ? w.members.front() + (gone ? " is not seen" : " is seen only weakly")
                              : joined(w.members) + (gone ? " are confounded" : " are nearly confounded");
    c.notes.push_back(which + (gone ? "" : " (" + number(w.relative_singular_value) + " of the strongest direction)") +
                      ". " + w.advice);
  }
  if (!far.empty()) {
    c.notes.push_back(joined(far) + (far.size() == 1 ? " deviates" : " deviate") +
                      " by more than 15 prior standard deviations from nominal: either the prior is too narrow for "
                      "this robot, or these parameters are told so badly that they must not be read one by one.");
  }
  if (!c.train.outliers.empty()) c.notes.push_back("Outliers among the training rows: " + joined(c.train.outliers) + ".");
  if (c.test && !c.test->outliers.empty()) {
    c.notes.push_back("Test rows beyond the training outlier threshold: " + joined(c.test->outliers) + ".");
  }
  c.notes.push_back(
      "Compliance, backlash and thermal drift are in no parameter: they stay in the residual, and the intervals cover "
      "the geometry only.");
}

std::string verdict_of(const Calibration& c) {
  if (!c.converged) return "Not converged: do not use this result.";
  if (!c.test) {
    return "Untested: no rows were held out; on the training rows the mean error is " + number(c.train.after.mean) +
           " mm (nominal " + number(c.train.before.mean) + " mm).";
  }
  const Statistics& after = c.test->after_good;
  if (!(c.test->after.median < c.test->before.median)) {
    return "Worse than nominal on the held-out rows: do not use this result.";
  }
  return "Tested on " + std::to_string(c.test->after.count) + " held-out rows: mean error " + number(after.mean) +
         " mm, maximum " + number(after.max) + " mm without " + std::to_string(c.test->outliers.size()) +
         " outliers; nominal " + number(c.test->before.mean) + " mm, maximum " + number(c.test->before.max) + " mm.";
}

}  // namespace mdhcal::offline
