// SPDX-License-Identifier: MIT
#include "offline/base/distributions.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace {

using namespace mdhcal::offline;

// Quantiles from printed tables of F, and closed forms.
TEST(Distributions, TheUpperTailOfFIsThatOfTheTables) {
  EXPECT_NEAR(f_upper_tail(3.4928, 2, 20), 0.05, 2e-6);
  EXPECT_NEAR(f_upper_tail(4.9646, 1, 10), 0.05, 2e-6);
  EXPECT_NEAR(f_upper_tail(2.9782, 10, 10), 0.05, 2e-6);
  EXPECT_NEAR(f_upper_tail(161.4476, 1, 1), 0.05, 1e-8);
  EXPECT_NEAR(f_upper_tail(2.5487, 20, 30), 0.01, 2e-6);
  for (const double f : {0.1, 1.0, 3.0, 30.0}) {  // two numerator degrees: (1 + 2 f / d)^(-d / 2)
    EXPECT_NEAR(f_upper_tail(f, 2, 7), std::pow(1 + 2 * f / 7, -3.5), 1e-13);
    EXPECT_NEAR(f_upper_tail(f, 5, 9), 1 - f_upper_tail(1 / f, 9, 5), 1e-13);
  }
  EXPECT_EQ(f_upper_tail(0, 3, 3), 1);
  EXPECT_NEAR(f_upper_tail(1, 30000, 30000), 0.5, 1e-9);
}

// Printed tables of Student's t, two-sided 5 %.
TEST(Distributions, StudentsQuantilesAreThoseOfTheTables) {
  EXPECT_NEAR(student_975(1), 12.7062, 1e-4);
  EXPECT_NEAR(student_975(2), 4.3027, 1e-4);
  EXPECT_NEAR(student_975(5), 2.5706, 1e-4);
  EXPECT_NEAR(student_975(14), 2.1448, 1e-4);
  EXPECT_NEAR(student_975(120), 1.9799, 1e-4);
}

}  // namespace
