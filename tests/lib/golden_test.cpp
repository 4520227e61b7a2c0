// SPDX-License-Identifier: MIT
#include "tests/lib/golden.hpp"

#include <gtest/gtest.h>

namespace {

using namespace mdhcal::test;

// Without a double unit 100 000 operations in double would take minutes under emulation.
#if defined(__ARM_FP) && !(__ARM_FP & 8)
constexpr bool slow_double = true;
#else
constexpr bool slow_double = false;
#endif

TEST(Golden, DoubleHasTheSameBitsOnEveryMachine) {
  EXPECT_EQ(golden_hash<double>(golden_soft), golden_double_soft);
  if (!slow_double) {
    EXPECT_EQ(golden_hash<double>(golden_short), golden_double_short);
    EXPECT_EQ(golden_hash<double>(golden_operations), golden_double);
  }
}

TEST(Golden, FloatHasTheSameBitsOnEveryMachine) {
  EXPECT_EQ(golden_hash<float>(golden_short), golden_float_short);
  EXPECT_EQ(golden_hash<float>(golden_operations), golden_float);
}

}  // namespace
