// SPDX-License-Identifier: MIT
#include "offline/identify/calibrate.hpp"

#include <algorithm>
#include <cmath>

#include "offline/base/distributions.hpp"
#include "offline/base/error.hpp"
#include "offline/base/random.hpp"
#include "offline/base/sentences.hpp"
#include "offline/identify/copies.hpp"
#include "offline/identify/covariance.hpp"
#include "offline/identify/dependence.hpp"
#include "offline/identify/families/family_model.hpp"
#include "offline/identify/judging.hpp"
#include "offline/identify/left_out.hpp"
#include "offline/identify/pose_checks.hpp"
#include "offline/identify/notes.hpp"
#include "offline/identify/published_methods.hpp"
#include "offline/identify/regularized.hpp"
#include "offline/identify/rotation_check.hpp"
#include "offline/identify/rotation_noise.hpp"
#include "offline/identify/shared_error.hpp"
#include "offline/identify/spectrum.hpp"
#include "offline/identify/splitting.hpp"
#include "offline/identify/unknowns.hpp"
#include "offline/identify/usable.hpp"
#include "offline/identify/verdict.hpp"
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

Dataset with_commanded(Dataset data) {
  for (std::size_t i = 0; i < data.rows.size() && i < data.commanded.size(); ++i) data.rows[i].q = data.commanded[i];
  return data;
}

// The turn of a target's probe where it was fitted, else as stated.
std::optional<std::array<double, 4>> turn_of(const Layout& layout, const Estimate& estimate, std::size_t target,
                                             const std::optional<std::array<double, 4>>& stated) {
  if (std::find(layout.probes.begin(), layout.probes.end(), target) == layout.probes.end()) return stated;
  const Pose<double> pose = pose_of(estimate.flange_R_probe[target]);
  return std::array<double, 4>{pose.quaternion[0], pose.quaternion[1], pose.quaternion[2], pose.quaternion[3]};
}

Robot corrected_robot(const Robot& robot, const Estimate& estimate, const Layout& layout, const Dataset& data) {
  Robot out = robot;
  out.geometry = estimate.geometry;
  out.transmission = estimate.transmission;
  out.tracker_T_base = pose_of(estimate.tracker_T_base);
  const bool unnamed = data.targets.size() <= 1 && (data.targets.empty() || data.targets.front().empty());
  if (unnamed) {
    out.tool_p_m = estimate.flange_p_m.front();
    out.tool_quaternion = turn_of(layout, estimate, 0, robot.tool_quaternion);
    return out;
  }
  for (std::size_t t = 0; t < data.targets.size(); ++t) {
    const auto found = std::find_if(out.targets.begin(), out.targets.end(),
                                    [&](const TargetPoint& p) { return p.name == data.targets[t]; });
    if (found != out.targets.end()) {
      found->flange_p_m = estimate.flange_p_m[t];
      found->quaternion = turn_of(layout, estimate, t, found->quaternion);
    } else {
      out.targets.push_back({data.targets[t], estimate.flange_p_m[t], turn_of(layout, estimate, t, {})});
    }
  }
  return out;
}

// A method of the source; the regularized ones are run by identify().
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

// The weight of rotations beside positions, in every row that is used.
void weigh_rotations(const CalibrationOptions& options, const Selection& selection, Calibration& out) {
  out.training.rotation_lever_mm =
      options.rotation_noise_mrad
          ? 1e3 * out.noise_mm / *options.rotation_noise_mrad
          : estimated_rotation_lever_mm(out.training, selection, out.layout, out.start, out.noise_mm);
  out.testing.rotation_lever_mm = out.training.rotation_lever_mm;
}

void figure_rotations(Calibration& out) {
  std::vector<std::size_t> tested;
  for (const RowResult& row : out.rows) {
    if (row.test) tested.push_back(row.row);
  }
  out.train_rotation = rotation_figures(out.start, out.estimate, out.training, out.training_rows);
  if (!tested.empty()) out.test_rotation = rotation_figures(out.start, out.estimate, out.testing, tested);
  const std::string sentence = rotation_sentence(out.train_rotation, "training");
  if (!sentence.empty()) out.notes.push_back(sentence);
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

// What the other rules without a judge say on the same problem: for the record.
void compare_rules(const Linearised& at, LambdaReport& report) {
  const SpectralProblem& problem = at.problem;
  if (problem.rank() == 0) return;
  const auto add = [&](const std::string& rule, double lambda) {
    report.choices.push_back({rule, lambda, std::sqrt(problem.residual_norm2(lambda)), std::sqrt(problem.solution_norm2(lambda))});
  };
  if (report.lambda > 0.0) add(report.rule + " (chosen)", report.lambda);
  for (const LambdaChoice& choice : {marginal_likelihood(problem), generalised_cross_validation(problem),
                                     l_curve(problem), quasi_optimality(problem)}) {
    if (choice.rule == report.rule) continue;
    if (choice.found && choice.lambda > 0.0) add(choice.rule, choice.lambda);
    else report.silent.push_back(choice.rule + ": " + (choice.note.empty() ? "no choice on this problem." : choice.note));
  }
  for (const char* rule : {"rpim", "rpim-train", "cv", "discrepancy"}) {
    if (rule != report.rule) report.silent.push_back(std::string(rule) + ": not run (it judges every row, or needs sigma); --lambda-rule runs it.");
  }
}

// The point of a target that was measured under two names, under its other name too.
void add_twin(const std::string& twin, const std::string& target, Robot& robot) {
  const auto of = std::find_if(robot.targets.begin(), robot.targets.end(), [&](const TargetPoint& p) { return p.name == target; });
  const Vector3 point = of != robot.targets.end() ? of->flange_p_m : robot.tool_p_m.value_or(Vector3{});
  const auto is = std::find_if(robot.targets.begin(), robot.targets.end(), [&](const TargetPoint& p) { return p.name == twin; });
  if (is != robot.targets.end()) is->flange_p_m = point;
  else robot.targets.push_back({twin, point});
}

// What the stages of a calibration hand on.
struct Work {
  const Robot& robot;
  const CalibrationOptions& options;
  std::vector<std::size_t> testing;  // rows of Calibration::testing
  Unknowns unknowns;
  Selection selection;
  RegularizedFit regularized;
  FamilyModel families;
  bool penalised = false;
};

UnknownsOptions unknowns_options(const CalibrationOptions& options) {
  UnknownsOptions out;
  out.fit_base = options.fit_base;
  out.fit_tool = options.fit_tool;
  out.parameters = options.parameters;
  out.noise_mm = options.noise_mm.value_or(0.02);
  return out;
}

// Which rows identify and which judge.
void split(const Dataset& data, const Dataset* test, Work& work, Calibration& out) {
  out.training = data;
  if (data.joint_count != static_cast<std::size_t>(work.robot.geometry.joint_count)) {
    throw InputError(data.path, 0, 0, "Found measurements of " + std::to_string(data.joint_count) + " joints; expected " +
                                          std::to_string(work.robot.geometry.joint_count) + ".");
  }
  split_off_test(data, work.options, out.training_rows, work.testing);
  if (test != nullptr) {
    out.testing = aligned(*test, data);
    std::vector<std::size_t> none;
    work.testing.clear();
    split_off_test(out.testing, {}, work.testing, none);
  } else if (!work.testing.empty()) {
    out.testing = data;
  }
}

// What enters beside the geometry (--model).
void identify_beyond_geometry(Work& work, Calibration& out) {
  const CalibrationOptions& asked = work.options;
  const bool by_likelihood = asked.method == "rpim" && rule_of(asked) == LambdaRule::marginal_likelihood;
  out.parameters_used = static_cast<double>(out.layout.columns());
  if (!by_likelihood && (asked.model == "auto" || asked.model == "geometry")) return;
  if (!by_likelihood) throw InputError("--model " + asked.model + " needs the method rpim and the rule reml: the families' variances are chosen by the same likelihood.");
  FamilyModelOptions options;
  options.model = asked.model;
  options.noise_mm = out.noise_mm;
  options.robust = asked.robust;
  options.leave_out = asked.cross_validate;
  options.seed = asked.seed;
  RegularizedFit& result = work.regularized;
  work.families = identify_families(work.robot, out.training, work.selection, work.unknowns, result.fit, out.start, options);
  out.model = work.families.report;
  if (!out.model.sentence.empty()) out.notes.push_back(out.model.sentence);
  out.notes.insert(out.notes.end(), out.model.left_out.begin(), out.model.left_out.end());
  if (!work.families.beyond_geometry) return;
  out.layout = work.families.layout;
  out.lambda.lambda = work.families.lambda;
  out.parameters_used = work.families.parameters_used;
  out.converged = work.families.fit.converged;
  out.iterations = work.families.fit.iterations;
  result.fit = work.families.fit;
  work.selection.robust_weight = work.families.robust_weight;
  set_shared_error(out.training, work.unknowns.layout, result.fit.estimate, out.noise_mm, work.selection);
  result.linearised = linearised(out.training, work.selection, work.unknowns.layout, result.fit.estimate, out.noise_mm);
}

// The nominal fit of base and targets, then the method.
void identify(Work& work, Calibration& out) {
  const Dataset& data = out.training;
  const UnknownsOptions unknowns_asked = unknowns_options(work.options);
  out.noise_mm = unknowns_asked.noise_mm;
  check_poses(data, out.training_rows, choose_unknowns(work.robot, data, out.training_rows, unknowns_asked).layout);
  out.contradiction = why_rotations_contradict(work.robot, data, out.training_rows, unknowns_asked);
  if (!out.contradiction.empty()) {
    leave_out_rotations(out.training);
    leave_out_rotations(out.testing);
  }
  work.unknowns = choose_unknowns(work.robot, data, out.training_rows, unknowns_asked);
  out.layout = work.unknowns.layout;
  out.decisions = work.unknowns.parameters.decisions;

  work.selection.rows = out.training_rows;
  const Fit nominal = fit_frames(work.unknowns, data, work.selection, out.noise_mm);
  out.start = nominal.estimate;
  const bool any_sigma = states_sigma(data);
  if (any_sigma) out.residual_unit_mm = mean_sigma_mm(data, out.training_rows, out.noise_mm);
  weigh_rotations(work.options, work.selection, out);

  RegularizedFit& result = work.regularized;
  work.penalised = work.options.method == "rpim" || work.options.method == "rpim-train";
  if (work.penalised) {
    RegularizedControl control;
    control.rule = rule_of(work.options);
    control.lambda = work.options.lambda.value_or(0.0);
    control.noise_mm = out.noise_mm;
    control.robust = work.options.robust;
    control.seed = work.options.seed;
    if (any_sigma) control.sigma = 1.0;
    else if (work.options.noise_mm) control.sigma = out.noise_mm;
    result = regularized_fit(data, work.selection, out.layout, out.start, control);
    out.converged = result.fit.converged;
    out.iterations = result.fit.iterations;
    out.lambda.rule = result.choice.rule;
    out.lambda.lambda = result.choice.lambda;
    out.lambda.note = result.choice.note;
    out.lambda.curve = points_of(result.choice.curve);
    out.lambda.l_curve = points_of(result.corner.curve);
    if (result.corner.found) out.lambda.corner = result.corner.lambda;
    if (!result.choice.note.empty()) out.notes.push_back(result.choice.note);
    identify_beyond_geometry(work, out);
    if (!out.converged) out.notes.push_back("The fit did not settle within its iteration bound.");
  } else {
    if (work.options.model != "auto") identify_beyond_geometry(work, out);
    work.selection.robust_weight.clear();
    const MethodOutcome outcome = run_method(work.options.method, data, work.selection, out.layout, out.start, out.noise_mm);
    out.converged = outcome.converged;
    out.iterations = outcome.iterations;
    if (!outcome.note.empty()) out.notes.push_back(outcome.note);
    out.lambda.rule = "none";
    result.fit.estimate = outcome.estimate;
    evaluate(MeasurementModel(outcome.estimate), data, work.selection, out.noise_mm, &result.fit.error_norms);
    result.fit.scale = robust_scale(result.fit.error_norms, 1.0, any_sigma ? 1.0 : out.noise_mm);
    set_shared_error(data, out.layout, outcome.estimate, out.noise_mm, work.selection);
    result.linearised = linearised(data, work.selection, out.layout, outcome.estimate, out.noise_mm);
  }
  out.estimate = result.fit.estimate;
  out.robust_weight = work.selection.robust_weight;
  out.shared = work.selection.shared;
  out.independent_share = independent_share(data, work.selection);
  if (work.selection.shared.any()) {
    out.notes.push_back("Rows of one pose share " + number(100.0 * (1.0 - work.selection.shared.own()), 0) +
                        " % of the variance of their errors: for what they share " + std::to_string(out.training_rows.size()) +
                        " rows inform like " + number(out.independent_share * static_cast<double>(out.training_rows.size())) + ".");
  }
  out.scale_mm = result.fit.scale * out.residual_unit_mm;
  out.outlier_threshold_mm = outlier_error_norm(out.scale_mm);
  out.corrected = corrected_robot(work.robot, out.estimate, out.layout, data);
}

// Rank, covariance and the parameters' intervals, from the linearisation at the result.
void tell_parameters(const Work& work, Calibration& out) {
  const Dataset& data = out.training;
  const Linearised& at = work.regularized.linearised;
  const MeasurementModel model(out.estimate);
  const Layout& layout = work.unknowns.layout;
  out.identifiability = identifiability(at.system, at.problem, layout, model, out.lambda.lambda, work.options.seed);
  out.identifiability.before =
      spectrum_of(linearised(data, work.selection, layout, out.start, out.noise_mm).system);
  out.covariance = work.families.beyond_geometry
                       ? work.families.covariance
                       : covariance_of(data, work.selection, layout, at.system, at.problem, work.regularized.fit, out.lambda.lambda, out.noise_mm);
  const std::size_t frames = out.layout.frame_columns();
  for (std::size_t i = 0; i < out.layout.geometry.size(); ++i) {
    const Parameter& parameter = out.layout.geometry[i];
    EstimatedParameter p;
    p.id = parameter.id;
    p.nominal = parameter.nominal;
    p.prior = parameter.prior;
    p.deviation = at.x0(static_cast<Eigen::Index>(i)) * parameter.prior;
    p.standard_deviation = std::sqrt(std::max(0.0, out.covariance.at(frames + i, frames + i))) * parameter.prior;
    p.low = p.deviation - out.covariance.coverage_factor * p.standard_deviation;
    p.high = p.deviation + out.covariance.coverage_factor * p.standard_deviation;
    p.identifiable = out.identifiability.identifiable[i];
    p.resolution = out.identifiability.resolution[i];
    out.parameters.push_back(p);
  }
  out.accuracy = predicted_accuracy(model, out.layout, out.covariance);
  if (out.lambda.rule != "none") compare_rules(at, out.lambda);
}

// The figures on the training rows, on those left out of folds, and on those held out.
void judge(const Work& work, Calibration& out) {
  const Dataset& data = out.training;
  out.train = judge_training(work.regularized.fit, out);
  if (work.families.left_out) {
    out.cross_validation = judge_left_out(*work.families.left_out, out);
  } else if (!work.families.beyond_geometry && work.penalised && work.options.cross_validate && work.selection.folds > 1) {
    LeaveOutControl control;
    control.robust = work.options.robust;
    control.choose_lambda = rule_of(work.options) == LambdaRule::marginal_likelihood;
    control.noise_mm = out.noise_mm;
    out.cross_validation = judge_left_out(leave_out(data, work.selection, work.unknowns, work.regularized.linearised,
                                                    work.regularized.fit, out.start, control), out);
  }
  if (!work.testing.empty()) {
    const Predictor predictor{MeasurementModel(out.estimate), out.layout, out.covariance, work.regularized.fit.scale, out.noise_mm,
                              states_sigma(data)};
    out.test = judge_held_out(predictor, work.testing, out);
  }
}

// Reasons, notes and the verdict.
void explain(const Work& work, Calibration& out) {
  const Dataset& data = out.training;
  find_reasons(work.options, out);
  if (work.penalised && work.options.robust) {
    if (3 * out.train.outliers.size() > out.training_rows.size()) {
      out.reasons.push_back(std::to_string(out.train.outliers.size()) + " of " + std::to_string(out.training_rows.size()) +
                            " rows lie beyond the outlier threshold of " + number(out.outlier_threshold_mm) +
                            " mm, more than a third: the measurements do not agree with one geometry. Check that the tracker "
                            "stood still, that robot file and joint order are right, and that the noise stated is not too "
                            "small.");
    }
  }
  note_dependences(out);
  add_standing_notes(data, out);
  figure_rotations(out);
  const std::vector<std::string> on_axis = targets_on_last_axis(out.estimate, data);
  out.notes.insert(out.notes.end(), on_axis.begin(), on_axis.end());
  out.accepted = out.usable() ? std::string() : work.options.accept;
  out.verdict = verdict_of(out);
}

Calibration calibrate_once(const Robot& robot, const Dataset& data, const CalibrationOptions& options, const Dataset* test) {
  Calibration out;
  out.robot = robot;
  out.method = options.method;
  Work work{robot, options, {}, {}, {}, {}, {}, false};
  split(data, test, work, out);
  identify(work, out);
  tell_parameters(work, out);
  judge(work, out);
  explain(work, out);
  return out;
}

// --rezero: a zero that is degrees off goes into the nominal geometry, and what is left is identified from there.
Calibration calibrate_rezeroed(const Robot& given, const Dataset& data, const CalibrationOptions& options, const Dataset* test) {
  Robot robot = given;
  std::vector<ZeroOffset> moved;
  constexpr int rounds = 3;  // the prior holds the first estimate back, by little
  for (int round = 0;; ++round) {
    Calibration out = calibrate_once(robot, data, options, test);
    const std::vector<ZeroOffset> zeros = options.rezero && round < rounds ? large_zero_offsets(out) : std::vector<ZeroOffset>{};
    if (zeros.empty()) {
      out.zeros = std::move(moved);
      std::vector<std::string> words;
      for (const ZeroOffset& zero : out.zeros) words.push_back(sentence_of(robot, zero));
      if (!words.empty()) {
        words.front()[0] = 'J';
        out.notes.insert(out.notes.begin(), joined(words) + ": moved into the nominal zero (--rezero); the deviations count from there.");
      }
      return out;
    }
    for (const ZeroOffset& zero : zeros) {
      const bool revolute = robot.geometry.joint[zero.link].kind == JointKind::revolute;
      Link& is = robot.geometry.link[zero.link];
      Link& was = robot.nominal[static_cast<std::size_t>(zero.link)];
      // Both by the same, so that what the file stated as a correction stays one.
      (revolute ? is.theta_rad : is.d_m) = (revolute ? was.theta_rad : was.d_m) += zero.offset;
      const auto known = std::find_if(moved.begin(), moved.end(), [&](const ZeroOffset& z) { return z.link == zero.link; });
      if (known == moved.end()) moved.push_back(zero);
      else known->offset += zero.offset;
    }
  }
}

// The readings that fit better, where that is beyond chance: an F test of the residuals' variances.
Calibration with_better_joints(const Robot& robot, const Dataset& data, const CalibrationOptions& options, const Dataset* test) {
  const bool forced = options.joints != JointReadings::better;
  const Dataset commanded_test = test != nullptr ? with_commanded(*test) : Dataset{};
  Calibration read = calibrate_rezeroed(robot, data, options, test);
  Calibration commanded = calibrate_rezeroed(robot, with_commanded(data), options, test != nullptr ? &commanded_test : nullptr);
  const double ratio = std::pow(read.covariance.sigma / commanded.covariance.sigma, 2);
  constexpr double level = 0.01;
  const bool clear = f_upper_tail(ratio, read.covariance.freedom, commanded.covariance.freedom) < level;
  const bool take_commanded = forced ? options.joints == JointReadings::commanded : clear;
  const bool better = commanded.scale_mm < read.scale_mm;
  Calibration& out = take_commanded ? commanded : read;
  out.notes.push_back(std::string("The ") + (better ? "commanded" : "read") + " joint angles fit better: residual scale " +
                      number(read.scale_mm) + " mm an axis with the read, " + number(commanded.scale_mm) +
                      " mm with the commanded ones. The " + (take_commanded ? "commanded" : "read") + " ones are used" +
                      (forced ? ", as --joints says." : clear == better ? "." : ", since chance may make as much (--joints decides otherwise)."));
  return std::move(out);
}

}  // namespace

Calibration calibrate(const Robot& robot, const Dataset& given, const CalibrationOptions& options, const Dataset* test) {
  if (options.joints == JointReadings::commanded && given.commanded.empty()) {
    throw InputError(given.path, 0, 0, "There are no commanded joint readings; expected columns q1_cmd, q2_cmd, ...");
  }
  const CountedOnce once = count_once(given);
  CountedOnce test_once;
  if (test != nullptr) {
    test_once = count_once(renamed(*test, once.twins));
    test = &test_once.data;
  }
  Calibration out = given.commanded.empty() ? calibrate_rezeroed(robot, once.data, options, test)
                                            : with_better_joints(robot, once.data, options, test);
  if (!once.note.empty()) out.notes.insert(out.notes.begin(), once.note);
  if (!test_once.note.empty()) out.notes.insert(out.notes.begin(), "Of the test rows: " + test_once.note);
  for (const auto& [twin, target] : once.twins) add_twin(twin, target, out.corrected);
  return out;
}

}  // namespace mdhcal::offline
