// SPDX-License-Identifier: MIT
// Private to lib/src. The square root of a double without an FPU for it: C libraries bring errno, and with it data, into
// the link. Digit by digit on the significand, rounded to nearest, ties do not occur: the bits of IEEE 754.
#pragma once

#include <cstdint>
#include <string.h>

namespace mdhcal {

static inline double integer_square_root(double x) {
  std::uint64_t bits = 0;
  memcpy(&bits, &x, sizeof bits);
  constexpr std::uint64_t infinity = 0x7FF0000000000000U;
  constexpr std::uint64_t hidden = 1ULL << 52U;
  if ((bits << 1U) == 0 || bits == infinity) return x;  // +-0, infinity
  if (bits > infinity) {                                // negative or NaN
    bits = (bits & ~(1ULL << 63U)) > infinity ? bits : 0x7FF8000000000000U;
    memcpy(&x, &bits, sizeof x);
    return x;
  }
  std::int32_t exponent = static_cast<std::int32_t>(bits >> 52U);
  std::uint64_t significand = bits & (hidden - 1U);
  if (exponent == 0) {
    exponent = 1;
    while (significand < hidden) {  // at most 52 turns: it is not zero
      significand <<= 1U;
      --exponent;
    }
  } else {
    significand |= hidden;
  }
  exponent -= 1023;
  if ((exponent & 1) != 0) {
    significand <<= 1U;
    --exponent;
  }
  // root = floor(sqrt(significand * 2^54)), 54 bits: one more than the result has. Two bits of the radicand a turn.
  std::uint64_t root = 0;
  std::uint64_t rest = 0;
  significand <<= 10U;  // its 54 bits to the top
  for (int i = 0; i < 54; ++i) {
    rest = (rest << 2U) | (significand >> 62U);
    significand <<= 2U;
    const std::uint64_t trial = (root << 2U) | 1U;
    root <<= 1U;
    if (rest >= trial) {
      rest -= trial;
      root |= 1U;
    }
  }
  bits = (root >> 1U) + (root & 1U);
  bits += static_cast<std::uint64_t>(exponent / 2 + 1022) << 52U;  // the hidden bit adds the last one
  memcpy(&x, &bits, sizeof x);
  return x;
}

}  // namespace mdhcal
