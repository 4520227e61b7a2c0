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
  if (gap > 1.5L * sector) {
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

}  // namespace mdhcal::test
