// SPDX-License-Identifier: MIT
#include "offline/simulate/simulate.hpp"

#include <cmath>
#include <set>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "offline/base/error.hpp"
#include "offline/simulate/family.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;

// Independent of lib: the five factors of (Li 2022, Eq. 1) as Eigen products.
Eigen::Isometry3d base_T_flange(const Geometry& g, const Joints& q) {
  using Eigen::AngleAxisd, Eigen::Translation3d, Eigen::Vector3d;
  Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
  for (int i = 0; i < g.joint_count; ++i) {
    const Link& l = g.link[i];
    t = t * AngleAxisd(l.alpha_rad, Vector3d::UnitX()) * Translation3d(l.a_m, 0, 0) *
        AngleAxisd(l.theta_rad + q[static_cast<std::size_t>(i)], Vector3d::UnitZ()) * Translation3d(0, 0, l.d_m) *
        AngleAxisd(l.beta_rad, Vector3d::UnitY());
  }
  return t;
}

Eigen::Isometry3d isometry(const Pose<double>& pose) {
  Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
  t.linear() = Eigen::Quaterniond(pose.quaternion[0], pose.quaternion[1], pose.quaternion[2], pose.quaternion[3])
                   .toRotationMatrix();
  t.translation() = Eigen::Vector3d(pose.position_m[0], pose.position_m[1], pose.position_m[2]);
  return t;
}

Eigen::Vector3d error(const Simulation& s, const Geometry& geometry, const Measurement& row) {
  const Vector3& p = s.truth.targets[row.target].flange_p_m;
  return isometry(*s.truth.tracker_T_base) * (base_T_flange(geometry, row.q) * Eigen::Vector3d(p[0], p[1], p[2])) -
         Eigen::Vector3d(row.position_m[0], row.position_m[1], row.position_m[2]);
}

TEST(Simulate, WithoutNoiseTheTruthExplainsEveryRowInEveryFamily) {
  for (const std::string& name : family_names()) {
    SimulationOptions options;
    options.noise_m = 0;
    options.targets = 3;
    options.repeats = 2;
    const Simulation s = simulate(family_robot(name), options);
    ASSERT_EQ(s.train.rows.size(), 50u * 2 * 3);
    double nominal = 0;
    for (const Measurement& row : s.train.rows) {
      EXPECT_LT(error(s, s.truth.geometry, row).norm(), 1e-12) << name;
      nominal = std::max(nominal, error(s, s.nominal.geometry, row).norm());
    }
    EXPECT_GT(nominal, 0.5e-3) << name;
  }
}

TEST(Simulate, NoiseAndOutliersAreOfTheStatedSize) {
  SimulationOptions options;
  options.configurations = 3000;
  options.noise_m = 0.02e-3;
  options.outlier_fraction = 0.1;
  options.outlier_m = 4e-3;
  const Simulation s = simulate(family_robot("three-parallel"), options);
  EXPECT_EQ(s.outlier_rows.size(), 300u);
  const std::set<std::size_t> outliers(s.outlier_rows.begin(), s.outlier_rows.end());
  double squares = 0;
  for (std::size_t i = 0; i < s.train.rows.size(); ++i) {
    const double norm = error(s, s.truth.geometry, s.train.rows[i]).norm();
    if (outliers.contains(i)) {
      EXPECT_NEAR(norm, 4e-3, 0.15e-3);
    } else {
      squares += norm * norm;
    }
  }
  EXPECT_NEAR(std::sqrt(squares / (3 * 2700)), 0.02e-3, 5 * 0.02e-3 / std::sqrt(2.0 * 3 * 2700));
}

TEST(Simulate, ErrorsLieInTheGaugeOfAFittedBaseAndTarget) {
  const Simulation s = simulate(family_robot("three-parallel"), {});
  const Link *t = s.truth.geometry.link, *n = s.nominal.geometry.link;
  int free = 0;
  for (int i = 0; i < 6; ++i) {
    for (const double deviation : {t[i].alpha_rad - n[i].alpha_rad, t[i].a_m - n[i].a_m,
                                   t[i].theta_rad - n[i].theta_rad, t[i].d_m - n[i].d_m, t[i].beta_rad}) {
      free += std::abs(deviation) > 0;
    }
  }
  EXPECT_EQ(free, 18);  // the count that METHOD section 2 states for a 6R arm with an off-axis target
  EXPECT_EQ(t[5].d_m, n[5].d_m);
  EXPECT_EQ(t[0].theta_rad, n[0].theta_rad);
  for (const int i : {1, 2}) {  // axes 2 and 3 have a parallel successor
    EXPECT_NE(t[i].beta_rad, 0);
    EXPECT_EQ(t[i].d_m, n[i].d_m);
  }
}

TEST(Simulate, ReadingsStayWithinTheLimitsAndJointNoiseMovesOnlyTheArm) {
  SimulationOptions options;
  options.noise_m = 0;
  options.joint_noise_rad = 1e-3;
  options.repeats = 4;
  const Simulation s = simulate(family_robot("five-joint"), options);
  double spread = 0;
  for (std::size_t i = 0; i < s.train.rows.size(); ++i) {
    const Measurement& row = s.train.rows[i];
    for (std::size_t j = 0; j < 5; ++j) {
      EXPECT_GE(row.q[j], s.nominal.geometry.joint[j].min);
      EXPECT_LE(row.q[j], s.nominal.geometry.joint[j].max);
    }
    EXPECT_EQ(row.q, s.train.rows[i / 4 * 4].q);
    EXPECT_EQ(row.group, i / 4);
    spread = std::max(spread, error(s, s.truth.geometry, row).norm());
  }
  EXPECT_GT(spread, 0.5e-3);
}

TEST(Simulate, TheSeedDecidesEverything) {
  const Robot robot = family_robot("spherical-wrist");
  SimulationOptions options;
  const Simulation a = simulate(robot, options), b = simulate(robot, options);
  options.seed = 2;
  const Simulation c = simulate(robot, options);
  for (std::size_t i = 0; i < a.train.rows.size(); ++i) {
    EXPECT_EQ(a.train.rows[i].position_m, b.train.rows[i].position_m);
    EXPECT_NE(a.train.rows[i].position_m, c.train.rows[i].position_m);
  }
}

TEST(Simulate, OptionsOutOfRangeAreRefused) {
  const Robot robot = family_robot("spherical-wrist");
  SimulationOptions options;
  options.noise_m = std::nan("");
  EXPECT_THROW((void)simulate(robot, options), InputError);
  options = {};
  options.targets = 9;
  EXPECT_THROW((void)simulate(robot, options), InputError);
  options = {};
  options.outlier_fraction = 1;
  EXPECT_THROW((void)simulate(robot, options), InputError);
  EXPECT_THROW((void)family_robot("scara"), InputError);
}

}  // namespace
