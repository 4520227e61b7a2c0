// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "mdhcal/kinematics.hpp"
#include "offline/base/random.hpp"
#include "offline/robot/convention.hpp"
#include "offline/robot/robot.hpp"
#include "offline/robot/rotation.hpp"
#include "tests/robot/factory_table.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/wide_frame.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using namespace mdhcal::tests;

// The largest difference of the modified chain from the plain standard product, over random joints [m], [1].
struct Difference {
  double position_m = 0, rotation = 0;
};

Difference difference(const std::vector<StandardLink>& table, const Geometry& geometry, int samples, Random& random) {
  Arm<double> arm{};
  EXPECT_EQ(make_arm(geometry, arm), Status::ok);
  Difference worst;
  for (int sample = 0; sample < samples; ++sample) {
    double q[max_joints] = {};
    for (double& angle : q) angle = random.uniform(-3.14, 3.14);
    WideFrame truth;
    for (std::size_t i = 0; i < table.size(); ++i) {
      truth = truth * wide_rot_z(static_cast<long double>(q[i]) + static_cast<long double>(table[i].theta_rad)) *
              wide_translation(0, 0, table[i].d_m) * wide_translation(table[i].a_m, 0, 0) * wide_rot_x(table[i].alpha_rad);
    }
    Pose<double> pose{};
    EXPECT_EQ(forward(arm, q, pose), Status::ok);
    worst.position_m = std::max(worst.position_m, position_difference(truth, pose));
    worst.rotation = std::max(worst.rotation, rotation_difference(truth, pose));
  }
  return worst;
}

MDHCAL_SHARED_DATA_TEST(Convention, FactoryRobotsKeepTheirPosesAndLoseTheirLongLengths) {
  for (const char* file : {"ur_factory/ur10_a.toml", "ur_factory/ur10e_c.toml"}) {
    Random random(7);
    const std::vector<StandardLink> table = factory_table(shared_data(file));
    ASSERT_EQ(table.size(), 6U);
    const Robot robot = read_robot(shared_data(file));
    const Difference worst = difference(table, robot.geometry, 1000, random);
    EXPECT_LE(worst.position_m, 1e-12) << file;
    EXPECT_LE(worst.rotation, 1e-14) << file;
    RecordProperty(std::string(file).substr(11, 6) + "_worst_m", std::to_string(worst.position_m * 1e15) + "e-15");
    for (int i = 0; i < 6; ++i) {
      EXPECT_LE(std::abs(robot.geometry.link[i].a_m), 2.0) << file;
      EXPECT_LE(std::abs(robot.geometry.link[i].d_m), 2.0) << file;
    }
    // Near the data sheet's values: -0.612 and -0.572 m for these arms.
    EXPECT_NEAR(robot.geometry.link[2].a_m, -0.612, 0.02) << file;
    EXPECT_NEAR(robot.geometry.link[3].a_m, -0.571, 0.02) << file;
  }
}

TEST(Convention, RandomStandardTablesKeepTheirPoses) {
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    Random random(seed);
    std::vector<StandardLink> table(1 + random.index(8));
    Geometry geometry{};
    for (StandardLink& link : table) {
      const double twists[] = {0, 1.5707963267948966, 3.141592653589793, 1e-7, 1e-3, -0.02, 3.14, random.uniform(-3, 3)};
      link = {random.uniform(-3, 3), random.uniform(-1, 1), random.index(3) == 0 ? 0.0 : random.uniform(-1, 1),
              twists[random.index(8)]};
    }
    const ModifiedChain chain = mdh_from_standard(table);
    geometry.joint_count = static_cast<std::int32_t>(table.size());
    for (std::size_t i = 0; i < table.size(); ++i) {
      geometry.link[i] = chain.links[i];
      geometry.joint[i].sign = 1;
      ASSERT_LT(std::abs(geometry.link[i].d_m), 20.0) << "seed " << seed;
    }
    geometry.last_T_flange = pose_of(chain.last_T_flange);
    const Difference worst = difference(table, geometry, 5, random);
    ASSERT_LE(worst.position_m, 2e-14) << "seed " << seed;
    ASSERT_LE(worst.rotation, 2e-14) << "seed " << seed;
  }
}

Frame<double> random_frame(Random& random) {
  Pose<double> pose{};
  const auto q = quaternion_of({random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)});
  for (std::size_t k = 0; k < 4; ++k) pose.quaternion[k] = q[k];
  for (double& p : pose.position_m) p = random.uniform(-1, 1);
  return frame_of(pose);
}

Frame<double> nearly_parallel_frame(Random& random, double tilt) {
  Pose<double> pose{};
  const auto tilted = quaternion_of({random.uniform(-tilt, tilt), random.uniform(-tilt, tilt), 0});
  const auto turned = quaternion_of({0, 0, random.uniform(-3, 3)});
  for (std::size_t k = 0; k < 4; ++k) pose.quaternion[k] = tilted[k];
  Frame<double> frame = frame_of(pose);
  for (std::size_t k = 0; k < 4; ++k) pose.quaternion[k] = turned[k];
  frame = compose(frame, frame_of(pose));
  for (double& p : frame.position_m) p = random.uniform(-1, 1);
  return frame;
}

TEST(Convention, AnyChainOfFixedTransformsIsExpressed) {
  for (std::uint64_t seed = 1; seed <= 4000; ++seed) {
    Random random(seed);
    const std::size_t count = 1 + random.index(8);
    std::vector<Frame<double>> fixed;
    for (std::size_t i = 0; i <= count; ++i) {
      const double tilts[] = {0, 1e-9, 1e-4, 0.05};
      fixed.push_back(random.index(2) == 0 ? random_frame(random) : nearly_parallel_frame(random, tilts[random.index(4)]));
    }
    // Coaxial neighbours: no direction of x is given by the geometry.
    if (random.index(4) == 0) {
      fixed[random.index(count + 1)] = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, random.uniform(-1, 1)}};
    }
    const ModifiedChain chain = mdh_from_chain(fixed);
    ASSERT_EQ(chain.links.size(), count);
    Geometry geometry{};
    geometry.joint_count = static_cast<std::int32_t>(count);
    for (std::size_t i = 0; i < count; ++i) {
      geometry.link[i] = chain.links[i];
      geometry.joint[i].sign = 1;
      geometry.joint[i].kind = random.index(3) == 0 ? JointKind::prismatic : JointKind::revolute;
      ASSERT_LT(std::abs(chain.links[i].beta_rad), 1.5 * nearly_parallel_rad) << "seed " << seed;
    }
    geometry.last_T_flange = pose_of(chain.last_T_flange);
    Arm<double> arm{};
    ASSERT_EQ(make_arm(geometry, arm), Status::ok) << "seed " << seed;
    for (int sample = 0; sample < 3; ++sample) {
      double q[max_joints] = {};
      WideFrame truth = wide(fixed[0]);
      for (std::size_t i = 0; i < count; ++i) {
        q[i] = random.uniform(-1, 1);
        const bool slides = geometry.joint[i].kind == JointKind::prismatic;
        truth = truth * (slides ? wide_translation(0, 0, q[i]) : wide_rot_z(q[i])) * wide(fixed[i + 1]);
      }
      Pose<double> pose{};
      ASSERT_EQ(forward(arm, q, pose), Status::ok);
      const Pose<double> base = pose_of(compose(chain.origin, frame_of(pose)));
      ASSERT_LE(position_difference(truth, base), 1e-12) << "seed " << seed;
      ASSERT_LE(rotation_difference(truth, base), 1e-13) << "seed " << seed;
    }
  }
}

TEST(Convention, ABaseThatTheFirstLinkExpressesNeedsNoOrigin) {
  Frame<double> column{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {0, 0, 0.4}};
  const std::vector<Frame<double>> fixed{column, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.1, 0, 0}}};
  const ModifiedChain chain = mdh_from_chain(fixed);
  EXPECT_EQ(chain.origin.rotation[0], 1.0);
  EXPECT_EQ(chain.origin.position_m[2], 0.0);
  EXPECT_NEAR(chain.links[0].d_m, 0.4, 1e-15);
  EXPECT_NEAR(chain.links[0].theta_rad, 1.5707963267948966, 1e-15);
}

}  // namespace
