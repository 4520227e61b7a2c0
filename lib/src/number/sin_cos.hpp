// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. The sine and cosine as inline code, for where a call would count.
#pragma once

#include <cstddef>
#include <cstdint>

#include <string.h>

#include "number/compare.hpp"
#include "number/real.hpp"
#include "number/trigonometry.hpp"

namespace mdhcal {
namespace {

// Polynomials are Chebyshev fits of (sin(x)/x - 1)/x^2, (cos(x) - 1 + x^2/2)/x^4 on [0, pi/4] and (atan(x)/x - 1)/x^2 on
// [0, 7/16] in x^2, computed with 60 digits and rounded. pi/2 is cut into parts whose products with a quadrant number
// are exact (Cody, Waite 1980): `near` for few quadrants, `far` for many, where the number itself is split in two.
template <class R>
struct Constants;

template <>
struct Constants<double> {
  static constexpr double near_rad = 101.0;       // 64 quadrants
  static constexpr double rounder = 0x1.8p+52;  // added and taken away, it leaves an integer
  static constexpr double near[3] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2e037073p-69};
  static constexpr double far[5] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2ep-69, 0x1.b839a252049c1p-104, 0};
  static constexpr double sine[6] = {-0x1.5555555555555p-3,  0x1.1111111110bb1p-7,  -0x1.a01a019e8357dp-13,
                                     0x1.71de37961e4c6p-19, -0x1.ae600a926c89ap-26, 0x1.5e0af186af739p-33};
  static constexpr double cosine[6] = {0x1.5555555555555p-5,   -0x1.6c16c16c16966p-10, 0x1.a01a019f4e867p-16,
                                       -0x1.27e4fa17a41b4p-22, 0x1.1eeb68b109173p-29,  -0x1.907d7aebd5e3dp-37};
  static constexpr double tangent[11] = {-0x1.5555555555554p-2, 0x1.999999999885ap-3,  -0x1.24924923b03dcp-3,
                                         0x1.c71c713636f43p-4,  -0x1.745cff5d70ad0p-4, 0x1.3b116123317ebp-4,
                                         -0x1.10ed190f13899p-4, 0x1.df0b34935310ap-5,  -0x1.9c5f39a16290ep-5,
                                         0x1.35d78557f7733p-5,  -0x1.1f71e6b79ac6dp-6};
  static constexpr double half_high = 0x1.dac670561bb4fp-2;  // atan(1/2)
  static constexpr double half_low = 0x1.a2b7f222f65e2p-56;
  static constexpr double right_high = 0x1.921fb54442d18p+0;  // pi/2
  static constexpr double right_low = 0x1.1a62633145c07p-54;
  static constexpr double splitter = 134217729.0;  // 2^27 + 1
};

template <>
struct Constants<float> {
  static constexpr float near_rad = 25.875F;  // 16 quadrants
  static constexpr float rounder = 0x1.8p+23F;
  static constexpr float near[3] = {0x1.921fap+0F, 0x1.54442p-20F, 0x1.a308d4p-41F};
  static constexpr float far[5] = {0x1.921p+0F, 0x1.f6ap-13F, 0x1.11p-26F, 0x1.68cp-39F, 0x1.1a6264p-54F};
  static constexpr float sine[4] = {-0x1.555556p-3F, 0x1.11110ep-7F, -0x1.a013a6p-13F, 0x1.6dbdd2p-19F};
  static constexpr float cosine[3] = {0x1.555554p-5F, -0x1.6c12d2p-10F, 0x1.9bd864p-16F};
  static constexpr float tangent[5] = {-0x1.555554p-2F, 0x1.999602p-3F, -0x1.23f96ep-3F, 0x1.b4f890p-4F, -0x1.fd29b0p-5F};
  static constexpr float half_high = 0x1.dac670p-2F;
  static constexpr float half_low = 0x1.586ed4p-28F;
  static constexpr float right_high = 0x1.921fb6p+0F;
  static constexpr float right_low = -0x1.777a5cp-25F;
  static constexpr float splitter = 4097.0F;  // 2^12 + 1
};

using Trig = Constants<Real>;

template <std::size_t N>
inline Real polynomial(const Real (&c)[N], Real z) {
  Real sum = c[N - 1];
  for (std::size_t k = N - 1; k-- > 0;) sum = sum * z + c[k];
  return sum;
}

// A value and what its rounding lost.
struct Pair {
  Real high, low;
};

inline Pair exact_sum(Real a, Real b) {
  const Real sum = a + b;
  const Real part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}

inline Pair exact_product(Real a, Real b) {
  const Real product = a * b;
  Real scaled = Trig::splitter * a;
  const Real a_high = scaled - (scaled - a);
  const Real a_low = a - a_high;
  scaled = Trig::splitter * b;
  const Real b_high = scaled - (scaled - b);
  const Real b_low = b - b_high;
  return {product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

// An angle in its quadrant, of which the two lowest bits count, and what is left of it.
struct Reduced {
  Pair rest;
  std::uint32_t quadrant;
};

// The integer nearest to x, ties to even, for |x| < 2^21: it stands in the lowest bits of the sum.
inline Real nearest(Real x, std::uint32_t& bits) {
  const Real sum = x + Trig::rounder;
  if constexpr (sizeof(Real) == sizeof(std::uint64_t)) {
    std::uint64_t whole = 0;
    memcpy(&whole, &sum, sizeof whole);
    bits = static_cast<std::uint32_t>(whole);
  } else {
    memcpy(&bits, &sum, sizeof bits);
  }
  return sum - Trig::rounder;
}

constexpr Real quadrants_per_rad = Real(0x1.45f306dc9c883p-1);

// Of few quadrants. The first difference is exact and a multiple of the second product's last bit, so that Dekker's
// sum of the two (1971) loses nothing, whichever is the larger (Boldo, Graillat, Muller 2017).
inline Reduced reduce_near(Real x) {
  Reduced y;
  const Real count = nearest(x * quadrants_per_rad, y.quadrant);
  const Real first = x - count * Trig::near[0];
  const Real second = count * Trig::near[1];
  y.rest.high = first - second;
  y.rest.low = ((first - y.rest.high) - second) - count * Trig::near[2];
  return y;
}

// Of many quadrants: every product is exact, and every sum but the last keeps its rounding. Out of range: NaN.
[[gnu::noinline]] Reduced reduce_far(Real x) {
  constexpr Real bound = static_cast<Real>(max_sin_cos_rad);
  if (!(magnitude(x) <= bound)) return {{static_cast<Real>(__builtin_nanf("")), 0}, 0};
  std::uint32_t quadrant = 0;
  const std::int32_t count = static_cast<std::int32_t>(nearest(x * quadrants_per_rad, quadrant));
  const Real low_part = static_cast<Real>(count % 512);
  const Real high_part = static_cast<Real>(count - count % 512);
  Real high = x;
  Real low = 0;
  for (const Real part : Trig::far) {
    const Pair first = exact_sum(high, -(high_part * part));
    const Pair second = exact_sum(first.high, -(low_part * part));
    high = second.high;
    low += first.low + second.low;
  }
  return {{high, low}, quadrant};
}

/// sin_cos() as inline code.
[[gnu::always_inline]] inline void sin_cos_inline(Real angle_rad, Real& sine, Real& cosine) {
  const Reduced y = magnitude(angle_rad) <= Trig::near_rad ? reduce_near(angle_rad) : reduce_far(angle_rad);
  const Real high = y.rest.high;
  const Real z = high * high;
  const Real half = Real(0.5) * z;
  const Real rest = Real{1} - half;
  const Real s = high + (y.rest.low * rest + high * z * polynomial(Trig::sine, z));
  const Real c = rest + (((Real{1} - rest) - half) + (z * z * polynomial(Trig::cosine, z) - y.rest.low * high));
  const bool odd = (y.quadrant & 1U) != 0;
  const Real sine_size = odd ? c : s;
  const Real cosine_size = odd ? s : c;
  sine = (y.quadrant & 2U) != 0 ? -sine_size : sine_size;
  cosine = ((y.quadrant + 1U) & 2U) != 0 ? -cosine_size : cosine_size;
}

}  // namespace
}  // namespace mdhcal
