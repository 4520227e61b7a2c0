// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. The servo tick: the regular one, and where limits, singularities or free joints
// matter, which minimisations (search.hpp) it takes, and what is claimed of their result.
#pragma once

#include "inverse/regular_tick.hpp"
#include "inverse/search.hpp"

namespace mdhcal {
namespace {

/// The damping of the first step over the root of the error.
constexpr Real care = Real(0.1);
constexpr Real near_singular_below = Real(0.01);
/// Nearer to a singularity than this, it is looked at before the pose is tried.
constexpr Real looked_at_below = Real(0.05);
/// The part of the error's square that the linear model has to promise away: half where a pose is to be met, little where
/// the best is to be made of it.
constexpr Real half = Real(0.5);
constexpr Real little = Real(1e-5);
/// A search that begins with more than this of the error's square, a tenth of the arm's length or of a radian, and ends with
/// so little of it has come far even where the pose is not met.
constexpr Real far_off = Real(0.01);
constexpr Real most_gone = Real(0.05);
/// The error's square at a hundred-thousandth of the arm's length or of a radian.
constexpr Real nearly_met = Real(1e-10);
/// The work that is kept for the best of a pose that is not met: a start, an iteration, and what is claimed of the result;
/// what the weakest direction does at the last joints comes before it or is in it.
constexpr std::int32_t best_work = evaluation + kept_iteration + weakest_alone;

/// Whether the target is further from the base than the arm is long. Slides may be of any length.
inline bool beyond_reach(const TickState& state) {
  const Real* p = state.target.position_m;
  const Real reach = Real(1.0001) * state.arm->reach_m + state.options->position_tolerance_m;
  return state.arm->prismatic_mask == 0U && dot(p, p) > reach * reach;
}

/// With less weight on the rotation than this it is given up for the position.
constexpr Real weighted_below = Real(0.05);

/// Whether a tick can meet the pose from its last joints.
enum class Chance : std::int32_t {
  some,
  not_within_a_step,
  none  ///< nor with any number of steps
};

/// None: the target is out of all reach; or, close to a fold, the second-order model s t + along t^2 / 2 of what the
/// weakest direction answers does not come to what is wanted of it, nor with what the other directions' motion may add,
/// sixteen times its square, nor with the rounding of the direction. Not within a step: no step within the tick's bounds
/// solves the linear model, since a damped solution is no longer than any exact one (a factor of eight is for the
/// curvature).
[[gnu::noinline]] Chance chance(Search& search, const Bend& bend) {
  const TickState& state = *search.state;
  if (beyond_reach(state)) return Chance::none;
  Real* step = search.ahead;
  solve_free(search.problem, step);
  search.solved = true;
  Real room = 0;
  Real along = 0;
  for (std::int32_t j = 0; j < search.problem.columns; ++j) {
    const Real down = (state.q[j] - state.low[j]) / joint_unit(state, j);
    const Real up = (state.high[j] - state.q[j]) / joint_unit(state, j);
    const Real wider = down > up ? down : up;
    room += wider * wider;
    if (bend.of_last) along += search.weakest.v[j] * step[j];
  }
  const Real length2 = square(step, search.problem.columns);
  if (bend.of_last && magnitude(bend.along) >= Real(0.05)) {
    const Real s = bend.s;
    constexpr Real rounding = sizeof(Real) == sizeof(double) ? Real(1e-15) : Real(5e-7);
    const Real slack = Real{16} * (length2 - along * along) + rounding * square_root(search.cost) / s;
    if (s * s + Real{2} * (bend.along * bend.wanted + magnitude(bend.along) * slack) < Real{0}) return Chance::none;
  }
  return length2 > Real{64} * room ? Chance::not_within_a_step : Chance::some;
}

/// Joints at a bound that the error pushes further.
struct Pushing {
  std::uint32_t step_mask, limit_mask;
};

inline Pushing find_pushing(const Search& search) {
  const TickState& state = *search.state;
  Pushing pushing{0, 0};
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    const Real push = slope_of(search.problem, j);
    const bool up = push > Real{0};
    const Real room = up ? state.high[j] - state.q[j] : state.q[j] - state.low[j];
    if (!(magnitude(push) > Real{0}) || room > Real(1e-6) * (state.high[j] - state.low[j])) continue;
    (limit_ends(state, j, up) ? pushing.limit_mask : pushing.step_mask) |= 1U << static_cast<std::uint32_t>(j);
  }
  return pushing;
}

inline Status classify(const Search& search) {
  const TickState& state = *search.state;
  if (search.met) return Status::ok;
  if (state.limit_mask != 0U) return Status::joint_limited;
  if (state.step_mask != 0U && !(state.smallest_singular_value < near_singular_below)) return Status::step_limited;
  if (state.smallest_singular_value < near_singular_below) return Status::near_singular;
  return search.cut ? Status::not_converged : Status::out_of_reach;
}

/// 1 below `low`, 0 above `high`, a straight line between.
inline Real falling(Real x, Real low, Real high) {
  return x < low ? Real{1} : (x > high ? Real{0} : (high - x) / (high - low));
}

/// How far the weakest direction is one along which the arm folds, which shifts the flange and bends: 1 at a fold, 0 where it
/// turns the flange (a wrist) or goes on without bending (a shoulder), between them a straight line. What hardly turns the
/// flange need hardly bend; what turns it more has to bend as much as hardly any wrist does. A fold that is almost reached may
/// turn the flange the more, the more it bends.
[[gnu::noinline]] Real fold_of(Real s, Real turn, Real curve) {
  const Real shifts = falling(turn, Real(0.1), Real(0.2));
  const Real reached = falling(s, Real(0.008), Real(0.012));
  const Real may_turn = curve > Real(0.05) ? Real{6} * (curve - Real(0.05)) * reached : Real{0};
  return falling(turn - may_turn, Real(0.2), Real(0.3)) *
         (Real{1} - falling(curve, Real(0.04) - Real(0.038) * shifts, Real(0.06) - Real(0.056) * shifts));
}

/// Finds what the weakest direction does at the search's joints, errors alike, which `look` is of.
[[gnu::noinline]] void find_bend(Search& search, const Look& look, Bend& bend) {
  TickState& state = *search.state;
  bend.of_last = search.there;
  Weakest& weakest = search.weakest;
  find_weakest(search.problem, state.options->task, Real{1}, weakest);
  slope_of_weakest(state, look.frame, look.coordinates, weakest, bend.slope);
  bend.s = weakest.s;
  search.problem.budget -= weakest_and_slope;
  bend.along = 0;
  for (std::int32_t j = 0; j < search.problem.columns; ++j) bend.along += bend.slope[j] * weakest.v[j];
  bend.wanted = 0;
  for (std::int32_t i = 0; i < search.problem.rows; ++i) bend.wanted += weakest.u[i] * search.problem.b[i];
  const Real* turn = weakest.u + 3;
  bend.fold = state.options->task == Task::pose
                  ? fold_of(bend.s, square_root(dot(turn, turn)), magnitude(bend.along))
                  : Real{1};
}

/// Starts at q and finds what the weakest direction does there.
[[gnu::noinline]] void start_along(Search& search, const Real* q, Bend& bend) {
  Look look;
  start(search, q, look);
  find_bend(search, look, bend);
}

/// Goes `leap` along the weakest direction from the search's joints. Returns whether that is a short way and the bounds leave
/// nearly all of it.
inline bool leap_to(const Search& search, Real leap, Real* q) {
  const TickState& state = *search.state;
  if (!(magnitude(leap) < furthest_leap)) return false;
  bool there = true;
  for (std::int32_t j = 0; j < search.problem.columns; ++j) {
    const Real way = leap * search.weakest.v[j] * joint_unit(state, j);
    const Real from = state.q[j];
    q[j] = within_bounds(state, j, from + way);
    if (magnitude(q[j] - from) < Real(0.9) * magnitude(way)) there = false;
  }
  return there;
}

/// Where s t + along t^2 / 2 = wanted puts the joints along the weakest direction at the search's joints, which are near a
/// fold: goes to the nearer root that is within the bounds; ahead are the joints at the other one. Returns how many there are.
[[gnu::noinline]] int go_to_root(Search& search) {
  TickState& state = *search.state;
  Bend bend;
  start_along(search, state.q, bend);
  const Real s = bend.s;
  Real discriminant = s * s + Real{2} * bend.along * bend.wanted;
  // A pose on the fold is short of it by rounding; within the tolerances that is no matter.
  const Real short_by = Real{2} * magnitude(bend.along) * state.options->rotation_tolerance_rad;
  if (discriminant < Real{0} && discriminant > -short_by) discriminant = 0;
  if (!(s < near_singular_below) || discriminant < Real{0}) return 0;
  const Real sum = s + square_root(discriminant);
  const bool further = leap_to(search, -sum / bend.along, search.ahead);
  if (leap_to(search, Real{2} * bend.wanted / sum, state.q)) return further ? 2 : 1;
  if (!further) return 0;
  for (std::int32_t j = 0; j < search.problem.columns; ++j) state.q[j] = search.ahead[j];
  return 1;
}

/// Whether the weakest direction bends as it does at a fold, and at hardly any wrist.
inline bool bends(const Bend& bend) { return !(magnitude(bend.along) < Real(0.04)); }

/// Whether step limits are what holds up the search on its way past a wrist's singularity, where hardly anything bends and
/// there is no fold to leave.
inline bool passes_wrist(const Search& search, const Bend& bend) { return search.held && bend.of_last && !bends(bend); }

/// Whether the singular value at the search's joints is surely not that near a fold, going by the last joints: linear there,
/// with a curvature of no more than 1 [/rad^2], or falling by no more than the way.
inline bool far_from_fold(const Search& search, const Bend& bend) {
  const TickState& state = *search.state;
  Real way = 0;
  for (std::int32_t j = 0; j < state.arm->joint_count; ++j) {
    way += magnitude(state.q[j] - state.last[j]) / joint_unit(state, j);
  }
  const Real least = bend.of_last ? linear_rise(state, bend, state.q, bend.s) - way * way : looked_at_below - way;
  return least > Real{2} * near_singular_below;
}

/// For a search that rests near a fold without meeting the pose, since there the error hardly has a slope: goes on from where
/// the second-order model of what the weakest direction answers meets the pose. `bend` is of the last joints.
[[gnu::noinline]] void leave_fold(Search& search, const Bend& bend) {
  constexpr std::int32_t work = evaluation + weakest_and_slope + evaluation;
  if (search.cost > foldable || search.problem.budget < work) return;
  if (far_from_fold(search, bend) || passes_wrist(search, bend)) return;
  const int roots = go_to_root(search);
  for (int root = 0; root < roots && !search.met; ++root) {
    if (search.problem.budget < evaluation) return;
    search.folded = root + 1 < roots;
    start(search, root == 0 ? search.state->q : search.ahead);
    minimise(search, {care, nullptr, false, false, half, half, max_tick_iterations});
  }
}

/// The caller's weight of the rotation over that of the position.
inline Real callers_weight(const TickState& state) {
  return state.options->rotation_weight / state.options->position_weight;
}

/// Starts over from the last joints. What the weakest singular direction does there decides how to go on. If it turns the
/// flange, or hardly bends (a wrist's singularity), the singularity may be passed. Where the arm folds the singular value
/// is kept from falling below a margin, so that the way back is the way that it came. The caller's weights hold but close
/// to a fold, or where an arm comes from one too late to hold the position: there the wrist would bend for nothing, and
/// errors are alike. Between the two the weight goes over without a jump, or ticks on either side of one would undo each
/// other for ever. Returns whether the singular value is to be kept.
[[gnu::noinline]] bool start_over(Search& search, Bend& bend, Chance found) {
  constexpr Real far = Real(0.01);
  const TickState& state = *search.state;
  if (!bend.of_last) {
    start_along(search, state.last, bend);
  } else if (!search.there) {
    start(search, state.last);
  }
  const Real s = bend.s;
  if (state.options->task == Task::pose) {
    const Real callers = callers_weight(state);
    const Real shift = state.error.position_m / state.length_m;
    const Real close = falling(s, Real(0.04), Real(0.06));
    const Real late = found == Chance::not_within_a_step ? falling(s, Real(0.1), Real(0.15)) *
                                                               falling(state.error.rotation_rad, Real(0.5) * shift, shift)
                                                         : Real{0};
    Real share = bend.fold * (close > late ? close : late);
    share *= share;
    weigh_rotation(search, callers + share * share * (Real{1} - callers));
  }
  // A wrist that only has to come round is not held back; with hardly a singular value left there is no side to keep to.
  const bool comes_round = search.rotation_weight < weighted_below && !(state.error.position_m > far * state.length_m);
  return (bend.fold > Real(0.5) || (s >= Real(0.1) && !comes_round)) && s > Real(1e-6);
}

/// The best that can be had of a pose that is not met, in four iterations (two where it has no chance at all) and what is
/// left of the work, but at least one. In the end the weakest direction is the result's.
[[gnu::noinline]] void make_the_best(Search& search, Bend& bend, Chance found) {
  TickState& state = *search.state;
  const bool keeps = start_over(search, bend, found);
  search.solved = false;
  // Set aside for the end; of the rest one iteration at least.
  search.problem.budget -= weakest_alone;
  if (search.problem.budget < kept_iteration) search.problem.budget = kept_iteration;
  const Real weight = search.rotation_weight;
  const bool weighted = weight < weighted_below;
  // A wrist comes round only slowly.
  const Real creeping = weighted ? Real(0.003) : Real(0.02);
  const Real damping = weighted ? (keeps ? Real{2} * weight : weight) : care;
  minimise(search, {damping, &bend, keeps, false, little, creeping, found == Chance::none ? 2 : 4});
  find_weakest(search.problem, state.options->task, weight, search.weakest);
}

/// The regular tick, where there is one; if it fails, puts the search at the last joints, by what that saw of them. Returns
/// whether the pose is met.
[[gnu::noinline]] bool begin(Search& search, Bend& bend) {
  TickState& state = *search.state;
  Look look;
  if (state.arm->joint_count == 6 && state.options->task == Task::pose && regular_tick(state, look)) return true;
  // What is seen first is the last joints.
  search.problem.budget -= evaluation * state.evaluations;
  if (state.evaluations != 1) look_at(search, state.last, look, state.error);
  settle(search, state.last, look);
  bend.of_last = false;
  if (state.smallest_singular_value < looked_at_below) find_bend(search, look, bend);
  return false;
}

/// The tick: the regular one, or if that fails the pose is tried with all errors alike; if that fails, the best is made of
/// it. Returns the status but for joints outside a limit.
[[gnu::noinline]] Status solve_tick(TickState& state) {
  Search search;
  Bend bend;
  search.state = &state;
  search.problem.rows = task_rank(state.options->task);
  search.problem.columns = state.arm->joint_count;
  search.problem.budget = per_iteration * state.tick->max_iterations;
  search.rotation_weight = 1;
  search.predicted = 0;
  search.met = false;
  search.solved = false;
  if (begin(search, bend)) return Status::ok;
  search.folded = bend.of_last && bends(bend);
  const bool posture = state.tick->posture.gain > Real{0} && search.problem.columns > search.problem.rows;
  search.problem.damping = step_damping(search, care);
  set_pull(search, false);
  const Chance found = posture ? Chance::some : chance(search, bend);
  bool came_far = false;
  if (found == Chance::some) {
    const Real cost_before = search.cost;
    // Where only the posture is left to go to, nothing better can be made of the last joints.
    const std::int32_t reserve = met(state, state.error) ? 0 : best_work + (bend.of_last ? 0 : weakest_and_slope);
    search.problem.budget -= reserve;
    minimise(search, {care, nullptr, false, posture, half, half, max_tick_iterations});
    came_far = !search.met && cost_before > far_off && search.cost < most_gone * cost_before;
    // So close to it the pose is worth all that is left.
    const bool nearly = search.cost < nearly_met;
    if (nearly) search.problem.budget += reserve;
    if (!search.met && !came_far) leave_fold(search, bend);
    if (!nearly) search.problem.budget += reserve;
  }
  if (search.met || came_far) {
    find_weakest(search.problem, state.options->task, Real{1}, search.weakest);
  } else {
    // What cannot be had is not worth more.
    make_the_best(search, bend, found);
  }
  state.smallest_singular_value = search.weakest.s;
  if (!search.met) {
    const Pushing pushing = find_pushing(search);
    state.step_mask = pushing.step_mask;
    state.limit_mask = pushing.limit_mask;
  }
  return classify(search);
}

}  // namespace
}  // namespace mdhcal
