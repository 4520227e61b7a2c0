// SPDX-License-Identifier: MIT
#include "mdhcal/kinematics.hpp"

#include "arm/chain.hpp"
#include "number/real.hpp"
#include "arm/rotation.hpp"
#include "arm/terms.hpp"
#include "number/sin_cos.hpp"
#include "number/compare.hpp"

namespace mdhcal {

namespace {

constexpr Real reading_bound = static_cast<Real>(max_reading);

// A joint that others' readings move, too.
[[gnu::noinline]] Real coupled_coordinate(const Arm<Real>& arm, std::int32_t i, const Real* q) {
  Real sum = 0;
  for (std::int32_t j = 0; j < arm.joint_count; ++j) sum += arm.map[i][j] * q[j];
  return sum;
}

bool slides(const Arm<Real>& arm, std::int32_t i) {
  return ((arm.prismatic_mask >> static_cast<std::uint32_t>(i)) & 1U) != 0U;
}

// What one link does: sines and cosines of alpha and theta; beta's stay with the arm.
struct LinkTurn {
  Real sin_alpha, cos_alpha, sine, cosine, a, d;
};

// The joint coordinate but for the terms.
[[gnu::always_inline]] inline Real plain_coordinate(const Arm<Real>& arm, std::int32_t i, const Real* q) {
  return arm.coupled == 0 ? arm.link[i].sign * q[i] : coupled_coordinate(arm, i, q);
}

[[gnu::always_inline]] inline void read_link(const Arm<Real>& arm, std::int32_t i, Real coordinate, LinkTurn& t) {
  const ArmLink<Real>& link = arm.link[i];
  Real theta = link.theta_rad;
  t.d = link.d_m;
  if (slides(arm, i)) {
    t.d = coordinate + t.d;
  } else {
    theta = coordinate + theta;
  }
  sin_cos_inline(theta, t.sine, t.cosine);
  t.sin_alpha = link.sin_alpha;
  t.cos_alpha = link.cos_alpha;
  t.a = link.a_m;
}

// Rot_y(beta): the rotation's first and third column. Most links have none.
template <int rows>
[[gnu::always_inline]] inline void tilt(const ArmLink<Real>& link, Real* r) {
  const Real sine = link.sin_beta;
  if (!(magnitude(sine) > Real{0})) return;
  const Real cosine = link.cos_beta;
  for (int row = 0; row < rows; ++row, r += 3) {
    const Real x = r[0];
    const Real z = r[2];
    r[0] = cosine * x - sine * z;
    r[2] = sine * x + cosine * z;
  }
}

// base_T_1 = A_1 but for beta: the same sums without the terms that are zero.
inline void first_turn(const LinkTurn& t, Frame<Real>& frame) {
  Real* r = frame.rotation;
  r[0] = t.cosine;
  r[1] = -t.sine;
  r[2] = 0;
  r[3] = t.sine * t.cos_alpha;
  r[4] = t.cosine * t.cos_alpha;
  r[5] = -t.sin_alpha;
  r[6] = t.sine * t.sin_alpha;
  r[7] = t.cosine * t.sin_alpha;
  r[8] = t.cos_alpha;
  frame.position_m[0] = t.a;
  frame.position_m[1] = -(t.d * t.sin_alpha);
  frame.position_m[2] = t.d * t.cos_alpha;
}

// What one link but for beta does to one row of the rotation and to the position's coordinate of that row.
inline void turn_row(const LinkTurn& t, Real* r, Real& position) {
  const Real x = r[0];
  const Real y = t.cos_alpha * r[1] + t.sin_alpha * r[2];
  const Real z = t.cos_alpha * r[2] - t.sin_alpha * r[1];
  position += t.a * x + t.d * z;
  r[0] = t.cosine * x + t.sine * y;
  r[1] = t.cosine * y - t.sine * x;
  r[2] = z;
}

// The joint's axis [0] ... [2] and the origin, before beta.
inline void keep(const Frame<Real>& frame, Real* axis, Real* origin) {
  for (int k = 0; k < 3; ++k) {
    axis[k] = frame.rotation[3 * k + 2];
    origin[k] = frame.position_m[k];
  }
}

// base_T_i = base_T_{i-1} A_i, in place; of i = 0 base_T_1. Where a column of the Jacobian is asked for, it receives a point
// on the joint's axis and the axis in the base frame.
template <bool with_column>
[[gnu::always_inline]] inline void append_turn(const Arm<Real>& arm, std::int32_t i, const LinkTurn& t, Frame<Real>& frame,
                                               Real* column) {
  if (i == 0) {
    first_turn(t, frame);
  } else {
    turn_row(t, frame.rotation, frame.position_m[0]);
    turn_row(t, frame.rotation + 3, frame.position_m[1]);
    turn_row(t, frame.rotation + 6, frame.position_m[2]);
  }
  if constexpr (with_column) keep(frame, column + 3, column);
  tilt<3>(arm.link[i], frame.rotation);
}

template <bool with_column>
[[gnu::always_inline]] inline void append_link(const Arm<Real>& arm, std::int32_t i, const Real* q, Frame<Real>& frame, Real* column) {
  LinkTurn t;
  read_link(arm, i, plain_coordinate(arm, i, q), t);
  append_turn<with_column>(arm, i, t, frame, column);
}

// The arm before sag, seen across gravity, and along it.
template <bool along>
inline void find_levers(const Arm<Real>& arm, const LinkTurn* turn, Levers<along>& levers) {
  const ArmTerms<Real>& terms = arm.terms;
  Real row[9] = {terms.across[0][0], terms.across[0][1], terms.across[0][2], terms.across[1][0], terms.across[1][1],
                 terms.across[1][2], terms.across[2][0], terms.across[2][1], terms.across[2][2]};
  Seen<along> at{};
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    turn_row(turn[i], row, at.u);
    turn_row(turn[i], row + 3, at.v);
    levers.axis[i].u = row[2];
    levers.axis[i].v = row[5];
    if constexpr (along) {
      turn_row(turn[i], row + 6, at.w);
      levers.axis[i].w = row[8];
    }
    levers.point[i] = at;
    tilt<along ? 3 : 2>(arm.link[i], row);
  }
  const auto seen = [&](const Real* p) {
    Seen<along> point = at;
    point.u += dot(row, p);
    point.v += dot(row + 3, p);
    if constexpr (along) point.w += dot(row + 6, p);
    return point;
  };
  levers.point[arm.joint_count] = seen(terms.flange_p_m);
  levers.payload = seen(terms.payload_p_m);
}

// What all links do, terms included. With `slopes`: the sag's derivative by the coordinates before it, that of the joint
// functions by motion of the own coordinate before the terms and, where it is not null, `by_terms`: what the terms add.
template <bool slopes>
[[gnu::noinline]] void read_links(const Arm<Real>& arm, const Real* q, LinkTurn* turn, Real (*sag_slope)[max_joints],
                                              FunctionValue* function, Real* by_terms) {
  const std::int32_t joints = arm.joint_count;
  const JointFunctionTable* table = arm.terms.functions;
  for (std::int32_t i = 0; i < joints; ++i) {
    Real coordinate = plain_coordinate(arm, i, q);
    if (table != nullptr) {
      Real error;
      if constexpr (slopes) {
        function[i] = function_value(table->coefficient[i], q[i]);
        error = arm.terms_share * function[i].value;
      } else {
        error = arm.terms_share * function_at(table->coefficient[i], q[i]);
      }
      coordinate += error;
      if (by_terms != nullptr) by_terms[i] = error;
    } else if (by_terms != nullptr) {
      by_terms[i] = 0;
    }
    read_link(arm, i, coordinate, turn[i]);
  }
  if (arm.terms.sag_mask == 0U) return;
  Levers<slopes> levers;
  Real sag[max_joints];
  find_levers(arm, turn, levers);
  sag_of(arm, levers, sag, sag_slope);
  for (std::int32_t i = 0; i < joints; ++i) {
    turn_by_sag(sag[i], turn[i].sine, turn[i].cosine);
    if (by_terms != nullptr) by_terms[i] += sag[i];
  }
}

inline void append_flange(const Arm<Real>& arm, Frame<Real>& frame) {
  if (arm.has_flange != 0) multiply(frame, arm.last_T_flange, frame);
}

constexpr Frame<Real> identity{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

}  // namespace

bool readings_valid(const Arm<Real>& arm, const Real* q) noexcept {
  if (arm.mark != arm_mark<Real>) return false;
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    if (!__builtin_islessequal(magnitude(q[i]), reading_bound)) return false;  // as within() does, in one comparison
  }
  return true;
}

namespace {

[[gnu::noinline]] void evaluate_terms(const Arm<Real>& arm, const Real* q, Frame<Real>& base_T_flange) {
  LinkTurn turn[max_joints];
  read_links<false>(arm, q, turn, nullptr, nullptr, nullptr);
  for (std::int32_t i = 0; i < arm.joint_count; ++i) append_turn<false>(arm, i, turn[i], base_T_flange, nullptr);
  append_flange(arm, base_T_flange);
}

// From points and axes to velocities of the flange's origin.
[[gnu::always_inline]] inline void to_velocities(const Arm<Real>& arm, const Real* p, Jacobian<Real>& coordinates) {
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    Real* column = coordinates.column[i];
    const Real x = column[3], y = column[4], z = column[5];
    if (slides(arm, i)) {
      column[0] = x;
      column[1] = y;
      column[2] = z;
      for (int k = 3; k < 6; ++k) column[k] = 0;
      continue;
    }
    const Real lever_x = p[0] - column[0], lever_y = p[1] - column[1], lever_z = p[2] - column[2];
    column[0] = y * lever_z - z * lever_y;
    column[1] = z * lever_x - x * lever_z;
    column[2] = x * lever_y - y * lever_x;
  }
}

// The Jacobian by coordinates before the terms: J (1 + sag's slopes) (1 + functions' slopes by motion).
[[gnu::noinline]] void add_slopes(const Arm<Real>& arm, const Real (*sag_slope)[max_joints], const FunctionValue* function,
                                  Jacobian<Real>& jacobian) {
  const std::int32_t joints = arm.joint_count;
  if (arm.terms.sag_mask != 0U) {
    const Jacobian<Real> geometric = jacobian;
    for (std::int32_t j = 0; j < joints; ++j) {
      Real* to = jacobian.column[j];
      Real a = to[0], b = to[1], c = to[2], d = to[3], e = to[4], f = to[5];
      for (std::int32_t i = 0; i < joints; ++i) {
        const Real s = sag_slope[i][j];
        const Real* from = geometric.column[i];
        a += s * from[0];
        b += s * from[1];
        c += s * from[2];
        d += s * from[3];
        e += s * from[4];
        f += s * from[5];
      }
      to[0] = a;
      to[1] = b;
      to[2] = c;
      to[3] = d;
      to[4] = e;
      to[5] = f;
    }
  }
  if (arm.terms.functions == nullptr) return;
  if (arm.coupled == 0) {
    for (std::int32_t j = 0; j < joints; ++j) {
      const Real scale = Real{1} + arm.link[j].sign * arm.terms_share * function[j].slope;
      Real* column = jacobian.column[j];
      for (int k = 0; k < 6; ++k) column[k] *= scale;
    }
    return;
  }
  // A function's slope is by its own reading, which the coordinates' motion is turned back into.
  const Jacobian<Real> before = jacobian;
  for (std::int32_t j = 0; j < joints; ++j) {
    for (std::int32_t i = 0; i < joints; ++i) {
      const Real s = arm.terms_share * function[i].slope * arm.inverse_map[i][j];
      for (int k = 0; k < 6; ++k) jacobian.column[j][k] += s * before.column[i][k];
    }
  }
}

[[gnu::noinline]] void evaluate_terms(const Arm<Real>& arm, const Real* q, Frame<Real>& base_T_flange,
                                      Jacobian<Real>& coordinates) {
  LinkTurn turn[max_joints];
  Real sag_slope[max_joints][max_joints];
  FunctionValue function[max_joints];
  read_links<true>(arm, q, turn, sag_slope, function, nullptr);
  const std::int32_t joints = arm.joint_count;
  for (std::int32_t i = 0; i < joints; ++i) append_turn<true>(arm, i, turn[i], base_T_flange, coordinates.column[i]);
  append_flange(arm, base_T_flange);
  to_velocities(arm, base_T_flange.position_m, coordinates);
  add_slopes(arm, sag_slope, function, coordinates);
  if (joints > curvature_column) return;
  for (std::int32_t i = 0; i < joints; ++i) {
    coordinates.column[curvature_column][i] = arm.terms.functions == nullptr ? Real{0} : arm.terms_share * function[i].curvature;
  }
}

}  // namespace

void evaluate(const Arm<Real>& arm, const Real* q, Frame<Real>& base_T_flange) noexcept {
  if (arm.has_terms != 0) {
    evaluate_terms(arm, q, base_T_flange);
    return;
  }
  for (std::int32_t i = 0; i < arm.joint_count; ++i) append_link<false>(arm, i, q, base_T_flange, nullptr);
  append_flange(arm, base_T_flange);
}

std::uint32_t unseen_readings(const Arm<Real>& arm, const Real* q) noexcept {
  std::uint32_t mask = 0;
  for (std::uint32_t left = arm.seen_mask, i = 0; left != 0U; left >>= 1U, ++i) {
    if ((left & 1U) == 0U) continue;
    Real u;
    const std::int32_t sector = (sector_of(q[i], u) - arm.seen_first[i]) & (turn_sectors - 1);
    if (sector >= arm.seen_sectors[i]) mask |= 1U << i;
  }
  return mask;
}

void coordinates_by_terms(const Arm<Real>& arm, const Real* q, Real* added) noexcept {
  LinkTurn turn[max_joints];
  read_links<false>(arm, q, turn, nullptr, nullptr, added);
}

void evaluate(const Arm<Real>& arm, const Real* q, Frame<Real>& base_T_flange, Jacobian<Real>& coordinates) noexcept {
  if (arm.has_terms != 0) {
    evaluate_terms(arm, q, base_T_flange, coordinates);
    return;
  }
  evaluate_plain(arm, q, base_T_flange, coordinates);
}

void evaluate_plain(const Arm<Real>& arm, const Real* q, Frame<Real>& base_T_flange, Jacobian<Real>& coordinates) noexcept {
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    append_link<true>(arm, i, q, base_T_flange, coordinates.column[i]);
  }
  append_flange(arm, base_T_flange);
  to_velocities(arm, base_T_flange.position_m, coordinates);
}

void to_readings(const Arm<Real>& arm, Jacobian<Real>& jacobian) noexcept {
  if (arm.coupled == 0) {
    for (std::int32_t j = 0; j < arm.joint_count; ++j) {
      if (arm.link[j].sign > Real{0}) continue;
      for (int k = 0; k < 6; ++k) jacobian.column[j][k] = -jacobian.column[j][k];
    }
    return;
  }
  for (int k = 0; k < 6; ++k) {
    Real row[max_joints];
    for (std::int32_t j = 0; j < arm.joint_count; ++j) {
      Real sum = 0;
      for (std::int32_t i = 0; i < arm.joint_count; ++i) sum += arm.map[i][j] * jacobian.column[i][k];
      row[j] = sum;
    }
    for (std::int32_t j = 0; j < arm.joint_count; ++j) jacobian.column[j][k] = row[j];
  }
}

Status forward(const Arm<Real>& arm, const Real* q, Pose<Real>& base_T_flange) noexcept {
  if (!readings_valid(arm, q)) return Status::bad_input;
  Frame<Real> frame;
  evaluate(arm, q, frame);
  to_pose(frame, base_T_flange);
  return Status::ok;
}

Status forward(const Arm<Real>& arm, const Real* q, Pose<Real>& base_T_flange, Jacobian<Real>& jacobian) noexcept {
  if (!readings_valid(arm, q)) return Status::bad_input;
  Frame<Real> frame;
  evaluate(arm, q, frame, jacobian);
  for (std::size_t j = static_cast<std::size_t>(arm.joint_count); j < max_joints; ++j) {
    for (Real& entry : jacobian.column[j]) entry = 0;
  }
  to_readings(arm, jacobian);
  to_pose(frame, base_T_flange);
  return Status::ok;
}

Status link_frames(const Arm<Real>& arm, const Real* q, Frame<Real>* frames) noexcept {
  if (!readings_valid(arm, q)) return Status::bad_input;
  LinkTurn turn[max_joints];
  if (arm.has_terms != 0) {
    read_links<false>(arm, q, turn, nullptr, nullptr, nullptr);
  } else {
    for (std::int32_t i = 0; i < arm.joint_count; ++i) read_link(arm, i, plain_coordinate(arm, i, q), turn[i]);
  }
  frames[0] = identity;
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    frames[i + 1] = frames[i];
    append_turn<false>(arm, i, turn[i], frames[i + 1], nullptr);
  }
  frames[arm.joint_count + 1] = frames[arm.joint_count];
  append_flange(arm, frames[arm.joint_count + 1]);
  return Status::ok;
}

}  // namespace mdhcal
