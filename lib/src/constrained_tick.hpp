// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. The servo tick where limits, singularities or free joints matter.
#pragma once

#include "tick.hpp"
#include "weighted_step.hpp"

namespace mdhcal {
namespace {

/// The longest step between two evaluations [rad, or lengths of the arm].
constexpr Real trust = Real(0.3);
/// Decompositions in one tick, at most.
constexpr std::int32_t max_decompositions = 16;
/// A decrease of the squared error by less than this part is the end.
constexpr Real material = Real(1e-4);
constexpr Real near_singular_below = Real(0.01);

inline void weigh(const TickState& state, const PoseError& error, Real position_weight, Real rotation_weight,
                  Real* weighted) {
  for (int k = 0; k < 3; ++k) weighted[k] = error.vector[k] * (position_weight / state.length_m);
  for (int k = 3; k < 6; ++k) weighted[k] = error.vector[k] * rotation_weight;
}

/// How far a joint may move in the direction of `step` from q.
inline Real gap(const TickState& state, std::int32_t j, Real q, Real step) {
  const Real room = step > Real{0} ? state.high[j] - q : q - state.low[j];
  const Real longest = trust * joint_unit(state, j);
  return room < longest ? room : longest;
}

/// The largest ratio of a joint's motion to its gap; at most 1 if the step fits.
inline Real fill(const TickState& state, const Real* q, const Real* step) {
  Real worst = 0;
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    const Real size = magnitude(step[j]);
    if (!(size > Real{0})) continue;
    const Real room = gap(state, j, q[j], step[j]);
    const Real ratio = room > Real{0} ? size / room : Real(1e30);
    if (ratio > worst) worst = ratio;
  }
  return worst;
}

/// Joints among `mask` that rest on a bound and are pushed against it.
inline std::uint32_t pushing(const TickState& state, const Real* q, const Real* push, std::uint32_t mask) {
  std::uint32_t found = 0;
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    const std::uint32_t bit = 1U << static_cast<std::uint32_t>(j);
    if ((mask & bit) == 0U) continue;
    const Real width = Real(1e-6) * (state.high[j] - state.low[j]);
    if (push[j] > Real{0} && state.high[j] - q[j] <= width) found |= bit;
    if (push[j] < Real{0} && q[j] - state.low[j] <= width) found |= bit;
  }
  return found;
}

/// The least damping, to within a quarter of a decade, that lets the step fit, applied; what still sticks out is
/// scaled back. Returns the damping.
inline Real fit_step(const TickState& state, const Real* q, const SingularBasis& basis, const Directions& directions,
                     Real damping, Real* step) {
  joint_step(state, basis, directions, damping, step);
  Real ratio = fill(state, q, step);
  if (ratio > Real{1}) {
    Real outside = damping > Real(1e-14) ? damping : Real(1e-14);
    Real inside = outside;
    for (int i = 0; i < 16 && ratio > Real{1}; ++i) {
      outside = inside;
      inside *= Real{16};
      joint_step(state, basis, directions, inside, step);
      ratio = fill(state, q, step);
    }
    for (int i = 0; i < 4; ++i) {
      const Real middle = square_root(inside * outside);
      joint_step(state, basis, directions, middle, step);
      ratio = fill(state, q, step);
      (ratio > Real{1} ? outside : inside) = middle;
    }
    damping = outside;
    joint_step(state, basis, directions, damping, step);
    ratio = fill(state, q, step);
    if (ratio > Real{1}) {
      for (std::int32_t j = 0; j < state.arm->joint_count; ++j) step[j] /= ratio;
    }
  }
  return damping;
}

inline Real clamp(Real x, Real low, Real high) { return x < low ? low : (x > high ? high : x); }

/// Adds motion in the null space of the task towards the posture, as far as the bounds leave room.
inline void add_posture(const TickState& state, const Real* q, const SingularBasis& basis, std::int32_t rank,
                        std::uint32_t free_mask, Real* step) {
  const std::int32_t joints = state.arm->joint_count;
  Real motion[max_joints] = {};
  for (std::int32_t k = rank; k < joints; ++k) {
    Real along = 0;
    for (std::int32_t j = 0; j < joints; ++j) {
      if (((free_mask >> static_cast<std::uint32_t>(j)) & 1U) == 0U) continue;
      along += basis.v[k][j] * ((state.options->posture[j] - q[j]) / joint_unit(state, j));
    }
    along *= state.options->posture_gain;
    for (std::int32_t j = 0; j < joints; ++j) motion[j] += along * basis.v[k][j];
  }
  // A tenth of a radian a tick keeps the curvature of the null space small against the Newton steps that follow.
  Real scale = 1;
  for (std::int32_t j = 0; j < joints; ++j) {
    if (((free_mask >> static_cast<std::uint32_t>(j)) & 1U) == 0U) motion[j] = 0;
    const Real size = magnitude(motion[j]);
    if (size * scale > Real(0.1)) scale = Real(0.1) / size;
    motion[j] *= joint_unit(state, j);
    // Half of the room that the step leaves, so that the correction after it fits as well.
    const Real room = Real(0.5) * (gap(state, j, q[j], motion[j]) - magnitude(step[j]));
    if (magnitude(motion[j]) * scale > room) scale = room > Real{0} ? room / magnitude(motion[j]) : Real{0};
  }
  for (std::int32_t j = 0; j < joints; ++j) step[j] += scale * motion[j];
}

inline Status classify(TickState& state, bool is_met, bool held, bool stationary) {
  if (is_met) return Status::ok;
  if (state.limit_mask != 0U) return Status::joint_limited;
  if (held && state.step_mask == 0U) return Status::out_of_reach;
  if (state.smallest_singular_value < near_singular_below) return Status::near_singular;
  if (state.step_mask != 0U) return Status::step_limited;
  return stationary ? Status::out_of_reach : Status::not_converged;
}

/// Which of the bounds that the joints rest on are the arm's own.
inline void split_masks(TickState& state, std::uint32_t resting) {
  const Arm<Real>& arm = *state.arm;
  state.limit_mask = 0;
  for (std::int32_t j = 0; j < arm.joint_count; ++j) {
    const std::uint32_t bit = 1U << static_cast<std::uint32_t>(j);
    const Real width = Real(1e-6) * (state.high[j] - state.low[j]);
    const bool at_min = (arm.min_mask & bit) != 0U && state.q[j] - arm.min[j] <= width;
    const bool at_max = (arm.max_mask & bit) != 0U && arm.max[j] - state.q[j] <= width;
    if ((resting & bit) != 0U && (at_min || at_max)) state.limit_mask |= bit;
  }
  state.step_mask = resting & ~state.limit_mask;
}

/// Damped least squares within the bounds, joints that push against a bound held there (an active set).
/// Returns the tick's status but for joints outside a limit.
[[gnu::noinline]] Status constrained_tick(TickState& state) {
  const Arm<Real>& arm = *state.arm;
  const std::int32_t joints = arm.joint_count;
  const std::uint32_t all = (1U << static_cast<std::uint32_t>(joints)) - 1U;
  const Real position_weight = 1;
  const Real rotation_weight = state.options->rotation_weight / state.options->position_weight;
  const std::int32_t task_rows = task_rank(state.options->task);
  Jacobian<Real> jacobian;
  SingularBasis basis;
  Directions directions{};
  Real weighted[6];
  Real step[max_joints];
  Real trial[max_joints];
  Frame<Real> frame;
  Real damping = 0;
  Real cost = 0;
  std::uint32_t resting = 0;
  bool stationary = false;
  bool posture = state.options->posture_gain > Real{0};

  evaluate(arm, state.q, frame, jacobian);
  ++state.evaluations;
  pose_error(state.target, frame, state.options->task, state.error);
  bool is_met = met(state, state.error) && !posture;
  weigh(state, state.error, position_weight, rotation_weight, weighted);
  cost = dot6(weighted, weighted);
  std::int32_t decompositions = 0;
  bool accepted = true;
  while (!is_met && decompositions < max_decompositions && state.evaluations < state.options->max_iterations) {
    Real z[3] = {frame.rotation[2], frame.rotation[5], frame.rotation[8]};
    if (accepted) {
      // Joints whose gradient pushes against a bound stay there; then those that the step itself would push.
      task_jacobian(state, jacobian, z, position_weight, rotation_weight, all, basis);
      for (std::int32_t j = 0; j < joints; ++j) step[j] = dot6(basis.us[j], weighted);
      resting = pushing(state, state.q, step, all);
      for (std::int32_t round = 0; round < joints; ++round) {
        const std::uint32_t free_mask = all & ~resting;
        std::int32_t rank = 0;
        for (std::int32_t j = 0; j < joints; ++j) rank += static_cast<std::int32_t>((free_mask >> static_cast<std::uint32_t>(j)) & 1U);
        if (rank > task_rows) rank = task_rows;
        if (round > 0 || resting != 0U) {
          task_jacobian(state, jacobian, z, position_weight, rotation_weight, free_mask, basis);
        }
        decompose(basis, joints);
        ++decompositions;
        plan_step(state, jacobian, z, position_weight, rotation_weight, basis, rank, weighted, directions);
        joint_step(state, basis, directions, damping, step);
        const std::uint32_t more = pushing(state, state.q, step, free_mask);
        if (more == 0U || decompositions >= max_decompositions) break;
        resting |= more;
      }
    }
    const Real used = fit_step(state, state.q, basis, directions, damping, step);
    if (posture) add_posture(state, state.q, basis, directions.count, all & ~resting, step);
    for (std::int32_t j = 0; j < joints; ++j) trial[j] = clamp(state.q[j] + step[j], state.low[j], state.high[j]);
    PoseError error;
    Frame<Real> trial_frame;
    evaluate(arm, trial, trial_frame, jacobian);
    ++state.evaluations;
    pose_error(state.target, trial_frame, state.options->task, error);
    weigh(state, error, position_weight, rotation_weight, weighted);
    const Real trial_cost = dot6(weighted, weighted);
    is_met = met(state, error);
    accepted = is_met || posture || trial_cost < cost;
    posture = false;
    if (accepted) {
      stationary = !(cost - trial_cost > material * cost);
      for (std::int32_t j = 0; j < joints; ++j) state.q[j] = trial[j];
      state.error = error;
      frame = trial_frame;
      cost = trial_cost;
      damping *= Real(0.0625);
      if (stationary) break;
    } else {
      damping = used > Real(1e-10) ? Real{16} * used : Real(1e-9);
      if (damping > Real{1e4}) {
        stationary = true;
        break;
      }
    }
  }
  if (!accepted) {
    evaluate(arm, state.q, frame, jacobian);
    weigh(state, state.error, position_weight, rotation_weight, weighted);
  }
  const Real z[3] = {frame.rotation[2], frame.rotation[5], frame.rotation[8]};
  task_jacobian(state, jacobian, z, position_weight, rotation_weight, all, basis);
  for (std::int32_t j = 0; j < joints; ++j) step[j] = is_met ? Real{0} : dot6(basis.us[j], weighted);
  split_masks(state, pushing(state, state.q, step, all));
  task_jacobian(state, jacobian, z, Real{1}, Real{1}, all, basis);
  decompose(basis, joints);
  state.smallest_singular_value = basis.s[(joints < task_rows ? joints : task_rows) - 1];
  return classify(state, is_met, directions.held, stationary);
}

}  // namespace
}  // namespace mdhcal
