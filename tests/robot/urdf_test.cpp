// SPDX-License-Identifier: MIT
#include "offline/robot/urdf.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "offline/base/error.hpp"
#include "offline/base/random.hpp"
#include "offline/robot/rotation.hpp"
#include "offline/robot/ur_factory.hpp"
#include "offline/simulate/family.hpp"
#include "offline/simulate/simulate.hpp"
#include "tests/robot/eigen_chain.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using namespace mdhcal::offline::test;

// A random serial URDF, with fixed joints in between, and its forward kinematics.
struct Sample {
  std::string text;
  struct Step {
    Eigen::Isometry3d origin;
    Eigen::Vector3d axis;
    char kind;  // r, p or f
  };
  std::vector<Step> steps;

  Eigen::Isometry3d tip(const double* q) const {
    Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
    for (const Step& step : steps) {
      t = t * step.origin;
      if (step.kind == 'r') t = t * about(*q++, step.axis);
      if (step.kind == 'p') {
        const Eigen::Vector3d move = step.axis * *q++;
        t = t * along(move.x(), move.y(), move.z());
      }
    }
    return t;
  }
};

std::string words(const Eigen::Vector3d& v) {
  char text[100];
  std::snprintf(text, sizeof text, "%.17g %.17g %.17g", v.x(), v.y(), v.z());
  return text;
}

Eigen::Vector3d vector(Random& random, double size) {
  Eigen::Vector3d v;
  for (int k = 0; k < 3; ++k) v[k] = random.uniform(-size, size);
  return v;
}

Sample random_urdf(Random& random, const std::string& kinds, bool right_angles) {
  Sample sample;
  sample.text = "<?xml version=\"1.0\"?>\n<robot name=\"sample\">\n  <link name=\"l0\"/>\n";
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const Eigen::Vector3d xyz = vector(random, 0.5);
    Eigen::Vector3d rpy = vector(random, 3.1), axis = vector(random, 1);
    if (right_angles) {
      for (double& angle : rpy) angle = std::round(angle / 1.5707963267948966) * 1.5707963267948966;
      Eigen::Index largest = 0;
      axis.cwiseAbs().maxCoeff(&largest);
      const double sign = axis[largest] < 0 ? -1 : 1;
      axis = sign * Eigen::Vector3d::Unit(largest);
    }
    sample.steps.push_back({xyz_rpy(xyz, rpy), axis.normalized(), kinds[i]});
    const std::string type = kinds[i] == 'r' ? "continuous" : (kinds[i] == 'p' ? "prismatic" : "fixed");
    const std::string n = std::to_string(i), m = std::to_string(i + 1);
    sample.text += "  <link name=\"l" + m + "\"><visual/></link>\n  <joint name=\"j" + m + "\" type=\"" + type +
                   "\">\n    <parent link=\"l" + n + "\"/>\n    <child link=\"l" + m + "\"/>\n    <origin xyz=\"" +
                   words(xyz) + "\" rpy=\"" + words(rpy) + "\"/>\n";
    if (kinds[i] != 'f') sample.text += "    <axis xyz=\"" + words(axis) + "\"/>\n";
    if (kinds[i] == 'p') sample.text += "    <limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>\n";
    sample.text += "  </joint>\n";
  }
  sample.text += "</robot>\n";
  return sample;
}

TEST(Urdf, AnyChainKeepsItsPosesInBothDirections) {
  Random random(11);
  for (int k = 0; k < 200; ++k) {
    const char* kinds[] = {"rrrrrr", "frrfrrrrf", "rrprf", "frrrrrrrf", "prrr", "r"};
    const Sample sample = random_urdf(random, kinds[k % 6], k % 2 == 0);
    const Robot robot = robot_from_chain(parse_urdf(sample.text, "sample.urdf", "", ""), "sample.urdf");
    const std::string out = urdf_text(robot);
    const Robot again = robot_from_chain(parse_urdf(out, "out.urdf", "", ""), "out.urdf");
    for (int pose = 0; pose < 5; ++pose) {
      double q[max_joints];
      random_readings(random, 1, q);
      EXPECT_LT(difference(flange(robot, q), sample.tip(q)), 1e-9) << sample.text;
      EXPECT_LT(difference(flange(again, q), sample.tip(q)), 1e-9) << out;
    }
  }
}

TEST(Urdf, ASimulatedArmSurvivesTheWayThroughUrdf) {
  for (const std::string& family : family_names()) {
    SimulationOptions options;
    options.base_frame = true;
    Robot truth = simulate(family_robot(family), options).truth;
    truth.geometry.joint[2].sign = -1;  // an axis that points down
    const Robot again = robot_from_chain(parse_urdf(urdf_text(truth), "t.urdf", "", "flange"), "t.urdf");
    Random random(5);
    for (int pose = 0; pose < 20; ++pose) {
      double q[max_joints];
      random_readings(random, 1, q);
      EXPECT_LT(difference(flange(again, q), flange(truth, q)), 1e-9) << family;
    }
  }
}

TEST(Urdf, ACorrectedUrdfHasTheCorrectedPosesAndKeepsEverythingElse) {
  Random random(12);
  for (int k = 0; k < 50; ++k) {
    Sample sample = random_urdf(random, "frrfrrrrf", k % 2 == 0);
    Robot corrected = robot_from_chain(parse_urdf(sample.text, "sample.urdf", "", ""), "sample.urdf");
    Link* link = corrected.geometry.link;
    for (std::size_t i = 1; i < 6; ++i) {
      link[i].alpha_rad += 1e-3 * random.normal();
      link[i].a_m += 1e-3 * random.normal();
      link[i].theta_rad += 1e-3 * random.normal();
      link[i].d_m += 1e-3 * random.normal();
      if (i < 5) link[i].beta_rad += 1e-3 * random.normal();
    }
    const std::string out = corrected_urdf(sample.text, "sample.urdf", corrected, "", "");
    const Robot again = robot_from_chain(parse_urdf(out, "out.urdf", "", ""), "out.urdf");
    for (int pose = 0; pose < 5; ++pose) {
      double q[max_joints];
      random_readings(random, 1, q);
      EXPECT_LT(difference(flange(again, q), flange(corrected, q)), 1e-9);
      EXPECT_GT(difference(flange(again, q), sample.tip(q)), 1e-5);
    }
    // Only origins of moving joints differ: what is not in an origin stays byte for byte.
    const auto without_origins = [](std::string text) {
      for (std::size_t at; (at = text.find("<origin")) != std::string::npos;) {
        text.erase(at, text.find("/>", at) + 2 - at);
      }
      return text;
    };
    EXPECT_EQ(without_origins(out), without_origins(sample.text));
  }
}

TEST(Urdf, AnOriginIsFoundInWhateverWayItIsWritten) {
  const std::string text =
      "<!-- made by hand -->\n<robot name='two'><link name='b'/><link name='m'/><link name='t'/>\n"
      "<joint name='a>b' type='continuous'><parent link='b'/><child link='m'/><axis xyz='0 0 1'/></joint>\n"
      "<joint name='j2' type='continuous'><parent link='m'/><child link='t'/>\n"
      "<axis xyz='0 1 0'/><origin xyz='1 0 0'><!-- > --></origin></joint></robot>\n";
  Robot robot = robot_from_chain(parse_urdf(text, "two.urdf", "", ""), "two.urdf");
  robot.geometry.link[0].d_m += 0.25;
  EXPECT_EQ(corrected_urdf(text, "two.urdf", robot, "", ""),
            "<!-- made by hand -->\n<robot name='two'><link name='b'/><link name='m'/><link name='t'/>\n"
            "<joint name='a>b' type='continuous'><origin xyz=\"0.0 0.0 0.25\" rpy=\"0.0 0.0 0.0\"/>"
            "<parent link='b'/><child link='m'/><axis xyz='0 0 1'/></joint>\n"
            "<joint name='j2' type='continuous'><parent link='m'/><child link='t'/>\n"
            "<axis xyz='0 1 0'/><origin xyz=\"1.0 0.0 0.0\" rpy=\"0.0 0.0 0.0\"/></joint></robot>\n");
}

TEST(Urdf, ACorrectedUrdfOfAnotherArmIsRefused) {
  Random random(13);
  const Sample one = random_urdf(random, "rrrrrr", false), other = random_urdf(random, "rrrrrr", false);
  const Robot robot = robot_from_chain(parse_urdf(one.text, "one.urdf", "", ""), "one.urdf");
  EXPECT_THROW((void)corrected_urdf(other.text, "other.urdf", robot, "", ""), InputError);
}

TEST(Urdf, LimitsAndNamesAreRead) {
  const char* text =
      "<robot name=\"two\"><link name=\"b\"/><link name=\"m\"/><link name=\"t\"/><link name=\"camera\"/>"
      "<joint name=\"j1\" type=\"revolute\"><parent link=\"b\"/><child link=\"m\"/><axis xyz=\"0 0 1\"/>"
      "<limit lower=\"-1.5\" upper=\"+2\" effort=\"1\" velocity=\"1\"/></joint>"
      "<joint name=\"j2\" type=\"revolute\"><parent link=\"m\"/><child link=\"t\"/><origin xyz=\"1 0 0\"/>"
      "<axis xyz=\"0 0 2\"/><limit lower=\"-1\" upper=\"1\"/></joint>"
      "<joint name=\"jc\" type=\"fixed\"><parent link=\"m\"/><child link=\"camera\"/></joint></robot>";
  const Robot robot = robot_from_chain(parse_urdf(text, "two.urdf", "b", "t"), "two.urdf");
  EXPECT_EQ(robot.name, "two");
  EXPECT_EQ(robot.geometry.joint_count, 2);
  EXPECT_EQ(robot.geometry.joint[0].min, -1.5);
  EXPECT_EQ(robot.geometry.joint[0].max, 2.0);
  EXPECT_FALSE(robot.tracker_T_base.has_value());
  try {
    (void)parse_urdf(text, "two.urdf", "", "");
    FAIL() << "two leaves, and none was named";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("camera, t"), std::string::npos) << error.what();
  }
}

// A declaration that names another encoding does no harm where every byte is ASCII.
TEST(Urdf, AsciiIsReadWhateverItsDeclarationSays) {
  for (const char* encoding : {"ISO-8859-1", "us-ascii", "utf-8", "UTF-16"}) {
    const std::string text = std::string("<?xml version='1.0' encoding='") + encoding +
                             "'?><robot name='x'><link name='a'/><link name='b'/><joint name='j' type='continuous'>"
                             "<parent link='a'/><child link='b'/></joint></robot>";
    EXPECT_EQ(parse_urdf(text, "a.urdf", "", "").joints.size(), 1U) << encoding;
  }
  const std::string utf8 = "<?xml version='1.0' encoding='UTF-8'?><robot name='caf\xC3\xA9'><link name='a'/></robot>";
  EXPECT_EQ(parse_urdf(utf8, "a.urdf", "", "").name, "caf\xC3\xA9");
}

std::string one_joint(const std::string& origin, const std::string& limit) {
  return "<robot name=\"one\"><link name=\"b\"/><link name=\"t\"/><joint name=\"swing\" type=\"revolute\"><parent link=\"b\"/>"
         "<child link=\"t\"/><origin " + origin + "/><axis xyz=\"0 0 1\"/>" + limit + "</joint></robot>";
}

// Zero limits are those of an exporter that knew none; limits beyond every reading are none. Both are said, with the joint.
TEST(Urdf, LimitsThatAreNoneAreReadAsNoneAndSaid) {
  struct Case {
    const char* limit;
    bool has_min, has_max, said;
  };
  for (const Case& each : {Case{"<limit lower='0' upper='0' effort='0' velocity='0'/>", false, false, true},
                           Case{"<limit effort='0' velocity='0'/>", false, false, true},
                           Case{"<limit lower='-1e+16' upper='1e+16'/>", false, false, true},
                           Case{"<limit lower='-1' upper='1.7976931348623157e+308'/>", true, false, true},
                           Case{"<limit lower='-inf' upper='inf'/>", false, false, true},
                           Case{"<limit lower='0' upper='1'/>", true, true, false}, Case{"", false, false, false}}) {
    const Chain chain = parse_urdf(one_joint("xyz='0 0 1'", each.limit), "one.urdf", "", "");
    const Robot robot = robot_from_chain(chain, "one.urdf");
    EXPECT_EQ(robot.geometry.joint[0].has_min == 1, each.has_min) << each.limit;
    EXPECT_EQ(robot.geometry.joint[0].has_max == 1, each.has_max) << each.limit;
    ASSERT_EQ(chain.notes.size(), each.said ? 1U : 0U) << each.limit;
    if (each.said) {
      EXPECT_NE(chain.notes[0].find("one.urdf:1: joint \"swing\""), std::string::npos) << chain.notes[0];
    }
  }
}

// A first joint that is a little off what link 1 can express leaves the robot's base frame a little off the root link: poses
// in the base frame differ by as little, and what they differ by is in [base] and said.
TEST(Urdf, TheBaseFrameStaysWhereTheRootLinkIs) {
  Random random(21);
  for (int k = 0; k < 200; ++k) {
    const double size = std::pow(10.0, random.uniform(-9, -1));
    Frame<double> off = frame_of_xyz_rpy({0, 0, 0.4}, {3.1416, 0, 0});
    off = compose(off, frame_of_xyz_rpy({size * random.normal(), size * random.normal(), 0},
                                        {size * random.normal(), size * random.normal(), random.uniform(-3, 3)}));
    Chain chain;
    for (int j = 0; j < 3; ++j) {
      ChainJoint joint;
      joint.parent_T_joint = j == 0 ? off : frame_of_xyz_rpy({0.1, 0.3, 0.2}, {1.5707963, 0.1 * j, 0});
      chain.joints.push_back(joint);
    }
    chain.last_T_tip = frame_of_xyz_rpy({0, 0.2, 0.5}, {0, 0, 0});
    const Robot robot = robot_from_chain(chain, "r.urdf");
    const double q[3] = {random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)};
    Arm<double> made{};
    Pose<double> pose{};
    ASSERT_EQ(make_arm(robot.geometry, made), Status::ok);
    ASSERT_EQ(forward(made, q, pose), Status::ok);
    const Frame<double> base = robot.tracker_T_base ? frame_of(*robot.tracker_T_base) : identity_frame();
    const Frame<double> truth = tip(chain, q), exact = compose(base, frame_of(pose));
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(exact.position_m[i], truth.position_m[i], 1e-12);
      // 3.1416 itself is 7.35e-6 off pi.
      EXPECT_NEAR(pose.position_m[i], truth.position_m[i], 20 * (size + 7.35e-6)) << "size " << size;
    }
    EXPECT_EQ(base_frame_note(robot, "base_link").empty(), !robot.tracker_T_base.has_value());
  }
}

TEST(Urdf, JointNamesGoIntoTheRobotFileAndBack) {
  const Robot robot = robot_from_chain(parse_urdf(one_joint("xyz='0 0 1'", ""), "one.urdf", "", ""), "one.urdf");
  EXPECT_EQ(robot.joint_name[0], "swing");
  EXPECT_EQ(parse_robot(write_robot(robot), "one.toml").joint_name[0], "swing");
  EXPECT_NE(urdf_text(robot).find("name=\"swing\""), std::string::npos);
}

struct Malformed {
  const char* what;
  const char* text;
  const char* message;  // a part of it
};

class MalformedUrdf : public testing::TestWithParam<Malformed> {};

TEST_P(MalformedUrdf, NamesTheSpot) {
  try {
    const Chain chain = parse_urdf(GetParam().text, "bad.urdf", "", "");
    (void)robot_from_chain(chain, "bad.urdf");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().message), std::string::npos) << error.what();
  }
}

#define ONE(joint) "<robot name=\"x\">\n<link name=\"a\"/><link name=\"b\"/>\n" joint "\n</robot>"
#define LINKS "<parent link=\"a\"/><child link=\"b\"/>"
INSTANTIATE_TEST_SUITE_P(
    Files, MalformedUrdf,
    testing::Values(
        Malformed{"not XML", "<robot name=\"x\">\n<link", "bad.urdf:2:"},
        Malformed{"no robot", "<sdf/>", "<robot>"},
        Malformed{"xacro", "<robot>\n <xacro:include filename=\"a\"/></robot>", "bad.urdf:2:3: <xacro:include> is xacro"},
        Malformed{"no joints", "<robot name=\"x\"><link name=\"a\"/></robot>", "0 moving joints"},
        Malformed{"type", ONE("<joint name=\"j\" type=\"planar\">" LINKS "</joint>"), "bad.urdf:3:2: Joint \"j\""},
        Malformed{"mimic", ONE("<joint name=\"j\" type=\"revolute\">" LINKS "<mimic joint=\"k\"/></joint>"), "mimics"},
        Malformed{"number", ONE("<joint name=\"j\" type=\"revolute\">" LINKS "<origin xyz=\"1 0,5 2\"/></joint>"),
                  "\"0,5\""},
        Malformed{"infinite", ONE("<joint name=\"j\" type=\"revolute\">" LINKS "<origin xyz=\"1 inf 2\"/></joint>"),
                  "\"inf\""},
        Malformed{"count", ONE("<joint name=\"j\" type=\"revolute\">" LINKS "<origin rpy=\"1 2\"/></joint>"),
                  "2 numbers; expected 3"},
        Malformed{"axis", ONE("<joint name=\"j\" type=\"revolute\">" LINKS "<axis xyz=\"0 0 0\"/></joint>"), "length 0"},
        Malformed{"limits",
                  ONE("<joint name=\"j\" type=\"revolute\">" LINKS "<limit lower=\"2\" upper=\"1\"/></joint>"), "above"},
        Malformed{"Latin-1", "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n<robot name=\"caf\xE9\"/>",
                  "bad.urdf:1:30: Found text in the encoding ISO-8859-1; expected a URDF in UTF-8"},
        Malformed{"Latin-1 that says nothing", "<robot name=\"caf\xE9\"/>", "bad.urdf:1:17: Found the byte 0xE9"},
        Malformed{"UTF-16", "\xFF\xFE<", "Found text in UTF-16"},
        Malformed{"control character", "<robot name=\"a\">\n<link name=\"&#27;[2J\"/></robot>", "bad.urdf:2:2: <link>: found a control"},
        Malformed{"two origins", ONE("<joint name=\"j\" type=\"revolute\">" LINKS "<origin/>\n<origin/></joint>"),
                  "bad.urdf:4:2: Joint \"j\" has a second <origin>"},
        Malformed{"no child", ONE("<joint name=\"j\" type=\"revolute\"><parent link=\"a\"/></joint>"), "no <child>"},
        Malformed{"ring",
                  ONE("<joint name=\"j\" type=\"fixed\">" LINKS "</joint>"
                      "<joint name=\"k\" type=\"fixed\"><parent link=\"b\"/><child link=\"a\"/></joint>"),
                  "may end at any of"}));

}  // namespace
