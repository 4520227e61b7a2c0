// SPDX-License-Identifier: MIT
// Private to lib; include after real.hpp. The servo tick: where the joints should be without a step limit, how far one tick gets
// towards it, and what is claimed of the result.
#pragma once

#include "inverse/regular_tick.hpp"
#include "inverse/step.hpp"

namespace mdhcal {
namespace {

/// Joints whose goal is further off than their step.
inline std::uint32_t beyond_step(const TickState& state, const Real* goal) {
  std::uint32_t mask = 0;
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    if (goal[j] < step_low(state, j) || goal[j] > step_high(state, j)) mask |= 1U << static_cast<std::uint32_t>(j);
  }
  return mask;
}

/// What holds a result short of its target: a limit that the error pushes against; else, if the error is at its least, the reach.
inline Status held_by(const TickState& state, Ending ending) {
  if (ending == Ending::met) return Status::ok;
  if (state.limit_mask != 0U) return Status::joint_limited;
  return ending == Ending::at_rest ? Status::out_of_reach : Status::not_converged;
}

/// Whether the pose can be met within this step although its goal is further off: by other joints near a singularity, or on the
/// other side of a fold. If not, the search has left the last joints.
inline bool meets_sooner(Search& search, const Fold& fold, const Real* goal) {
  TickState& state = *search.state;
  if (meet_within_step(search)) return true;
  if (!reflect(state, fold, goal)) return false;
  look_at(search, state.q);
  return meet_within_step(search);
}

/// The square of the error by the caller's weights.
inline Real weighted(const TickState& state) {
  const Real position = state.error.position_m / state.length_m;
  const Real rotation = state.error.rotation_rad * callers_weight(state);
  return position * position + rotation * rotation;
}

/// What is left to do at a search's end: the smallest singular value there, and the side of a fold.
[[gnu::noinline]] void finish(Search& search, Ending ending) {
  TickState& state = *search.state;
  const bool on_fold = ending == Ending::at_rest && search.pushing == 0U;
  if (!on_fold && beyond_step(state, state.q) != 0U) return;
  Weakest weakest;
  find_weakest(search.problem, state.options->task, search.rotation_weight, weakest);
  state.smallest_singular_value = weakest.s;
  if (on_fold) keep_side(search, weakest);
}

/// One tick towards a goal that is not the result: it is further off than the step, or the search for it was cut.
[[gnu::noinline]] Status approach(Search& search, Ending ending) {
  TickState& state = *search.state;
  const std::int32_t joints = search.problem.columns;
  const Real reached = weighted(state), position_m = state.error.position_m, rotation_rad = state.error.rotation_rad;
  Real goal[max_joints];
  for (std::int32_t j = 0; j < joints; ++j) goal[j] = state.q[j];
  Fold fold;
  look_back(search, fold);
  state.smallest_singular_value = fold.weakest.s;
  if (ending == Ending::met) {
    if (meets_sooner(search, fold, goal)) {
      state.step_mask = 0;
      return Status::ok;
    }
    look_back(search, fold);
  }
  follow(search, goal, fold, ending == Ending::cut);
  if (met(state, state.error)) {
    state.step_mask = 0;
    state.limit_mask = 0;
    return Status::ok;
  }
  if (state.step_mask != 0U) return Status::step_limited;
  if (reached < weighted(state)) {
    for (std::int32_t j = 0; j < joints; ++j) state.q[j] = goal[j];
    state.error.position_m = position_m;
    state.error.rotation_rad = rotation_rad;
  }
  return held_by(state, ending);
}

/// The tick. Returns the status but for joints outside a limit.
[[gnu::noinline]] Status solve_tick(TickState& state) {
  const std::int32_t joints = state.arm->joint_count;
  Search search;
  search.state = &state;
  search.problem.rows = task_rank(state.options->task);
  search.problem.columns = joints;
  search.rotation_weight = 1;
  search.pushing = 0;
  Ending ending = Ending::met;
  const bool six = joints == 6 && state.options->task == Task::pose;
  if (!six || !regular_tick(state, search.look)) {
    for (std::int32_t j = 0; j < joints; ++j) state.q[j] = within_limits(state, j, state.from[j]);
    look_at(search, state.q);
    // Where there is no regular case, the search has its evaluations as well.
    ending = find_goal(search, state.evaluations + state.tick->max_iterations + (six ? 0 : regular_evaluations));
    finish(search, ending);
  }
  if (ending != Ending::met) state.limit_mask = search.pushing;
  state.step_mask = beyond_step(state, state.q);
  if (state.step_mask == 0U && ending != Ending::cut) return held_by(state, ending);
  return approach(search, ending);
}

}  // namespace
}  // namespace mdhcal
