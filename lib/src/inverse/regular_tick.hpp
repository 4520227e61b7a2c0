// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. The regular case of a servo tick of a six-joint arm.
#pragma once

#include "inverse/newton.hpp"
#include "inverse/second_order.hpp"

namespace mdhcal {
namespace {

/// The longest step [rad, or lengths of the arm]: its third order, which nothing here looks at, is then a hundredth of it.
constexpr Real regular_step = Real(0.3);
/// The most that the Jacobian's change along the way may do to a step, as a part of the step: along the first step this is
/// Kantorovich's h, and up to 1/2 Newton's method finds the solution that belongs to the last joints and no other
/// (Kantorovich, Akilov 1982, ch. XVIII). At 1/2 it halves its error, which is the least that a step has to do.
constexpr Real regular_change = Real(0.5);
constexpr Real regular_rest = Real(0.5);
/// Beyond this change the Jacobian is taken anew: its square, a hundredth, is about what a step leaves of the error.
constexpr Real renewed_change = Real(0.1);

/// Steps of third order from an error of a step of regular_step come to the rounding in four; near a singularity, where the first
/// ones do less, in seven (of 10^6 poses near wrists and elbows).
constexpr std::int32_t regular_evaluations = 8;

/// The largest component.
inline Real largest_of(const Real* x) {
  Real largest = 0;
  for (int j = 0; j < 6; ++j) {
    if (magnitude(x[j]) > largest) largest = magnitude(x[j]);
  }
  return largest;
}

/// What the unknowns of the step are measured in: 1 rad, or for a slide the arm's length.
inline void units_of(const TickState& state, Real* unit) {
  for (std::int32_t j = 0; j < 6; ++j) unit[j] = joint_unit(state, j);
}

[[gnu::noinline]] void coupled_columns(const TickState& state, const Jacobian<Real>& coordinates, Real per_length,
                                       Factors& factors) {
  for (std::int32_t j = 0; j < 6; ++j) {
    reading_column(*state.arm, coordinates, j, joint_unit(state, j), factors.column[j]);
    for (int k = 0; k < 3; ++k) factors.column[j][k] *= per_length;
  }
}

/// The Jacobian, lengths over the arm's, by the unknowns: the joint coordinates, or the readings where joints are coupled.
/// Returns false if it is singular.
inline bool factor_jacobian(const TickState& state, const Jacobian<Real>& coordinates, const Real* unit, Real per_length,
                            Factors& factors) {
  if (state.arm->coupled != 0) {
    coupled_columns(state, coordinates, per_length, factors);
    return factor(factors);
  }
  for (int j = 0; j < 6; ++j) {
    const Real* from = coordinates.column[j];
    Real* to = factors.column[j];
    const Real scale = unit[j] * per_length;
    to[0] = scale * from[0];
    to[1] = scale * from[1];
    to[2] = scale * from[2];
    to[3] = from[3];  // of a slide: zero
    to[4] = from[4];
    to[5] = from[5];
  }
  return factor(factors);
}

[[gnu::noinline]] void coupled_rates(const Arm<Real>& arm, const Real* step, Real* rate) {
  for (int i = 0; i < 6; ++i) {
    rate[i] = 0;
    for (int j = 0; j < 6; ++j) rate[i] += arm.map[i][j] * step[j];
  }
}

/// How the joint coordinates move where the unknowns move by x.
inline void rates_of(const TickState& state, const Real* unit, const Real* x, Real* rate) {
  Real step[6];
  for (int j = 0; j < 6; ++j) step[j] = x[j] * unit[j];
  if (state.arm->coupled != 0) {
    coupled_rates(*state.arm, step, rate);
  } else {
    for (int j = 0; j < 6; ++j) rate[j] = step[j];
  }
}

/// What the second derivatives of the joint functions add to that, as a motion of the unknowns but for a slope of some per
/// cent. Where joints are coupled the unknowns are others, and an evaluation more makes up for it.
inline void add_curvature(const Arm<Real>& arm, const Jacobian<Real>& coordinates, const Real* a, const Real* b, Real* bend) {
  if (arm.has_terms == 0 || arm.coupled != 0) return;
  for (int j = 0; j < 6; ++j) bend[j] += coordinates.column[curvature_column][j] * (a[j] * b[j]);
}

/// The unknowns' motion for a displacement of the flange, in its place.
inline void solve_displacement(const Factors& factors, Real per_length, Real* displacement) {
  for (int k = 0; k < 3; ++k) displacement[k] *= per_length;
  solve(factors, displacement);
}

/// Moves the tick's joints by the unknowns x. Returns whether they stay within the tick's bounds.
inline bool move(TickState& state, const Real* unit, const Real* x) {
  const Arm<Real>& arm = *state.arm;
  const bool coupled = arm.coupled != 0;
  for (int j = 0; j < 6; ++j) {
    const Real step = x[j] * unit[j];
    const Real q = state.q[j] + (coupled ? step : arm.link[j].sign * step);
    state.q[j] = q;
    if (!(q >= state.low[j] && q <= state.high[j])) return false;
  }
  return true;
}

/// The error, lengths over the arm's.
inline Real size_of(const PoseError& error, Real per_length) {
  const Real length = error.position_m * per_length;
  return length > error.rotation_rad ? length : error.rotation_rad;
}

/// What the Jacobian's change along the unknowns x does to them, in unknowns: they come out as x - way(x) / 2.
inline void way_bent(const TickState& state, const Jacobian<Real>& coordinates, const Factors& factors, const Real* unit,
                     Real per_length, const Real* x, Real* bent) {
  Real rate[6];
  rates_of(state, unit, x, rate);
  change_of_motion(coordinates, 6, rate, rate, bent);
  solve_displacement(factors, per_length, bent);
  add_curvature(*state.arm, coordinates, rate, rate, bent);
}

/// Whether unknowns x take more than two ticks: then the arm is late.
inline bool is_late(const TickState& state, const Real* unit, const Real* x) {
  for (int j = 0; j < 6; ++j) {
    if (magnitude(x[j]) * unit[j] > Real{2} * state.tick->limits.max_step[j]) return true;
  }
  return false;
}

/// Near a singularity, in place of Newton's step d: d = a + t v, v the weakest direction and a across it, solves
/// a + t v = d - w(a + t v) / 2, w what the Jacobian's change does to it. Along v that is a quadratic equation,
/// (v . w_vv / 2) t^2 + (1 + v . w_av) t = v . (d - w_aa / 2): its roots are on the two sides of a fold, and the own one is that
/// on which the determinant has the sign that the motion across v leaves it. `passed` is whether that is another sign. Returns
/// false where there is no root, or where the arm is late and the side not its own.
[[gnu::noinline]] bool near_singular_step(const TickState& state, const Jacobian<Real>& coordinates, const Factors& factors,
                                          const Real* unit, Real per_length, Real* d, bool& passed) {
  Real v[6], a[6], both[6], w_aa[6], w_vv[6], w_av[6];
  weakest_direction(factors, v);
  const Real along = tail_product<0>(v, d);
  for (int j = 0; j < 6; ++j) {
    a[j] = d[j] - along * v[j];
    both[j] = a[j] + v[j];
  }
  if (!(largest_of(a) <= regular_step)) return false;
  way_bent(state, coordinates, factors, unit, per_length, a, w_aa);
  way_bent(state, coordinates, factors, unit, per_length, v, w_vv);
  way_bent(state, coordinates, factors, unit, per_length, both, w_av);
  for (int j = 0; j < 6; ++j) w_av[j] = Real(0.5) * (w_av[j] - w_aa[j] - w_vv[j]);
  const Real constant = along - Real(0.5) * tail_product<0>(v, w_aa);
  const Real linear = Real{1} + tail_product<0>(v, w_av);
  const Real discriminant = linear * linear + Real{2} * tail_product<0>(v, w_vv) * constant;
  passed = linear < Real{0};
  if (!(discriminant > Real{0}) || (passed && is_late(state, unit, a))) return false;
  const Real root = square_root(discriminant);
  const Real t = Real{2} * constant / (passed ? linear - root : linear + root);
  if (!(magnitude(t) <= regular_step)) return false;
  Real across = 0;
  for (int j = 0; j < 6; ++j) {
    d[j] -= Real(0.5) * (w_aa[j] + t * (Real{2} * w_av[j] + t * w_vv[j]));
    across += v[j] * d[j];
  }
  for (int j = 0; j < 6; ++j) d[j] += (t - across) * v[j];
  return largest_of(d) <= regular_step;
}

/// Newton's method with what the Jacobian's change along the way does to a step taken into it: the first step is Chebyshev's,
/// of third order (Traub 1964, ch. 5), and one Jacobian does for the later ones. At least one step is made, whatever the
/// tolerance. Where Kantorovich's condition does not hold for a step, it is near_singular_step(); from then on the sign of the
/// determinant has to be what the steps promise, so that no fold is passed unseen. Given up where that fails, a step leaves more
/// than half of the error or passes a joint limit. Returns whether the pose is met. `look` is of the last joints as long as that
/// is the only evaluation.
[[gnu::noinline]] bool regular_tick(TickState& state, Look& look) {
  const Real per_length = Real{1} / state.length_m;
  PoseError& error = state.error;
  Factors factors;
  Real unit[6], step[6], rate[6], way[6], bend[6];
  units_of(state, unit);
  Real size = 0;
  bool fresh = true;
  bool near_singular = false;
  bool negative = false;  // the determinant, as the last step promises it
  while (state.evaluations < regular_evaluations) {
    ++state.evaluations;
    if (fresh) {
      evaluate(*state.arm, state.q, look.frame, look.coordinates);
    } else {
      evaluate(*state.arm, state.q, look.frame);
    }
    pose_error(state.target, look.frame, Task::pose, error);
    const Real left = size_of(error, per_length);
    const bool first = state.evaluations == 1;
    const bool is_met = !first && met(state, error);
    if (is_met && !near_singular) return true;
    if (!first && !is_met && !(left <= regular_rest * size)) return false;
    size = left;
    if (fresh) {
      const bool full_rank = factor_jacobian(state, look.coordinates, unit, per_length, factors);
      if (first) state.smallest_singular_value = full_rank ? singular_bound(factors) : Real{0};
      if (!full_rank) return false;
    }
    if (near_singular && negative_determinant(factors) != negative) return false;
    if (is_met) return true;
    for (int j = 0; j < 6; ++j) step[j] = error.vector[j];
    solve_displacement(factors, per_length, step);
    rates_of(state, unit, step, rate);
    change_of_motion(look.coordinates, 6, fresh ? rate : way, rate, bend);
    solve_displacement(factors, per_length, bend);
    add_curvature(*state.arm, look.coordinates, fresh ? rate : way, rate, bend);
    const Real longest = largest_of(step);
    const Real change = largest_of(bend);
    if (longest <= regular_step && change <= regular_change * longest) {
      const Real part = fresh ? Real(0.5) : Real{1};
      for (int j = 0; j < 6; ++j) step[j] -= part * bend[j];
    } else {
      if (!fresh || is_singular(factors)) return false;
      if (!near_singular) negative = negative_determinant(factors);
      near_singular = true;
      bool passed = false;
      if (!near_singular_step(state, look.coordinates, factors, unit, per_length, step, passed)) return false;
      negative = negative != passed;
    }
    if (!move(state, unit, step)) return false;
    rates_of(state, unit, step, rate);
    for (int j = 0; j < 6; ++j) way[j] = fresh ? rate[j] : way[j] + rate[j];
    fresh = near_singular || change > renewed_change * longest;
  }
  return false;
}

}  // namespace
}  // namespace mdhcal
