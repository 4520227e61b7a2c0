// SPDX-License-Identifier: MIT
#include "offline/identify/lambda_rules.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "offline/base/random.hpp"
#include "tests/identify/ill_posed.hpp"

namespace {

using namespace mdhcal::offline;
using namespace mdhcal::tests;

constexpr double noise_share = 1e-3;
// 64 rows: what rounding leaves of an SVD.
constexpr double tolerance = 64 * 2.220446049250313e-16;

struct Draw {
  SpectralProblem problem;
  double sigma = 0;
  double best_error = 0;
  Eigen::VectorXd truth;

  double error(double lambda) const { return (problem.solution(lambda) - truth).norm() / truth.norm(); }
};

Draw draw_of(const IllPosed& given, std::uint64_t seed) {
  Random random(seed);
  Eigen::VectorXd noise(given.b.size());
  for (double& e : noise) e = random.normal();
  noise *= noise_share * given.b.norm() / noise.norm();
  Draw out;
  out.problem = spectral_problem(given.a, given.b + noise, tolerance);
  out.sigma = noise_share * given.b.norm() / std::sqrt(static_cast<double>(given.b.size()));
  out.truth = given.x;
  out.best_error = 1e300;
  for (double t = -40; t <= 10; t += 0.01) out.best_error = std::min(out.best_error, out.error(std::pow(10.0, t)));
  return out;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

class ClassicalProblems : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    for (const IllPosed& given : ill_posed_problems(64)) {
      for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        const Draw draw = draw_of(given, seed);
        const auto note = [&](const char* rule, const LambdaChoice& choice) {
          ratios[given.name + " " + rule].push_back(choice.found ? draw.error(choice.lambda) / draw.best_error : 1e9);
        };
        note("l-curve", l_curve(draw.problem));
        note("gcv", generalised_cross_validation(draw.problem));
        note("quasi-optimality", quasi_optimality(draw.problem));
        note("discrepancy", discrepancy(draw.problem, draw.sigma));
        note("reml", marginal_likelihood(draw.problem));
      }
    }
    for (const auto& [key, values] : ratios) {
      std::printf("%-28s median %.3f worst %.3g\n", key.c_str(), median(values),
                  *std::max_element(values.begin(), values.end()));
    }
  }
  static std::map<std::string, std::vector<double>> ratios;
};
std::map<std::string, std::vector<double>> ClassicalProblems::ratios;

TEST_F(ClassicalProblems, DiscrepancyIsWithinOneAndAHalf) {
  for (const char* name : {"shaw", "phillips", "gravity", "i_laplace"}) {
    EXPECT_LE(median(ratios[std::string(name) + " discrepancy"]), 1.5) << name;
  }
}

TEST_F(ClassicalProblems, QuasiOptimalityIsWithinOneAndAHalf) {
  for (const char* name : {"shaw", "phillips", "gravity", "i_laplace"}) {
    EXPECT_LE(median(ratios[std::string(name) + " quasi-optimality"]), 1.5) << name;
  }
}

TEST_F(ClassicalProblems, GeneralisedCrossValidationIsWithinTwo) {
  for (const char* name : {"shaw", "phillips", "gravity", "i_laplace"}) {
    EXPECT_LE(median(ratios[std::string(name) + " gcv"]), 2.0) << name;
  }
}

TEST_F(ClassicalProblems, LCurveIsWithinOneAndAHalfWhereItWorks) {
  EXPECT_LE(median(ratios["shaw l-curve"]), 1.5);
  EXPECT_LE(median(ratios["i_laplace l-curve"]), 1.5);
}

// At round-off the solution is noise times 1e13: a hundredfold of the best error is still far from it.
TEST_F(ClassicalProblems, TheCornerIsNeverAtRoundOff) {
  for (const char* name : {"shaw", "phillips", "gravity", "i_laplace"}) {
    for (double ratio : ratios[std::string(name) + " l-curve"]) EXPECT_LE(ratio, 100.0) << name;
  }
}

// The curvature of log norms by central differences of the norms themselves.
TEST(LCurve, CurvatureIsThatOfTheSampledCurve) {
  const Draw draw = draw_of(shaw(32), 5);
  for (double t = -6; t <= 0; t += 0.5) {
    const double h = 1e-3;
    double u[3];
    double v[3];
    for (int k = 0; k < 3; ++k) {
      const double lambda = std::exp(t * std::log(10.0) + (k - 1) * h);
      u[k] = 0.5 * std::log(draw.problem.residual_norm2(lambda));
      v[k] = 0.5 * std::log(draw.problem.solution_norm2(lambda));
    }
    const double u1 = (u[2] - u[0]) / (2 * h);
    const double v1 = (v[2] - v[0]) / (2 * h);
    const double u2 = (u[2] - 2 * u[1] + u[0]) / (h * h);
    const double v2 = (v[2] - 2 * v[1] + v[0]) / (h * h);
    const double expected = (u1 * v2 - u2 * v1) / std::pow(u1 * u1 + v1 * v1, 1.5);
    EXPECT_NEAR(l_curve_curvature(draw.problem, std::pow(10.0, t)), expected, 1e-3 * (1.0 + std::fabs(expected)));
  }
}

// A straight descent has no corner: one singular value only.
TEST(LCurve, NoCornerIsAnAnswer) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3, 1);
  a(0, 0) = 1.0;
  const LambdaChoice choice = l_curve(spectral_problem(a, Eigen::Vector3d(1.0, 0.0, 0.0), tolerance));
  EXPECT_FALSE(choice.found);
  EXPECT_FALSE(choice.note.empty());
}

// With lambda's bounds every rule stays inside them.
TEST(Rules, StayWithinTheirBounds) {
  for (const IllPosed& given : ill_posed_problems(32)) {
    const Draw draw = draw_of(given, 3);
    for (const LambdaChoice& choice :
         {l_curve(draw.problem), generalised_cross_validation(draw.problem), quasi_optimality(draw.problem),
          discrepancy(draw.problem, draw.sigma), marginal_likelihood(draw.problem)}) {
      if (!choice.found) continue;
      EXPECT_GE(choice.lambda, draw.problem.smallest_lambda() * 0.999) << choice.rule;
      EXPECT_LE(choice.lambda, draw.problem.largest_lambda() * 1.001) << choice.rule;
    }
  }
}

TEST(Discrepancy, SaysWhenTheNoiseIsUnderstated) {
  const Draw draw = draw_of(shaw(64), 1);
  EXPECT_TRUE(discrepancy(draw.problem, draw.sigma).found);
  const LambdaChoice choice = discrepancy(draw.problem, 1e-6 * draw.sigma);
  EXPECT_FALSE(choice.found);
  EXPECT_NE(choice.note.find("understated"), std::string::npos);
}

// The sweep's corner cases: a judge that likes one lambda is obeyed to within a step.
TEST(TwoStageSweep, FindsTheJudgesFavourite) {
  const Draw draw = draw_of(shaw(64), 1);
  const double corner = l_curve(draw.problem).lambda;
  for (double favourite : {1e-5 * corner, 1e-2 * corner, corner, 5 * corner}) {
    const Judge judge = [&](double lambda) { return std::fabs(std::log(lambda / favourite)); };
    const LambdaChoice choice = two_stage_sweep(draw.problem, judge, "rpim");
    EXPECT_NEAR(std::log(choice.lambda / favourite), 0.0, 0.3);
  }
}

}  // namespace
