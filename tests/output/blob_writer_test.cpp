// SPDX-License-Identifier: MIT
// Blobs made from robots: what goes in comes out, and the encoding is one to one.
#include "offline/output/blob_writer.hpp"

#include <gtest/gtest.h>

#include <random>

#include "mdhcal/arm.hpp"
#include "mdhcal/kinematics.hpp"
#include "mdhcal/self_test.hpp"
#include "mdhcal/solutions.hpp"
#include "offline/base/error.hpp"
#include "tests/lib/arms.hpp"
#include "tests/output/sample_robot.hpp"

namespace mdhcal::offline {
namespace {

BlobContent decoded(const Blob& blob) {
  BlobContent model{};
  EXPECT_EQ(decode(blob.data(), blob.size(), DecodeOptions{}, model), Status::ok);
  return model;
}

TEST(BlobWriter, HoldsTheRobot) {
  const Robot robot = sample_robot();
  const BlobContent model = decoded(make_blob(robot, sample_provenance()));
  EXPECT_STREQ(model.name, "sample arm");
  EXPECT_STREQ(model.serial, "SN-0007");
  ASSERT_EQ(model.geometry.joint_count, 6);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(model.geometry.link[i].d_m, robot.geometry.link[i].d_m);
    EXPECT_EQ(model.geometry.link[i].beta_rad, robot.geometry.link[i].beta_rad);
    EXPECT_EQ(model.nominal[i].d_m, robot.nominal[static_cast<std::size_t>(i)].d_m);
  }
  EXPECT_EQ(model.geometry.joint[2].coupling[1], 0.5);
  EXPECT_EQ(model.geometry.joint[0].max, 3.0);
  EXPECT_EQ(model.geometry.joint[1].has_max, 0);
  EXPECT_EQ(model.geometry.joint[1].max, 0.0);
  ASSERT_EQ(model.target_count, 2);
  EXPECT_STREQ(model.target[1].name, "B");
  EXPECT_EQ(model.target[1].flange_p_m[2], 0.3);
  EXPECT_EQ(model.has_base, 1);
  EXPECT_EQ(model.tracker_T_base.position_m[0], 1.5);
  EXPECT_EQ(model.tracker_T_base.quaternion[0], 0.6) << "the quaternion's sign is chosen so that w >= 0";
  EXPECT_EQ(model.provenance.pose_count, 50U);
  EXPECT_EQ(model.provenance.lambda, 0.25);
  EXPECT_EQ(model.provenance.max_after_m, 0.0002);
  EXPECT_EQ(model.provenance.measurements_sha256[1], 0x23);
  EXPECT_STREQ(model.provenance.lambda_rule, "quasi-optimality");
}

TEST(BlobWriter, EncodingIsTheInverseOfDecoding) {
  for (const bool calibrated : {true, false}) {
    const Blob blob = make_blob(sample_robot(), calibrated ? sample_provenance() : Provenance{});
    EXPECT_EQ(encode(decoded(blob)), blob);
  }
}

TEST(BlobWriter, TheToolIsATargetWhereNoneIsNamed) {
  Robot robot = sample_robot();
  robot.targets.clear();
  robot.tool_p_m = Vector3{0.1, 0.2, 0.3};
  const BlobContent model = decoded(make_blob(robot, Provenance{}));
  ASSERT_EQ(model.target_count, 1);
  EXPECT_STREQ(model.target[0].name, "tool");
}

// Arms of one to eight joints, some sliding, some with limits: each blob carries its full set of vectors, and they hold
// here bit for bit, under another arithmetic id within the tolerance.
TEST(BlobWriter, EveryKindOfArmPassesItsSelfTest) {
  std::mt19937_64 random(7);
  const auto unit = [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; };
  for (int trial = 0; trial < 200; ++trial) {
    Robot robot;
    robot.geometry.joint_count = 1 + trial % 8;
    for (std::size_t i = 0; i < static_cast<std::size_t>(robot.geometry.joint_count); ++i) {
      robot.nominal[i] = {(unit() - 0.5) * 4, unit() - 0.5, unit() * 6, unit() - 0.5, 0.0};
      robot.geometry.link[i] = robot.nominal[i];
      robot.geometry.link[i].a_m += 0.002 * unit();
      Joint& joint = robot.geometry.joint[i];
      joint.kind = unit() < 0.15 ? JointKind::prismatic : JointKind::revolute;
      joint.sign = unit() < 0.5 ? -1 : 1;
      joint.has_min = unit() < 0.5 ? 1 : 0;
      joint.has_max = unit() < 0.5 ? 1 : 0;
      joint.min = -0.1 - 3 * unit();
      joint.max = 0.1 + 3 * unit();
    }
    robot.geometry.last_T_flange.quaternion[0] = 1.0;
    BlobContent model = decoded(make_blob(robot, Provenance{}));
    ASSERT_EQ(model.double_vector_count, 4);
    ASSERT_EQ(model.float_vector_count, 4);
    Arm<double> arm{};
    Arm<float> arm_float{};
    ASSERT_EQ(make_arm(model.geometry, arm), Status::ok);
    ASSERT_EQ(make_arm(model.geometry, arm_float), Status::ok);
    EXPECT_EQ(self_test(model, arm), Status::ok) << trial;
    EXPECT_EQ(self_test(model, arm_float), Status::ok) << trial;
    model.arithmetic_id ^= 1U;
    EXPECT_EQ(self_test(model, arm), Status::self_test_tolerance) << trial;
    EXPECT_EQ(self_test(model, arm_float), Status::self_test_tolerance) << trial;
    if (robot.geometry.joint_count < 3) continue;  // the servo tick does not always meet a whole pose with so few
    for (const auto& vector : model.double_vector) {
      EXPECT_EQ(vector.inverse_status, 0) << trial << ": no easy vector was found";
    }
  }
}

TEST(BlobWriter, RefusesWhatAControllerWouldRefuse) {
  Robot robot = sample_robot();
  robot.geometry.link[2].a_m += 0.06;
  EXPECT_THROW(make_blob(robot, Provenance{}), Refusal);
  robot = sample_robot();
  robot.geometry.link[3].beta_rad -= 0.06;
  EXPECT_THROW(make_blob(robot, Provenance{}), Refusal);
  robot = sample_robot();
  robot.serial = std::string(32, 'x');
  EXPECT_THROW(make_blob(robot, Provenance{}), InputError);
  robot = sample_robot();
  robot.targets.resize(9);
  EXPECT_THROW(make_blob(robot, Provenance{}), InputError);
}

TEST(BlobWriter, KnowsTheFamilies) {
  const double quarter = 1.5707963267948966;
  const auto family = [](const std::array<Link, max_joints>& links, std::int32_t count) {
    Robot robot;
    robot.geometry.joint_count = count;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      robot.geometry.link[i] = robot.nominal[i] = links[i];
      robot.geometry.joint[i].sign = 1;
    }
    robot.geometry.last_T_flange.quaternion[0] = 1.0;
    return decoded(make_blob(robot, Provenance{})).family;
  };
  const std::array<Link, max_joints> ur{Link{0, 0, 0, 0.089, 0},        Link{quarter, 0, 0, 0, 0},
                                        Link{0, -0.425, 0, 0, 0},       Link{0, -0.392, 0, 0.109, 0},
                                        Link{quarter, 0, 0, 0.095, 0},  Link{-quarter, 0, 0, 0.082, 0}};
  EXPECT_EQ(family(ur, 6), ArmFamily::parallel_axes);
  std::array<Link, max_joints> wrist{Link{0, 0, 0, 0.6, 0},           Link{-quarter, 0.3, 0, 0, 0},
                                     Link{0, 1.0, 0, 0, 0},           Link{-quarter, 0.2, 0, 1.2, 0},
                                     Link{quarter, 0, 0, 0, 0},       Link{-quarter, 0, 0, 0.2, 0}};
  EXPECT_EQ(family(wrist, 6), ArmFamily::spherical_wrist);
  wrist[4].a_m = 0.4;
  EXPECT_EQ(family(wrist, 6), ArmFamily::general);
  EXPECT_EQ(family(ur, 5), ArmFamily::general);
}

// Each border of family_of()'s tolerances from both sides: 5 degrees, 0.05 of the reach. What the blob declares for a
// nominal geometry is what find_solutions() uses on the corrected one.
TEST(BlobWriter, DeclaresTheFamilyThatTheSolverUses) {
  test::Random random(17);
  const auto expect_family = [&](const Geometry& nominal, ArmFamily family) {
    Robot robot;
    robot.geometry = test::with_errors(nominal, random, 1e-4, 1e-4);
    std::copy(nominal.link, nominal.link + max_joints, robot.nominal.begin());
    EXPECT_EQ(decoded(make_blob(robot, Provenance{})).family, family);
    Arm<double> arm{};
    ASSERT_EQ(make_arm(robot.geometry, arm), Status::ok);
    double q[max_joints] = {0.3, -1.2, 1.5, 0.4, 1.1, -0.6};
    Pose<double> target{};
    ASSERT_EQ(forward(arm, q, target), Status::ok);
    Solutions<double> found{};
    ASSERT_EQ(find_solutions(arm, default_solution_options(arm), target, q, found), Status::ok);
    EXPECT_EQ(found.family, family);
  };
  for (const double side : {0.8, 1.2}) {
    const bool inside = side < 1.0;
    const auto parallel = inside ? ArmFamily::parallel_axes : ArmFamily::general;
    const auto wrist = inside ? ArmFamily::spherical_wrist : ArmFamily::general;
    Geometry g = test::ur5();
    g.link[2].alpha_rad += side * 5 * test::deg;
    expect_family(g, parallel);
    g = test::ur5();
    g.link[3].alpha_rad += side * 5 * test::deg;
    expect_family(g, parallel);
    g = test::ur5();
    g.link[5].a_m = side * 2 * 0.06;  // axes 5 and 6 pass each other half as far from where they nearly meet
    expect_family(g, parallel);
    g = test::wrist_arm();
    g.link[2].alpha_rad += side * 5 * test::deg;
    expect_family(g, wrist);
    g = test::wrist_arm();
    g.link[4].a_m = side * 0.107;
    expect_family(g, wrist);
  }
}

TEST(BlobDate, FollowsItsSources) {
  EXPECT_EQ(blob_date("2024-02-29"), "2024-02-29");
  for (const char* wrong : {"2023-02-29", "2024-2-9", "24-02-2009", "2024-02-29x", "", "2024/02/29", "-024-02-02"}) {
    EXPECT_THROW(blob_date(wrong), InputError) << wrong;
  }
  ASSERT_EQ(setenv("SOURCE_DATE_EPOCH", "1700000000", 1), 0);
  EXPECT_EQ(blob_date(std::nullopt), "2023-11-14");
  ASSERT_EQ(setenv("SOURCE_DATE_EPOCH", "soon", 1), 0);
  EXPECT_THROW(blob_date(std::nullopt), InputError);
  ASSERT_EQ(unsetenv("SOURCE_DATE_EPOCH"), 0);
  EXPECT_EQ(blob_date(std::nullopt).size(), 10U);
}

}  // namespace
}  // namespace mdhcal::offline
