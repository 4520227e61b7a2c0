// SPDX-License-Identifier: MIT
#include "offline/identify/usable.hpp"

#include <algorithm>
#include <cmath>

#include "mdhcal/blob.hpp"
#include "offline/base/sentences.hpp"
#include "offline/identify/named_rows.hpp"
#include "offline/identify/pose_checks.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

bool only_distances(const Calibration& c) {
  return std::all_of(c.training_rows.begin(), c.training_rows.end(),
                     [&](std::size_t row) { return c.training.rows[row].kind == MeasurementKind::distance; });
}

const char* judged_rows(const Calibration& c) {
  return c.test ? "held-out rows" : c.cross_validation ? "rows left out of the folds" : "training rows";
}

// Half of the rows, and the mean of those that are not gross: one gross row must not decide.
void compare_with_nominal(Calibration& c) {
  const SplitFigures& figures = c.judged();
  const bool median_better = figures.after.median < figures.before.median;
  const bool mean_better = figures.after_good.count == 0 || figures.after_good.mean < figures.before_good.mean;
  if (median_better && mean_better) return;
  const bool by_median = !median_better;
  c.reasons.push_back("It is no better than the nominal geometry on the " + std::string(judged_rows(c)) + ": " +
                      (by_median ? "median" : "mean") + " error " +
                      number(by_median ? figures.after.median : figures.after_good.mean) + " mm, nominal " +
                      number(by_median ? figures.before.median : figures.before_good.mean) + " mm.");
}

void hold_residual(double limit_mm, Calibration& c) {
  const double left = std::max(c.judged().after.median, c.train.after.median);
  if (left <= limit_mm) return;
  c.reasons.push_back("The residual is not explained: half of the rows are missed by " + number(left) +
                      " mm or more, over the limit of " + number(limit_mm) +
                      " mm (--max-residual). Units, signs, order and zeros of the joints, base and tool are what is usually "
                      "wrong.");
}

std::string sd_text(const Calibration& c, std::size_t first, std::size_t count, double factor, const char* unit) {
  double largest = 0.0;
  for (std::size_t i = first; i < first + count; ++i) largest = std::max(largest, c.covariance.frames[i * c.covariance.frame_size + i]);
  return number(std::sqrt(largest) * factor) + " " + unit;
}

std::string what_is_missing(const Calibration& c) {
  return spread_of_poses(c.robot, c.training, c.training_rows) +
         " Measure points that lie neither on one line nor near one orientation, or give base or target (--base given, --tool given).";
}

void hold_frames(Calibration& c) {
  if (only_distances(c)) return;  // lengths between poses know no base; the notes say so
  if (c.identifiability.frame_rank < c.identifiability.frame_unknowns) {
    c.reasons.push_back("Base frame and targets are not determined: of their " +
                        std::to_string(c.identifiability.frame_unknowns) + " unknowns these poses tell " +
                        std::to_string(c.identifiability.frame_rank) +
                        ". " + what_is_missing(c));
    return;
  }
  // Were the geometry known: what base and geometry are uncertain by together cancels in the positions.
  // What a calibration is for: to leave less than the nominal geometry does. Where base and targets alone leave more than
  // that over the workspace, the measured poses agree and others do not.
  // Held-out rows are no measure of it: where base or targets are open, it is these that they are off by.
  const double nominal_mm = c.cross_validation ? c.cross_validation->figures.before.mean : c.train.before.mean;
  if (!(c.accuracy.frames_median_mm > nominal_mm)) return;
  std::string sds;
  if (c.layout.base) {
    sds = "base turned by " + sd_text(c, 0, 3, 1e-3 * deg_per_rad, "degrees") + " and moved by " + sd_text(c, 3, 3, 1.0, "mm");
  }
  if (c.layout.target) {
    sds += (sds.empty() ? "" : ", ") + std::string("target ") +
           sd_text(c, c.layout.base_columns(), c.layout.target_columns(), 1.0, "mm");
  }
  c.reasons.push_back("Base frame and targets are badly determined (standard deviations: " + sds +
                      "): positions over the workspace are uncertain by " + number(c.accuracy.frames_median_mm) +
                      " mm from these alone, and the nominal geometry misses by only " + number(nominal_mm) +
                      " mm. " + what_is_missing(c));
}

}  // namespace

double default_max_residual_mm(const Robot& robot) {
  double reach_m = 0.0;
  for (std::int32_t i = 0; i < robot.geometry.joint_count; ++i) {
    const Link& link = robot.nominal[static_cast<std::size_t>(i)];
    reach_m += std::hypot(link.a_m, link.d_m);
    const Joint& joint = robot.geometry.joint[i];
    if (joint.kind == JointKind::prismatic && joint.has_min == 1 && joint.has_max == 1) {
      reach_m += std::min(joint.max - joint.min, 100.0);
    }
  }
  return std::max(2.0, 2e-3 * 1e3 * reach_m);
}

std::vector<ZeroOffset> large_zero_offsets(const Calibration& c) {
  std::vector<ZeroOffset> out;
  for (const EstimatedParameter& p : c.parameters) {
    const bool revolute = c.robot.geometry.joint[p.id.link].kind == JointKind::revolute;
    if (p.id.key != (revolute ? ParameterKey::theta : ParameterKey::d)) continue;
    // What the controller holds against its bound counts from the maker's zero.
    const Link& nominal = c.robot.nominal[static_cast<std::size_t>(p.id.link)];
    const double offset = p.nominal + p.deviation - (revolute ? nominal.theta_rad : nominal.d_m);
    if (std::fabs(offset) > (revolute ? max_deviation_rad() : max_deviation_m())) {
      out.push_back({static_cast<std::int32_t>(p.id.link), offset});
    }
  }
  return out;
}

std::string sentence_of(const Robot& robot, const ZeroOffset& zero) {
  const bool revolute = robot.geometry.joint[zero.link].kind == JointKind::revolute;
  return "joint " + std::to_string(zero.link + 1) + "'s zero is " +
         number(revolute ? zero.offset * deg_per_rad : zero.offset * mm_per_m) + (revolute ? " degrees off" : " mm off");
}

void find_reasons(const CalibrationOptions& options, Calibration& c) {
  if (!c.contradiction.empty()) c.reasons.push_back(c.contradiction);
  if (!c.converged) c.reasons.push_back("The fit did not converge.");
  compare_with_nominal(c);
  hold_frames(c);
  hold_residual(options.max_residual_mm.value_or(default_max_residual_mm(c.robot)), c);
  bool in_order = false;
  const std::string shared = what_named_rows_share(c, false, &in_order);
  if (in_order && 10 * c.train.outliers.size() > c.training_rows.size()) {
    c.reasons.push_back(shared + " Calibrate from one series, or bring both into one frame first.");
  }
  std::vector<std::string> zeros;
  for (const ZeroOffset& zero : large_zero_offsets(c)) zeros.push_back(sentence_of(c.robot, zero));
  if (!zeros.empty()) {
    std::string text = joined(zeros);
    text[0] = 'J';
    c.reasons.push_back(text + ": that is mastering, not a deviation that a controller accepts. With --rezero it goes into the "
                               "nominal zero of the robot that is written, and the rest is calibration.");
  }
}

}  // namespace mdhcal::offline
