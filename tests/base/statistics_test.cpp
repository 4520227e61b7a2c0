// SPDX-License-Identifier: MIT
#include "offline/base/statistics.hpp"

#include <gtest/gtest.h>

namespace {

using mdhcal::offline::Statistics;
using mdhcal::offline::statistics;

TEST(Statistics, OfFiveByHand) {
  // Squares 1, 4, 9, 16, 100; mean 4; squared deviations 9, 4, 1, 0, 36 sum to 50.
  const Statistics s = statistics({4, 1, 10, 2, 3});
  EXPECT_EQ(s.count, 5U);
  EXPECT_DOUBLE_EQ(s.max, 10);
  EXPECT_DOUBLE_EQ(s.mean, 4);
  EXPECT_DOUBLE_EQ(s.median, 3);
  EXPECT_DOUBLE_EQ(s.sd * s.sd, 12.5);
  EXPECT_DOUBLE_EQ(s.rms * s.rms, 26);
  // Rank 0.95 * 4 = 3.8: 4 + 0.8 * 6.
  EXPECT_DOUBLE_EQ(s.p95, 8.8);
}

TEST(Statistics, OfAnEvenCountTakesTheMiddleOfTwo) { EXPECT_DOUBLE_EQ(statistics({1, 9, 2, 4}).median, 3); }

TEST(Statistics, OfOneAndOfNone) {
  EXPECT_DOUBLE_EQ(statistics({2}).p95, 2);
  EXPECT_DOUBLE_EQ(statistics({2}).sd, 0);
  EXPECT_EQ(statistics({}).count, 0U);
  EXPECT_DOUBLE_EQ(statistics({}).mean, 0);
}

TEST(Statistics, ScatterSurvivesALargeMean) {
  EXPECT_DOUBLE_EQ(statistics({1e9, 1e9 + 1, 1e9 + 2}).sd, 1);
}

}  // namespace
