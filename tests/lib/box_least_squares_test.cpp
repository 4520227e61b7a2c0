// SPDX-License-Identifier: MIT
// The solver of a tick's step against the conditions that mark the minimum within bounds (Karush 1939; Kuhn, Tucker 1951).
#define MDHCAL_REAL double
#include "lib/src/inverse/box_least_squares.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/lib/arms.hpp"

namespace {

using namespace mdhcal;
using test::Random;

struct Bounded : BoxProblem {
  Box box;
};

// The rows' entries up to 1, nearly dependent in every third problem; bounds from nothing to far beyond the solution.
Bounded random_problem(Random& random, int n, std::int32_t rows, std::int32_t columns) {
  Bounded problem{};
  problem.rows = rows;
  problem.columns = columns;
  for (std::int32_t i = 0; i < rows; ++i) {
    for (std::int32_t j = 0; j < columns; ++j) problem.column[j][i] = random.symmetric(1);
    problem.b[i] = random.symmetric(1);
  }
  if (n % 3 == 0 && rows > 1) {
    for (std::int32_t j = 0; j < columns; ++j) problem.column[j][1] = problem.column[j][0] + random.symmetric(1e-6);
  }
  problem.budget = 1000;
  problem.damping = std::pow(10.0, -4.0 + 4.0 * std::fabs(random.symmetric(1)));
  for (std::int32_t j = 0; j < columns; ++j) {
    problem.box.pull[j] = n % 2 == 0 ? 0 : random.symmetric(0.1);
    problem.box.low[j] = j == n % 11 ? 0 : -std::pow(10.0, random.symmetric(2));
    problem.box.high[j] = j == n % 7 ? 0 : std::pow(10.0, random.symmetric(2));
  }
  return problem;
}

std::array<double, max_equations> residual(const BoxProblem& problem, const double* x) {
  std::array<double, max_equations> left{};
  std::copy(problem.b, problem.b + problem.rows, left.begin());
  for (std::int32_t i = 0; i < problem.rows; ++i) {
    for (std::int32_t j = 0; j < problem.columns; ++j) left[static_cast<std::size_t>(i)] -= problem.column[j][i] * x[j];
  }
  return left;
}

// Minus half the slope of the objective by x_j.
double pull_on(const Bounded& problem, const double* x, std::int32_t j) {
  double sum = problem.damping * problem.damping * (problem.box.pull[j] - x[j]);
  for (std::int32_t i = 0; i < problem.rows; ++i) sum += problem.column[j][i] * residual(problem, x)[static_cast<std::size_t>(i)];
  return sum;
}

TEST(BoxLeastSquares, MeetsTheConditionsOfTheMinimum) {
  constexpr double tolerance = 1e-10;  // against numbers of about 1, with dampings down to 1e-4
  Random random(41);
  int at_bounds = 0;
  constexpr int problems = test::cases(20000);
  for (int n = 0; n < problems; ++n) {
    const auto rows = static_cast<std::int32_t>(1 + n % 7), columns = static_cast<std::int32_t>(1 + n / 7 % 8);
    Bounded problem = random_problem(random, n, rows, columns);
    double x[max_joints];
    solve(problem, problem.box, x);
    for (std::int32_t j = 0; j < columns; ++j) {
      ASSERT_GE(x[j], problem.box.low[j]);
      ASSERT_LE(x[j], problem.box.high[j]);
      const double pull = pull_on(problem, x, j);
      // Away from a bound nothing pulls; on one, only outwards.
      if (x[j] < problem.box.high[j]) {
        ASSERT_LT(pull, tolerance) << n << ' ' << j;
      }
      if (x[j] > problem.box.low[j]) {
        ASSERT_GT(pull, -tolerance) << n << ' ' << j;
      }
      if (!(x[j] < problem.box.high[j]) || !(x[j] > problem.box.low[j])) ++at_bounds;
    }
  }
  EXPECT_GT(at_bounds, problems);
}

double objective(const Bounded& problem, const double* x) {
  double sum = 0;
  for (std::int32_t i = 0; i < problem.rows; ++i) sum += residual(problem, x)[static_cast<std::size_t>(i)] * residual(problem, x)[static_cast<std::size_t>(i)];
  for (std::int32_t j = 0; j < problem.columns; ++j) {
    sum += problem.damping * problem.damping * (problem.box.pull[j] - x[j]) * (problem.box.pull[j] - x[j]);
  }
  return sum;
}

// Whatever it is cut off at: within the bounds, no worse than no step, and little more than the work that was left.
TEST(BoxLeastSquares, IsUsableWithAnyBudget) {
  Random random(43);
  constexpr double nothing[max_joints] = {};
  int cut = 0;
  constexpr int problems = test::cases(20000);
  for (int n = 0; n < problems; ++n) {
    const auto rows = static_cast<std::int32_t>(1 + n % 7), columns = static_cast<std::int32_t>(1 + n / 7 % 8);
    Bounded problem = random_problem(random, n, rows, columns);
    problem.budget = n % 20 - 2;
    const std::int32_t before = problem.budget;
    double x[max_joints];
    solve(problem, problem.box, x);
    if (problem.budget <= 0) ++cut;
    EXPECT_GE(problem.budget, (before > 3 ? 3 : before) - 5) << n;
    for (std::int32_t j = 0; j < problem.columns; ++j) {
      ASSERT_GE(x[j], problem.box.low[j]);
      ASSERT_LE(x[j], problem.box.high[j]);
    }
    const double start = objective(problem, nothing);
    EXPECT_LE(objective(problem, x), start * (1 + 1e-12)) << n;
  }
  EXPECT_GT(cut, problems / 5);
}

TEST(BoxLeastSquares, WithRoomIsTheSolutionWithoutBounds) {
  Random random(42);
  for (int n = 0; n < 1000; ++n) {
    Bounded problem = random_problem(random, n, 6, 6);
    for (double& pull : problem.box.pull) pull = 0;
    double free[max_joints], bounded[max_joints];
    solve_free(problem, free);
    for (std::int32_t j = 0; j < 6; ++j) {
      problem.box.low[j] = -1e9;
      problem.box.high[j] = 1e9;
      ASSERT_LT(std::fabs(pull_on(problem, free, j)), 1e-9);
    }
    EXPECT_TRUE(inside(problem, problem.box, free));
    solve(problem, problem.box, bounded);
    for (std::int32_t j = 0; j < 6; ++j) ASSERT_EQ(bounded[j], free[j]);
  }
}

}  // namespace
