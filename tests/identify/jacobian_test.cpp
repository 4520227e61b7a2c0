// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "offline/base/random.hpp"
#include "offline/identify/model.hpp"
#include "offline/robot/vectors.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;

// An arm with every joint kind, sign, coupling, beta and flange transform, all parameters free.
struct Case {
  Dataset data;
  Estimate estimate;
  Layout layout;
};

Case random_case(std::uint64_t seed) {
  Random random(seed);
  Case c;
  Geometry& g = c.estimate.geometry;
  g.joint_count = static_cast<std::int32_t>(2 + random.index(7));
  for (std::int32_t i = 0; i < g.joint_count; ++i) {
    g.link[i] = {random.uniform(-3, 3), random.uniform(-0.5, 0.5), random.uniform(-3, 3), random.uniform(-0.5, 0.5),
                 random.uniform(-1, 1)};
    g.joint[i].kind = random.index(4) == 0 ? JointKind::prismatic : JointKind::revolute;
    g.joint[i].sign = random.index(2) == 0 ? 1 : -1;
  }
  g.joint[1].coupling[0] = 0.7;
  const Frame<double> flange = rotation_about({0.3, -0.2, 0.5}, {0.1, 0.2, -0.1});
  g.last_T_flange = pose_of(flange);
  c.estimate.tracker_T_base = rotation_about({1.0, -0.5, 0.7}, {0.4, 1.0, -2.0});
  c.estimate.flange_p_m = {{0.05, -0.03, 0.12}, {-0.04, 0.06, 0.08}};
  c.estimate.flange_R_probe = {rotation_about({0.2, 1.1, -0.4}, {}), rotation_about({-1.7, 0.3, 0.9}, {})};
  c.layout.targets = 2;
  c.layout.probes = {0, 1};
  c.layout.pivot_m = {0.3, -0.2, 0.9};
  for (std::int32_t i = 0; i < g.joint_count; ++i) {
    for (int key = 0; key < 5; ++key) {
      Parameter p;
      p.id = {static_cast<ParameterKey>(key), i};
      p.nominal = value(g, p.id);
      p.prior = random.uniform(0.5e-3, 2e-3);
      c.layout.geometry.push_back(p);
    }
  }
  c.data.targets = {"A", "B"};
  for (int row = 0; row < 5; ++row) {
    Measurement m;
    for (std::size_t j = 0; j < max_joints; ++j) m.q[j] = random.uniform(-1.5, 1.5);
    for (double& x : m.position_m) x = random.uniform(-1, 1);
    m.quaternion = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.1, 1)};
    m.target = static_cast<std::uint32_t>(row % 2);
    c.data.rows.push_back(m);
  }
  c.data.rows[1].kind = MeasurementKind::pose;
  c.data.rows[2].kind = MeasurementKind::distance;  // to another pose's target
  c.data.rows[2].other_row = 3;
  c.data.rows[2].distance_m = 0.4;
  c.data.rows[4].kind = MeasurementKind::distance;  // to a fixed point
  c.data.rows[4].distance_m = 0.7;
  return c;
}

// Central differences, extrapolated once (Richardson), so that their own error is far below 1e-7.
double difference(const Case& c, std::size_t row, std::size_t column, std::size_t component) {
  const auto at = [&](double h) {
    double r[2][max_row_residuals];
    for (int side = 0; side < 2; ++side) {
      std::vector<double> step(c.layout.columns(), 0.0);
      step[column] = side == 0 ? h : -h;
      MeasurementModel(moved(c.estimate, c.layout, step.data())).residual(c.data, row, r[side]);
    }
    return (r[0][component] - r[1][component]) / (2 * h);
  };
  // Steps of 1 and 2 units: milliradians and millimetres.
  return (4.0 * at(1.0) - at(2.0)) / 3.0;
}

TEST(Jacobian, AllColumnsAndKindsAgreeWithCentralDifferences) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Case c = random_case(seed);
    const MeasurementModel model(c.estimate);
    const std::size_t n = c.layout.columns();
    std::vector<double> jacobian(max_row_residuals * n);
    for (std::size_t row = 0; row < c.data.rows.size(); ++row) {
      double residual[max_row_residuals];
      const std::size_t count = model.residual(c.data, row, c.layout, residual, jacobian.data(), n);
      ASSERT_EQ(count, residual_count(c.data.rows[row].kind));
      for (std::size_t column = 0; column < n; ++column) {
        // Relative to the column's length in this row: a component may vanish.
        double length = 0.0;
        for (std::size_t k = 0; k < count; ++k) length = std::hypot(length, jacobian[k * n + column]);
        for (std::size_t k = 0; k < count; ++k) {
          EXPECT_NEAR(jacobian[k * n + column], difference(c, row, column, k), 1e-7 * std::max(length, 0.1))
              << "seed " << seed << " row " << row << " column " << column << " component " << k;
        }
      }
    }
  }
}

TEST(Jacobian, ResidualWithoutJacobianIsTheSame) {
  const Case c = random_case(7);
  const MeasurementModel model(c.estimate);
  std::vector<double> jacobian(max_row_residuals * c.layout.columns());
  for (std::size_t row = 0; row < c.data.rows.size(); ++row) {
    double with[max_row_residuals];
    double without[max_row_residuals];
    model.residual(c.data, row, c.layout, with, jacobian.data(), c.layout.columns());
    const std::size_t count = model.residual(c.data, row, without);
    for (std::size_t k = 0; k < count; ++k) EXPECT_EQ(with[k], without[k]);
  }
}

}  // namespace
