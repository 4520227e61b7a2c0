// SPDX-License-Identifier: MIT
#include "offline/identify/families/family_model.hpp"

#include <algorithm>
#include <cmath>

#include "offline/base/error.hpp"
#include "offline/base/sentences.hpp"
#include "offline/identify/families/family_choice.hpp"
#include "offline/identify/folds.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

// The choice is between errors that differ by a tenth: a few hundred poses tell that, and more only cost time.
constexpr std::size_t poses_to_choose = 300;
// With so many poses what the variances and the terms still gain is below a micrometre, and memory stays below 100 MB.
constexpr std::size_t poses_to_identify = 2000;
// A joint that moved less than one period of the highest order told nothing periodic of itself.
constexpr double least_range_rad = 2.0 * pi / static_cast<double>(max_orders);

// The whole of what may enter: sag of every joint that turns, functions of those that moved. Sets the readings seen.
Layout all_terms(const Robot& robot, const Dataset& data, const Selection& selection, Layout layout, Estimate& at, std::vector<std::string>& said) {
  const std::int32_t joints = robot.geometry.joint_count;
  std::copy(robot.gravity_direction.begin(), robot.gravity_direction.end(), at.transmission.gravity.direction);
  std::vector<std::int32_t> moved;
  std::vector<std::string> still;
  for (std::int32_t i = 0; i < joints; ++i) {
    if (robot.geometry.joint[i].kind != JointKind::revolute) continue;
    for (std::int32_t j = i; j < joints; ++j) layout.terms.push_back({TermFamily::gravity, i, j, false, 1e-3});
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const std::size_t row : selection.rows) {
      low = std::min(low, data.rows[row].q[static_cast<std::size_t>(i)]);
      high = std::max(high, data.rows[row].q[static_cast<std::size_t>(i)]);
    }
    if (!(high - low >= least_range_rad)) {
      still.push_back(std::to_string(i + 1));
      continue;
    }
    at.transmission.function[i].seen_min_rad = low;
    at.transmission.function[i].seen_max_rad = high;
    moved.push_back(i);
  }
  if (!still.empty()) {
    said.push_back("Joint " + joined(still) + " moved less than " + number(least_range_rad * deg_per_rad, 0) +
                   " degrees, one period of order " + std::to_string(max_orders) + ": no joint function there.");
  }
  for (std::size_t k = 1; k <= max_orders; ++k) {
    for (const std::int32_t i : moved) {
      for (const bool sine : {false, true}) layout.terms.push_back({family_of_order(k), i, static_cast<std::int32_t>(k), sine, 1e-3});
    }
  }
  return layout;
}

Layout terms_of(const Layout& all, const FamilyChoice& choice) {
  Layout out = all;
  std::erase_if(out.terms, [&](const Term& term) {
    return term.family == TermFamily::gravity ? !choice.gravity : term.index > choice.orders;
  });
  return out;
}

// Functions that take no part are as the robot file has them.
void keep_functions(Estimate& at, const Estimate& stated, const Layout& layout) {
  for (std::size_t i = 0; i < max_joints; ++i) {
    const bool used = std::any_of(layout.terms.begin(), layout.terms.end(), [&](const Term& term) {
      return term.family != TermFamily::gravity && static_cast<std::size_t>(term.joint) == i;
    });
    if (!used) at.transmission.function[i] = stated.transmission.function[i];
  }
}

// At most so many poses, drawn evenly in the order of the file.
Selection thinned(const Dataset& data, const Selection& selection, std::size_t most) {
  const std::vector<std::uint32_t> pose = poses_of(data, selection.rows);
  const std::size_t poses = pose.empty() ? 0 : *std::max_element(pose.begin(), pose.end()) + 1U;
  if (poses <= most) return selection;
  Selection out;
  for (std::size_t i = 0; i < selection.rows.size(); ++i) {
    // Bresenham: pose p is drawn where p * most / poses steps up.
    if ((pose[i] + 1U) * most / poses == pose[i] * most / poses) continue;
    out.rows.push_back(selection.rows[i]);
    if (!selection.robust_weight.empty()) out.robust_weight.push_back(selection.robust_weight[i]);
  }
  return out;
}

FamilyChoice asked_for(const std::string& model) {
  const auto orders = static_cast<std::int32_t>(max_orders);
  if (model == "gravity") return {true, 0};
  if (model == "joints") return {false, orders};
  if (model == "full") return {true, orders};
  throw InputError("--model names \"" + model + "\"; expected auto, geometry, gravity, joints or full.");
}

void name_variances(const FamilyVariances& variances, const FamilyChoice& choice, ModelReport& report) {
  static constexpr const char* names[] = {"geometry", "gravity", "orders 1 to 2", "orders 3 to 10", "orders 11 to 20", "orders 21 to 40"};
  static constexpr const char* units[] = {"1", "mrad/m", "mrad", "mrad", "mrad", "mrad"};
  for (std::size_t f = 0; f < family_count; ++f) {
    const bool in = f == 0 || (f == 1 && choice.gravity) || (f == 2 && choice.orders > 0) || (f > 2 && choice.orders > 10);
    if (in) report.families.push_back({choice.orders == 1 && f == 2 ? "order 1" : names[f], variances.sd[f], units[f]});
  }
}

// The estimate after a step; what the linearisation left is taken up by one more.
struct Identified {
  Estimate estimate;
  FamilyFit fit;
};

Identified identified(const Dataset& data, const Selection& selection, const Layout& layout, Estimate at, const FamilyChoice& choice,
                      FamilyFit start, const FamilyFitControl& control, double noise_mm) {
  Identified out;
  const FamilyRows first = family_rows(data, selection, layout, at, noise_mm);
  start.weight.clear();
  start = fit_families(first, {}, choice, start, control);
  at = moved(at, layout, start.step.data());
  const FamilyRows second = family_rows(data, selection, layout, at, noise_mm);
  out.fit = fit_families(second, {}, choice, start, control, true);
  out.estimate = moved(at, layout, out.fit.step.data());
  return out;
}

// Every row by the fit that left its pose out, as leave_out() does for the geometry alone.
LeftOut without_folds(const Dataset& data, const Selection& selection, const Unknowns& unknowns, const Layout& layout, const Identified& whole,
                      const FamilyChoice& choice, const Estimate& start, FamilyFitControl control, const FamilyModelOptions& options) {
  const FamilyRows rows = family_rows(data, selection, layout, whole.estimate, options.noise_mm);
  std::uint32_t folds = 0;
  const std::vector<std::uint32_t> fold = family_folds(rows.poses, options.seed, folds);
  const std::vector<std::uint32_t> pose = poses_of(data, selection.rows);
  LeftOut out;
  out.folds = folds;
  out.after.resize(selection.rows.size());
  out.before_mm.resize(selection.rows.size());
  out.before_turn_mm.resize(selection.rows.size());
  const bool any_sigma = states_sigma(data);
  control.rounds = 2;
  control.steps = 1;
  for (std::uint32_t f = 0; f < folds; ++f) {
    std::vector<bool> use;
    for (const Cell& cell : rows.cells) use.push_back(fold[cell.pose] != f);
    const FamilyFit part = fit_families(rows, use, choice, whole.fit, control, true);
    Selection rest;
    for (std::size_t i = 0; i < selection.rows.size(); ++i) {
      if (fold[pose[i]] != f) rest.rows.push_back(selection.rows[i]);
    }
    FitControl frames;
    frames.noise_mm = options.noise_mm;
    frames.loss = Loss::huber;
    frames.tolerance = 1e-2;
    const MeasurementModel before(fit(data, rest, unknowns.frames, start, frames).estimate);
    const Predictor predictor{MeasurementModel(moved(whole.estimate, layout, part.step.data())), layout, part.covariance, part.scale,
                              options.noise_mm, any_sigma};
    for (std::size_t i = 0; i < selection.rows.size(); ++i) {
      if (fold[pose[i]] != f) continue;
      double residual[max_row_residuals] = {};
      const std::size_t count = before.residual(data, selection.rows[i], residual);
      for (std::size_t k = 0; k < std::min<std::size_t>(count, 3); ++k) out.before_mm[i][k] = residual[k];
      for (std::size_t k = 3; k < count; ++k) out.before_turn_mm[i][k - 3] = residual[k];
      out.after[i] = predict(predictor, data, selection.rows[i]);
    }
  }
  return out;
}

std::string sentence_of(const ModelReport& report) {
  const ModelReport::Candidate& chosen = report.candidates[report.chosen];
  if (report.chosen == 0) {
    const ModelReport::Candidate* best = nullptr;
    for (std::size_t i = 1; i < report.candidates.size(); ++i) {
      if (best == nullptr || report.candidates[i].error_mm < best->error_mm) best = &report.candidates[i];
    }
    std::string out = "Geometry alone: " + number(chosen.error_mm) + " mm cross-validated";
    if (best != nullptr) out += "; " + best->name + " " + number(best->error_mm) + ", which does not gain enough to enter";
    return out + ".";
  }
  std::string name = chosen.name;
  name[0] = static_cast<char>(name[0] - 'a' + 'A');
  return name + ": " + number(chosen.error_mm) + " mm cross-validated, geometry alone " + number(report.candidates.front().error_mm) + ".";
}

}  // namespace

FamilyModel identify_families(const Robot& robot, const Dataset& data, const Selection& selection, const Unknowns& unknowns,
                              const Fit& geometry, const Estimate& start, const FamilyModelOptions& options) {
  FamilyModel out;
  out.report.asked = options.model;
  if (options.model == "geometry") return out;
  Estimate at = geometry.estimate;
  const Layout all = all_terms(robot, data, selection, unknowns.layout, at, out.report.left_out);
  const bool functions = std::any_of(all.terms.begin(), all.terms.end(), [](const Term& term) { return term.family != TermFamily::gravity; });

  const Selection few = thinned(data, selection, poses_to_choose);
  const FamilyRows rows = family_rows(data, few, all, at, options.noise_mm);
  std::vector<FamilyChoice> choices = candidates_for(rows.poses, functions);
  if (choices.size() < 2 || choices.back().orders <= 1) {
    out.report.left_out.push_back(std::to_string(rows.poses) + (choices.size() < 2
        ? " poses are too few for gravity and joint functions (12): the geometry alone is identified."
        : " poses are too few for joint functions beyond order 1 (16)."));
  }
  if (options.model != "auto") {
    const FamilyChoice asked = asked_for(options.model);
    if (std::find(choices.begin(), choices.end(), asked) == choices.end()) {
      throw InputError(data.path, 0, 0, "--model " + options.model + " asks for what these measurements do not tell: " +
                                            (functions ? std::to_string(rows.poses) + " poses are too few." : "no joint turned far enough."));
    }
    choices = {FamilyChoice{}, asked};
  }
  if (choices.size() < 2) return out;

  FamilyFitControl control;
  control.robust = options.robust;
  control.floor = states_sigma(data) ? 1.0 : options.noise_mm;
  const FamilyComparison comparison = compare_families(rows, choices, control, options.seed);
  for (const FamilyCandidate& candidate : comparison.candidates) out.report.candidates.push_back({name(candidate.choice), candidate.error_mm});
  out.report.chosen = options.model == "auto" ? comparison.chosen : 1;
  out.report.sentence = sentence_of(out.report);
  if (out.report.chosen == 0) return out;

  // Base, targets, geometry and terms together, linearised anew where the first fit has led.
  const FamilyCandidate& chosen = comparison.candidates[out.report.chosen];
  out.layout = terms_of(all, chosen.choice);
  keep_functions(at, geometry.estimate, out.layout);
  if (!chosen.choice.gravity) at.transmission.gravity = geometry.estimate.transmission.gravity;
  const Selection most = thinned(data, selection, poses_to_identify);
  const bool some = most.rows.size() < selection.rows.size();
  Identified whole = identified(data, most, out.layout, at, chosen.choice, chosen.fit, control, options.noise_mm);
  if (some) {
    out.report.left_out.push_back("Joint functions and sag are identified from " + std::to_string(poses_to_identify) + " of the poses, base, targets and geometry from all.");
  } else if (options.leave_out) {
    out.left_out = without_folds(data, selection, unknowns, out.layout, whole, chosen.choice, start, control, options);
  }
  const bool accepted = check_transmission(whole.estimate.geometry, whole.estimate.transmission) == Status::ok;
  if (!accepted && options.model == "auto") {
    out.report.left_out.push_back(out.report.candidates[out.report.chosen].name +
                                  ": what is found is beyond what a controller accepts, so the geometry alone is used.");
    out.report.chosen = 0;
    return out;
  }
  const FamilyVariances& variances = whole.fit.variances;
  out.lambda = std::pow(variances.noise / variances.sd[0], 2);
  Selection every = selection;
  if (some) {
    FitControl stage;
    stage.noise_mm = options.noise_mm;
    stage.loss = options.robust ? Loss::tukey : Loss::squares;
    stage.lambda = out.lambda;
    whole.estimate = fit(data, every, unknowns.layout, whole.estimate, stage).estimate;
  }
  out.beyond_geometry = true;
  out.fit.estimate = whole.estimate;
  out.fit.scale = whole.fit.scale;
  out.fit.lambda = out.lambda;
  out.fit.iterations = geometry.iterations + 2;
  out.fit.converged = whole.fit.settled;
  every.robust_weight.clear();
  evaluate(MeasurementModel(whole.estimate), data, every, options.noise_mm, &out.fit.error_norms);
  out.robust_weight = options.robust ? robust_weights(Loss::tukey, out.fit.error_norms, out.fit.scale) : std::vector<double>{};
  out.parameters_used = whole.fit.parameters_used;
  out.covariance = std::move(whole.fit.covariance);
  name_variances(variances, chosen.choice, out.report);
  if (!accepted) out.report.left_out.push_back("The joint functions or the sag found are beyond what a controller accepts.");
  return out;
}

}  // namespace mdhcal::offline
