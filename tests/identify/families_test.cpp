// SPDX-License-Identifier: MIT
// Joint functions and gravity: columns against differences, variances against the likelihood, results against the truth.
#include <gtest/gtest.h>

#include <cmath>

#include "offline/base/error.hpp"
#include "offline/base/random.hpp"
#include "offline/base/statistics.hpp"
#include "offline/identify/calibrate.hpp"
#include "offline/identify/families/family_choice.hpp"
#include "offline/identify/families/family_variances.hpp"
#include "offline/robot/vectors.hpp"
#include "offline/simulate/family.hpp"
#include "offline/simulate/simulate.hpp"
#include "offline/simulate/transmission.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;

Simulation simulated(const std::string& arm, std::uint64_t seed, std::size_t poses, bool with_terms, std::size_t test_poses = 300) {
  SimulationOptions options;
  options.seed = seed;
  options.configurations = poses;
  options.test_configurations = test_poses;
  if (with_terms) {
    options.joint_function_rad = 0.2e-3;
    options.sag_rad = 2e-3;
  }
  return simulate(family_robot(arm), options);
}

CalibrationOptions model(const std::string& word) {
  CalibrationOptions options;
  options.model = word;
  return options;
}

// The noise-free truth, by the simulation's own code.
Vector3 true_position(const Simulation& s, const Joints& q) {
  const Joints turn = turns_of(s.truth, q);
  Estimate truth;
  truth.geometry = s.truth.geometry;
  for (std::int32_t i = 0; i < truth.geometry.joint_count; ++i) truth.geometry.link[i].theta_rad += turn[static_cast<std::size_t>(i)];
  truth.tracker_T_base = frame_of(*s.truth.tracker_T_base);
  truth.flange_p_m = {s.truth.targets.front().flange_p_m};
  return MeasurementModel(truth).target_position(q.data(), 0);
}

double mean_distance_mm(const Simulation& s, const Calibration& c) {
  const MeasurementModel found(c.estimate);
  double sum = 0.0;
  for (const Measurement& m : s.test.rows) sum += 1e3 * norm(minus(found.target_position(m.q.data(), 0), true_position(s, m.q)));
  return sum / static_cast<double>(s.test.rows.size());
}

// Every column is the derivative of what the model predicts, up to the slope of the terms themselves (a hundredth).
TEST(Families, ColumnsAreDifferences) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Simulation s = simulated(seed % 2 == 0 ? "spherical-wrist" : "seven-joint", seed, 3, false, 1);
    Estimate at;
    at.geometry = s.truth.geometry;
    at.tracker_T_base = frame_of(*s.truth.tracker_T_base);
    at.flange_p_m = {s.truth.targets.front().flange_p_m};
    at.transmission.gravity.direction[1] = 0.6;
    at.transmission.gravity.direction[2] = -0.8;
    Layout layout;
    layout.base = layout.target = false;
    for (std::int32_t i = 0; i < at.geometry.joint_count; ++i) {
      at.transmission.function[i].seen_min_rad = -1.0;
      at.transmission.function[i].seen_max_rad = 2.0;
      for (std::int32_t j = i; j < at.geometry.joint_count; ++j) layout.terms.push_back({TermFamily::gravity, i, j, false, 1e-3});
      for (const std::int32_t order : {1, 2, 7, 40}) {
        for (const bool sine : {false, true}) layout.terms.push_back({family_of_order(static_cast<std::size_t>(order)), i, order, sine, 1e-3});
      }
    }
    const std::size_t n = layout.columns();
    std::vector<double> jacobian(3 * n), step(n, 0.0);
    for (std::size_t row = 0; row < s.train.rows.size(); ++row) {
      double residual[max_row_residuals], forward[max_row_residuals], backward[max_row_residuals];
      MeasurementModel(at).residual(s.train, row, layout, residual, jacobian.data(), n);
      for (std::size_t c = 0; c < n; ++c) {
        // Coefficients are float: a step of 2^-7 columns is one of their numbers.
        step[c] = 0.0078125;
        MeasurementModel(moved(at, layout, step.data())).residual(s.train, row, forward);
        step[c] = -0.0078125;
        MeasurementModel(moved(at, layout, step.data())).residual(s.train, row, backward);
        step[c] = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
          EXPECT_NEAR(jacobian[k * n + c], (forward[k] - backward[k]) / 0.015625, 2e-6) << "seed " << seed << " column " << c;
        }
      }
    }
  }
}

// The sag of the model is that of the simulation's own transforms.
TEST(Families, SagAndFunctionsAreThoseOfTheSimulation) {
  for (const std::string& arm : family_names()) {
    const Simulation s = simulated(arm, 3, 1, true, 40);
    Estimate truth;
    truth.geometry = s.truth.geometry;
    truth.transmission = s.truth.transmission;
    truth.tracker_T_base = frame_of(*s.truth.tracker_T_base);
    truth.flange_p_m = {s.truth.targets.front().flange_p_m};
    const MeasurementModel found(truth);
    for (const Measurement& m : s.test.rows) {
      EXPECT_LT(norm(minus(found.target_position(m.q.data(), 0), true_position(s, m.q))), 1e-9) << arm;
    }
  }
}

// At the variances found the likelihood falls on both sides, for every family and the noise.
TEST(Families, VariancesAreWhereTheLikelihoodIsGreatest) {
  Random random(4);
  ProjectedRows rows;
  rows.columns = Eigen::MatrixXd(120, 60);
  rows.y = Eigen::VectorXd(120);
  for (Eigen::Index c = 0; c < 60; ++c) {
    rows.family.push_back(c < 20 ? TermFamily::geometry : c < 40 ? TermFamily::gravity : TermFamily::orders_1_2);
    for (Eigen::Index r = 0; r < 120; ++r) rows.columns(r, c) = random.normal();
  }
  Eigen::VectorXd u(60);
  for (Eigen::Index c = 0; c < 60; ++c) u(c) = (c < 20 ? 1.0 : c < 40 ? 0.3 : 0.05) * random.normal();
  for (Eigen::Index r = 0; r < 120; ++r) rows.y(r) = rows.columns.row(r).dot(u) + 0.1 * random.normal();
  VarianceBounds bounds;
  bounds.most.fill(10.0);
  FamilyVariances start;
  start.sd = {0.1, 0.1, 0.1, 0.1, 0.1, 0.1};
  bool settled = false;
  const FamilySolution best = maximise_likelihood(rows, start, bounds, 30, &settled);
  EXPECT_TRUE(settled);
  EXPECT_NEAR(best.variances.sd[0], 1.0, 0.35);
  EXPECT_NEAR(best.variances.sd[1], 0.3, 0.12);
  EXPECT_NEAR(best.variances.noise, 0.1, 0.03);
  for (std::size_t f = 0; f < 4; ++f) {
    for (const double factor : {0.8, 1.25}) {
      FamilyVariances other = best.variances;
      (f == 3 ? other.noise : other.sd[f]) *= factor;
      EXPECT_LT(maximise_likelihood(rows, other, bounds, 0).log_likelihood, best.log_likelihood + 1e-3) << f;
    }
  }
}

// Sag of 2 mrad and functions of 0.2 mrad, noise 0.02 mm, 200 poses: found by themselves.
TEST(Families, TruthIsFoundWhereThereIsOne) {
  const Simulation s = simulated("three-parallel", 7, 200, true);
  const Calibration c = calibrate(s.nominal, s.train, model("auto"));
  EXPECT_EQ(c.model.candidates[c.model.chosen].name, "gravity and joint functions");
  // Measured 0.058; five orders of forty carry all of it here, and a band's one variance holds the strong ones back.
  EXPECT_LT(mean_distance_mm(s, c), 0.07);
  EXPECT_GT(mean_distance_mm(s, calibrate(s.nominal, s.train, model("geometry"))), 0.2);
}

// Without such effects the geometry is chosen, and its result is that of --model geometry to the bit.
TEST(Families, NothingIsFoundWhereThereIsNothing) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Simulation s = simulated("spherical-wrist", seed, 60, false);
    const Calibration c = calibrate(s.nominal, s.train, model("auto"));
    ASSERT_EQ(c.model.chosen, 0U) << c.model.sentence;
    const Calibration geometry = calibrate(s.nominal, s.train, model("geometry"));
    EXPECT_EQ(mean_distance_mm(s, c), mean_distance_mm(s, geometry));
  }
}

TEST(Families, IntervalsOfPositionsHoldTheTruth) {
  std::size_t inside = 0, count = 0;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const Simulation s = simulated(seed == 1 ? "three-parallel" : "spherical-wrist", 20 + seed, 120, true);
    const Calibration c = calibrate(s.nominal, s.train, model("full"));
    const MeasurementModel found(c.estimate);
    for (const Measurement& m : s.test.rows) {
      double sd_mm[3];
      (void)predicted_position_sd_mm(found, c.layout, c.covariance, m.q.data(), 0, sd_mm);
      const Vector3 error = minus(found.target_position(m.q.data(), 0), true_position(s, m.q));
      for (std::size_t k = 0; k < 3; ++k, ++count) inside += 1e3 * std::fabs(error[k]) <= c.covariance.coverage_factor * sd_mm[k] ? 1U : 0U;
    }
  }
  const double share = static_cast<double>(inside) / static_cast<double>(count);
  EXPECT_GT(share, 0.90);
  EXPECT_LT(share, 0.99);
}

TEST(Families, WhatCannotEnterIsSaid) {
  const Simulation few = simulated("three-parallel", 5, 10, false);
  const Calibration c = calibrate(few.nominal, few.train, model("auto"));
  EXPECT_TRUE(c.model.candidates.empty());
  ASSERT_FALSE(c.model.left_out.empty());
  EXPECT_NE(c.model.left_out.front().find("10 poses are too few"), std::string::npos) << c.model.left_out.front();
  EXPECT_THROW((void)calibrate(few.nominal, few.train, model("full")), InputError);

  Simulation still = simulated("three-parallel", 5, 40, false);
  for (Measurement& m : still.train.rows) m.q[5] *= 0.01;
  const Calibration d = calibrate(still.nominal, still.train, model("auto"));
  ASSERT_FALSE(d.model.left_out.empty());
  EXPECT_NE(d.model.left_out.front().find("Joint 6 moved less than 9 degrees"), std::string::npos) << d.model.left_out.front();
}

}  // namespace
