// SPDX-License-Identifier: MIT
// Full poses of simulated arms whose probe is turned on the flange: the position is told no worse than from positions
// alone, the turn is found, and rotations that are read wrongly are found out.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mdhcal/kinematics.hpp"
#include "offline/base/error.hpp"
#include "offline/base/random.hpp"
#include "offline/robot/units.hpp"
#include "offline/robot/vectors.hpp"
#include "offline/simulate/family.hpp"
#include "tests/identify/measured_table.hpp"
#include "tests/identify/simulated.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using namespace mdhcal::tests;

Vector3 direction(Random& random) {
  const Vector3 v{random.normal(), random.normal(), random.normal()};
  const double length = norm(v);
  return {v[0] / length, v[1] / length, v[2] / length};
}

Frame<double> turned_by(const Vector3& axis, double angle_rad) {
  return rotation_about({angle_rad * axis[0], angle_rad * axis[1], angle_rad * axis[2]}, {});
}

// The measured rotations with the probe turned by flange_R_probe.
void turn_probe(Dataset& data, const Frame<double>& flange_R_probe) {
  for (Measurement& m : data.rows) {
    const Pose<double> pose = pose_of(compose(frame_of(m.quaternion, {}), flange_R_probe));
    m.quaternion = {pose.quaternion[0], pose.quaternion[1], pose.quaternion[2], pose.quaternion[3]};
    m.rotation_numbers = m.quaternion;
  }
}

Dataset positions_of(Dataset data) {
  for (Measurement& m : data.rows) m.kind = MeasurementKind::position;
  return data;
}

Simulation full_poses(const std::string& arm, std::uint64_t seed, std::size_t poses, double rotation_noise_rad) {
  SimulationOptions options = arm_options(seed);
  options.configurations = poses;
  options.full_pose = true;
  options.rotation_noise_rad = rotation_noise_rad;
  return simulate(family_robot(arm), options);
}

double angle_between(const Frame<double>& a, const Frame<double>& b) {
  return norm(log_of_rotation(compose(inverted(a), b)));
}

TEST(FullPoses, AreNoWorseThanPositionsHoweverTheProbeIsTurned) {
  Random random(1);
  std::uint64_t seed = 1;
  for (const char* arm : {"spherical-wrist", "three-parallel", "seven-joint"}) {
    for (const double angle_deg : {0.0, 1.0, 10.0, 90.0, 180.0}) {
      Simulation s = full_poses(arm, ++seed, 40, 0.05e-3);
      const Frame<double> turn = turned_by(direction(random), angle_deg * rad_per_deg);
      turn_probe(s.train, turn);
      const Calibration poses = calibrate(s.nominal, s.train, {});
      const Calibration positions = calibrate(s.nominal, positions_of(s.train), {});
      const std::string where = arm + std::string(", turned by ") + std::to_string(angle_deg);
      EXPECT_TRUE(poses.converged) << where;
      EXPECT_LT(distance_from_truth_mm(s, poses, 300, seed), 1.05 * distance_from_truth_mm(s, positions, 300, seed)) << where;
      EXPECT_LT(angle_between(poses.estimate.flange_R_probe.at(0), turn), 0.1e-3) << where;
      // It goes into the corrected robot's [tool].
      ASSERT_TRUE(poses.corrected.tool_quaternion.has_value());
      EXPECT_LT(angle_between(frame_of(*poses.corrected.tool_quaternion, {}), turn), 0.1e-3) << where;
      EXPECT_EQ(poses.train_rotation.after.count, 40U);
      EXPECT_LT(poses.train_rotation.after.mean, 0.01) << where;   // 0.05 mrad an axis are 0.0046 degrees in the mean
      EXPECT_GT(poses.train_rotation.before.mean, 0.05) << where;  // the arm's own errors are of 0.1 degrees
    }
  }
}

// Rotations weigh what they are worth: the scatter that they have is found, and coarse ones take nothing from positions.
TEST(FullPoses, WeighRotationsByTheirOwnScatter) {
  for (const double noise_rad : {0.02e-3, 0.2e-3, 5e-3}) {
    const Simulation s = full_poses("spherical-wrist", 31, 60, noise_rad);
    const Calibration poses = calibrate(s.nominal, s.train, {});
    const Calibration positions = calibrate(s.nominal, positions_of(s.train), {});
    // 0.02 mm over the noise; 60 poses tell a scatter to about 10 %.
    EXPECT_NEAR(poses.training.rotation_lever_mm * noise_rad / 0.02, 1.0, 0.3) << noise_rad;
    EXPECT_LT(distance_from_truth_mm(s, poses, 300, 1), 1.05 * distance_from_truth_mm(s, positions, 300, 1)) << noise_rad;
  }
  CalibrationOptions options;
  options.rotation_noise_mrad = 0.4;
  const Simulation s = full_poses("spherical-wrist", 32, 30, 0.2e-3);
  EXPECT_DOUBLE_EQ(calibrate(s.nominal, s.train, options).training.rotation_lever_mm, 50.0);
}

TEST(FullPoses, AGivenTurnIsHeldAndAWrongOneIsNamed) {
  Random random(5);
  Simulation s = full_poses("spherical-wrist", 41, 40, 0.05e-3);
  const Frame<double> turn = turned_by(direction(random), 1.2);
  turn_probe(s.train, turn);
  CalibrationOptions options;
  options.fit_tool = false;
  Robot robot = s.nominal;
  robot.tool_p_m = s.truth.tool_p_m;
  robot.targets = s.truth.targets;
  const Calibration unturned = calibrate(robot, s.train, options);
  EXPECT_FALSE(unturned.usable());
  EXPECT_NE(unturned.reasons.front().find("--tool fit"), std::string::npos) << unturned.reasons.front();
  const Pose<double> pose = pose_of(turn);
  robot.tool_quaternion = {pose.quaternion[0], pose.quaternion[1], pose.quaternion[2], pose.quaternion[3]};
  for (TargetPoint& target : robot.targets) target.quaternion = robot.tool_quaternion;
  const Calibration c = calibrate(robot, s.train, options);
  EXPECT_LT(angle_between(c.estimate.flange_R_probe.at(0), turn), 1e-15);
  EXPECT_LT(distance_from_truth_mm(s, c, 300, 3), 0.05);
}

// Ten conventions: the same poses are read right by name, and read by any other name they are found out with the right one.
TEST(FullPoses, RotationsInAnotherConventionAreFoundOut) {
  Random random(9);
  Simulation s = full_poses("spherical-wrist", 51, 25, 0.1e-3);
  turn_probe(s.train, turned_by(direction(random), 0.8));
  const TableColumns plain = TableColumns{id_column(s.train)} + joint_columns(s.train) + position_columns(s.train);
  const double alone = distance_from_truth_mm(s, calibrate(s.nominal, positions_of(s.train), {}), 200, 1);
  const auto written = [&](const RotationConvention& convention, bool by_axis) {
    TableColumns columns = plain;
    const std::vector<std::string> names = convention.form == RotationForm::quaternion
                                               ? std::vector<std::string>{"qw", "qx", "qy", "qz"}
                                               : std::vector<std::string>{by_axis ? "rx" : "a", by_axis ? "ry" : "b", by_axis ? "rz" : "c"};
    const double unit = convention.form == RotationForm::quaternion || convention.radians ? 1.0 : deg_per_rad;
    for (std::size_t k = 0; k < names.size(); ++k) {
      columns.emplace_back(names[k], [&s, &convention, k, by_axis, unit](std::size_t i) {
        const auto numbers = numbers_of(convention, s.train.rows[i].quaternion);
        std::size_t slot = k;
        for (std::size_t n = 0; n < 3 && by_axis && convention.form == RotationForm::euler && convention.names_axes(); ++n) {
          if (static_cast<std::size_t>(convention.axis[n]) == k) slot = n;
        }
        return decimal(unit * numbers[slot]);
      });
    }
    return measured_table(s.train.rows.size(), columns);
  };
  struct Case {
    const char* right;
    bool by_axis;
    const char* wrong;
  };
  for (const Case& each : {Case{"kuka", false, "mitsubishi"}, Case{"fanuc", true, "staubli"}, Case{"staubli", true, "fanuc"},
                           Case{"abb", true, "vector"}, Case{"yaskawa", true, "vector"}, Case{"ur", true, "vector"},
                           Case{"kawasaki", false, "kuka"}, Case{"vector", true, "rpy"}, Case{"quaternion-xyzw", false, "quaternion"},
                           Case{"quaternion-inverse", false, "quaternion"}, Case{"yxz-extrinsic", true, "zxz"}}) {
    const RotationConvention convention = *rotation_convention(each.right);
    const std::string text = written(convention, each.by_axis);
    const Calibration c = calibrate(s.nominal, parse_dataset(text, "m.csv", s.nominal, each.right), {});
    EXPECT_LT(distance_from_truth_mm(s, c, 200, 1), 1.05 * alone) << each.right;
    const Calibration misread = calibrate(s.nominal, parse_dataset(text, "m.csv", s.nominal, each.wrong), {});
    ASSERT_FALSE(misread.usable()) << each.right << " read as " << each.wrong;
    const std::string message = misread.contradiction;
    EXPECT_EQ(misread.reasons, std::vector<std::string>{message});
    // What is left is the calibration of the positions.
    EXPECT_LT(distance_from_truth_mm(s, misread, 200, 1), 1.001 * alone) << each.wrong;
    const std::size_t at = message.find("(--rotation ");
    ASSERT_NE(at, std::string::npos) << message;
    const std::string named = message.substr(at + 12, message.find(')', at) - at - 12);
    const RotationConvention offered = *rotation_convention(named);
    for (int k = 0; k < 10; ++k) {
      const std::array<double, 4> n{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0, 1)};
      const auto read_as = [&](const RotationConvention& r) { return frame_of(quaternion_from(r, ordered(r, each.by_axis, n)), {}); };
      EXPECT_LT(angle_between(read_as(convention), read_as(offered)), 1e-6) << each.right << " offered as " << named;
    }
    if (convention.radians) {
      EXPECT_NE(message.find("rx_rad"), std::string::npos) << message;
    }
  }
}

// A flange that is turned in two poses of eighty only, by 20 degrees: the others fit in any convention once the probe's turn is
// fitted.
TEST(FullPoses, AWrongConventionIsFoundOutWhereTheFlangeHardlyTurns) {
  Simulation s = full_poses("three-parallel", 71, 80, 0.1e-3);
  Arm<double> arm{};
  ASSERT_EQ(make_arm(s.truth.geometry, arm), Status::ok);
  const MeasurementModel truth = truth_model(s);
  Random random(3);
  for (std::size_t i = 0; i < s.train.rows.size(); ++i) {
    Measurement& m = s.train.rows[i];
    // Axes 2, 3 and 4 are parallel: joint 4 takes back what 2 and 3 turn.
    m.q[0] = 0.4, m.q[3] = 0.2 - m.q[1] - m.q[2], m.q[4] = 0.7, m.q[5] = -0.4;
    if (i % 40 == 0) m.q[5] += 0.35;
    m.position_m = truth.target_position(m.q.data(), 0);
    Pose<double> pose{};
    ASSERT_EQ(forward(arm, m.q.data(), pose), Status::ok);
    const Frame<double> noise = rotation_about({1e-4 * random.normal(), 1e-4 * random.normal(), 1e-4 * random.normal()}, {});
    Frame<double> turn = compose(compose(truth.estimate().tracker_T_base, frame_of(pose)), noise);
    const Pose<double> turned = pose_of(turn);
    m.quaternion = {turned.quaternion[0], turned.quaternion[1], turned.quaternion[2], turned.quaternion[3]};
    for (double& c : m.position_m) c += 0.02e-3 * random.normal();
  }
  const auto calibrated = [&](const char* as) {
    const auto number = [&s](std::size_t k) { return [&s, k](std::size_t i) { return decimal(s.train.rows[i].quaternion[k]); }; };
    TableColumns columns = TableColumns{id_column(s.train)} + joint_columns(s.train) + position_columns(s.train);
    for (const char* name : {"qw", "qx", "qy", "qz"}) columns.emplace_back(name, number(columns.size() - 1 - s.train.joint_count - 3));
    return calibrate(s.nominal, parse_dataset(measured_table(s.train.rows.size(), columns), "m.csv", s.nominal, as), {});
  };
  EXPECT_EQ(calibrated("quaternion").contradiction, "");
  EXPECT_NE(calibrated("quaternion-inverse").contradiction.find("They fit as qw, qx, qy, qz (--rotation quaternion)"), std::string::npos);
}

// What is sound is never accused: noisy, few, hardly turning, with joints' zeros off by a degree.
TEST(FullPoses, SoundRotationsAreNotAccused) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    Simulation s = full_poses(seed % 2 == 0 ? "spherical-wrist" : "three-parallel", 60 + seed, 8 + 3 * seed, seed % 3 == 0 ? 5e-3 : 0.1e-3);
    turn_probe(s.train, turned_by(direction(random), random.uniform(0, 3)));
    EXPECT_EQ(calibrate(s.nominal, s.train, {}).contradiction, "") << seed;
  }
}

}  // namespace
