// SPDX-License-Identifier: MIT
// Private to lib; include after real.hpp. How far one tick gets towards a goal that is further off than its step.
#pragma once

#include "inverse/goal_search.hpp"

namespace mdhcal {
namespace {

/// The part of a step by which the goal comes nearer in every tick: a target at rest is met within twelve times the least number
/// of ticks, whatever the weights do.
constexpr Real progress = Real(1) / Real(12);
/// The pull to the goal's joints over the rotation's weight: enough to choose where the pose does not, little enough that it
/// moves neither (arcs past wrists: bench_sweep).
constexpr Real pull = Real(0.001);
/// Work that a box problem of eight unknowns does not use up: every unknown meets a bound and one in three is let go of again.
constexpr std::int32_t box_budget = 32;
/// What a step bends does not count where it is less than this part of what is left after it.
constexpr Real no_matter = Real(0.01);

/// What the weakest direction does at the last joints, errors alike.
struct Fold {
  Weakest weakest;
  Real slope[max_joints];   ///< of the singular value, by the unit-free readings
  Real bend;                ///< slope . v
};

/// Ticks that are more than any way takes which a servo goes; more are not counted, so that the smallest steps do not overflow.
constexpr Real most_ticks = Real(1e9);

/// The largest of |goal - last| over max_step: the ticks that the goal is away.
inline Real ticks_to(const TickState& state, const Real* goal) {
  Real most = 0;
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    const Real way = magnitude(goal[j] - state.last[j]);
    const Real step = state.tick->limits.max_step[j];
    if (way > most * step) most = way < most_ticks * step ? way / step : most_ticks;
  }
  return most;
}

/// Puts the search at the last joints, errors alike, and finds what the weakest direction does there.
[[gnu::noinline]] void look_back(Search& search, Fold& fold) {
  TickState& state = *search.state;
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) state.q[j] = state.last[j];
  search.rotation_weight = 1;
  look_at(search, state.last);
  settle(search);
  find_weakest(search.problem, state.options->task, Real{1}, fold.weakest);
  slope_of_weakest(state, search.look.frame, search.look.coordinates, fold.weakest, fold.slope);
  fold.bend = inner(fold.slope, fold.weakest.v, search.problem.columns);
}

/// From the search's joints to joints within this tick's step that meet the pose: near a singularity many joints meet it to
/// within its tolerances. Damped least squares in the box of the step, as long as that promises nine tenths of the error.
[[gnu::noinline]] bool meet_within_step(Search& search) {
  TickState& state = *search.state;
  BoxProblem& problem = search.problem;
  for (int round = 0; round < 5; ++round) {
    if (met(state, state.error)) return true;
    settle(search);
    Box box;
    Real step[max_joints];
    for (std::int32_t j = 0; j < problem.columns; ++j) {
      box.pull[j] = 0;
      box.low[j] = (step_low(state, j) - state.q[j]) / joint_unit(state, j);
      box.high[j] = (step_high(state, j) - state.q[j]) / joint_unit(state, j);
    }
    const Real damping = square_root(first_damping * search.cost);
    problem.damping = damping > least_damping ? damping : least_damping;
    problem.budget = box_budget;
    solve(problem, box, step);
    Real left[6];
    for (std::int32_t i = 0; i < 6; ++i) left[i] = problem.b[i];
    take_motion(problem, step, left);
    if (inner(left, left) > Real(0.1) * search.cost) return false;
    for (std::int32_t j = 0; j < problem.columns; ++j) {
      state.q[j] = within_step(state, j, state.q[j] + step[j] * joint_unit(state, j));
    }
    look_at(search, state.q);
  }
  return met(state, state.error);
}

/// Goes to the goal's image on the other side of the fold, where s + slope . d has the opposite value. Returns whether that is
/// near the step.
inline bool reflect(TickState& state, const Fold& fold, const Real* goal) {
  if (!(magnitude(fold.bend) > no_bend)) return false;
  const std::int32_t joints = state.arm->joint_count;
  Real s = fold.weakest.s;
  for (std::int32_t j = 0; j < joints; ++j) s += fold.slope[j] * (goal[j] - state.last[j]) / joint_unit(state, j);
  for (std::int32_t j = 0; j < joints; ++j) {
    const Real image = goal[j] - Real{2} * s / fold.bend * fold.weakest.v[j] * joint_unit(state, j);
    state.q[j] = within_step(state, j, image);
    if (magnitude(image - state.q[j]) > Real(0.5) * state.tick->limits.max_step[j]) return false;
  }
  return true;
}

/// Sets the progress box about `start`, the point of it next to the last joints: joint limits, step limits, and no joint further
/// from the goal than what is left of the way when the goal has come nearer by its part. The straight step to the goal is in it.
inline void set_progress(Search& search, const Real* goal, Real left, Box& box, Real* start) {
  const TickState& state = *search.state;
  for (std::int32_t j = 0; j < search.problem.columns; ++j) {
    const Real per_unit = Real{1} / joint_unit(state, j);
    const Real room = left * state.tick->limits.max_step[j];
    const Real way = goal[j] - state.last[j];
    Real low = step_low(state, j) - state.last[j];
    Real high = step_high(state, j) - state.last[j];
    if (way - room > low) low = way - room < high ? way - room : high;
    if (way + room < high) high = way + room > low ? way + room : low;
    start[j] = (low > Real{0} ? low : (high < Real{0} ? high : Real{0})) * per_unit;
    const Real down = low * per_unit - start[j];
    const Real up = high * per_unit - start[j];
    box.low[j] = down < Real{0} ? down : Real{0};
    box.high[j] = up > Real{0} ? up : Real{0};
    box.pull[j] = way * per_unit - start[j];
  }
}

/// Where `step` would leave the side of the fold that the last joints are on, takes the least part of the straight way to the
/// goal, which is on that side, that keeps it.
inline void keep_fold(const TickState& state, const Fold& fold, const Real* goal, Real ticks, Real* step) {
  if (!is_fold(state.options->task, fold.weakest.u, fold.bend)) return;
  const std::int32_t joints = state.arm->joint_count;
  Real boxed = fold.weakest.s, straight = fold.weakest.s, along = 0;
  for (std::int32_t j = 0; j < joints; ++j) {
    const Real way = (goal[j] - state.last[j]) / joint_unit(state, j);
    boxed += fold.slope[j] * step[j];
    straight += fold.slope[j] * way / ticks;
    along += fold.weakest.v[j] * way;
  }
  Real least = side_margin * magnitude(fold.bend);
  if (fold.weakest.s < least) least = fold.weakest.s;
  // Further off than the model holds, it does not know the side.
  if (boxed >= least || magnitude(along) > longest_step) return;
  Real part = straight > boxed ? (least - boxed) / (straight - boxed) : Real{0};
  if (part > Real{1}) part = 1;
  for (std::int32_t j = 0; j < joints; ++j) {
    step[j] += part * ((goal[j] - state.last[j]) / joint_unit(state, j) / ticks - step[j]);
  }
}

/// Whether a step is in the box about `start`.
inline bool is_within(const BoxProblem& problem, const Box& box, const Real* start, const Real* step) {
  for (std::int32_t j = 0; j < problem.columns; ++j) {
    const Real x = step[j] - start[j];
    if (!(x >= box.low[j]) || !(x <= box.high[j])) return false;
  }
  return true;
}

/// Whether a step leaves less than half of the position's error.
inline bool holds_position(const TickState& state, const BoxProblem& problem, const Real* error, const Real* step) {
  Real left[6];
  for (std::int32_t i = 0; i < 6; ++i) left[i] = error[i];
  take_motion(problem, step, left);
  Real before = 0, after = 0;
  for (std::int32_t i = 0; i < first_turn(state.options->task); ++i) {
    before += error[i] * error[i];
    after += left[i] * left[i];
  }
  return after <= Real(0.25) * before;
}

/// Whether a step is shorter than the part by which the goal has to come nearer.
inline bool stalls(const TickState& state, const Real* step) {
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    if (magnitude(step[j]) * joint_unit(state, j) > progress * state.tick->limits.max_step[j]) return false;
  }
  return true;
}

/// One tick from the last joints, where the search is, to a goal that is further off than its step: in the progress box the least
/// of the error, by the exact second-order model. By the caller's weights, as long as the position can be held within the step;
/// where it cannot, giving up the rotation for it is no use, and errors count alike. While a wrist is passed, or the goal is
/// only as far as the search came, the progress box is left out unless the arm would stand still.
[[gnu::noinline]] void follow(Search& search, const Real* goal, const Fold& fold, bool cut) {
  TickState& state = *search.state;
  const std::int32_t joints = state.arm->joint_count;
  BoxProblem& problem = search.problem;
  search.rotation_weight = callers_weight(state);
  settle(search);
  problem.damping = pull * search.rotation_weight;
  const Real away = ticks_to(state, goal);
  const Real ticks = away > Real{1} ? away : Real{1};
  Box box;
  Real start[max_joints], step[max_joints];
  set_progress(search, goal, away + Real{1}, box, start);
  Real error[max_equations], bend[max_equations] = {}, rest[max_equations];
  for (std::int32_t i = 0; i < 6; ++i) error[i] = problem.b[i];
  error[6] = 0;
  bool resting = false, alike = false;
  for (int round = 0; round < 3; ++round) {
    for (std::int32_t i = 0; i < equations_of(problem); ++i) problem.b[i] = rest[i] = error[i] - Real(0.5) * bend[i];
    take_motion(problem, start, problem.b);
    problem.budget = box_budget;
    solve(problem, box, step);
    for (std::int32_t j = 0; j < joints; ++j) step[j] += start[j];
    if (round == 2 || (round == 1 && !((resting || cut) && stalls(state, step)))) break;
    if (round == 0 && search.rotation_weight < Real{1} && !holds_position(state, problem, error, step)) {
      search.rotation_weight = 1;
      settle(search);
      problem.damping = pull;
      alike = true;
      for (std::int32_t i = 0; i < 6; ++i) error[i] = problem.b[i];
      --round;
      continue;
    }
    if (round == 0) {
      second_order(state, search.look, search.rotation_weight, step, bend);
      // How the others change the weakest direction's singular value. While it falls the direction rests: a wrist is passed.
      const Real change = inner(fold.slope, step, joints) - fold.bend * inner(fold.weakest.v, step, joints);
      resting = !alike && change < Real{0} && !is_fold(state.options->task, fold.weakest.u, fold.bend);
    }
    if (round == 0 && resting) {
      for (std::int32_t j = 0; j < joints; ++j) problem.column[j][6] = search.rotation_weight * fold.weakest.v[j];
      problem.rows = max_equations;
      continue;
    }
    if (round > 0 || alike || !cut) set_progress(search, goal, away > progress ? away - progress : Real{0}, box, start);
    take_motion(problem, step, rest);
    if (inner(bend, bend) < no_matter * no_matter * inner(rest, rest) && is_within(problem, box, start, step)) break;
  }
  keep_fold(state, fold, goal, ticks, step);
  for (std::int32_t j = 0; j < joints; ++j) {
    state.q[j] = within_step(state, j, state.last[j] + step[j] * joint_unit(state, j));
  }
  Frame<Real> frame;
  evaluate(*state.arm, state.q, frame);
  ++state.evaluations;
  pose_error(state.target, frame, state.options->task, state.error);
}

}  // namespace
}  // namespace mdhcal
