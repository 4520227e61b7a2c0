// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. The tick's minimisation: damped least squares from joints towards a pose,
// within the step and joint limits.
#pragma once

#include "inverse/weakest_direction.hpp"

namespace mdhcal {
namespace {

/// Further off than this a second-order model is of no use [rad, or lengths of the arm].
constexpr Real furthest_leap = Real(0.05);
/// The longest step between two evaluations [rad, or lengths of the arm].
constexpr Real longest_step = Real(0.3);
/// What keeps the equations of a step regular; a direction with a smaller singular value is left alone.
constexpr Real least_damping = sizeof(Real) == sizeof(double) ? Real(1e-8) : Real(1e-4);

/// Work is counted in thirds of a factorization: an evaluation of the arm with what follows from it; an iteration, which is
/// one of each, or with a singular value kept two factorizations; the weakest direction; how that changes as well.
constexpr std::int32_t evaluation = 5;
constexpr std::int32_t per_iteration = evaluation + 3;
constexpr std::int32_t kept_iteration = per_iteration + 3;
constexpr std::int32_t weakest_alone = 6;
constexpr std::int32_t weakest_and_slope = weakest_alone + 3;
/// The error's square below which a second-order model of the weakest direction may take over: an error of the square of
/// the way that it is good for.
constexpr Real foldable = (furthest_leap * furthest_leap) * (furthest_leap * furthest_leap);
/// What a minimisation may lose at first: iterations that fail or gain little.
constexpr std::int32_t all_patience = 2;

/// A minimisation's joints, and the linear model there.
struct Search {
  TickState* state;
  BoxProblem problem;
  Real rotation_weight;
  Real cost;             ///< |weighted error|^2 at the joints
  Real scale;            ///< of the damping
  Real predicted;        ///< what the last step's linear model was to leave of the cost
  Real ahead[max_joints]; ///< found before it is used: the first step without its bounds; then joints at another root
  Weakest weakest;       ///< the newest
  std::int32_t patience;
  bool met;
  bool there;            ///< at the last joints
  bool folded;           ///< if the linear model fails close to the pose, the second-order one has another way
  bool solved;           ///< the first step is ahead
  bool held;             ///< ended where the linear model promises nothing because a step limit holds it back
  bool cut;              ///< ended by the bound of the tick's work
};

/// What the weakest singular direction does at some joints.
struct Bend {
  Real s;                   ///< the singular value
  Real slope[max_joints];   ///< of the singular value, by the unit-free readings
  Real along;               ///< the slope along the direction
  Real wanted;              ///< the error's component that the direction answers
  Real fold;                ///< 1 on a straight elbow, 0 on a wrist: fold_of()
  bool of_last;             ///< at the last joints
};

/// How a minimisation goes about it: to meet the pose, or to make the best of it by what the weakest direction does.
struct Aim {
  Real damping;           ///< of a step, the weight of the joints' motion; times the error's root if the pose is to be met
  const Bend* bend;       ///< what to make the best by; null if the pose is to be met
  bool keeps;             ///< the singular value from falling too low
  bool posture;           ///< the first step goes to the posture as well
  Real promise;           ///< the least part of the cost that the linear model has to take away for a step to be tried
  Real creeping;          ///< likewise, after the first step: what comes more slowly can wait for the next tick
  std::int32_t most;      ///< iterations
};

inline void look_at(Search& search, const Real* q, Look& look, PoseError& error) {
  TickState& state = *search.state;
  evaluate(*state.arm, q, look.frame, look.coordinates);
  ++state.evaluations;
  search.problem.budget -= evaluation;
  pose_error(state.target, look.frame, state.options->task, error);
}

inline Real square(const Real* b, std::int32_t count) {
  Real sum = 0;
  for (std::int32_t i = 0; i < count; ++i) sum += b[i] * b[i];
  return sum;
}

/// Makes q, where the error is the state's, the search's joints: state.last itself where it goes back to these.
inline void settle(Search& search, const Real* q, const Look& look) {
  TickState& state = *search.state;
  BoxProblem& problem = search.problem;
  search.there = q == state.last;
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) state.q[j] = q[j];
  to_task(state, look.frame, search.rotation_weight, state.error.vector, problem.b);
  search.cost = square(problem.b, problem.rows);
  linearise(state, look.frame, look.coordinates, search.rotation_weight, problem);
}

/// Gives the rotation another weight, once, in the model as it stands.
inline void weigh_rotation(Search& search, Real weight) {
  BoxProblem& problem = search.problem;
  search.rotation_weight = weight;
  for (std::int32_t i = first_turn(search.state->options->task); i < problem.rows; ++i) {
    for (std::int32_t j = 0; j < problem.columns; ++j) problem.row[i][j] *= weight;
    problem.b[i] *= weight;
  }
  search.cost = square(problem.b, problem.rows);
}

/// Starts a search with all errors alike at q. `look` receives what is seen there.
inline void start(Search& search, const Real* q, Look& look) {
  search.rotation_weight = 1;
  look_at(search, q, look, search.state->error);
  settle(search, q, look);
}

[[gnu::noinline]] void start(Search& search, const Real* q) {
  Look look;
  start(search, q, look);
}

/// Joints whose arm's limit, not the step limit, ends the way down or up.
inline bool limit_ends(const TickState& state, std::int32_t j, bool up) {
  const Arm<Real>& arm = *state.arm;
  return up ? has(arm.max_mask, j) && !(state.high[j] < arm.max[j])
            : has(arm.min_mask, j) && !(state.low[j] > arm.min[j]);
}

/// The room for a step around the search's joints.
inline void set_room(const Search& search, Box& room) {
  const TickState& state = *search.state;
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    const Real down = (state.q[j] - state.low[j]) / joint_unit(state, j);
    const Real up = (state.high[j] - state.q[j]) / joint_unit(state, j);
    room.low[j] = down > longest_step ? -longest_step : -down;
    room.high[j] = up > longest_step ? longest_step : up;
  }
}

/// `at_last` and what bend's singular value, taken as linear from the last joints, adds to it at q.
inline Real linear_rise(const TickState& state, const Bend& bend, const Real* q, Real at_last) {
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    at_last += bend.slope[j] * (q[j] - state.last[j]) / joint_unit(state, j);
  }
  return at_last;
}

/// What a minimisation may not take the singular value below: where that is close already, a little above where it is, or
/// what the linear model leaves out would take it through the fold in a few thousand ticks.
inline Real least_of(const Bend& bend) {
  constexpr Real margin = Real(0.005);
  return bend.s < margin ? bend.s + Real(0.01) * (margin - bend.s) : margin;
}

/// Solves for the step, which is that without bounds already if `solved`; where it takes the singular value that is to be
/// kept too low, once more with the equation that it ends there.
[[gnu::noinline]] void solve_kept(Search& search, const Box& room, const Bend* keep, bool solved, Real* step) {
  // Against rows of one and less: the equation is met to a thousandth.
  constexpr Real weight = 30;
  BoxProblem& problem = search.problem;
  if (!solved || !inside(problem, room, step)) solve(problem, room, step);
  if (keep == nullptr) return;
  const TickState& state = *search.state;
  const Real give = linear_rise(state, *keep, state.q, keep->s - least_of(*keep));
  Real change = 0;
  for (std::int32_t j = 0; j < problem.columns; ++j) change += keep->slope[j] * step[j];
  if (give + change >= Real{0}) return;
  for (std::int32_t j = 0; j < problem.columns; ++j) problem.row[problem.rows][j] = weight * keep->slope[j];
  problem.b[problem.rows] = -weight * give;
  ++problem.rows;
  solve(problem, room, step);
  --problem.rows;
}

/// What the step limits and the longest step leave of joint j's way in one direction, or 0 if the arm's limit ends it: a
/// joint that has used up its step holds nobody else back.
inline Real step_room(const TickState& state, std::int32_t j, bool up) {
  if (limit_ends(state, j, up)) return 0;
  const Real room = (up ? state.high[j] - state.q[j] : state.q[j] - state.low[j]) / joint_unit(state, j);
  if (!(room > Real(1e-9))) return 0;
  return room < longest_step ? room : longest_step;
}

/// Raises the damping, to little more than the least, until the step fits between the step limits: unlike one that is cut
/// off at them, it keeps to the directions that the joints are good at. `step` receives it, free of bounds. Returns whether
/// it had to.
[[gnu::noinline]] bool fit_damping(Search& search, Real* step) {
  const TickState& state = *search.state;
  BoxProblem& problem = search.problem;
  // Far from the pose the damping rules, and a step is the slope over its square. Never more than is needed: no
  // singular value squared is over 4.
  Real steepest = 0;
  for (std::int32_t j = 0; j < problem.columns; ++j) {
    const Real slope = slope_of(problem, j);
    const Real room = step_room(state, j, slope > Real{0});
    if (room > Real{0} && magnitude(slope) > steepest * room) steepest = magnitude(slope) / room;
  }
  bool raised = false;
  if (steepest > Real{4} + problem.damping * problem.damping) {
    problem.damping = square_root(steepest - Real{4});
    raised = true;
  }
  for (int round = 0; round < 8 && problem.budget > 0; ++round) {
    solve_free(problem, step);
    Real worst = 0;
    for (std::int32_t j = 0; j < problem.columns; ++j) {
      const Real room = step_room(state, j, step[j] > Real{0});
      if (room > Real{0} && magnitude(step[j]) > worst * room) worst = magnitude(step[j]) / room;
    }
    if (!(worst > Real{1})) break;
    raised = true;
    const Real factor = Real(1.1) * square_root(worst);
    problem.damping *= factor > Real(1.5) ? factor : Real(1.5);
  }
  return raised;
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
        posture ? (state.tick->posture.q[j] - state.q[j]) / joint_unit(state, j) * state.tick->posture.gain : Real{0};
    search.problem.pull[j] = way > longest ? longest : (way < -longest ? -longest : way);
  }
}

inline Real within_bounds(const TickState& state, std::int32_t j, Real q) {
  return q < state.low[j] ? state.low[j] : (q > state.high[j] ? state.high[j] : q);
}

/// Whether what is left of the error is in its turn.
inline bool turns_only(const Real* b, std::int32_t rows) {
  return rows == 6 && square(b, 3) < square(b + 3, 3);
}

/// Goes the step if that meets the pose, or brings some of what the linear model predicted of the cost, and adapts the
/// damping and the patience; one towards the posture is gone whatever it costs. Where a singularity is passed the weakest
/// direction rests while its singular value falls, and is caught up while that rises. Returns whether it went.
[[gnu::noinline]] bool go(Search& search, const Aim& aim, const Real* step, bool posture) {
  TickState& state = *search.state;
  Real q[max_joints];
  for (std::int32_t j = 0; j < search.problem.columns; ++j) {
    q[j] = within_bounds(state, j, state.q[j] + step[j] * joint_unit(state, j));
  }
  Look look;
  PoseError error;
  look_at(search, q, look, error);
  search.met = met(state, error);
  Real b[6];
  to_task(state, look.frame, search.rotation_weight, error.vector, b);
  const Real cost = square(b, search.problem.rows);
  const Real ratio = (search.cost - cost) / (search.cost - search.predicted);
  const bool goes = search.met || posture || ratio > Real(0.001);
  // A step that does as predicted has to halve the cost to count as a gain, one that does not to quarter it.
  const Real enough = ratio > Real(0.75) ? Real(0.5) : Real(0.25);
  if (!posture) {
    if (!goes && aim.bend == nullptr && search.cost < foldable && search.patience == all_patience) {
      // Close to the pose a model that fails at once is bent.
      search.patience = search.folded ? -1 : 0;
    } else if (!goes || !(cost < enough * search.cost)) {
      --search.patience;
    }
    if (!(ratio > Real(0.25))) {
      // A damping that does not go by the error may be far too small.
      search.scale *= aim.bend == nullptr || ratio > Real{-10} ? Real{10} : Real{1000};
    } else if (ratio > Real(0.75) && !aim.keeps && (aim.bend == nullptr || turns_only(b, search.problem.rows))) {
      if (aim.bend == nullptr || linear_rise(state, *aim.bend, q, 0) > Real{0}) {
        search.scale *= Real(0.1);
      } else {
        search.patience -= 2;
      }
    }
  }
  if (goes) {
    state.error = error;
    settle(search, q, look);
  }
  return goes;
}

/// Whether a step limit holds the step back.
inline bool holds(const Search& search, const Box& room, const Real* step) {
  for (std::int32_t j = 0; j < search.problem.columns; ++j) {
    const bool up = !(step[j] < room.high[j]);
    const bool held = up ? room.high[j] < longest_step : !(step[j] > room.low[j]) && room.low[j] > -longest_step;
    if (held && !limit_ends(*search.state, j, up)) return true;
  }
  return false;
}

/// Damped least squares (Levenberg 1944, Marquardt 1963) within the bounds, from the search's joints. Stops when the
/// pose is met, when the linear model promises nothing, when a step has gone to the step limit, when patience is lost,
/// or when the work is done that the tick may do.
[[gnu::noinline]] void minimise(Search& search, const Aim& aim) {
  TickState& state = *search.state;
  BoxProblem& problem = search.problem;
  bool posture = aim.posture;
  Real promise = aim.promise;
  search.scale = aim.damping;
  search.patience = all_patience;
  search.met = met(state, state.error) && !posture;
  search.cut = false;
  search.held = false;
  for (std::int32_t n = 0; n < aim.most && !search.met && search.patience >= 0; ++n) {
    search.cut = problem.budget < (aim.keeps ? kept_iteration : per_iteration);
    if (search.cut) return;
    problem.damping = aim.bend == nullptr ? step_damping(search, search.scale) : search.scale;
    if (posture || problem.damping < least_damping) problem.damping = least_damping;
    set_pull(search, posture);
    Box room;
    set_room(search, room);
    Real step[max_joints];
    if (search.solved) {
      for (std::int32_t j = 0; j < problem.columns; ++j) step[j] = search.ahead[j];
    }
    const bool fitted = aim.keeps && fit_damping(search, step);
    solve_kept(search, room, aim.keeps ? aim.bend : nullptr, aim.keeps || search.solved, step);
    search.solved = false;
    search.predicted = 0;
    for (std::int32_t i = 0; i < problem.rows; ++i) {
      const Real left = residual(problem, i, step);
      search.predicted += left * left;
    }
    if (!posture && !(search.cost - search.predicted > promise * search.cost)) {
      search.held = holds(search, room, step);
      return;
    }
    if (go(search, aim, step, posture) && fitted) return;
    posture = false;
    promise = aim.creeping;
  }
}

}  // namespace
}  // namespace mdhcal
