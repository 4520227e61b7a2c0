// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "mdhcal/kinematics.hpp"
#include "tests/lib/arms.hpp"

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

}  // namespace
