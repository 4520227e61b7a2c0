// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. The servo tick where limits, singularities or free joints matter.
#pragma once

#include "weakest_direction.hpp"

namespace mdhcal {
namespace {

/// The longest step between two evaluations [rad, or lengths of the arm].
constexpr Real longest_step = Real(0.3);
/// What keeps the equations of a step regular; a direction with a smaller singular value is left alone.
constexpr Real least_damping = sizeof(Real) == sizeof(double) ? Real(1e-8) : Real(1e-4);
/// The damping of the first step over the root of the error.
constexpr Real care = Real(0.1);
constexpr Real near_singular_below = Real(0.01);

/// A minimisation's joints, and the linear model there.
struct Search {
  TickState* state;
  BoxProblem problem;
  Real rotation_weight;
  Real cost;             ///< |weighted error|^2 at the joints
  Real scale;            ///< of the damping
  std::int32_t patience;
  bool met;
};

/// What one evaluation of the arm shows. Large, hence on the stack only of what uses it.
struct Look {
  Frame<Real> frame;
  Jacobian<Real> coordinates;   ///< by joint coordinate
  PoseError error;
};

/// The singular value that a minimisation may not take below `least`, linearised at the last joints.
struct Keep {
  Weakest weakest;
  Real slope[max_joints];
  Real least;
};

/// How a minimisation goes about it.
struct Aim {
  Real damping;           ///< of a step, the weight of the joints' motion; times the error's root if `by_error`
  bool by_error;
  const Keep* keep;       ///< or null
  bool posture;           ///< the first step goes to the posture as well
  std::int32_t patience;  ///< iterations that fail or gain little
  std::int32_t most;      ///< evaluations of the arm
};

inline void look_at(TickState& state, const Real* q, Look& look) {
  evaluate(*state.arm, q, look.frame, look.coordinates);
  ++state.evaluations;
  pose_error(state.target, look.frame, state.options->task, look.error);
}

inline Real square(const Real* b, std::int32_t count) {
  Real sum = 0;
  for (std::int32_t i = 0; i < count; ++i) sum += b[i] * b[i];
  return sum;
}

/// Makes q the search's joints.
inline void settle(Search& search, const Real* q, const Look& look) {
  TickState& state = *search.state;
  BoxProblem& problem = search.problem;
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) state.q[j] = q[j];
  state.error = look.error;
  to_task(state, look.frame, search.rotation_weight, look.error.vector, problem.b);
  search.cost = square(problem.b, problem.rows);
  linearise(state, look.frame, look.coordinates, search.rotation_weight, problem);
}

/// Starts a search with all errors alike at q.
[[gnu::noinline]] void start(Search& search, TickState& state, const Real* q) {
  search.state = &state;
  search.problem.rows = task_rank(state.options->task);
  search.problem.columns = state.arm->joint_count;
  search.rotation_weight = 1;
  search.met = false;
  Look look;
  look_at(state, q, look);
  settle(search, q, look);
}

/// Joints whose arm's limit, not the step limit, ends the way down or up.
inline bool limit_ends(const TickState& state, std::int32_t j, bool up) {
  const Arm<Real>& arm = *state.arm;
  return up ? has(arm.max_mask, j) && !(state.high[j] < arm.max[j])
            : has(arm.min_mask, j) && !(state.low[j] > arm.min[j]);
}

inline std::uint32_t all_joints(const Search& search) {
  return (1U << static_cast<std::uint32_t>(search.problem.columns)) - 1U;
}

/// The room for a step around the search's joints.
inline void set_room(Search& search) {
  const TickState& state = *search.state;
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    const Real down = (state.q[j] - state.low[j]) / joint_unit(state, j);
    const Real up = (state.high[j] - state.q[j]) / joint_unit(state, j);
    search.problem.low[j] = down > longest_step ? -longest_step : -down;
    search.problem.high[j] = up > longest_step ? longest_step : up;
  }
}

/// Solves for a step; where it takes the kept singular value below its least, once more with the equation that it ends
/// there.
[[gnu::noinline]] void solve_kept(Search& search, const Keep* keep, Real* step) {
  // Against rows of one and less: the equation is met to a thousandth.
  constexpr Real weight = 30;
  BoxProblem& problem = search.problem;
  solve(problem, step);
  if (keep == nullptr) return;
  const TickState& state = *search.state;
  Real give = keep->weakest.s - keep->least;
  Real change = 0;
  for (std::int32_t j = 0; j < problem.columns; ++j) {
    give += keep->slope[j] * (state.q[j] - state.last[j]) / joint_unit(state, j);
    change += keep->slope[j] * step[j];
  }
  if (give + change >= Real{0}) return;
  for (std::int32_t j = 0; j < problem.columns; ++j) problem.row[problem.rows][j] = weight * keep->slope[j];
  problem.b[problem.rows] = -weight * give;
  ++problem.rows;
  solve(problem, step);
  --problem.rows;
}

/// Raises the damping, to within a factor of two of the least, until the step fits between the step limits: unlike one
/// that is cut off at them, it keeps to the directions that the joints are good at. Returns whether it had to.
[[gnu::noinline]] bool fit_damping(Search& search) {
  const TickState& state = *search.state;
  bool raised = false;
  for (int round = 0; round < 8; ++round) {
    Real step[max_joints] = {};
    solve_free(search.problem, all_joints(search), step, step);
    Real worst = 0;
    for (std::int32_t j = 0; j < search.problem.columns; ++j) {
      const bool up = step[j] > Real{0};
      if (limit_ends(state, j, up)) continue;
      const Real room = (up ? state.high[j] - state.q[j] : state.q[j] - state.low[j]) / joint_unit(state, j);
      // A joint that has used up its step holds nobody else back.
      if (room > Real(1e-9) && magnitude(step[j]) > worst * room) worst = magnitude(step[j]) / room;
    }
    if (!(worst > Real{1})) break;
    raised = true;
    const Real factor = square_root(worst);
    search.problem.damping *= factor > Real{2} ? factor : Real{2};
  }
  return raised;
}

/// Whether no step within the tick's bounds solves the linear model: a damped solution is no longer than any exact one
/// (a factor of eight is for the curvature).
[[gnu::noinline]] bool hopeless(const Search& search) {
  const TickState& state = *search.state;
  Real step[max_joints] = {};
  solve_free(search.problem, all_joints(search), step, step);
  Real room = 0;
  for (std::int32_t j = 0; j < search.problem.columns; ++j) {
    const Real down = (state.q[j] - state.low[j]) / joint_unit(state, j);
    const Real up = (state.high[j] - state.q[j]) / joint_unit(state, j);
    const Real wider = down > up ? down : up;
    room += wider * wider;
  }
  return square(step, search.problem.columns) > Real{64} * room;
}

/// scale |error|^(1/2): far from the target a step is careful, near it Newton's (Yamashita, Fukushima 2001; Sugihara
/// 2011).
inline Real step_damping(const Search& search, Real scale) {
  const Real damping = scale * square_root(square_root(search.cost));
  return damping > least_damping ? damping : least_damping;
}

inline void set_pull(Search& search, bool posture) {
  const TickState& state = *search.state;
  // A tenth of a radian a tick keeps the null space's curvature small against the steps that follow.
  constexpr Real longest = Real(0.1);
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    const Real way =
        posture ? (state.options->posture[j] - state.q[j]) / joint_unit(state, j) * state.options->posture_gain : Real{0};
    search.problem.pull[j] = way > longest ? longest : (way < -longest ? -longest : way);
  }
}

/// Goes the step if that meets the pose, or brings some of what the linear model `predicted` of the cost, and adapts the
/// damping and the patience. Returns whether it went.
[[gnu::noinline]] bool go(Search& search, const Aim& aim, const Real* step, Real predicted, bool anyway) {
  TickState& state = *search.state;
  Real q[max_joints];
  for (std::int32_t j = 0; j < search.problem.columns; ++j) {
    const Real next = state.q[j] + step[j] * joint_unit(state, j);
    q[j] = next < state.low[j] ? state.low[j] : (next > state.high[j] ? state.high[j] : next);
  }
  Look look;
  look_at(state, q, look);
  search.met = met(state, look.error);
  Real b[6];
  to_task(state, look.frame, search.rotation_weight, look.error.vector, b);
  const Real cost = square(b, search.problem.rows);
  const Real ratio = (search.cost - cost) / (search.cost - predicted);
  const bool goes = search.met || anyway || ratio > Real(0.001);
  if (!goes || !(cost < (ratio > Real(0.75) ? Real(0.9) : Real(0.25)) * search.cost)) --search.patience;
  if (!(ratio > Real(0.25))) {
    search.scale *= Real{10};
  } else if (ratio > Real(0.75) && aim.by_error) {
    search.scale *= Real(0.1);
  }
  if (goes) settle(search, q, look);
  return goes;
}

/// Damped least squares (Levenberg 1944, Marquardt 1963) within the bounds, from the search's joints. Stops when the
/// pose is met, when the linear model promises nothing, when a step has gone to the step limit, when patience is lost,
/// or at the bound of evaluations.
[[gnu::noinline]] void minimise(Search& search, const Aim& aim) {
  TickState& state = *search.state;
  BoxProblem& problem = search.problem;
  bool posture = aim.posture;
  search.scale = aim.damping;
  search.patience = aim.patience;
  search.met = met(state, state.error) && !posture;
  while (!search.met && search.patience >= 0 && state.evaluations < aim.most) {
    problem.damping = aim.by_error ? step_damping(search, search.scale) : search.scale;
    if (posture || problem.damping < least_damping) problem.damping = least_damping;
    set_pull(search, posture);
    set_room(search);
    const bool fitted = aim.keep != nullptr && fit_damping(search);
    Real step[max_joints];
    solve_kept(search, aim.keep, step);
    Real predicted = 0;
    for (std::int32_t i = 0; i < problem.rows; ++i) {
      const Real left = residual(problem, i, step);
      predicted += left * left;
    }
    if (!posture && !(search.cost - predicted > Real(1e-5) * search.cost)) return;
    if (go(search, aim, step, predicted, posture) && fitted) return;
    posture = false;
  }
}

/// Sets the masks: joints at a bound that the error pushes further.
inline void find_pushing(const Search& search) {
  TickState& state = *search.state;
  state.step_mask = 0;
  state.limit_mask = 0;
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    Real push = 0;
    for (std::int32_t i = 0; i < search.problem.rows; ++i) push += search.problem.row[i][j] * search.problem.b[i];
    const bool up = push > Real{0};
    const Real room = up ? state.high[j] - state.q[j] : state.q[j] - state.low[j];
    if (!(magnitude(push) > Real{0}) || room > Real(1e-6) * (state.high[j] - state.low[j])) continue;
    (limit_ends(state, j, up) ? state.limit_mask : state.step_mask) |= 1U << static_cast<std::uint32_t>(j);
  }
}

inline Status classify(const Search& search) {
  const TickState& state = *search.state;
  if (search.met) return Status::ok;
  if (state.limit_mask != 0U) return Status::joint_limited;
  if (state.step_mask != 0U && !(state.smallest_singular_value < near_singular_below)) return Status::step_limited;
  if (state.smallest_singular_value < near_singular_below) return Status::near_singular;
  return state.evaluations < state.options->max_iterations ? Status::out_of_reach : Status::not_converged;
}

/// How to make the best of a pose that is not met.
struct Best {
  Real weight;     ///< of the rotation
  bool passes;     ///< the singularity may be passed
  bool keeps;      ///< the singular value is kept up
  Real leap;       ///< along the weakest direction, to where the second-order model meets the pose, or 0
};

/// Starts over from the last joints. What the weakest singular direction does decides how to go on. If it turns the
/// flange, or hardly bends (a wrist's singularity), the singularity may be passed. If it shifts the flange and bends (a
/// straight elbow), the arm folds there; the singular value is kept from falling below a margin, so that the way back is
/// the way that it came. The caller's weights hold but close to a fold, where the wrist would bend for nothing.
[[gnu::noinline]] Best start_over(Search& search, Keep& keep) {
  constexpr Real turning = Real(0.2);
  constexpr Real bending = Real(0.05);
  constexpr Real margin = Real(0.005);
  TickState& state = *search.state;
  Look look;
  look_at(state, state.last, look);
  search.rotation_weight = 1;
  settle(search, state.last, look);
  find_weakest(search.problem, state.options->task, Real{1}, keep.weakest);
  const Real s = keep.weakest.s;
  const Real* u = keep.weakest.u;
  slope_of_weakest(state, look.frame, look.coordinates, keep.weakest, keep.slope);
  Real bend = 0;
  for (std::int32_t j = 0; j < search.problem.columns; ++j) bend += keep.slope[j] * keep.weakest.v[j];
  const bool is_pose = state.options->task == Task::pose;
  const bool turns = is_pose && (dot(u + 3, u + 3) > turning * turning || magnitude(bend) < bending);
  Best best{Real{1}, turns && s < Real(0.1), false, Real{0}};
  // With hardly a singular value left there is no side to keep to.
  best.keeps = !best.passes && s > Real(1e-6);
  keep.least = s < margin ? s : margin;
  // On a fold the error's slope vanishes however far the pose is on either side: bend t^2 / 2 is what there is of it.
  Real wanted = 0;
  for (std::int32_t i = 0; i < search.problem.rows; ++i) wanted += u[i] * search.problem.b[i];
  if (s < Real(0.01) && magnitude(bend) > bending && wanted / bend > Real{0}) {
    const Real leap = square_root(Real{2} * wanted / bend);
    if (leap < Real(0.05)) best.leap = wanted > Real{0} ? leap : -leap;
  }
  if (is_pose && (turns || s > Real(0.05))) {
    best.weight = state.options->rotation_weight / state.options->position_weight;
    search.rotation_weight = best.weight;
    settle(search, state.last, look);
  }
  return best;
}

/// The best that can be had of a pose that is not met. Where a singularity is passed the weakest direction rests while
/// its singular value falls, and is caught up while that rises.
[[gnu::noinline]] void make_the_best(Search& search) {
  TickState& state = *search.state;
  Keep keep;
  Best best = start_over(search, keep);
  if (magnitude(best.leap) > Real{0}) {
    Real q[max_joints];
    for (std::int32_t j = 0; j < search.problem.columns; ++j) {
      const Real next = state.last[j] + best.leap * keep.weakest.v[j] * joint_unit(state, j);
      q[j] = next < state.low[j] ? state.low[j] : (next > state.high[j] ? state.high[j] : next);
    }
    start(search, state, q);
    minimise(search, {care, true, nullptr, false, 6, state.options->max_iterations});
    if (search.met) return;
    best = start_over(search, keep);
  }
  const Real before = keep.weakest.s;
  const std::int32_t most = state.options->max_iterations;
  const bool weighted = best.weight < Real{1};
  minimise(search, {weighted ? Real{2} * best.weight : care, false, best.keeps ? &keep : nullptr, false,
                    weighted ? 6 : 2, most});
  if (search.met || !weighted) return;
  find_weakest(search.problem, state.options->task, best.weight, keep.weakest);
  if (keep.weakest.s > before) minimise(search, {Real(0.001) * best.weight, false, nullptr, false, 6, most});
}

[[gnu::noinline]] Real smallest_singular_value(const Search& search) {
  Weakest weakest;
  find_weakest(search.problem, search.state->options->task, search.rotation_weight, weakest);
  return weakest.s;
}

/// The tick where limits, singularities or free joints matter. First the pose is tried with all errors alike; if that
/// fails, the best is made of it. Returns the tick's status but for joints outside a limit.
[[gnu::noinline]] Status constrained_tick(TickState& state) {
  Search search;
  start(search, state, state.last);
  const bool posture = state.options->posture_gain > Real{0} && search.problem.columns > search.problem.rows;
  search.problem.damping = step_damping(search, care);
  set_pull(search, false);
  // A quarter of the evaluations is left for what comes after it.
  const std::int32_t most = (3 * state.options->max_iterations + 3) / 4;
  if (posture || !hopeless(search)) minimise(search, {care, true, nullptr, posture, 6, most});
  if (!search.met) make_the_best(search);
  state.smallest_singular_value = smallest_singular_value(search);
  if (!search.met) find_pushing(search);
  return classify(search);
}

}  // namespace
}  // namespace mdhcal
