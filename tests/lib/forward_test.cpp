// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "mdhcal/kinematics.hpp"
#include "tests/lib/arms.hpp"
#include "tests/lib/factors.hpp"
#include "tests/support/wide_frame.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

// (Li 2022, Table 2), first row.
TEST(Forward, ReproducesThePublishedReferencePosition) {
  Arm<double> arm{};
  ASSERT_EQ(make_arm(published_robot(), arm), Status::ok);
  const double q[6] = {-7.5005 * deg, -234.484 * deg, -106.745 * deg, -92.3875 * deg, -61.5425 * deg, 20.7451 * deg};
  Pose<double> pose{};
  ASSERT_EQ(forward(arm, q, pose), Status::ok);
  EXPECT_NEAR(pose.position_m[0], 227.468e-3, 6e-6);
  EXPECT_NEAR(pose.position_m[1], -98.454e-3, 6e-6);
  EXPECT_NEAR(pose.position_m[2], 533.779e-3, 6e-6);
}

template <class Real>
void compare_with_products(double position_bound, double orthogonality_bound) {
  Random random(61);
  for (int n = 0; n < cases(20000); ++n) {
    Geometry g = with_errors(n % 3 == 0 ? ur5() : (n % 3 == 1 ? wrist_arm() : seven_joint_arm()), random, 5e-3, 0.5 * deg);
    if (n % 5 == 0) g.joint[2].kind = JointKind::prismatic;
    if (n % 2 == 0) g.joint[1].sign = -1;
    if (n % 4 == 0) g.joint[3].coupling[2] = 0.5;
    Arm<Real> arm{};
    ASSERT_EQ(make_arm(g, arm), Status::ok);
    Real q[max_joints] = {};
    for (Real& joint : q) joint = static_cast<Real>(random.symmetric(pi));
    const Matrix truth = product_of_factors(g, q);
    Pose<Real> pose{};
    ASSERT_EQ(forward(arm, q, pose), Status::ok);
    Frame<Real> frames[max_joints + 2];
    ASSERT_EQ(link_frames(arm, q, frames), Status::ok);
    const Frame<Real>& flange = frames[g.joint_count + 1];
    for (int i = 0; i < 3; ++i) {
      ASSERT_EQ(flange.position_m[i], pose.position_m[i]);
      ASSERT_NEAR(static_cast<double>(truth.m[i][3] - static_cast<long double>(pose.position_m[i])), 0, position_bound);
      for (int j = 0; j < 3; ++j) {
        const Real* r = flange.rotation;
        ASSERT_NEAR(static_cast<double>(truth.m[i][j] - static_cast<long double>(r[3 * i + j])), 0, position_bound);
        const double dot = static_cast<double>(r[i]) * static_cast<double>(r[j]) +
                           static_cast<double>(r[3 + i]) * static_cast<double>(r[3 + j]) +
                           static_cast<double>(r[6 + i]) * static_cast<double>(r[6 + j]);
        ASSERT_NEAR(dot, i == j ? 1.0 : 0.0, orthogonality_bound);
      }
    }
  }
}

TEST(Forward, IsTheProductOfTheFactorsInDouble) { compare_with_products<double>(1e-12, 1e-14); }
TEST(Forward, IsTheProductOfTheFactorsInFloat) { compare_with_products<float>(5e-6, 5e-6); }

// An identity is not multiplied by, a flange off by a rounding is; where it is all the same, the numbers are.
TEST(Forward, EndsAtTheFlange) {
  Random random(62);
  for (int n = 0; n < cases(2000); ++n) {
    Geometry g = with_errors(wrist_arm(), random, 5e-3, 0.5 * deg);
    double* c = g.last_T_flange.quaternion;
    if (n % 4 >= 2) {
      double square = 0;
      for (int k = 0; k < 4; ++k) {
        c[k] = random.symmetric(1) + (k == 0 ? 1.5 : 0);
        square += c[k] * c[k];
      }
      for (int k = 0; k < 4; ++k) c[k] /= std::sqrt(square);
    }
    if (n % 2 == 1) g.last_T_flange.position_m[n % 3] = random.symmetric(0.3);
    if (n % 8 == 0) c[3] = 1e-13;
    Arm<double> arm{};
    ASSERT_EQ(make_arm(g, arm), Status::ok);
    double q[6];
    for (double& joint : q) joint = random.symmetric(pi);
    Pose<double> pose{}, multiplied{};
    ASSERT_EQ(forward(arm, q, pose), Status::ok);
    const tests::WideFrame truth = tests::wide_forward(g, q);
    ASSERT_LT(tests::position_difference(truth, pose), 1e-12) << n;
    ASSERT_LT(tests::rotation_difference(truth, pose), 1e-14) << n;
    arm.has_flange = 1;
    ASSERT_EQ(forward(arm, q, multiplied), Status::ok);
    for (int k = 0; k < 4; ++k) ASSERT_EQ(pose.quaternion[k], multiplied.quaternion[k]) << n;
    for (int k = 0; k < 3; ++k) ASSERT_EQ(pose.position_m[k], multiplied.position_m[k]) << n;
  }
}

}  // namespace
