// SPDX-License-Identifier: MIT
#include "offline/plan/design.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "offline/base/random.hpp"

namespace {

using namespace mdhcal::offline;

Experiment random_experiment(std::uint64_t seed, Eigen::Index candidates, Eigen::Index unknowns) {
  Random random(seed);
  Experiment e;
  e.rows_per_pose = 3;
  e.rows.resize(3 * candidates, unknowns);
  for (double& x : e.rows.reshaped()) x = random.normal();
  // Poses of different worth: without it every criterion would be nearly flat.
  for (Eigen::Index c = 0; c < candidates; ++c) e.rows.middleRows(3 * c, 3) *= random.uniform(0.2, 2);
  e.prior = Eigen::VectorXd::Constant(unknowns, 0.1);
  e.of_interest = 2;
  e.targets = e.rows;
  return e;
}

// The criteria from their definitions, by the normal matrix and its inverse.
double by_definition(const Experiment& e, Criterion criterion, const std::vector<std::size_t>& chosen) {
  Eigen::MatrixXd m = e.prior.cwiseAbs2().asDiagonal();
  for (const std::size_t c : chosen) {
    const Eigen::MatrixXd j = e.rows.middleRows(3 * static_cast<Eigen::Index>(c), 3);
    m += j.transpose() * j;
  }
  const Eigen::MatrixXd covariance = m.inverse();
  switch (criterion) {
    case Criterion::d: return std::log(m.determinant());
    case Criterion::a: return -covariance.diagonal().tail(m.cols() - e.of_interest).sum();
    case Criterion::e: return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(m).eigenvalues()[0];
    case Criterion::position: break;
  }
  return -(e.targets * covariance * e.targets.transpose()).trace();
}

constexpr Criterion criteria[] = {Criterion::d, Criterion::a, Criterion::e, Criterion::position};

TEST(Design, TheCriteriaAreThoseOfTheInformationMatrix) {
  const Experiment e = random_experiment(1, 30, 6);
  const std::vector<std::size_t> chosen{3, 7, 20, 29};
  for (const Criterion criterion : criteria) {
    const double truth = by_definition(e, criterion, chosen);
    EXPECT_NEAR(value(e, criterion, information_factor(e, chosen)), truth, 1e-9 * std::abs(truth));
  }
}

TEST(Design, ExpectedErrorsAreTheRootsOfTheTraces) {
  const Experiment e = random_experiment(2, 10, 5);
  const std::vector<std::size_t> chosen{1, 2, 5};
  const Eigen::VectorXd errors = expected_errors(e.rows, 3, information_factor(e, chosen));
  Experiment one = e;
  for (Eigen::Index c = 0; c < 10; ++c) {
    one.targets = e.rows.middleRows(3 * c, 3);
    EXPECT_NEAR(errors[c] * errors[c], -by_definition(one, Criterion::position, chosen), 1e-12);
  }
}

// Every subset of 3 of 14, by definition: the exchange is no worse than the best but one in a hundred, as a rule best.
TEST(Design, TheExchangeFindsTheBestSubsetOrNearlySo) {
  int best_found = 0, runs = 0;
  for (std::uint64_t seed = 10; seed < 20; ++seed) {
    const Experiment e = random_experiment(seed, 14, 5);
    for (const Criterion criterion : criteria) {
      std::vector<double> all;
      for (std::size_t i = 0; i < 14; ++i) {
        for (std::size_t j = i + 1; j < 14; ++j) {
          for (std::size_t k = j + 1; k < 14; ++k) all.push_back(by_definition(e, criterion, {i, j, k}));
        }
      }
      std::sort(all.begin(), all.end(), std::greater<>());
      const auto chosen = exchange(e, criterion, 3);
      ASSERT_EQ(chosen.size(), 3u);
      const double got = by_definition(e, criterion, chosen);
      EXPECT_GE(got, all[3] - 1e-9) << seed << ' ' << static_cast<int>(criterion);
      best_found += got >= all[0] - 1e-9;
      ++runs;
    }
  }
  EXPECT_GE(best_found, runs * 8 / 10) << best_found << " of " << runs;
}

TEST(Design, ChosenPosesDifferAndGivenOnesStay) {
  const Experiment e = random_experiment(3, 40, 8);
  for (const Criterion criterion : criteria) {
    const std::vector<std::size_t> given{0, 1};
    auto chosen = exchange(e, criterion, 10, given);
    EXPECT_EQ(chosen, exchange(e, criterion, 10, given));
    chosen.insert(chosen.end(), given.begin(), given.end());
    std::sort(chosen.begin(), chosen.end());
    EXPECT_EQ(std::unique(chosen.begin(), chosen.end()), chosen.end());
    EXPECT_EQ(chosen.size(), 12u);
  }
}

}  // namespace
