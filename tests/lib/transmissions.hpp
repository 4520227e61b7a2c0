// SPDX-License-Identifier: MIT
// Transmissions for the tests of lib, and what they do in long double, derived apart from the library.
#pragma once

#include <cmath>

#include "mdhcal/transmission.hpp"
#include "tests/lib/arms.hpp"
#include "tests/support/wide_frame.hpp"

namespace mdhcal::test {

inline constexpr long double wide_pi = 3.14159265358979323846264338327950288L;

/// A function of these orders with amplitudes up to 0.35 mrad in the first three and a tenth of that above, as arms have, seen
/// over `seen_rad` somewhere.
inline JointFunction some_function(Random& random, int orders, double seen_rad) {
  JointFunction f{};
  f.order_count = orders;
  f.seen_min_rad = random.symmetric(pi);
  f.seen_max_rad = f.seen_min_rad + seen_rad;
  for (int k = 0; k < orders; ++k) {
    const double bound = k < 3 || k == 27 ? 3e-4 : 3e-5;
    f.cosine_rad[k] = static_cast<float>(random.symmetric(bound));
    f.sine_rad[k] = static_cast<float>(random.symmetric(bound));
  }
  return f;
}

/// f in long double, from its definition.
inline long double wide_function(const JointFunction& f, long double r) {
  const long double sector = wide_pi / 32;
  const long double begin = std::ceil(static_cast<long double>(f.seen_min_rad) / sector - 1e-9L) * sector;
  const long double seen = std::floor(static_cast<long double>(f.seen_max_rad) / sector + 1e-9L) * sector - begin;
  const long double gap = 2 * wide_pi - seen;
  long double window = 1;
  if (gap > 3.5L * sector) {
    const long double fade = std::min(4.0L, std::floor(gap / sector / 2 + 1e-6L)) * sector;
    long double x = std::fmod(r - begin, 2 * wide_pi);
    if (x < 0) x += 2 * wide_pi;
    const long double s = std::min(1.0L, std::max(0.0L, std::min(x - seen, 2 * wide_pi - x)) / fade);
    window = 1 - 3 * s * s + 2 * s * s * s;
  }
  long double sum = 0;
  for (int k = 1; k <= f.order_count; ++k) {
    sum += static_cast<long double>(f.cosine_rad[k - 1]) * std::cos(static_cast<long double>(k) * r) +
           static_cast<long double>(f.sine_rad[k - 1]) * std::sin(static_cast<long double>(k) * r);
  }
  return window * sum;
}

/// Functions on every joint that turns and a sag of up to 2 mrad a link's weight, payload known.
inline Transmission some_transmission(Random& random, const Geometry& g) {
  Transmission t{};
  double square = 0;
  for (double& x : t.gravity.direction) {
    x = random.symmetric(1);
    square += x * x;
  }
  for (double& x : t.gravity.direction) x /= std::sqrt(square);
  double reach = 0.2;
  for (int i = 0; i < g.joint_count; ++i) reach += std::fabs(g.link[i].a_m) + std::fabs(g.link[i].d_m);
  for (int i = 0; i < g.joint_count; ++i) {
    t.function[i].seen_min_rad = -3;
    t.function[i].seen_max_rad = 3;
    if (g.joint[i].kind == JointKind::prismatic) continue;
    t.function[i] = some_function(random, 40, random.uniform(1.0, 7.0));
    for (int j = i; j < g.joint_count; ++j) t.gravity.compliance[i][j] = random.symmetric(2e-3 / reach);
    t.gravity.payload_compliance[i] = random.symmetric(1e-4 / reach);
  }
  t.gravity.payload_kg = random.uniform(0, 5);
  for (double& x : t.gravity.payload_com_m) x = random.symmetric(0.1);
  return t;
}

/// Arms of seven kinds, with errors, readings reversed and some of them coupled: axes 2, 3, 4 parallel; a spherical wrist with
/// and without offsets; no family; a gantry with a wrist; seven joints; five.
inline Geometry some_arm(Random& random, int kind) {
  Geometry g = kind % 7 == 0   ? ur5()
               : kind % 7 == 1 ? wrist_arm()
               : kind % 7 == 2 ? puma560()
               : kind % 7 == 5 ? seven_joint_arm()
               : kind % 7 == 6 ? five_joint_arm()
                               : random_arm(random);
  if (kind % 7 == 4) {
    for (int i = 0; i < 3; ++i) {
      g.joint[i].kind = JointKind::prismatic;
      g.link[i].alpha_rad = (i == 0 ? 0 : 90) * deg;
      g.link[i].theta_rad = 90 * deg;
      g.joint[i].has_min = g.joint[i].has_max = 1;
      g.joint[i].min = -3.2;
      g.joint[i].max = 3.2;
    }
  }
  g = with_errors(g, random, 1e-3, 0.1 * deg);
  for (int i = 0; i < g.joint_count; ++i) g.joint[i].sign = random.symmetric(1) < 0 ? -1 : 1;
  if (kind % 3 == 1 && kind % 7 != 4) g.joint[2].coupling[1] = random.symmetric(1);
  if (kind % 5 == 2 && kind % 7 != 4) g.joint[4].coupling[0] = random.symmetric(1);
  if (kind % 2 == 1) {
    for (double& p : g.last_T_flange.position_m) p = random.symmetric(0.1);
  }
  return g;
}

/// base_T_1 ... base_T_N, base_T_flange at joint coordinates, factor by factor.
inline void wide_chain(const Geometry& g, const long double* coordinate, tests::WideFrame* frames) {
  tests::WideFrame t;
  for (int i = 0; i < g.joint_count; ++i) {
    const Link& link = g.link[i];
    const bool slides = g.joint[i].kind == JointKind::prismatic;
    t = t * tests::wide_rot_x(static_cast<long double>(link.alpha_rad)) *
        tests::wide_translation(static_cast<long double>(link.a_m), 0, 0) *
        tests::wide_rot_z(static_cast<long double>(link.theta_rad) + (slides ? 0.0L : coordinate[i])) *
        tests::wide_translation(0, 0, static_cast<long double>(link.d_m) + (slides ? coordinate[i] : 0.0L));
    frames[i] = t;
    t = t * tests::wide_rot_y(static_cast<long double>(link.beta_rad));
  }
  frames[g.joint_count] = t * tests::wide(g.last_T_flange);
}

/// The joint coordinates at the readings q, with signs, couplings, the series and the torque, from their definitions.
inline void wide_coordinates(const Geometry& g, const Transmission& t, long double payload_kg, const long double* q,
                             long double* coordinate) {
  for (int i = 0; i < g.joint_count; ++i) {
    coordinate[i] = g.joint[i].sign * q[i] + wide_function(t.function[i], q[i]);
    for (int j = 0; j < g.joint_count; ++j) coordinate[i] += static_cast<long double>(g.joint[i].coupling[j]) * q[j];
  }
  tests::WideFrame frames[max_joints + 1];
  wide_chain(g, coordinate, frames);
  const double* d = t.gravity.direction;
  // z_i . ((p - o_i) x g)
  const auto torque = [&](int i, long double x, long double y, long double z) {
    const auto& m = frames[i].m;
    const long double r[3] = {x - m[0][3], y - m[1][3], z - m[2][3]};
    return m[0][2] * (r[1] * static_cast<long double>(d[2]) - r[2] * static_cast<long double>(d[1])) +
           m[1][2] * (r[2] * static_cast<long double>(d[0]) - r[0] * static_cast<long double>(d[2])) +
           m[2][2] * (r[0] * static_cast<long double>(d[1]) - r[1] * static_cast<long double>(d[0]));
  };
  const tests::WideFrame com = frames[g.joint_count] * tests::wide_translation(static_cast<long double>(t.gravity.payload_com_m[0]),
                                                                               static_cast<long double>(t.gravity.payload_com_m[1]),
                                                                               static_cast<long double>(t.gravity.payload_com_m[2]));
  for (int i = 0; i < g.joint_count; ++i) {
    for (int j = i; j < g.joint_count; ++j) {
      const auto& end = frames[j + 1].m;
      coordinate[i] += static_cast<long double>(t.gravity.compliance[i][j]) * torque(i, end[0][3], end[1][3], end[2][3]);
    }
    coordinate[i] += (payload_kg - static_cast<long double>(t.gravity.payload_kg)) *
                     static_cast<long double>(t.gravity.payload_compliance[i]) * torque(i, com.m[0][3], com.m[1][3], com.m[2][3]);
  }
}

/// base_T_flange with all terms.
inline tests::WideFrame wide_forward_terms(const Geometry& g, const Transmission& t, long double payload_kg, const long double* q) {
  long double coordinate[max_joints];
  tests::WideFrame frames[max_joints + 1];
  wide_coordinates(g, t, payload_kg, q, coordinate);
  wide_chain(g, coordinate, frames);
  return frames[g.joint_count];
}

}  // namespace mdhcal::test
