// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "mdhcal/kinematics.hpp"
#include "tests/lib/arms.hpp"
#include "tests/lib/factors.hpp"

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

}  // namespace
