// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. The servo tick where limits, singularities or free joints matter.
#pragma once

#include "tick.hpp"
#include "weighted_step.hpp"

namespace mdhcal {
namespace {

/// The longest step between two evaluations [rad, or lengths of the arm], and the least that it is bounded to.
constexpr Real longest_trust = Real(0.3);
constexpr Real least_trust = Real(0.002);
/// Below this slope a direction that does not fold counts as a singularity to be passed.
constexpr Real passable_below = Real(0.1);
constexpr Real near_singular_below = Real(0.01);

inline void weigh(const TickState& state, const PoseError& error, Real rotation_weight, Real* weighted) {
  for (int k = 0; k < 3; ++k) weighted[k] = error.vector[k] / state.length_m;
  for (int k = 3; k < 6; ++k) weighted[k] = error.vector[k] * rotation_weight;
}

/// How far a joint may move in the direction of `step` from q.
inline Real gap(const TickState& state, Real trust, std::int32_t j, Real q, Real step) {
  const Real room = step > Real{0} ? state.high[j] - q : q - state.low[j];
  const Real longest = trust * joint_unit(state, j);
  return room < longest ? room : longest;
}

/// The largest ratio of a joint's motion to its gap; at most 1 if the step fits.
inline Real fill(const TickState& state, Real trust, const Real* q, const Real* step) {
  Real worst = 0;
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    const Real size = magnitude(step[j]);
    if (!(size > Real{0})) continue;
    const Real room = gap(state, trust, j, q[j], step[j]);
    const Real ratio = room > Real{0} ? size / room : Real(1e30);
    if (ratio > worst) worst = ratio;
  }
  return worst;
}

/// Joints among `mask` that rest on a bound and are pushed against it. With `urge` a step limit counts from a little
/// before it for a joint that is pushed at least that many times as far as it can go: the rest of the way is not worth
/// the damping that it would cost the other joints. `up` receives those pushed upwards.
inline std::uint32_t pushing(const TickState& state, const Real* q, const Real* push, Real urge, std::uint32_t mask,
                             std::uint32_t& up) {
  const Arm<Real>& arm = *state.arm;
  std::uint32_t found = 0;
  for (std::int32_t j = 0; j < arm.joint_count; ++j) {
    const std::uint32_t bit = 1U << static_cast<std::uint32_t>(j);
    if ((mask & bit) == 0U || !(magnitude(push[j]) > Real{0})) continue;
    const bool upwards = push[j] > Real{0};
    const Real width = state.high[j] - state.low[j];
    const Real room = upwards ? state.high[j] - q[j] : q[j] - state.low[j];
    const bool is_limit = upwards ? (arm.max_mask & bit) != 0U && !(state.high[j] < arm.max[j])
                                  : (arm.min_mask & bit) != 0U && !(state.low[j] > arm.min[j]);
    const Real near = Real(0.025) * (width < Real(0.02) ? width : Real(0.02));
    const bool close = !is_limit && room <= near && magnitude(push[j]) >= urge * room;
    if (room <= Real(1e-6) * width || close) {
      found |= bit;
      if (upwards) up |= bit;
    }
  }
  return found;
}

/// Joints that are held against a bound go all the way to it.
inline void rest_on_bounds(const TickState& state, const Real* q, std::uint32_t mask, std::uint32_t up, Real* step) {
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    const std::uint32_t bit = 1U << static_cast<std::uint32_t>(j);
    if ((mask & bit) != 0U) step[j] = ((up & bit) != 0U ? state.high[j] : state.low[j]) - q[j];
  }
}

/// The least damping, to within a quarter of a decade, that lets the step fit, applied; what still sticks out is
/// scaled back. Returns the damping.
[[gnu::noinline]] Real fit_step(const TickState& state, Real trust, const Real* q, const SingularBasis& basis, const Directions& directions,
                     Real damping, Real* step) {
  joint_step(state, basis, directions, damping, step);
  Real ratio = fill(state, trust, q, step);
  if (ratio > Real{1}) {
    Real outside = damping > Real(1e-14) ? damping : Real(1e-14);
    Real inside = outside;
    for (int i = 0; i < 16 && ratio > Real{1}; ++i) {
      outside = inside;
      inside *= Real{16};
      joint_step(state, basis, directions, inside, step);
      ratio = fill(state, trust, q, step);
    }
    for (int i = 0; i < 4; ++i) {
      const Real middle = square_root(inside * outside);
      joint_step(state, basis, directions, middle, step);
      ratio = fill(state, trust, q, step);
      (ratio > Real{1} ? outside : inside) = middle;
    }
    damping = outside;
    joint_step(state, basis, directions, damping, step);
    ratio = fill(state, trust, q, step);
    if (ratio > Real{1}) {
      for (std::int32_t j = 0; j < state.arm->joint_count; ++j) step[j] /= ratio;
    }
  }
  return damping;
}

inline Real clamp(Real x, Real low, Real high) { return x < low ? low : (x > high ? high : x); }

/// Adds motion in the null space of the task towards the posture, as far as the bounds leave room.
[[gnu::noinline]] void add_posture(const TickState& state, const Real* q, const SingularBasis& basis, std::int32_t rank,
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
    const Real room = Real(0.5) * (gap(state, longest_trust, j, q[j], motion[j]) - magnitude(step[j]));
    if (magnitude(motion[j]) * scale > room) scale = room > Real{0} ? room / magnitude(motion[j]) : Real{0};
  }
  for (std::int32_t j = 0; j < joints; ++j) step[j] += scale * motion[j];
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

/// The strong directions once more from where a step ended: takes back the error that its curvature left there
/// (second-order correction, Fletcher 1982). Without it a long step along a weak direction would be refused for an
/// error that the strong ones undo at once.
[[gnu::noinline]] void correct_step(const TickState& state, const SingularBasis& basis, const Directions& directions,
                         Real damping, const Real* weighted, std::uint32_t free_mask, Real* trial) {
  Directions strong = directions;
  strong.count = directions.count > 0 ? directions.count - 1 : 0;
  for (std::int32_t k = 0; k < strong.count; ++k) strong.wanted[k] = dot6(basis.us[k], weighted);
  Real step[max_joints];
  joint_step(state, basis, strong, damping, step);
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    if (((free_mask >> static_cast<std::uint32_t>(j)) & 1U) == 0U) continue;
    const Real longest = longest_trust * joint_unit(state, j);
    trial[j] = clamp(trial[j] + clamp(step[j], -longest, longest), state.low[j], state.high[j]);
  }
}

/// How far one step may go: four times as far as the strong directions ask for. The weak one, whose errors are
/// magnified, then stays near, and on this branch.
[[gnu::noinline]] Real strong_step(const TickState& state, const SingularBasis& basis, const Directions& directions) {
  Directions strong = directions;
  strong.count = directions.count > 0 ? directions.count - 1 : 0;
  Real step[max_joints];
  joint_step(state, basis, strong, Real{0}, step);
  Real longest = 0;
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    const Real size = magnitude(step[j]) / joint_unit(state, j);
    if (size > longest) longest = size;
  }
  return clamp(Real{4} * longest, least_trust, longest_trust);
}

/// The result of one attempt.
struct Attempt {
  bool met;
  bool held;        ///< the target is beyond a fold
  bool stationary;  ///< nothing nearby is materially better
  bool passable;    ///< the last joints are near a singularity that is no fold, as a wrist's
};

inline std::int32_t count_bits(std::uint32_t mask) {
  std::int32_t count = 0;
  for (; mask != 0U; mask &= mask - 1U) ++count;
  return count;
}

/// Damped least squares within the bounds from state.q, joints that push against a bound held there (an active set).
/// Stops when the pose is met, when the squared error no longer falls by the part `material`, or at the bounds of
/// evaluations and decompositions.
[[gnu::noinline]] Attempt attempt(TickState& state, Real rotation_weight, Real margin, Real least_curvature,
                                  Real material, std::int32_t max_decompositions, std::int32_t max_evaluations,
                                  bool posture) {
  const Arm<Real>& arm = *state.arm;
  const std::int32_t joints = arm.joint_count;
  const std::uint32_t all = (1U << static_cast<std::uint32_t>(joints)) - 1U;
  const std::int32_t task_rows = task_rank(state.options->task);
  Jacobian<Real> jacobian;
  SingularBasis basis;
  Directions directions{};
  Frame<Real> frame;
  PoseError error;
  Real weighted[6];
  Real step[max_joints];
  Real trial[max_joints];
  evaluate(arm, state.q, frame, jacobian);
  ++state.evaluations;
  pose_error(state.target, frame, state.options->task, state.error);
  weigh(state, state.error, rotation_weight, weighted);
  Real cost = dot6(weighted, weighted);
  Real damping = 0;
  Real trust = 0;
  std::uint32_t free_mask = all;
  std::uint32_t up = 0;
  // With all errors alike the pose is expected to be met: a bound matters only if the step itself runs into it. With
  // weights it is not, and a joint whose gradient pushes against a bound is best left there.
  const bool weighing = margin > Real{0};
  const std::int32_t max_refused = weighing ? 20 : 3;
  std::int32_t refused = 0;
  std::int32_t decompositions = 0;
  bool accepted = true;
  const Real first_cost = cost;
  Attempt result{met(state, state.error) && !posture, false, false, false};
  while (!result.met && decompositions < max_decompositions && state.evaluations < max_evaluations) {
    if (accepted) {
      const Real z[3] = {frame.rotation[2], frame.rotation[5], frame.rotation[8]};
      task_jacobian(state, jacobian, z, rotation_weight, all, basis);
      free_mask = all;
      up = 0;
      if (weighing) {
        for (std::int32_t j = 0; j < joints; ++j) step[j] = dot6(basis.us[j], weighted);
        free_mask = all & ~pushing(state, state.q, step, Real{0}, all, up);
      }
      for (std::int32_t round = 0; round < joints; ++round) {
        std::int32_t rank = count_bits(free_mask);
        if (rank > task_rows) rank = task_rows;
        if (free_mask != all) task_jacobian(state, jacobian, z, rotation_weight, free_mask, basis);
        decompose(basis, joints);
        ++decompositions;
        plan_step(state, jacobian, z, rotation_weight, margin, least_curvature, basis, rank, weighted,
                  directions);
        joint_step(state, basis, directions, damping, step);
        const std::uint32_t more = pushing(state, state.q, step, Real{4}, free_mask, up);
        if (more == 0U || decompositions >= max_decompositions) break;
        free_mask &= ~more;
      }
      result.held = directions.held;
      if (!(trust > Real{0})) {
        trust = strong_step(state, basis, directions);
        result.passable =
            directions.count > 0 && !directions.folds && basis.s[directions.count - 1] < passable_below;
      }
    }
    const Real used = fit_step(state, trust, state.q, basis, directions, damping, step);
    rest_on_bounds(state, state.q, all & ~free_mask, up, step);
    if (posture) add_posture(state, state.q, basis, directions.count, free_mask, step);
    for (std::int32_t j = 0; j < joints; ++j) trial[j] = clamp(state.q[j] + step[j], state.low[j], state.high[j]);
    Real trial_cost = 0;
    for (int correction = 0; correction < 2; ++correction) {
      if (correction == 1) correct_step(state, basis, directions, used, weighted, free_mask, trial);
      evaluate(arm, trial, frame, jacobian);
      ++state.evaluations;
      pose_error(state.target, frame, state.options->task, error);
      weigh(state, error, rotation_weight, weighted);
      trial_cost = dot6(weighted, weighted);
      result.met = met(state, error);
      accepted = result.met || posture || trial_cost < cost;
      if (accepted || state.evaluations >= max_evaluations) break;
    }
    if (accepted) {
      // A step that a bound cut short says nothing about what the next one may do, unless the target is far.
      const bool cut = used > damping && trial_cost < Real(0.01) * first_cost;
      result.stationary = !posture && !cut && !(cost - trial_cost > material * cost);
      for (std::int32_t j = 0; j < joints; ++j) state.q[j] = trial[j];
      state.error = error;
      cost = trial_cost;
      damping *= Real(0.0625);
      posture = false;
      if (result.stationary) break;
    } else {
      damping = used > Real(1e-10) ? Real{16} * used : Real(1e-9);
      if (damping > Real{1e4} || ++refused > max_refused) {
        result.stationary = true;
        break;
      }
    }
  }
  return result;
}

/// Sets the masks and the smallest singular value at state.q.
[[gnu::noinline]] void inspect(TickState& state, Real rotation_weight, bool is_met) {
  const Arm<Real>& arm = *state.arm;
  const std::int32_t joints = arm.joint_count;
  const std::uint32_t all = (1U << static_cast<std::uint32_t>(joints)) - 1U;
  Jacobian<Real> jacobian;
  SingularBasis basis;
  Frame<Real> frame;
  Real push[max_joints];
  Real weighted[6];
  evaluate(arm, state.q, frame, jacobian);
  weigh(state, state.error, rotation_weight, weighted);
  const Real z[3] = {frame.rotation[2], frame.rotation[5], frame.rotation[8]};
  task_jacobian(state, jacobian, z, rotation_weight, all, basis);
  for (std::int32_t j = 0; j < joints; ++j) push[j] = is_met ? Real{0} : dot6(basis.us[j], weighted);
  std::uint32_t up = 0;
  split_masks(state, pushing(state, state.q, push, Real{0}, all, up));
  task_jacobian(state, jacobian, z, Real{1}, all, basis);
  decompose(basis, joints);
  const std::int32_t task_rows = task_rank(state.options->task);
  state.smallest_singular_value = basis.s[(joints < task_rows ? joints : task_rows) - 1];
}

inline Status classify(const TickState& state, const Attempt& result) {
  if (result.met) return Status::ok;
  if (state.limit_mask != 0U) return Status::joint_limited;
  if (result.held && state.step_mask == 0U) return Status::out_of_reach;
  if (state.smallest_singular_value < near_singular_below) return Status::near_singular;
  if (state.step_mask != 0U) return Status::step_limited;
  return result.stationary ? Status::out_of_reach : Status::not_converged;
}

/// The tick where limits, singularities or free joints matter. First an attempt to meet the pose, all errors alike;
/// if that stalls, from the last joints again with the caller's weights. Returns the tick's status but for joints
/// outside a limit.
[[gnu::noinline]] Status constrained_tick(TickState& state) {
  const std::int32_t joints = state.arm->joint_count;
  const Real rotation_weight = state.options->rotation_weight / state.options->position_weight;
  const bool posture = state.options->posture_gain > Real{0};
  Real last[max_joints];
  for (std::int32_t j = 0; j < joints; ++j) last[j] = state.q[j];
  const std::int32_t most = state.options->max_iterations;
  // The first attempt and the second leave evaluations for what comes after them.
  const std::int32_t first = (3 * most + 7) / 8;
  const std::int32_t second = (5 * most + 7) / 8;
  Attempt result = attempt(state, Real{1}, Real{0}, fold_curvature, Real(0.5), 8, first, posture);
  if (!result.met && state.error.position_m < Real(1e-3) * state.length_m && state.error.rotation_rad < Real(1e-3)) {
    // Nearly met. Next to a cusp, where two folds meet, the model of one fold denies solutions that are there; elsewhere
    // another balance of the errors finds the way that this one blocked.
    for (std::int32_t j = 0; j < joints; ++j) state.q[j] = last[j];
    result = result.held ? attempt(state, Real{1}, Real{0}, Real(1e30), Real(0.1), 8, second, posture)
                         : attempt(state, Real(0.01), Real{0}, fold_curvature, Real(1e-3), 8, second, posture);
  }
  if (!result.met) {
    // Only to pass a singularity is the orientation given up for the position. At the border of the workspace that
    // would bend the wrist to gain a little, and not come back the same way.
    const Real weight = result.passable || state.options->task != Task::pose ? rotation_weight : Real{1};
    for (std::int32_t j = 0; j < joints; ++j) state.q[j] = last[j];
    result = attempt(state, weight, fold_margin, fold_curvature, Real(1e-6), 8, most, posture);
  }
  inspect(state, rotation_weight, result.met);
  return classify(state, result);
}

}  // namespace
}  // namespace mdhcal
