// SPDX-License-Identifier: MIT
#include "offline/identify/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "offline/base/random.hpp"
#include "offline/identify/factorization.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

// Directions below this share of the largest are named as weak.
constexpr double weak_share = 1e-2;
// A parameter is identifiable if no more than this part of it lies in lost directions.
constexpr double lost_share = 1e-6;

std::vector<double> readings_within_a_turn(const Geometry& geometry, Random& random) {
  std::vector<double> q(max_joints, 0.0);
  for (std::int32_t i = 0; i < geometry.joint_count; ++i) {
    const Joint& joint = geometry.joint[i];
    const double half = joint.kind == JointKind::revolute ? 3.14159265358979323846 : 0.5;
    const double low = joint.has_min == 1 ? std::max(joint.min, -half) : -half;
    const double high = joint.has_max == 1 ? std::min(joint.max, half) : half;
    q[static_cast<std::size_t>(i)] = low < high ? random.uniform(low, high) : low;
  }
  return q;
}

std::string readings_text(const Geometry& geometry, const std::vector<double>& q) {
  std::string text;
  for (std::int32_t i = 0; i < geometry.joint_count; ++i) {
    const bool revolute = geometry.joint[i].kind == JointKind::revolute;
    char word[48];
    std::snprintf(word, sizeof word, "%sq%d = %.0f %s", i > 0 ? ", " : "", static_cast<int>(i + 1),
                  q[static_cast<std::size_t>(i)] * (revolute ? deg_per_rad : mm_per_m), revolute ? "deg" : "mm");
    text += word;
  }
  return text;
}

// Looks for a pose whose target would move when the parameters move along `direction` (with base and targets following
// as the present poses make them): such a pose tells the direction.
std::string advice(const Layout& layout, const MeasurementModel& model, const Eigen::VectorXd& direction, bool alone,
                   bool at_flange, std::uint64_t seed) {
  constexpr int trials = 300;
  Random random(seed);
  Dataset trial;
  trial.rows.resize(1);
  const auto columns = static_cast<Eigen::Index>(layout.columns());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobian(3, columns);
  double best = 0.0;
  double typical = 0.0;
  std::vector<double> best_q;
  for (int i = 0; i < trials; ++i) {
    const std::vector<double> q = readings_within_a_turn(model.estimate().geometry, random);
    std::copy(q.begin(), q.end(), trial.rows[0].q.begin());
    double residual[3];
    model.residual(trial, 0, layout, residual, jacobian.data(), layout.columns());
    const double movement = (jacobian * direction).norm();
    typical = std::max(typical, jacobian.norm() * direction.norm());
    if (movement > best) best = movement, best_q = q;
  }
  // Of a direction that is lost in every pose only the Jacobian's rounding is left.
  constexpr double rounding_share = 1e-6;
  if (!(best > rounding_share * typical)) {
    // Only what the last link holds is told by another target; two rails or parallel axes stay as they are.
    return std::string("No pose of this arm with this target tells ") + (alone ? "it" : "them apart") + ": " +
           (at_flange ? "put the target further off the last axis, or fix " : "fix ") + (alone ? "it." : "one of them.");
  }
  return "A pose such as " + readings_text(model.estimate().geometry, best_q) + " would tell " + (alone ? "it." : "them apart.");
}

}  // namespace

Spectrum spectrum_of(const ReducedSystem& system) {
  Spectrum out;
  out.scalar_rows = system.row_count;
  if (system.geometry.cols() == 0) return out;
  const Eigen::MatrixXd scaled = system.geometry * column_norms(system.geometry).cwiseInverse().asDiagonal();
  // Unit columns hide how strongly the poses see anything at all; the mean column length puts that back.
  const Eigen::VectorXd norms = column_norms(system.geometry);
  const double mean_norm = norms.mean();
  const Eigen::VectorXd s = singular_values(scaled);
  double log_product = 0.0;
  double reciprocals = 0.0;
  for (double value : s) {
    out.singular_values.push_back(value * mean_norm);
    if (value > jacobian_tolerance * s(0) && value > 0.0) {
      ++out.rank;
      log_product += std::log(value * mean_norm);
      reciprocals += 1.0 / (value * mean_norm);
    }
  }
  if (out.rank == 0) return out;
  const double first = out.singular_values.front();
  const double last = out.singular_values[out.rank - 1];
  out.condition = first / last;
  out.observability = {std::exp(log_product / static_cast<double>(out.rank)) /
                           std::sqrt(static_cast<double>(std::max<std::size_t>(1, system.row_count))),
                       last / first, last, last * last / first, 1.0 / reciprocals};
  return out;
}

Identifiability identifiability(const ReducedSystem& system, const SpectralProblem& problem, const Layout& layout,
                                const MeasurementModel& model, double lambda, std::uint64_t seed) {
  Identifiability out;
  out.after = spectrum_of(system);
  out.frame_unknowns = layout.frame_columns();
  out.frame_rank = static_cast<std::size_t>(system.frame_rank);
  const auto n = static_cast<Eigen::Index>(layout.geometry.size());
  if (n == 0) return out;
  if (problem.rank() > 0) {
    const double last = problem.rank() < n ? 0.0 : problem.s(problem.rank() - 1);
    const double bottom = last * last + lambda;
    out.condition_regularized = bottom > 0.0 ? std::sqrt((problem.s(0) * problem.s(0) + lambda) / bottom) : 0.0;
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::ArrayXd share = problem.v.row(i).transpose().array().square();
    out.identifiable.push_back(1.0 - share.sum() <= lost_share);
    out.resolution.push_back((share * problem.s.array().square() / (problem.s.array().square() + lambda)).sum());
  }

  const Eigen::VectorXd norms = column_norms(system.geometry);
  const Eigen::MatrixXd scaled = system.geometry * norms.cwiseInverse().asDiagonal();
  const SingularVectors svd = full_svd(scaled);
  const Eigen::VectorXd& s = svd.s;
  for (Eigen::Index k = n - 1; k >= 0; --k) {
    const double relative = k < s.size() && s(0) > 0.0 ? s(k) / s(0) : 0.0;
    if (relative >= weak_share) break;
    const Eigen::VectorXd v = svd.v.col(k);
    WeakDirection weak;
    weak.relative_singular_value = relative > jacobian_tolerance ? relative : 0.0;
    const std::int32_t last = model.estimate().geometry.joint_count - 1;
    bool at_flange = false;
    std::vector<Eigen::Index> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](Eigen::Index a, Eigen::Index b) { return std::fabs(v(a)) > std::fabs(v(b)); });
    for (Eigen::Index i : order) {
      if (std::fabs(v(i)) < 0.2 * std::fabs(v(order.front()))) break;
      const ParameterId id = layout.geometry[static_cast<std::size_t>(i)].id;
      at_flange = at_flange || (id.link == last && model.estimate().geometry.joint[last].kind == JointKind::revolute);
      weak.members.push_back(name(id));
    }
    const Eigen::VectorXd direction = norms.cwiseInverse().asDiagonal() * v;
    Eigen::VectorXd full(static_cast<Eigen::Index>(layout.columns()));
    ReducedSystem still = system;
    still.frame_residual.setZero();
    full.tail(n) = direction;
    full.head(full.size() - n) = frame_step(still, direction);
    weak.advice = advice(layout, model, full, weak.members.size() == 1, at_flange, seed);
    out.weak.push_back(std::move(weak));
  }
  return out;
}

}  // namespace mdhcal::offline
