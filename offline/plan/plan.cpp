// SPDX-License-Identifier: MIT
#include "offline/plan/plan.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "offline/base/error.hpp"
#include "offline/simulate/simulate.hpp"

namespace mdhcal::offline {

namespace {

// Base and target are known to about a metre and a radian before measuring: enough to keep a design of few poses
// regular, too little to be information.
constexpr double frame_prior = 1e-3;

std::vector<Joints> drawn(const Robot& robot, const Arm<double>& arm, const PlanOptions& options,
                            std::size_t& unreachable) {
  Random random(options.seed);
  std::vector<Joints> found;
  while (found.size() < options.candidate_count) {
    const Joints q = random_readings(robot.geometry, random);
    if (reachable(robot, arm, options.reach, q)) {
      found.push_back(q);
    } else if (++unreachable >= 1000 && unreachable > 100 * (found.size() + 1)) {
      throw InputError(robot.path, 0, 0,
                       "Fewer than 1 in 100 random configurations can be measured from there; expected a tracker, a "
                       "cone and keep-out boxes that leave the arm room.");
    }
  }
  return found;
}

// The data set that the candidates would give, positions where the nominal robot puts the target.
Dataset imagined(const Robot& robot, const std::vector<Joints>& candidates) {
  Dataset data;
  data.path = robot.path;
  data.joint_count = static_cast<std::size_t>(robot.geometry.joint_count);
  data.targets = {""};
  Arm<double> arm{};
  if (make_arm(robot.geometry, arm) != Status::ok) throw InputError(robot.path, 0, 0, "The geometry is not valid.");
  for (const Joints& q : candidates) {
    Measurement row;
    row.id = std::to_string(data.rows.size() + 1);
    row.group = static_cast<std::uint32_t>(data.rows.size());
    row.q = q;
    Pose<double> pose{};
    if (forward(arm, q.data(), pose) != Status::ok) throw InputError(robot.path, 0, 0, "A candidate is out of range.");
    std::copy(std::begin(pose.position_m), std::end(pose.position_m), row.position_m.begin());
    data.groups.push_back(row.id);
    data.rows.push_back(row);
  }
  return data;
}

ExpectedPosition summary(const Eigen::VectorXd& errors) {
  std::vector<double> sorted(errors.begin(), errors.end());
  std::sort(sorted.begin(), sorted.end());
  const double rank = 0.95 * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const double above = sorted[std::min(below + 1, sorted.size() - 1)];
  ExpectedPosition out;
  out.rms_mm = std::sqrt(errors.squaredNorm() / static_cast<double>(errors.size()));
  out.p95_mm = sorted[below] + (rank - static_cast<double>(below)) * (above - sorted[below]);
  out.max_mm = sorted.back();
  return out;
}

// Each pose next to the nearest of those left, from the zero configuration on: less travel, less time for drift.
std::vector<Joints> ordered(std::vector<Joints> poses) {
  const auto distance = [](const Joints& a, const Joints& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum;
  };
  Joints at{};
  for (auto next = poses.begin(); next != poses.end(); ++next) {
    std::iter_swap(next, std::min_element(next, poses.end(), [&](const Joints& a, const Joints& b) {
      return distance(a, at) < distance(b, at);
    }));
    at = *next;
  }
  return poses;
}

ExpectedPosition median_of_random_sets(const Experiment& experiment, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<ExpectedPosition> sets;
  for (int k = 0; k < 50; ++k) {
    std::vector<std::size_t> all(experiment.candidates());
    std::iota(all.begin(), all.end(), 0u);
    for (std::size_t i = 0; i < count; ++i) std::swap(all[i], all[i + random.index(all.size() - i)]);
    all.resize(count);
    sets.push_back(summary(
        expected_errors(experiment.targets, experiment.rows_per_pose, information_factor(experiment, all))));
  }
  std::nth_element(sets.begin(), sets.begin() + 25, sets.end(),
                   [](const ExpectedPosition& a, const ExpectedPosition& b) { return a.rms_mm < b.rms_mm; });
  return sets[25];
}

}  // namespace

Experiment experiment_of(const Robot& robot, const UnknownsOptions& options, const std::vector<Joints>& candidates) {
  const Dataset data = imagined(robot, candidates);
  std::vector<std::size_t> rows(data.rows.size());
  std::iota(rows.begin(), rows.end(), 0u);
  const Unknowns unknowns = choose_unknowns(robot, data, rows, options);
  const MeasurementModel model(unknowns.nominal);
  const auto columns = static_cast<Eigen::Index>(unknowns.layout.columns());
  const auto frames = static_cast<Eigen::Index>(unknowns.layout.frame_columns());

  Experiment experiment;
  experiment.rows_per_pose = 3;
  experiment.of_interest = frames;
  experiment.targets.resize(3 * static_cast<Eigen::Index>(rows.size()), columns);
  std::vector<double> jacobian(max_row_residuals * static_cast<std::size_t>(columns));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    double residual[max_row_residuals];
    model.residual(data, i, unknowns.layout, residual, jacobian.data(), static_cast<std::size_t>(columns));
    for (Eigen::Index k = 0; k < 3; ++k) {
      for (Eigen::Index c = 0; c < columns; ++c) {
        experiment.targets(3 * static_cast<Eigen::Index>(i) + k, c) = jacobian[static_cast<std::size_t>(k * columns + c)];
      }
    }
  }
  experiment.rows = experiment.targets / options.noise_mm;
  experiment.prior = Eigen::VectorXd::Ones(columns);
  experiment.prior.head(frames).setConstant(frame_prior);
  return experiment;
}

Plan make_plan(const Robot& robot, const PlanOptions& options, const std::vector<Joints>& given,
               const std::function<void(std::size_t, std::size_t)>& progress) {
  Arm<double> arm{};
  if (make_arm(robot.geometry, arm) != Status::ok) throw InputError(robot.path, 0, 0, "The geometry is not valid.");
  Plan plan;
  std::vector<Joints> candidates;
  if (given.empty()) {
    candidates = drawn(robot, arm, options, plan.unreachable);
  } else {
    for (const Joints& q : given) {
      if (reachable(robot, arm, options.reach, q)) candidates.push_back(q);
    }
    plan.unreachable = given.size() - candidates.size();
  }
  plan.candidates = candidates.size();
  if (options.count < 1 || candidates.size() < options.count) {
    throw InputError(robot.path, 0, 0, std::to_string(candidates.size()) + " candidates can be measured; expected at least " +
                                           std::to_string(std::max<std::size_t>(options.count, 1)) + '.');
  }
  Experiment experiment = experiment_of(robot, options.unknowns, candidates);
  // Exchange ends after three or four sweeps as a rule.
  constexpr std::size_t usual_sweeps = 4;
  std::size_t done = 0;
  const auto step = [&] {
    ++done;
    if (progress) progress(done, std::max(done, (usual_sweeps + 1) * (options.count + 10)));
  };
  const auto chosen = exchange(experiment, options.criterion, options.count, {}, step);
  const Eigen::MatrixXd factor = information_factor(experiment, chosen);
  plan.expected = summary(expected_errors(experiment.targets, experiment.rows_per_pose, factor));
  plan.random_median = median_of_random_sets(experiment, options.count, options.seed);
  const std::size_t more = std::min<std::size_t>(10, candidates.size() - options.count);
  auto all = exchange(experiment, options.criterion, more, chosen, step);
  all.insert(all.end(), chosen.begin(), chosen.end());
  plan.with_ten_more =
      summary(expected_errors(experiment.targets, experiment.rows_per_pose, information_factor(experiment, all)));

  const Eigen::Index n = factor.cols();
  const Eigen::MatrixXd inverse_transposed =
      factor.transpose().triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(n, n));
  const ParameterList list = choose_parameters(
      robot, {options.unknowns.fit_base, options.unknowns.fit_tool}, options.unknowns.parameters);
  for (std::size_t k = 0; k < list.free.size(); ++k) {
    const Parameter& parameter = list.free[k];
    const double sd = inverse_transposed.col(experiment.of_interest + static_cast<Eigen::Index>(k)).norm();
    plan.parameters.push_back({name(parameter.id), is_angle(parameter.id), parameter.prior, sd * parameter.prior});
  }
  std::vector<Joints> poses;
  for (const std::size_t c : chosen) poses.push_back(candidates[c]);
  plan.poses = ordered(std::move(poses));
  return plan;
}

}  // namespace mdhcal::offline
