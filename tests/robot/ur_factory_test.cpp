// SPDX-License-Identifier: MIT
#include "offline/robot/ur_factory.hpp"

#include <cmath>
#include <tuple>

#include <gtest/gtest.h>

#include "offline/base/error.hpp"
#include "offline/base/random.hpp"
#include "offline/robot/rotation.hpp"
#include "offline/robot/units.hpp"
#include "offline/simulate/family.hpp"
#include "offline/simulate/simulate.hpp"
#include "tests/robot/eigen_chain.hpp"
#include "tests/robot/factory_table.hpp"
#include "tests/support/shared_data.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using namespace mdhcal::offline::test;

// The frames that ur_description publishes as default_kinematics of the UR5e, with the ten digits printed there.
const char* const ur5e_yaml = R"(kinematics:
  shoulder: {x: 0, y: 0, z: 0.1625, roll: -0, pitch: 0, yaw: -0}
  upper_arm: {x: 0, y: 0, z: 0, roll: 1.570796327, pitch: 0, yaw: -0}
  forearm: {x: -0.425, y: 0, z: 0, roll: -0, pitch: 0, yaw: -0}
  wrist_1: {x: -0.3922, y: 0, z: 0.1333, roll: -0, pitch: 0, yaw: -0}
  wrist_2: {x: 0, y: -0.0997, z: -2.044881182297852e-11, roll: 1.570796327, pitch: 0, yaw: -0}
  wrist_3: {x: 0, y: 0.0996, z: -2.042830148012698e-11, roll: 1.570796326589793, pitch: 3.141592653589793, yaw: 3.141592653589793}
  hash: calib_0
)";

// base_T_flange of a standard table, in long double: d runs to 440 m there.
using Real = long double;
using Table = std::array<std::array<Real, 4>, 6>;  // theta, d, a, alpha

Eigen::Matrix<Real, 4, 4> standard_flange(const Table& table, const double* q) {
  Eigen::Matrix<Real, 4, 4> t = Eigen::Matrix<Real, 4, 4>::Identity();
  for (std::size_t i = 0; i < 6; ++i) {
    const Real ct = std::cos(table[i][0] + static_cast<Real>(q[i])), st = std::sin(table[i][0] + static_cast<Real>(q[i]));
    const Real ca = std::cos(table[i][3]), sa = std::sin(table[i][3]), a = table[i][2], d = table[i][1];
    Eigen::Matrix<Real, 4, 4> m;
    m << ct, -st * ca, st * sa, a * ct, st, ct * ca, -ct * sa, a * st, 0, sa, ca, d, 0, 0, 0, 1;
    t = t * m;
  }
  return t;
}

TEST(UrFactory, ThePublishedFramesAreThePublishedTable) {
  const Robot from_yaml = robot_from_chain(parse_ros_kinematics(ur5e_yaml, "ur5e.yaml"), "ur5e.yaml");
  const Robot nominal = ur_nominal("ur5e");
  Random random(1);
  for (int pose = 0; pose < 50; ++pose) {
    double q[max_joints];
    random_readings(random, 3, q);
    EXPECT_LT(difference(flange(from_yaml, q), flange(nominal, q)), 2e-9);  // ten digits of pi/2
  }
}

// The correction of the UR10e of the shared set, whose upper arm sits 439 m away, less the published table.
const char* const calibration_conf = R"([mounting]
delta_theta = [ -2.4147806894359025e-07, 1.60233952386694556, -1.68607190752171299, 0.0837331147700118711, -1.01260355871157781e-07, 3.91986209186123702e-08] # rad
delta_a = [ 2.12234865071205891e-05, 0.632017132627700651, 0.00229834638831230319, -4.61409023720933908e-05, -6.39280055471920822e-05, 0]
delta_d = [ -0.00016021428174132504, 439.140974079900957, -446.027059806332147, 6.88618689642360149, -3.8658869684867e-05, -0.00087932456742874186]
delta_alpha = [ -0.00065024635248111, 0.00139416666825590402, 0.00693818880325995126, -0.000810641357286841, 0.000411121589402, 0 ]
joint_checksum = [ 0x6e0f7bf, 0xa32a713f, 0xf636a50, 0x9ec2338a, 0xa1afded8, 0xb29b2979]
calibration_status = 2 # 0 == notInitialized / 1 == notLinearised / 2 == Linearised
)";

TEST(UrFactory, AControllersCorrectionGivesItsPosesWithoutRunawayLengths) {
  const Robot robot = parse_ur_calibration(calibration_conf, "calibration.conf", "ur10e");
  constexpr Real right = 1.57079632679489661923L;
  const Table table = {{{-2.4147806894359025e-07L, 0.1807L - 0.00016021428174132504L, 2.12234865071205891e-05L,
                         right - 0.00065024635248111L},
                        {1.60233952386694556L, 439.140974079900957L, -0.6127L + 0.632017132627700651L,
                         0.00139416666825590402L},
                        {-1.68607190752171299L, -446.027059806332147L, -0.57155L + 0.00229834638831230319L,
                         0.00693818880325995126L},
                        {0.0837331147700118711L, 0.17415L + 6.88618689642360149L, -4.61409023720933908e-05L,
                         right - 0.000810641357286841L},
                        {-1.01260355871157781e-07L, 0.11985L - 3.8658869684867e-05L, -6.39280055471920822e-05L,
                         -right + 0.000411121589402L},
                        {3.91986209186123702e-08L, 0.11655L - 0.00087932456742874186L, 0, 0}}};
  Random random(2);
  for (int pose = 0; pose < 100; ++pose) {
    double q[max_joints];
    random_readings(random, 3, q);
    const Eigen::Matrix4d truth = standard_flange(table, q).cast<double>();
    EXPECT_LT(difference(flange(robot, q), Eigen::Isometry3d(truth)), 1e-12);
  }
  for (const Link& link : robot.geometry.link) {
    EXPECT_LT(std::abs(link.d_m), 1.3);
    EXPECT_LT(std::abs(link.a_m), 1.3);
  }
}

// Two real units: what their controllers add to the published table, written as a calibration.conf and read back, gives the
// standard-DH poses of the shared files. Where axes are not parallel the additions are small, which speaks for the tables.
MDHCAL_SHARED_DATA_TEST(UrFactory, RealUnitsComeBackThroughTheirCorrections) {
  constexpr double right = 1.57079632679489662;
  const auto published = [](double d1, double a2, double a3, double d4, double d5, double d6) {
    return std::vector<StandardLink>{{0, d1, 0, right}, {0, 0, a2, 0}, {0, 0, a3, 0}, {0, d4, 0, right}, {0, d5, 0, -right}, {0, d6, 0, 0}};
  };
  const std::tuple<const char*, const char*, std::vector<StandardLink>> units[] = {
      {"ur_factory/ur10_a.toml", "ur10", published(0.1273, -0.612, -0.5723, 0.163941, 0.1157, 0.0922)},
      {"ur_factory/ur10e_c.toml", "ur10e", published(0.1807, -0.6127, -0.57155, 0.17415, 0.11985, 0.11655)}};
  for (const auto& [file, model, nominal] : units) {
    const std::vector<StandardLink> unit = mdhcal::tests::factory_table(mdhcal::tests::shared_data(file));
    ASSERT_EQ(unit.size(), 6U);
    std::string theta, a, d, alpha;
    Table table{};
    for (std::size_t i = 0; i < 6; ++i) {
      const std::string comma = i == 0 ? "" : ", ";
      theta += comma + shortest_decimal(unit[i].theta_rad);
      a += comma + shortest_decimal(unit[i].a_m - nominal[i].a_m);
      d += comma + shortest_decimal(unit[i].d_m - nominal[i].d_m);
      alpha += comma + shortest_decimal(unit[i].alpha_rad - nominal[i].alpha_rad);
      table[i] = {unit[i].theta_rad, unit[i].d_m, unit[i].a_m, unit[i].alpha_rad};
      if (i >= 1 && i <= 3) continue;
      EXPECT_NEAR(unit[i].a_m, nominal[i].a_m, 2e-3) << file << ' ' << i;
      EXPECT_NEAR(unit[i].d_m, nominal[i].d_m, 2e-3) << file << ' ' << i;
      EXPECT_NEAR(unit[i].alpha_rad, nominal[i].alpha_rad, 2e-3) << file << ' ' << i;
    }
    const std::string conf = "delta_theta = [" + theta + "]\ndelta_a = [" + a + "]\ndelta_d = [" + d + "]\ndelta_alpha = [" +
                             alpha + "]\n";
    const Robot corrected = parse_ur_calibration(conf, "calibration.conf", model);
    Random random(5);
    for (int pose = 0; pose < 50; ++pose) {
      double q[max_joints];
      random_readings(random, 3, q);
      const Eigen::Isometry3d truth(standard_flange(table, q).cast<double>());
      EXPECT_LT(difference(flange(corrected, q), truth), 1e-12) << file;
    }
  }
}

TEST(UrFactory, KinematicsWrittenAreReadBackWithTheSamePoses) {
  std::vector<Robot> robots{parse_ur_calibration(calibration_conf, "calibration.conf", "ur10e")};
  for (const std::string& family : family_names()) robots.push_back(simulate(family_robot(family), {}).truth);
  for (Robot& robot : robots) {
    robot.tracker_T_base.reset();
    robot.geometry.joint[1].sign = -1;
    robot.geometry.last_T_flange = pose_of(frame_of_xyz_rpy({0.1, -0.2, 0.05}, {0.3, 1.5707, -2}));
    const std::string text = ros_kinematics_text(robot);
    const Robot again = robot_from_chain(parse_ros_kinematics(text, "k.yaml"), "k.yaml");
    Random random(3);
    for (int pose = 0; pose < 20; ++pose) {
      double q[max_joints];
      random_readings(random, 3, q);
      EXPECT_LT(difference(flange(again, q), flange(robot, q)), 1e-9) << text;
    }
  }
}

// The hash by which the driver knows the arm's own calibration is kept on the way through a robot file, in any style.
TEST(UrFactory, TheCalibrationsHashIsKept) {
  for (const char* hash : {"calib_4890363623803256388", "\"calib: 1\"", "12"}) {
    const std::string text = "kinematics:\n  one: {x: 0, y: 0, z: 0.1, roll: 0, pitch: 0, yaw: 0}\n  hash: " + std::string(hash) + '\n';
    const Robot robot = robot_from_chain(parse_ros_kinematics(text, "k.yaml"), "k.yaml");
    const Robot again = parse_robot(write_robot(robot), "r.toml");
    EXPECT_EQ(again.kinematics_hash, robot.kinematics_hash);
    const std::string written = ros_kinematics_text(again);
    EXPECT_NE(written.find("  hash: " + std::string(hash) + '\n'), std::string::npos) << written;
  }
}

TEST(RollPitchYaw, HoldsThroughTheSingularPitch) {
  Random random(4);
  for (const double off : {0.0, 1e-12, 1e-9, 1e-6, 1e-3, 1.0}) {
    for (const double side : {-1.0, 1.0}) {
      const Vector3 rpy{random.uniform(-3, 3), side * (1.5707963267948966 - off), random.uniform(-3, 3)};
      const Frame<double> frame = frame_of_xyz_rpy({0, 0, 0}, rpy);
      const Frame<double> again = frame_of_xyz_rpy({0, 0, 0}, roll_pitch_yaw(frame));
      for (int k = 0; k < 9; ++k) EXPECT_NEAR(frame.rotation[k], again.rotation[k], 2e-15) << off;
    }
  }
}

template <class Call>
std::string message(Call&& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(UrFactory, MalformedFilesAreRefusedWithTheirSpot) {
  const auto conf = [](const std::string& text, const std::string& model = "ur5") {
    return message([&] { (void)parse_ur_calibration(text, "c.conf", model); });
  };
  EXPECT_NE(conf("\ndelta_a = [1, 2]\n").find("c.conf:2:16: Found \"]\" after entry 2"), std::string::npos);
  EXPECT_NE(conf("delta_a = [1, x, 2]").find("c.conf:1:15: Entry 2"), std::string::npos);
  EXPECT_NE(conf("delta_a = 5").find("no [ or no ]"), std::string::npos);
  EXPECT_NE(conf("delta_a = ] [").find("no [ or no ]"), std::string::npos);
  EXPECT_NE(conf("delta_a = [nan, 0, 0, 0, 0, 0]").find("no number"), std::string::npos);
  EXPECT_NE(conf("delta_a = [1, 2, 3, 4, 5, 6]\n# again\n delta_a = [1, 2, 3, 4, 5, 6]\n").find("c.conf:3:1: Found \"delta_a\" a second time"),
            std::string::npos);
  EXPECT_NE(conf("# caf\xE9\n").find("c.conf:1:6: Found the byte 0xE9"), std::string::npos);
  EXPECT_NE(conf("[mounting]\n").find("There is no \"delta_theta\""), std::string::npos);
  EXPECT_NE(conf(calibration_conf, "kr6").find("ur16e"), std::string::npos);
  const auto yaml = [](const std::string& text) {
    return message([&] { (void)robot_from_chain(parse_ros_kinematics(text, "k.yaml"), "k.yaml"); });
  };
  EXPECT_NE(yaml("a: [1").find("k.yaml:"), std::string::npos);
  EXPECT_NE(yaml("other: 1\n").find("\"kinematics\""), std::string::npos);
  EXPECT_NE(yaml("kinematics:\n  shoulder: {x: 0}\n").find("There is no \"upper_arm\""), std::string::npos);
  EXPECT_NE(yaml("kinematics:\n  one: {x: 0, y: 0, z: zero, roll: 0, pitch: 0, yaw: 0}\n").find("k.yaml:2:24: \"zero\""),
            std::string::npos);
  EXPECT_NE(yaml("kinematics:\n  one: {x: 0, y: 0, z: 0, roll: 0, pitch: 0}\n").find("no \"yaw\""), std::string::npos);
  EXPECT_NE(yaml("kinematics:\n  one: {x: 0, y: 0, z: 0, roll: 0, pitch: 0, yaw: 0, x: 1}\n").find("k.yaml:2:54: Found \"x\" a second"),
            std::string::npos);
  EXPECT_NE(yaml("kinematics:\n  a: {}\n  a: {}\n").find("k.yaml:3:3: Found \"a\" a second"), std::string::npos);
  EXPECT_NE(yaml("kinematics: \xFF\n").find("0xFF"), std::string::npos);
  EXPECT_NE(yaml("kinematics: {a: " + std::string(100000000, 'x') + "}\n").find("at most 1048576"), std::string::npos);
  EXPECT_NE(yaml("kinematics: {a: " + std::string(1000000, 'x') + "}\n").find("0 moving joints"), std::string::npos);
  EXPECT_NE(yaml("kinematics: " + std::string(1000000, '[') + "\n").find("k.yaml:"), std::string::npos);
  EXPECT_NE(yaml("kinematics:\n  hash: x\n").find("0 moving joints"), std::string::npos);
}

}  // namespace
