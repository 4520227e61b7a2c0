// SPDX-License-Identifier: MIT
// The square root for processors without one in double, against the machine's own, which IEEE 754 pins to the last bit.
#include "lib/src/number/square_root.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace {

std::uint64_t bits_of(double x) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}

void expect_same(std::uint64_t bits) {
  double x = 0;
  std::memcpy(&x, &bits, sizeof x);
  const double root = std::sqrt(x);
  const double own = mdhcal::integer_square_root(x);
  if (std::isnan(root)) {
    ASSERT_TRUE(std::isnan(own));
  } else {
    ASSERT_EQ(bits_of(own), bits_of(root)) << std::hex << bits;
  }
}

TEST(SquareRoot, IsRoundedCorrectlyEverywhere) {
  std::uint64_t state = 88172645463325252U;
  for (int i = 0; i < 30000; ++i) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    expect_same(state);
    expect_same(state & 0x7FFFFFFFFFFFFFFFU);
    expect_same(state & 0x000FFFFFFFFFFFFFU);
  }
}

TEST(SquareRoot, HoldsAtTheEdges) {
  using limits = std::numeric_limits<double>;
  for (double x : {0.0, -0.0, 1.0, 2.0, 4.0, 0.25, -1.0, limits::infinity(), -limits::infinity(), limits::quiet_NaN(),
                   limits::denorm_min(), 2 * limits::denorm_min(), limits::min(), limits::max(), 1.0 - 0x1p-53,
                   1.0 + 0x1p-52, 4.0 - 0x1p-51}) {
    expect_same(bits_of(x));
  }
}

}  // namespace
