// SPDX-License-Identifier: MIT
#include "offline/identify/calibrate.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "offline/base/error.hpp"
#include "offline/base/random.hpp"
#include "offline/base/sentences.hpp"
#include "offline/identify/covariance.hpp"
#include "offline/identify/dependence.hpp"
#include "offline/identify/mistakes.hpp"
#include "offline/identify/notes.hpp"
#include "offline/identify/published_methods.hpp"
#include "offline/identify/regularized.hpp"
#include "offline/identify/spectrum.hpp"
#include "offline/identify/unknowns.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

LambdaRule rule_of(const CalibrationOptions& options) {
  if (options.method == "rpim-train") return LambdaRule::rpim_train;
  if (options.lambda) return LambdaRule::fixed;
  for (const auto& [word, rule] : lambda_rules) {
    if (options.lambda_rule == word) return rule;
  }
  throw InputError("--lambda-rule names \"" + options.lambda_rule +
                   "\"; expected reml, rpim, rpim-train, l-curve, gcv, cv, discrepancy or quasi-optimality.");
}

// Draws whole groups for the test until the fraction is reached.
void split_off_test(const Dataset& data, const CalibrationOptions& options, std::vector<std::size_t>& training,
                    std::vector<std::size_t>& testing) {
  std::vector<std::uint32_t> order(data.groups.size());
  std::iota(order.begin(), order.end(), 0U);
  Random random(options.seed);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.index(i)]);
  const auto wanted = static_cast<std::size_t>(std::llround(options.test_fraction * static_cast<double>(order.size())));
  std::vector<bool> drawn(order.size(), false);
  for (std::size_t i = 0; i < std::min(wanted, order.size()); ++i) drawn[order[i]] = true;
  for (std::uint32_t group : options.held_out_groups) drawn[group] = true;
  for (std::size_t row = 0; row < data.rows.size(); ++row) {
    if (data.rows[row].kind == MeasurementKind::joints) continue;
    (drawn[data.rows[row].group] ? testing : training).push_back(row);
  }
}

Dataset with_commanded(Dataset data) {
  for (std::size_t i = 0; i < data.rows.size() && i < data.commanded.size(); ++i) data.rows[i].q = data.commanded[i];
  return data;
}

// Rows of another file, their targets renumbered to those of the training data.
Dataset aligned(const Dataset& test, const Dataset& training) {
  Dataset out = test;
  for (Measurement& m : out.rows) {
    const std::string& word = test.targets.empty() ? std::string() : test.targets[m.target];
    const auto found = std::find(training.targets.begin(), training.targets.end(), word);
    if (found == training.targets.end() && !(training.targets.empty() && word.empty())) {
      throw InputError(test.path, m.line, 0,
                       "Found the target \"" + word + "\", which the measurements to identify from do not have.");
    }
    m.target = static_cast<std::uint32_t>(found - training.targets.begin());
  }
  out.targets = training.targets;
  return out;
}

Robot corrected_robot(const Robot& robot, const Estimate& estimate, const Dataset& data) {
  Robot out = robot;
  out.geometry = estimate.geometry;
  out.tracker_T_base = pose_of(estimate.tracker_T_base);
  const bool unnamed = data.targets.size() <= 1 && (data.targets.empty() || data.targets.front().empty());
  if (unnamed) {
    out.tool_p_m = estimate.flange_p_m.front();
    return out;
  }
  for (std::size_t t = 0; t < data.targets.size(); ++t) {
    const auto found = std::find_if(out.targets.begin(), out.targets.end(),
                                    [&](const TargetPoint& p) { return p.name == data.targets[t]; });
    if (found != out.targets.end()) {
      found->flange_p_m = estimate.flange_p_m[t];
    } else {
      out.targets.push_back({data.targets[t], estimate.flange_p_m[t]});
    }
  }
  return out;
}

// A method of the source; the regularized ones are run by calibrate() itself.
MethodOutcome run_method(const std::string& method, const Dataset& data, const Selection& selection,
                         const Layout& layout, const Estimate& start, double noise_mm) {
  if (method == "lsm") return least_squares_step(data, selection, layout, start, noise_mm);
  if (method == "gd") return gradient_descent(data, selection, layout, start, noise_mm);
  if (method == "gn") return gauss_newton(data, selection, layout, start, noise_mm);
  if (method == "lm") return levenberg_marquardt(data, selection, layout, start, noise_mm);
  if (method == "ekf") return extended_kalman_filter(data, selection, layout, start, noise_mm);
  if (method == "nc") return {start, 0, true, ""};
  throw InputError("--method names \"" + method + "\"; expected rpim, rpim-train, nc, lsm, gd, gn, lm or ekf.");
}

std::vector<LambdaReport::Point> points_of(const std::vector<LambdaPoint>& curve) {
  std::vector<LambdaReport::Point> out;
  for (const LambdaPoint& p : curve) out.push_back({p.lambda, p.residual_norm, p.solution_norm, p.criterion});
  return out;
}

void note_commanded(const Robot& robot, const Dataset& data, const CalibrationOptions& options, double scale_mm,
                    Calibration& out) {
  if (data.commanded.empty()) return;
  CalibrationOptions other = options;
  other.commanded_joints = !options.commanded_joints;
  Dataset copy = options.commanded_joints ? data : with_commanded(data);
  copy.commanded.clear();
  other.commanded_joints = false;
  other.test_fraction = 0;
  other.held_out_groups.clear();
  const Calibration with = calibrate(robot, copy, other);
  const bool better = with.scale_mm < scale_mm;
  const char* used = options.commanded_joints ? "commanded" : "read";
  const char* alternative = options.commanded_joints ? "read" : "commanded";
  out.notes.push_back("The " + std::string(better ? alternative : used) + " joint angles fit better: residual scale " +
                      number(scale_mm) + " mm an axis with the " + used + ", " + number(with.scale_mm) +
                      " mm with the " + alternative + " ones" +
                      (better ? std::string("; use them by --joints ") + alternative + "." : std::string(".")));
}

void note_dependences(Calibration& out) {
  if (!out.training.temperature.empty()) out.dependences.push_back(temperature_dependence(out));
  if (!out.training.direction.empty()) {
    const std::vector<Dependence> more = direction_dependences(out);
    out.dependences.insert(out.dependences.end(), more.begin(), more.end());
  }
  const std::vector<std::string> sentences = sentences_on(out.dependences);
  out.notes.insert(out.notes.end(), sentences.begin(), sentences.end());
}

}  // namespace

Calibration calibrate(const Robot& robot, const Dataset& given, const CalibrationOptions& options,
                      const Dataset* test) {
  Calibration out;
  out.robot = robot;
  out.method = options.method;
  if (options.commanded_joints && given.commanded.empty()) {
    throw InputError(given.path, 0, 0, "There are no commanded joint readings; expected columns q1_cmd, q2_cmd, ...");
  }
  out.training = options.commanded_joints ? with_commanded(given) : given;
  const Dataset& data = out.training;
  if (data.joint_count != static_cast<std::size_t>(robot.geometry.joint_count)) {
    throw InputError(data.path, 0, 0, "Found measurements of " + std::to_string(data.joint_count) +
                                          " joints; expected " + std::to_string(robot.geometry.joint_count) + ".");
  }
  std::vector<std::size_t> testing;
  split_off_test(data, options, out.training_rows, testing);
  if (test != nullptr) {
    out.testing = aligned(options.commanded_joints ? with_commanded(*test) : *test, data);
  }

  UnknownsOptions unknowns_options;
  unknowns_options.fit_base = options.fit_base;
  unknowns_options.fit_tool = options.fit_tool;
  unknowns_options.parameters = options.parameters;
  unknowns_options.noise_mm = options.noise_mm.value_or(0.02);
  const double noise_mm = unknowns_options.noise_mm;
  out.noise_mm = noise_mm;
  const Unknowns unknowns = choose_unknowns(robot, data, out.training_rows, unknowns_options);
  out.layout = unknowns.layout;
  out.decisions = unknowns.parameters.decisions;
  check_poses(robot, data, out.training_rows, unknowns);

  Selection selection;
  selection.rows = out.training_rows;
  const Fit nominal = fit_frames(unknowns, data, selection, noise_mm);
  out.start = nominal.estimate;
  const bool any_sigma = states_sigma(data);
  if (any_sigma) out.residual_unit_mm = mean_sigma_mm(data, out.training_rows, noise_mm);
  check_simple_mistakes(robot, data, out.training_rows, unknowns_options, nominal.scale * out.residual_unit_mm);

  RegularizedFit regularized;
  const bool penalised = options.method == "rpim" || options.method == "rpim-train";
  if (penalised) {
    RegularizedControl control;
    control.rule = rule_of(options);
    control.lambda = options.lambda.value_or(0.0);
    control.noise_mm = noise_mm;
    control.robust = options.robust;
    control.seed = options.seed;
    if (any_sigma) control.sigma = 1.0;
    else if (options.noise_mm) control.sigma = noise_mm;
    regularized = regularized_fit(data, selection, unknowns.layout, out.start, control);
    out.converged = regularized.fit.converged;
    out.iterations = regularized.fit.iterations;
    out.lambda.rule = regularized.choice.rule;
    out.lambda.lambda = regularized.choice.lambda;
    out.lambda.note = regularized.choice.note;
    out.lambda.curve = points_of(regularized.choice.curve);
    out.lambda.l_curve = points_of(regularized.corner.curve);
    if (regularized.corner.found) out.lambda.corner = regularized.corner.lambda;
    if (!out.lambda.note.empty()) out.notes.push_back(out.lambda.note);
    if (!out.converged) out.notes.push_back("The fit did not settle within its iteration bound.");
  } else {
    Selection plain = selection;
    plain.robust_weight.clear();
    const MethodOutcome outcome =
        run_method(options.method, data, plain, unknowns.layout, out.start, noise_mm);
    out.converged = outcome.converged;
    out.iterations = outcome.iterations;
    if (!outcome.note.empty()) out.notes.push_back(outcome.note);
    out.lambda.rule = "none";
    selection = plain;
    regularized.fit.estimate = outcome.estimate;
    evaluate(MeasurementModel(outcome.estimate), data, selection, noise_mm, &regularized.fit.error_norms);
    regularized.fit.scale = robust_scale(regularized.fit.error_norms, 1.0, any_sigma ? 1.0 : noise_mm);
  }
  out.estimate = regularized.fit.estimate;
  out.robust_weight = selection.robust_weight;
  const double scale = regularized.fit.scale;
  out.scale_mm = scale * out.residual_unit_mm;
  out.outlier_threshold_mm = outlier_error_norm(out.scale_mm);

  std::size_t rejected = 0;
  for (double e : regularized.fit.error_norms) rejected += e > outlier_threshold * scale ? 1 : 0;
  if (penalised && options.robust) {
    if (const auto move = find_tracker_move(data, out.training_rows, unknowns, regularized.fit, noise_mm)) {
      throw Refusal("The tracker, or the robot's foot, seems to have moved before row " +
                    row_name(data, data.rows[move->first_row_after]) + " (line " +
                    std::to_string(data.rows[move->first_row_after].line) + "): the rows from there on lie in a frame " +
                    number(move->shift_mm) + " mm and " + number(move->turn_deg) +
                    " degrees away. Calibrate from one series, or bring both into one tracker frame first.");
    }
    if (3 * rejected > out.training_rows.size()) {
      throw Refusal(std::to_string(rejected) + " of " + std::to_string(out.training_rows.size()) +
                    " rows lie beyond the outlier threshold of " + number(out.outlier_threshold_mm) +
                    " mm, more than a third: the measurements do not agree with one geometry. Check that the tracker "
                    "stood still, that robot file and joint order are right, and that the noise stated is not too "
                    "small.");
    }
  }

  // Everything that is said about the result comes from one more linearisation, at the result.
  const MeasurementModel model(out.estimate);
  Triangle whole = sum_of(linearise(model, data, selection, unknowns.layout, noise_mm));
  const ReducedSystem system = reduce_frames(whole.matrix(), unknowns.layout.frame_columns(), whole.row_count());
  const std::vector<double> x = deviation(out.estimate, unknowns.layout);
  const SpectralProblem problem =
      penalised_problem(system, Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size())));
  Triangle nominal_whole = sum_of(linearise(MeasurementModel(out.start), data, selection, unknowns.layout, noise_mm));
  out.identifiability = identifiability(system, problem, unknowns.layout, model, out.lambda.lambda, options.seed);
  out.identifiability.before = spectrum_of(
      reduce_frames(nominal_whole.matrix(), unknowns.layout.frame_columns(), nominal_whole.row_count()));
  out.covariance = covariance_of(data, selection, unknowns.layout, system, problem, regularized.fit, out.lambda.lambda,
                                 independent_share(data, selection, model), noise_mm);
  const std::size_t frames = unknowns.layout.frame_columns();
  for (std::size_t i = 0; i < unknowns.layout.geometry.size(); ++i) {
    const Parameter& parameter = unknowns.layout.geometry[i];
    EstimatedParameter p;
    p.id = parameter.id;
    p.nominal = parameter.nominal;
    p.prior = parameter.prior;
    p.deviation = x[i] * parameter.prior;
    p.standard_deviation = std::sqrt(std::max(0.0, out.covariance.at(frames + i, frames + i))) * parameter.prior;
    p.low = p.deviation - out.covariance.coverage_factor * p.standard_deviation;
    p.high = p.deviation + out.covariance.coverage_factor * p.standard_deviation;
    p.identifiable = out.identifiability.identifiable[i];
    p.resolution = out.identifiability.resolution[i];
    out.parameters.push_back(p);
  }

  out.corrected = corrected_robot(robot, out.estimate, data);
  const RowJudge judge{out.start, out.estimate, noise_mm, any_sigma, scale};
  out.train = judge_rows(judge, data, out.training_rows, false, out.rows);
  if (test != nullptr) {
    std::vector<std::size_t> all;
    std::vector<std::size_t> none;
    split_off_test(out.testing, {}, all, none);
    out.test = judge_rows(judge, out.testing, all, true, out.rows);
  } else if (!testing.empty()) {
    out.testing = data;
    out.test = judge_rows(judge, data, testing, true, out.rows);
  }
  note_dependences(out);
  add_standing_notes(data, out);
  const std::vector<std::string> on_axis = targets_on_last_axis(out.estimate, data);
  out.notes.insert(out.notes.end(), on_axis.begin(), on_axis.end());
  note_commanded(robot, given, options, out.scale_mm, out);
  out.verdict = verdict_of(out);
  return out;
}

}  // namespace mdhcal::offline
