// SPDX-License-Identifier: MIT
#include "offline/identify/judging.hpp"

#include <algorithm>
#include <cmath>

#include "offline/base/distributions.hpp"
#include "offline/identify/folds.hpp"
#include "offline/identify/named_rows.hpp"
#include "offline/identify/robust.hpp"
#include "offline/robot/random_readings.hpp"
#include "offline/robot/units.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

struct JudgedRow {
  std::string name;
  double before_mm = 0, after_mm = 0, predicted_mm = 0;
  std::uint32_t pose = 0;
  bool named = false;
};

SplitFigures figures_of(const std::vector<JudgedRow>& rows) {
  SplitFigures out;
  std::vector<double> before;
  std::vector<double> after;
  std::vector<double> good_before;
  std::vector<double> good_after;
  std::vector<std::uint32_t> pose;
  double predicted = 0.0;
  for (const JudgedRow& row : rows) {
    before.push_back(row.before_mm);
    after.push_back(row.after_mm);
    pose.push_back(row.pose);
    out.poses = std::max<std::size_t>(out.poses, row.pose + 1);
    if (row.named) {
      out.outliers.push_back(row.name);
      continue;
    }
    good_before.push_back(row.before_mm);
    good_after.push_back(row.after_mm);
    predicted += row.predicted_mm;
  }
  out.before = statistics(before);
  out.after = statistics(after);
  out.before_good = statistics(good_before);
  out.after_good = statistics(good_after);
  out.mean = bounds_of_mean(after, pose);
  if (!good_after.empty()) out.predicted_mean_mm = predicted / static_cast<double>(good_after.size());
  return out;
}

Vector3 leading(const double* residual, std::size_t count) {
  if (count == 1) return {residual[0], 0.0, 0.0};
  return {residual[0], residual[1], residual[2]};
}

// Whether the rows left out that are named are gross measurements and nothing else: few, outliers of the fit that had them
// too, and not lying together.
bool gross_only(const std::vector<JudgedRow>& rows, const Calibration& c) {
  std::size_t named = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!rows[i].named) continue;
    ++named;
    if (!c.rows[i].outlier) return false;
  }
  return named > 0 && named <= std::max<std::size_t>(1, rows.size() / 10) && what_named_rows_share(c, false).empty();
}

// A gross measurement is no error of the arm, and nothing else is known of the arm there: at worst it is as at the other
// poses' worst.
void count_as_the_worst_other(std::vector<JudgedRow>& rows) {
  double before = 0.0;
  double after = 0.0;
  for (const JudgedRow& row : rows) {
    if (row.named) continue;
    before = std::max(before, row.before_mm);
    after = std::max(after, row.after_mm);
  }
  for (JudgedRow& row : rows) {
    if (!row.named) continue;
    row.before_mm = std::min(row.before_mm, before);
    row.after_mm = std::min(row.after_mm, after);
  }
}

double misfit_of(const Calibration& c) { return c.cross_validation ? c.cross_validation->misfit : 1.0; }

}  // namespace

double outlier_error_norm(double scale) {
  return outlier_threshold * scale * chi_median(3);
}

Bounds bounds_of_mean(const std::vector<double>& errors, const std::vector<std::uint32_t>& pose) {
  Bounds out;
  if (errors.empty()) return out;
  const auto n = static_cast<double>(errors.size());
  double mean = 0.0;
  for (const double e : errors) mean += e / n;
  std::vector<double> sum(*std::max_element(pose.begin(), pose.end()) + 1, 0.0);
  for (std::size_t i = 0; i < errors.size(); ++i) sum[pose[i]] += errors[i] - mean;
  const auto poses = static_cast<double>(sum.size());
  if (poses < 2.0 || !(mean > 0.0)) return out;
  double squares = 0.0;
  for (const double s : sum) squares += s * s;
  const double relative = std::sqrt(squares * poses / (poses - 1.0)) / n / mean;
  const double factor = std::exp(student_975(poses - 1.0) * relative);
  out.low = mean / factor;
  out.high = mean * factor;
  return out;
}

SplitFigures judge_training(const Fit& fit, Calibration& out) {
  const Dataset& data = out.training;
  const MeasurementModel before(out.start);
  const MeasurementModel after(out.estimate);
  const std::vector<std::uint32_t> pose = poses_of(data, out.training_rows);
  std::vector<JudgedRow> judged;
  for (std::size_t i = 0; i < out.training_rows.size(); ++i) {
    double residual[max_row_residuals];
    RowResult result;
    result.row = out.training_rows[i];
    result.before_mm = leading(residual, before.residual(data, result.row, residual));
    result.after_mm = leading(residual, after.residual(data, result.row, residual));
    result.outlier = fit.error_norms[i] > outlier_threshold * fit.scale;
    judged.push_back({row_name(data, data.rows[result.row]), norm(result.before_mm), norm(result.after_mm), 0.0, pose[i],
                      result.outlier});
    out.rows.push_back(result);
  }
  return figures_of(judged);
}

SplitFigures judge_held_out(const Predictor& predictor, const std::vector<std::size_t>& rows, Calibration& out) {
  const Dataset& data = out.testing;
  const MeasurementModel before(out.start);
  const double misfit = misfit_of(out);
  const std::vector<std::uint32_t> pose = poses_of(data, rows);
  std::vector<JudgedRow> judged;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    double residual[max_row_residuals];
    const Prediction prediction = predict(predictor, data, rows[i]);
    RowResult result;
    result.row = rows[i];
    result.test = true;
    result.before_mm = leading(residual, before.residual(data, rows[i], residual));
    result.after_mm = prediction.error_mm;
    result.outlier = prediction.standardised > outlier_threshold * misfit;
    judged.push_back({row_name(data, data.rows[rows[i]]), norm(result.before_mm), norm(result.after_mm),
                      misfit * prediction.mean_mm, pose[i], result.outlier});
    out.rows.push_back(result);
  }
  return figures_of(judged);
}

CrossValidation judge_left_out(const LeftOut& left_out, const Calibration& c) {
  CrossValidation out;
  out.folds = left_out.folds;
  std::vector<double> standardised;
  for (const Prediction& p : left_out.after) standardised.push_back(p.standardised);
  out.misfit = robust_scale(standardised, 1.0, 1.0);
  const std::vector<std::uint32_t> pose = poses_of(c.training, c.training_rows);
  std::vector<JudgedRow> judged;
  std::vector<double> turned_before;
  std::vector<double> turned_after;
  for (std::size_t i = 0; i < c.training_rows.size(); ++i) {
    const Prediction& p = left_out.after[i];
    if (c.training.rows[c.training_rows[i]].kind == MeasurementKind::pose) {
      turned_before.push_back(deg_per_rad * norm(left_out.before_turn_mm[i]) / c.training.rotation_lever_mm);
      turned_after.push_back(deg_per_rad * norm(p.turn_mm) / c.training.rotation_lever_mm);
    }
    judged.push_back({row_name(c.training, c.training.rows[c.training_rows[i]]), norm(left_out.before_mm[i]), norm(p.error_mm),
                      out.misfit * p.mean_mm, pose[i], p.standardised > outlier_threshold * out.misfit});
  }
  out.rotation = {statistics(turned_before), statistics(turned_after)};
  if (gross_only(judged, c)) count_as_the_worst_other(judged);
  out.figures = figures_of(judged);
  // Folds share most of their rows, so their errors are not independent: for k folds the variance of the mean is
  // 1 + k / (k - 1) times that of independent ones (Nadeau and Bengio 2003, on the logarithm here).
  const auto k = static_cast<double>(out.folds);
  if (std::isfinite(out.figures.mean.high)) {
    // Errors left out are made of the fit's residuals, of which only its degrees of freedom are independent: as many poses'
    // worth stand behind Student's t.
    double scalars = 0.0;
    for (const std::size_t row : c.training_rows) scalars += static_cast<double>(residual_count(c.training.rows[row].kind));
    const auto poses = static_cast<double>(out.figures.poses);
    const double independent = poses * std::min(1.0, c.covariance.freedom / scalars);
    const double student = student_975(std::max(1.0, independent - 1.0)) / student_975(poses - 1.0);
    const double width = std::log(out.figures.mean.high / out.figures.after.mean) * student * std::sqrt(1.0 + k / (k - 1.0));
    out.figures.mean = {out.figures.after.mean * std::exp(-width), out.figures.after.mean * std::exp(width)};
  }
  return out;
}

PredictedAccuracy predicted_accuracy(const MeasurementModel& model, const Layout& layout, const Covariance& covariance) {
  PredictedAccuracy out;
  if (covariance.size == 0) return out;
  const Frame<double> base_T_tracker = inverted(model.estimate().tracker_T_base);
  Covariance frames = covariance;
  frames.value.assign(frames.value.size(), 0.0);
  for (std::size_t i = 0; i < frames.frame_size; ++i) {
    for (std::size_t j = 0; j < frames.frame_size; ++j) frames.value[i * frames.size + j] = frames.frames[i * frames.frame_size + j];
  }
  Random random(1);
  std::vector<double> all;
  std::vector<double> of_frames;
  for (int k = 0; k < 600; ++k) {
    const Joints q = random_readings(model.estimate().geometry, random);
    const Vector3 p = transform(base_T_tracker, model.target_position(q.data(), 0));
    all.push_back(predicted_position_sd_mm(model, layout, covariance, q.data(), 0));
    of_frames.push_back(predicted_position_sd_mm(model, layout, frames, q.data(), 0));
    out.points.push_back({1e3 * p[0], 1e3 * p[1], 1e3 * p[2], all.back()});
  }
  std::sort(all.begin(), all.end());
  std::sort(of_frames.begin(), of_frames.end());
  out.median_mm = all[all.size() / 2];
  out.p95_mm = all[all.size() * 95 / 100];
  out.max_mm = all.back();
  out.frames_median_mm = of_frames[of_frames.size() / 2];
  return out;
}

}  // namespace mdhcal::offline
