// SPDX-License-Identifier: MIT
// Private to lib; include after real.hpp. Where the joints should be without a step limit: the least of the error within the
// joint limits, on this side of a fold.
#pragma once

#include "inverse/second_order.hpp"
#include "inverse/weakest_direction.hpp"

namespace mdhcal {
namespace {

/// The longest step between two evaluations [rad, or lengths of the arm]: the second-order model leaves out a sixth of its cube.
constexpr Real longest_step = Real(0.3);
/// What keeps the equations of a step regular: the square of it is what rounding leaves of the Jacobian.
constexpr Real least_damping = sizeof(Real) == sizeof(double) ? Real(1e-8) : Real(3e-4);

/// How far off a fold a search rests that cannot reach its target [rad, or lengths of the arm]. The side is told from where the
/// next tick begins, so the margin has to exceed what a tick's motion of the other joints does to it; it costs bend / 2 of its
/// square, a hundred-thousandth of the arm's length at most.
constexpr Real side_margin = Real(0.005);
/// A search's damping: this part of the error's square. Levenberg-Marquardt with damping by the error converges quadratically
/// where the Jacobian is singular as well (Yamashita, Fukushima 2001); a hundredth is a step of nine tenths along a direction
/// whose singular value is a third of the error.
constexpr Real first_damping = Real(0.01);

/// How a search ended.
enum class Ending : std::int32_t { met, at_rest, cut };

/// A search's joints, and the linear model there.
struct Search {
  TickState* state;
  BoxProblem problem;          ///< columns and errors at the joints
  Look look;                   ///< of the joints
  Real rotation_weight;
  Real cost;                   ///< |b|^2
  std::uint32_t pushing;       ///< joints on a limit that the error pushes further
};

/// The second-order model at a search's joints over the joints that may move.
struct ErrorModel {
  std::int8_t index[max_joints];    ///< of the joints that may move
  bool bent;                        ///< whether the residual's curvature counts
  Real mu;                          ///< the damping's square
  /// R'R is the Hessian, damped. Where it is bent, row i's first i numbers and its last are the lower triangle and the diagonal
  /// of the Hessian itself.
  Stack triangle;
  Real v[max_joints];               ///< its weakest direction
  Real along[max_joints];           ///< (R'R)^-1 v / v . (R'R)^-1 v
};

inline Real square(const Real* b, std::int32_t count) {
  Real sum = 0;
  for (std::int32_t i = 0; i < count; ++i) sum += b[i] * b[i];
  return sum;
}

inline Real inner(const Real* a, const Real* b, std::int32_t count) {
  Real sum = 0;
  for (std::int32_t i = 0; i < count; ++i) sum += a[i] * b[i];
  return sum;
}

/// The product of two vectors of components of a task.
inline Real inner(const Real* a, const Real* b) {
  return ((((a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]) + a[3] * b[3]) + a[4] * b[4]) + a[5] * b[5];
}

/// y += factor * a, likewise.
inline void add(Real factor, const Real* a, Real* y) {
  y[0] += factor * a[0];
  y[1] += factor * a[1];
  y[2] += factor * a[2];
  y[3] += factor * a[3];
  y[4] += factor * a[4];
  y[5] += factor * a[5];
}

/// y -= J d, likewise.
[[gnu::noinline]] void take_motion(const BoxProblem& problem, const Real* d, Real* y) {
  Real sum[6] = {y[0], y[1], y[2], y[3], y[4], y[5]};
  for (std::int32_t j = 0; j < problem.columns; ++j) add(-d[j], problem.column[j], sum);
  for (int i = 0; i < 6; ++i) y[i] = sum[i];
}

/// The caller's weight of the rotation over that of the position. One of less than a hundred-thousandth is lost in float.
inline Real callers_weight(const TickState& state) {
  constexpr Real least = Real(1e-5);
  const Real weight = state.options->rotation_weight / state.options->position_weight;
  return weight > Real{1} ? Real{1} : (weight > least ? weight : least);
}

/// Evaluates the arm at q.
inline void look_at(Search& search, const Real* q) {
  TickState& state = *search.state;
  evaluate(*state.arm, q, search.look.frame, search.look.coordinates);
  ++state.evaluations;
  pose_error(state.target, search.look.frame, state.options->task, state.error);
}

/// Makes what `look` shows the model.
inline void settle(Search& search) {
  TickState& state = *search.state;
  to_task(state, search.look.frame, search.rotation_weight, state.error.vector, search.problem.b);
  search.cost = inner(search.problem.b, search.problem.b);
  linearise(state, search.look.frame, search.look.coordinates, search.rotation_weight, search.problem);
}

/// H = R'R + curvature of the residual r; R := that of H + shift (Cholesky), the shift growing from nothing until it is positive
/// definite. What the residual bends is no product J'J: there is no orthogonal way to it, and where it counts the error has no
/// steep slope that rounding could hide.
[[gnu::noinline]] void bend_triangle(const Search& search, ErrorModel& model, const Real* r) {
  Stack& stack = model.triangle;
  const std::int32_t size = stack.size;
  constexpr int own = max_joints - 1;
  std::int8_t place[max_joints];
  for (std::int32_t j = 0; j < search.problem.columns; ++j) place[j] = -1;
  for (std::int32_t i = 0; i < size; ++i) {
    place[model.index[i]] = static_cast<std::int8_t>(i);
    for (std::int32_t k = 0; k < i; ++k) stack.column[i][k] = 0;
    stack.column[i][own] = 0;
  }
  add_residual_curvature(*search.state, search.look, search.rotation_weight, r, place, stack.column);
  Real largest = 0;
  for (std::int32_t i = 0; i < size; ++i) {
    for (std::int32_t j = i; j < size; ++j) {
      Real& entry = stack.column[j][i == j ? own : i];
      largest = magnitude(entry) > largest ? magnitude(entry) : largest;
      for (std::int32_t k = 0; k < i; ++k) entry += stack.column[k][i - 1] * stack.column[k][j - 1];
      entry += stack.diagonal[i] * (i == j ? stack.diagonal[i] : stack.column[i][j - 1]);
    }
  }
  Real shift = 0;
  bool definite = false;
  // The last shift is eight times the largest entry of the curvature: its eight rows cannot outweigh that.
  for (int round = 0; round < 4 && !definite; ++round) {
    definite = true;
    for (std::int32_t i = 0; i < size && definite; ++i) {
      Real pivot = stack.column[i][own] + shift;
      for (std::int32_t k = 0; k < i; ++k) pivot -= stack.column[k][i - 1] * stack.column[k][i - 1];
      definite = pivot > least_damping * least_damping;
      stack.diagonal[i] = definite ? square_root(pivot) : Real{1};
      for (std::int32_t j = i + 1; j < size && definite; ++j) {
        Real sum = stack.column[j][i];
        for (std::int32_t k = 0; k < i; ++k) sum -= stack.column[k][i - 1] * stack.column[k][j - 1];
        stack.column[i][j - 1] = sum / stack.diagonal[i];
      }
    }
    shift = round > 0 ? Real{16} * shift : largest / Real{32} + least_damping * least_damping;
  }
}

/// The weakest direction of R'R, and (R'R)^-1 of it: inverse iteration.
[[gnu::noinline]] void find_direction(ErrorModel& model) {
  const std::int32_t size = model.triangle.size;
  Real* v = model.v;
  Real* x = model.along;
  // Any start will do that is not orthogonal to what is sought; unlike entries make that unlikely.
  for (std::int32_t i = 0; i < size; ++i) x[i] = i % 2 == 0 ? Real{1} : Real(0.7);
  for (int round = 0; round < 4; ++round) {
    const Real scale = Real{1} / square_root(square(x, size));
    for (std::int32_t i = 0; i < size; ++i) v[i] = scale * x[i];
    solve_lower(model.triangle, v, x);
    solve_upper(model.triangle, x, x);
  }
  const Real scale = Real{1} / inner(v, x, size);
  for (std::int32_t i = 0; i < size; ++i) x[i] *= scale;
}

/// The least of the model of y after a step `done` (or null) without the weakest direction's part, as a step of all joints.
[[gnu::noinline]] void solve_others(const Search& search, const ErrorModel& model, const Real* y, const Real* done, Real* d) {
  const BoxProblem& problem = search.problem;
  const std::int32_t size = model.triangle.size;
  Real x[max_joints] = {}, before[6];
  const bool bent = model.bent && done != nullptr;
  for (std::int32_t i = 0; i < 6; ++i) before[i] = y[i];
  // The curvature of what was done is that of the Hessian less J'J and the damping.
  for (std::int32_t k = 0; bent && k < size; ++k) add(done[model.index[k]], problem.column[model.index[k]], before);
  for (std::int32_t k = 0; k < size; ++k) {
    x[k] = inner(problem.column[model.index[k]], before);
    if (!bent) continue;
    x[k] += (model.mu - model.triangle.column[k][max_joints - 1]) * done[model.index[k]];
    for (std::int32_t i = 0; i < k; ++i) {
      const Real entry = model.triangle.column[k][i];
      x[k] -= entry * done[model.index[i]];
      x[i] -= entry * done[model.index[k]];
    }
  }
  solve_lower(model.triangle, x, x);
  solve_upper(model.triangle, x, x);
  const Real part = inner(model.v, x, size);
  for (std::int32_t j = 0; j < problem.columns; ++j) d[j] = 0;
  for (std::int32_t k = 0; k < size; ++k) d[model.index[k]] = x[k] - part * model.along[k];
}

/// Scales d so that no entry is longer than the longest step. Returns whether it was.
inline bool shorten(Real* d, std::int32_t count) {
  Real longest = 0;
  for (std::int32_t j = 0; j < count; ++j) longest = magnitude(d[j]) > longest ? magnitude(d[j]) : longest;
  if (!(longest > longest_step)) return false;
  for (std::int32_t j = 0; j < count; ++j) d[j] *= longest_step / longest;
  return true;
}

/// How far along one direction the second-order model is trusted: what it leaves out, a sixth of the cube, is no more than the
/// error that is to be taken away. To within a factor of two.
inline Real trusted_step(Real cost) {
  Real longest = longest_step;
  for (int round = 0; round < 20 && longest * longest * longest > Real{6} * square_root(cost); ++round) longest *= Real(0.5);
  return longest;
}

/// The t at which |r - j t - x t^2 / 2|^2 + mu t^2 is least; at a fold, where there may be two, on the own side of it, where
/// j . x + |x|^2 t >= 0. Half its slope is a cubic; from the right Newton's method comes to the largest root without passing
/// it, bisection guards.
inline Real along_weakest(const Real* r, const Real* j, const Real* x, Real mu, Real longest, bool fold) {
  const Real xx = inner(x, x);
  const Real jx = inner(j, x);
  const Real rx = inner(r, x);
  const Real constant = -inner(r, j);
  const Real linear = inner(j, j) - rx + mu;
  Real low = -longest;
  Real high = longest;
  const bool parted = fold && jx * jx + Real{2} * xx * rx > Real{0};
  if (parted && xx * longest > jx) low = -jx / xx;
  if (low > high) return high;
  Real t = high;
  for (int round = 0; round < 24; ++round) {
    const Real f = constant + t * (linear + t * (Real(1.5) * jx + t * Real(0.5) * xx));
    if (round == 0 && !(f > Real{0})) return high;
    (f > Real{0} ? high : low) = t;
    const Real rate = linear + t * (Real{3} * jx + t * Real(1.5) * xx);
    Real next = rate > Real{0} ? t - f / rate : low;
    if (!(next > low) || !(next < high)) next = Real(0.5) * (low + high);
    const bool there = magnitude(next - t) <= Real(1e-3) * magnitude(t);
    t = next;
    if (there && round > 3) break;
  }
  return t;
}

/// Factors what may move: R'R = J'J + mu over all joints but those on a limit that the error pushes outwards. `rest` receives
/// what the least of |b - J d|^2 + mu |d|^2 leaves of b.
inline void factor_movable(Search& search, ErrorModel& model, Real* rest) {
  const BoxProblem& problem = search.problem;
  const TickState& state = *search.state;
  Stack& stack = model.triangle;
  stack.size = 0;
  stack.equations = 6;
  Real right[max_joints];
  search.pushing = 0;
  for (std::int32_t j = 0; j < problem.columns; ++j) {
    const Real push = inner(problem.column[j], problem.b);
    const bool up = push > Real{0};
    if (magnitude(push) > Real{0} && !(up ? state.q[j] < state.high[j] : state.q[j] > state.low[j])) {
      search.pushing |= 1U << static_cast<std::uint32_t>(j);
      continue;
    }
    for (std::int32_t i = 0; i < 6; ++i) stack.column[stack.size][i] = problem.column[j][i];
    right[stack.size] = 0;
    model.index[stack.size++] = static_cast<std::int8_t>(j);
  }
  Real b[max_joints] = {};
  for (std::int32_t i = 0; i < 6; ++i) rest[i] = b[i] = problem.b[i];
  factor(stack, square_root(model.mu), right, b);
  solve_upper(stack, right, right);
  for (std::int32_t k = 0; k < stack.size; ++k) add(-right[k], problem.column[model.index[k]], rest);
}

/// Whether motion d of all but the weakest direction takes more than two ticks: then the arm is late, and the own side is
/// that of the joints as they are, not as the others will leave them.
inline bool others_late(const TickState& state, const Real* d) {
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    if (magnitude(d[j]) * joint_unit(state, j) > Real{2} * state.tick->limits.max_step[j]) return true;
  }
  return false;
}

/// The step d of the second-order model from the search's joints, mu the damping's square. Returns what it promises of the
/// cost. All but the weakest direction go first, by the linear model; then that direction, by what it bends and the others
/// cannot make good; then the others make good what they can.
[[gnu::noinline]] Real propose(Search& search, Real mu, Real* d) {
  const BoxProblem& problem = search.problem;
  const TickState& state = *search.state;
  const std::int32_t columns = problem.columns;
  const Real floor = least_damping * least_damping;
  ErrorModel model;
  model.mu = mu > floor ? mu : floor;
  Real left[6];
  for (std::int32_t j = 0; j < columns; ++j) d[j] = 0;
  factor_movable(search, model, left);
  if (model.triangle.size == 0) return 0;
  // What is left bends the model, unless that is less than the damping.
  model.bent = inner(left, left) > model.mu * model.mu;
  if (model.bent) bend_triangle(search, model, left);
  find_direction(model);
  solve_others(search, model, problem.b, nullptr, d);
  shorten(d, columns);
  const Real weight = search.rotation_weight;
  Real bend_d[6], bend_v[6], bend_both[6], j[6] = {}, x[6];
  Real step[max_joints] = {};
  for (std::int32_t k = 0; k < model.triangle.size; ++k) step[model.index[k]] = -model.v[k];
  take_motion(problem, step, j);  // J v
  second_order(state, search.look, weight, step, bend_v);
  second_order(state, search.look, weight, d, bend_d);
  for (std::int32_t k = 0; k < columns; ++k) step[k] = d[k] - step[k];
  second_order(state, search.look, weight, step, bend_both);
  for (std::int32_t i = 0; i < 6; ++i) {
    bend_both[i] = Real(0.5) * (bend_both[i] - bend_d[i] - bend_v[i]);
    j[i] += bend_both[i];
    x[i] = bend_v[i];
    left[i] = problem.b[i] - Real(0.5) * bend_d[i];
  }
  take_motion(problem, d, left);
  // What of x the others can make good does not count. Of J v they can make good nothing: v is an eigenvector.
  solve_others(search, model, x, nullptr, step);
  take_motion(problem, step, x);
  const Real side = inner(j, x) - (others_late(state, d) ? inner(bend_both, x) : Real{0});
  const Real turned = side < Real{0} ? Real{-1} : Real{1};
  for (Real& component : j) component *= turned;
  const Real bend = square_root(inner(x, x));
  for (std::int32_t i = 0; i < 6; ++i) step[i] = bend > Real{0} ? x[i] / bend : Real{0};
  const bool fold = is_fold(state.options->task, step, bend);
  const Real t = turned * along_weakest(left, j, x, model.mu, trusted_step(search.cost), fold);
  for (std::int32_t k = 0; k < model.triangle.size; ++k) d[model.index[k]] += t * model.v[k];
  for (std::int32_t i = 0; i < 6; ++i) {
    left[i] = problem.b[i] - Real(0.5) * bend_d[i] - t * (bend_both[i] + Real(0.5) * t * bend_v[i]);
  }
  take_motion(problem, d, left);
  solve_others(search, model, left, d, step);
  take_motion(problem, step, left);
  for (std::int32_t k = 0; k < columns; ++k) d[k] += step[k];
  bool cut = shorten(d, columns);
  for (std::int32_t k = 0; k < columns; ++k) {
    const Real unit = joint_unit(state, k);
    const Real to = state.q[k] + d[k] * unit;
    const Real kept = within_limits(state, k, to);
    if (!(kept < to) && !(kept > to)) continue;
    d[k] = (kept - state.q[k]) / unit;
    cut = true;
  }
  if (cut) {
    second_order(state, search.look, weight, d, x);
    for (std::int32_t i = 0; i < 6; ++i) left[i] = problem.b[i] - Real(0.5) * x[i];
    take_motion(problem, d, left);
  }
  return search.cost - inner(left, left);
}

/// Adds to d, once, the way to the posture that the task does not feel, no further than a tick goes.
[[gnu::noinline]] void add_posture(Search& search, Real* d) {
  TickState& state = *search.state;
  BoxProblem& problem = search.problem;
  Real way[max_joints] = {}, seen[6], step[max_joints];
  for (std::int32_t j = 0; j < problem.columns; ++j) {
    way[j] = state.tick->posture.gain * (state.tick->posture.q[j] - state.q[j]) / joint_unit(state, j);
  }
  for (std::int32_t i = 0; i < 6; ++i) {
    seen[i] = problem.b[i];
    problem.b[i] = 0;
  }
  take_motion(problem, way, problem.b);
  problem.damping = least_damping;
  solve_free(problem, step);
  Real part = Real(0.9);
  for (std::int32_t j = 0; j < problem.columns; ++j) {
    way[j] += step[j];
    const Real length = magnitude(way[j]) * joint_unit(state, j);
    const Real most = Real(0.9) * state.tick->limits.max_step[j];
    if (part * length > most) part = most / length;
  }
  for (std::int32_t j = 0; j < problem.columns; ++j) d[j] += part * way[j];
  for (std::int32_t i = 0; i < 6; ++i) problem.b[i] = seen[i];
}

/// Moves a search that rests short of its target, on a fold, off it by a margin, to the side of the joints that it came from:
/// from there the next tick can tell the side. At the least of the error the Jacobian answers nothing of what is left, whose
/// direction is u; along its weakest direction v the arm bends away by (slope . v) t^2 / 2, and at a step d from there answers
/// (slope . d) t. Where that is zero is the fold.
[[gnu::noinline]] void keep_side(Search& search, Weakest& weakest) {
  TickState& state = *search.state;
  const std::int32_t joints = search.problem.columns;
  const Real size = square_root(search.cost);
  const std::int32_t turn = first_turn(state.options->task);
  for (std::int32_t i = 0; i < search.problem.rows; ++i) {
    weakest.u[i] = search.problem.b[i] / size * (i < turn ? Real{1} : search.rotation_weight);
  }
  Real slope[max_joints];
  slope_of_weakest(state, search.look.frame, search.look.coordinates, weakest, slope);
  const Real bend = inner(slope, weakest.v, joints);
  if (!is_fold(state.options->task, weakest.u, bend)) return;
  Real side = 0;
  for (std::int32_t j = 0; j < joints; ++j) side += slope[j] * (within_limits(state, j, state.from[j]) - state.q[j]) / joint_unit(state, j);
  // Just out of reach the fold is as near as the square root of what is missing: the margin begins at nothing.
  Real margin = square_root(Real{2} * size / magnitude(bend));
  if (margin > side_margin) margin = side_margin;
  if ((side < Real{0}) != (bend < Real{0})) margin = -margin;
  for (std::int32_t j = 0; j < joints; ++j) {
    state.q[j] = within_limits(state, j, state.q[j] + margin * weakest.v[j] * joint_unit(state, j));
  }
  look_at(search, state.q);
}

/// Makes d a step of the search and looks at its end. Returns the cost there.
inline Real try_step(Search& search, const Real* d) {
  TickState& state = *search.state;
  for (std::int32_t j = 0; j < search.problem.columns; ++j) {
    state.q[j] = within_limits(state, j, state.q[j] + d[j] * joint_unit(state, j));
  }
  look_at(search, state.q);
  Real b[6];
  to_task(state, search.look.frame, search.rotation_weight, state.error.vector, b);
  return inner(b, b);
}

/// From state.q, whose look is taken, to the goal: at least one step, at most until `most` evaluations. First all errors
/// count alike. A search that rests short of its target with fewer joints than the task has components, those on a limit left
/// out, goes on with the caller's weights: what a missing joint leaves is the caller's to place. On a fold, where no joint is
/// missing, the errors stay alike, or a wrist would bend for a hair of position.
[[gnu::noinline]] Ending find_goal(Search& search, std::int32_t most) {
  TickState& state = *search.state;
  BoxProblem& problem = search.problem;
  Real rho = first_damping;
  bool posture = state.tick->posture.gain > Real{0} && problem.columns > problem.rows;
  settle(search);
  Real d[max_joints], last[max_joints];
  do {
    const Real promise = propose(search, rho * search.cost, d);
    const bool moves_on = posture;
    if (posture) add_posture(search, d);
    posture = false;
    Real longest = 0;
    std::int32_t movable = problem.columns;
    for (std::int32_t j = 0; j < problem.columns; ++j) {
      longest = magnitude(d[j]) > longest ? magnitude(d[j]) : longest;
      last[j] = state.q[j];
      if (has(search.pushing, j)) --movable;
    }
    const bool resting = !moves_on && promise <= Real(1e-6) * search.cost && longest < Real(1e-3);
    const Real before = search.cost;
    const Real after = try_step(search, d);
    const bool is_met = met(state, state.error);
    if (is_met || moves_on || after < before - Real(0.05) * promise) {
      if (before - after > Real(0.5) * promise) rho *= Real(0.1);
      settle(search);
      if (is_met) return Ending::met;
    } else {
      for (std::int32_t j = 0; j < problem.columns; ++j) state.q[j] = last[j];
      look_at(search, state.q);
      if (met(state, state.error)) return Ending::met;
      rho *= Real{16};
    }
    if (!resting) continue;
    const Real weight = callers_weight(state);
    if (movable >= problem.rows || !(search.rotation_weight > weight)) return Ending::at_rest;
    search.rotation_weight = weight;
    settle(search);
    rho = first_damping;
  } while (state.evaluations < most);
  return Ending::cut;
}

}  // namespace
}  // namespace mdhcal
