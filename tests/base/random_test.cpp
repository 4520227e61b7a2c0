// SPDX-License-Identifier: MIT
#include "offline/base/random.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace {

using mdhcal::offline::Random;

// The C++ standard fixes the 10000th word of a default-seeded engine ([rand.predef]); uniform() is its top 53 bits.
TEST(Random, UniformNumbersAreTheTopBitsOfTheStandardEngine) {
  Random random(std::mt19937_64::default_seed);
  for (int i = 1; i < 10000; ++i) random.bits();
  EXPECT_EQ(random.bits(), 9981545732273789042ULL);
  Random same(std::mt19937_64::default_seed);
  for (int i = 1; i < 10000; ++i) same.bits();
  EXPECT_EQ(same.uniform(), static_cast<double>(9981545732273789042ULL >> 11) / 9007199254740992.0);
}

TEST(Random, NormalNumbersHaveTheMomentsAndTailsOfTheNormalLaw) {
  Random random(7);
  constexpr int count = 1000000;
  double sum = 0, squares = 0, fourth = 0;
  int within_one = 0, beyond_three = 0;
  for (int i = 0; i < count; ++i) {
    const double z = random.normal();
    sum += z;
    squares += z * z;
    fourth += z * z * z * z;
    within_one += std::abs(z) < 1;
    beyond_three += std::abs(z) > 3;
  }
  // Bounds are five standard deviations of each statistic over a million draws.
  EXPECT_NEAR(sum / count, 0, 5e-3);
  EXPECT_NEAR(squares / count, 1, 5 * std::sqrt(2.0 / count));
  EXPECT_NEAR(fourth / count, 3, 5 * std::sqrt(96.0 / count));
  EXPECT_NEAR(static_cast<double>(within_one) / count, 0.6826894921, 5 * 0.466e-3);
  EXPECT_NEAR(static_cast<double>(beyond_three) / count, 0.0026997961, 5 * 0.052e-3);
}

TEST(Random, IndicesCoverTheirRangeEvenly) {
  Random random(3);
  int seen[7] = {};
  for (int i = 0; i < 70000; ++i) ++seen[random.index(7)];
  for (const int count : seen) EXPECT_NEAR(count, 10000, 5 * 93);
}

}  // namespace
