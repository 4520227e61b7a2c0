// SPDX-License-Identifier: MIT
#include "offline/identify/notes.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "offline/base/sentences.hpp"
#include "offline/identify/reduction.hpp"
#include "offline/identify/robust.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

bool states_another_nominal(const Robot& robot) {
  for (std::int32_t i = 0; i < robot.geometry.joint_count; ++i) {
    if (std::memcmp(&robot.geometry.link[i], &robot.nominal[static_cast<std::size_t>(i)], sizeof(Link)) != 0) return true;
  }
  return false;
}

bool lost(const WeakDirection& w) { return !(w.relative_singular_value > 0.0); }

// Without its end.
std::string sentence_of(const WeakDirection& w) {
  const bool alone = w.members.size() == 1;
  if (lost(w)) return joined(w.members) + (alone ? " is not seen" : " are confounded");
  return joined(w.members) + (alone ? " is seen only weakly" : " are nearly confounded") + " (" +
         number(w.relative_singular_value) + " of the strongest direction)";
}

// How many combinations are lost or weak, the worst of each, and what would tell those.
std::string note_of(const std::vector<WeakDirection>& weak) {
  const auto first_weak = std::find_if_not(weak.begin(), weak.end(), lost);
  const auto lost_count = static_cast<std::size_t>(first_weak - weak.begin());
  const std::size_t weak_count = weak.size() - lost_count;
  std::string out = "Combinations of parameters that these poses tell badly: " + std::to_string(lost_count) + " lost, " +
                    std::to_string(weak_count) + " weak (below 0.01 of the strongest).";
  if (lost_count > 0) out += " Lost first: " + sentence_of(weak.front()) + ". " + weak.front().advice;
  if (weak_count > 0) {
    WeakDirection worst = *first_weak;
    constexpr std::size_t most = 4;
    const std::size_t more = worst.members.size() > most ? worst.members.size() - most : 0;
    if (more > 0) {
      worst.members.resize(most - 1);
      worst.members.push_back(std::to_string(more + 1) + " others");
    }
    out += " Weakest: " + sentence_of(worst) + ". " + worst.advice;
  }
  return out + (weak.size() > 1 ? " All of them: --verbose, or weak_directions in result.json." : "");
}

Vector3 leading(const double* residual, std::size_t count) {
  if (count == 1) return {residual[0], 0.0, 0.0};
  return {residual[0], residual[1], residual[2]};
}

}  // namespace

double outlier_error_norm(double scale) {
  return outlier_threshold * scale * chi_median(3);
}

SplitFigures judge_rows(const RowJudge& judge, const Dataset& data, const std::vector<std::size_t>& rows, bool test,
                        std::vector<RowResult>& results) {
  SplitFigures out;
  const MeasurementModel before(judge.before);
  const MeasurementModel after(judge.after);
  std::vector<double> errors_before;
  std::vector<double> errors_after;
  std::vector<double> good_before;
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
      out.outliers.push_back(row_name(data, data.rows[row]));
    } else {
      good_before.push_back(errors_before.back());
      good.push_back(errors_after.back());
    }
    results.push_back(result);
  }
  out.before = statistics(errors_before);
  out.after = statistics(errors_after);
  out.before_good = statistics(good_before);
  out.after_good = statistics(good);
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
  if (states_another_nominal(c.robot)) {
    c.notes.push_back("The robot file states a geometry that was corrected before: deviations and their penalty count "
                      "from its geometry, and \"nominal\" in the figures means it. The maker's nominal links are kept.");
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
  for (const WeakDirection& w : c.identifiability.weak) c.details.push_back(sentence_of(w) + ". " + w.advice);
  if (!c.identifiability.weak.empty()) c.notes.push_back(note_of(c.identifiability.weak));
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
    return "Untested: no rows were held out; on the training rows the mean error is " + number(c.train.after_good.mean) +
           " mm (nominal " + number(c.train.before_good.mean) + " mm)" +
           (c.train.outliers.empty() ? "." : " without " + std::to_string(c.train.outliers.size()) + " outliers.");
  }
  // Both without the outliers: a gross error is no fault of the nominal geometry either.
  const Statistics& after = c.test->after_good;
  const Statistics& before = c.test->before_good;
  if (!(c.test->after.median < c.test->before.median)) {
    return "Worse than nominal on the held-out rows: do not use this result.";
  }
  return "Tested on " + std::to_string(c.test->after.count) + " held-out rows: mean error " + number(after.mean) +
         " mm, maximum " + number(after.max) + " mm without " + std::to_string(c.test->outliers.size()) +
         " outliers; nominal " + number(before.mean) + " mm, maximum " + number(before.max) + " mm on the same rows.";
}

}  // namespace mdhcal::offline
