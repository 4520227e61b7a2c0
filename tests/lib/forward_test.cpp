// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "mdhcal/kinematics.hpp"

namespace {

using namespace mdhcal;

Geometry published_robot() {
  constexpr double deg = 3.14159265358979323846 / 180.0;
  Geometry g{};
  g.joint_count = 6;
  const double table[6][3] = {{0, 0, 99.927},   {90, 0, 106.950}, {0, 428.052, 0},
                              {0, 398.551, 0}, {-90, 0, 93.160}, {-90, 0, 81.910}};
  for (int i = 0; i < 6; ++i) {
    g.link[i].alpha_rad = table[i][0] * deg;
    g.link[i].a_m = table[i][1] * 1e-3;
    g.link[i].d_m = table[i][2] * 1e-3;
    g.joint[i].sign = 1;
  }
  g.last_T_flange.quaternion[0] = 1;
  return g;
}

// (Li 2022, Table 2), first row.
TEST(Forward, ReproducesThePublishedReferencePosition) {
  constexpr double deg = 3.14159265358979323846 / 180.0;
  Arm<double> arm{};
  ASSERT_EQ(make_arm(published_robot(), arm), Status::ok);
  const double q[6] = {-7.5005 * deg, -234.484 * deg, -106.745 * deg, -92.3875 * deg, -61.5425 * deg, 20.7451 * deg};
  Pose<double> pose{};
  ASSERT_EQ(forward(arm, q, pose), Status::ok);
  EXPECT_NEAR(pose.position_m[0], 227.468e-3, 6e-6);
  EXPECT_NEAR(pose.position_m[1], -98.454e-3, 6e-6);
  EXPECT_NEAR(pose.position_m[2], 533.779e-3, 6e-6);
}

}  // namespace
