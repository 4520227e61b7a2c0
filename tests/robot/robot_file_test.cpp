// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "mdhcal/kinematics.hpp"
#include "offline/base/error.hpp"
#include "offline/base/random.hpp"
#include "offline/robot/robot.hpp"
#include "offline/robot/units.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using mdhcal::offline::Random;

const std::string one_link = "[[link]]\nalpha = 0\na = 0\nd = 100.0\n";

std::string message_of(const std::string& text) {
  try {
    (void)parse_robot(text, "robot.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(RobotFile, ReadsWhatItSays) {
  const Robot robot = parse_robot(R"(
name = "cobot"
serial = "SN-1"
convention = "modified"
length_unit = "mm"
angle_unit = "deg"
[[link]]
alpha = 90.0
a = -12.5
d = 99.927
theta = 180
beta = 0.5
sign = -1
min = -360.0
max = 360
[[link]]
joint = "prismatic"
alpha = 0.0
a = 0
d = 1.0
theta = 30.0
min = 0.0
nominal = {alpha = 1.0, a = 2.0, d = 3.0}
[[coupling]]
of = 1
by = 2
ratio = 2.0
[flange]
xyz = [1.0, 2.0, 3.0]
rxryrz = [0, 0, 90.0]
[tool]
xyz = [0, 0, 31.0]
[base]
xyz = [1000, 0, 0]
quaternion = [0.0, 0.0, 0.0, -1.0]
[[target]]
name = "A"
xyz = [4, 5, 6]
[prior]
alpha1 = 0.1
d2 = 2.0
)",
                                   "robot.toml");
  EXPECT_EQ(robot.name, "cobot");
  EXPECT_EQ(robot.serial, "SN-1");
  const Geometry& g = robot.geometry;
  ASSERT_EQ(g.joint_count, 2);
  EXPECT_DOUBLE_EQ(g.link[0].alpha_rad, pi / 2);
  EXPECT_DOUBLE_EQ(g.link[0].a_m, -0.0125);
  EXPECT_DOUBLE_EQ(g.link[0].d_m, 0.099927);
  EXPECT_DOUBLE_EQ(g.link[0].theta_rad, pi);
  EXPECT_DOUBLE_EQ(g.link[0].beta_rad, pi / 360);
  EXPECT_EQ(g.joint[0].sign, -1);
  EXPECT_EQ(g.joint[0].has_min, 1);
  EXPECT_DOUBLE_EQ(g.joint[0].min, -2 * pi);
  EXPECT_DOUBLE_EQ(g.joint[0].max, 2 * pi);
  EXPECT_EQ(g.joint[1].kind, JointKind::prismatic);
  EXPECT_EQ(g.joint[1].sign, 1);
  EXPECT_EQ(g.joint[1].has_max, 0);
  EXPECT_DOUBLE_EQ(robot.nominal[1].a_m, 0.002);
  EXPECT_DOUBLE_EQ(robot.nominal[0].a_m, -0.0125);
  EXPECT_NEAR(g.joint[0].coupling[1], 2.0 * (pi / 180) / 1e-3, 1e-12);  // 2 degrees a millimetre
  EXPECT_DOUBLE_EQ(g.last_T_flange.position_m[2], 0.003);
  EXPECT_NEAR(g.last_T_flange.quaternion[3], std::sqrt(0.5), 1e-15);
  EXPECT_DOUBLE_EQ((*robot.tool_p_m)[2], 0.031);
  EXPECT_DOUBLE_EQ(robot.tracker_T_base->position_m[0], 1.0);
  EXPECT_EQ(robot.targets.at(0).name, "A");
  EXPECT_DOUBLE_EQ(robot.prior.at("alpha1"), 0.1 * pi / 180);
  EXPECT_DOUBLE_EQ(robot.prior.at("d2"), 0.002);
}

TEST(RobotFile, MessagesNameThePlaceWhatWasFoundAndWhatWasExpected) {
  const struct {
    std::string text, place, found, expected;
  } cases[] = {
      {"name = \"a\"\nnmae = \"b\"\n" + one_link, ":2:1:", "\"nmae\"", "expected name, serial"},
      {"length_unit = \"inch\"\n" + one_link, ":1:15:", "\"inch\"", "expected \"mm\" or \"m\""},
      {one_link + "betta = 1\n", ":5:1:", "\"betta\" in [[link]] 1", "expected joint, alpha"},
      {"[[link]]\nalpha = 0\na = 0\n", ":1:1:", "no key \"d\"", "expected a number"},
      {"[[link]]\nalpha = 0\na = \"0\"\nd = 1\n", ":3:5:", "the text \"0\"", "expected a number"},
      {"[[link]]\nalpha = 0\na = nan\nd = 1\n", ":3:5:", "nan", "expected a finite number"},
      {"[[link]]\nalpha = 0\na = inf\nd = 1\n", ":3:5:", "inf", "expected a finite number"},
      {"angle_unit = \"rad\"\n[[link]]\nalpha = 90\na = 1\nd = 1\n", ":3:9:", "90 rad", "expected at most"},
      {one_link + "sign = 2\n", ":5:8:", "found 2", "expected 1 or -1"},
      {one_link + "min = 3\nmax = 2\n", ":5:7:", "found 3", "expected min <= max"},
      {one_link + "[flange]\nxyz = [1, 2]\n", ":6:7:", "an array of 2", "expected an array of 3"},
      {one_link + "[[coupling]]\nof = 1\nby = 2\nratio = 1\n", ":7:6:", "found 2", "joint, 1 to 1"},
      {"convention = \"standard\"\n" + one_link + "beta = 1\n", ":6:8:", "\"beta\"", "\"modified\""},
      {one_link + "[prior]\nd2 = 1\n", ":6:1:", "\"d2\"", "a link, 1 to 1"},
      {one_link + "[prior]\nd1 = -1\n", ":6:6:", "found -1", "above 0"},
      {one_link + "d = 2\n", ":5:", "'d'", ""},
      {one_link + "name =\n", ":5", "", ""},
      {"name = \"a\nb\"\n" + one_link, ":1:", "", ""},
      {"link = 3\n", ":1:8:", "found 3", "expected sections [[link]]"},
      {"name = \"a\"\n", ":1:1:", "no section [[link]]", "expected one a joint"},
      {"name = \"0123456789012345678901234567890123456789012345678901234567890123\"\n" + one_link, ":1:8:", "64 bytes",
       "expected at most 63"},
      {one_link + one_link + one_link + one_link + one_link + one_link + one_link + one_link + one_link, ":33:1:",
       "more than 8", "at most 8"},
      {one_link + "[flange]\nquaternion = [1, 1, 0, 0]\n", ":6:14:", "norm", "unit quaternion"},
  };
  for (const auto& c : cases) {
    const std::string message = message_of(c.text);
    EXPECT_NE(message.find("robot.toml" + c.place), std::string::npos) << message << "\n  wanted " << c.place;
    EXPECT_NE(message.find(c.found), std::string::npos) << message;
    EXPECT_NE(message.find(c.expected), std::string::npos) << message;
  }
}

double decimal(Random& random, double bound, int digits) {
  const double scale = std::pow(10.0, digits);
  return std::round(random.uniform(-bound, bound) * scale) / scale;
}

std::string random_file(Random& random) {
  const bool mm = random.index(2) == 0, deg = random.index(2) == 0, standard = random.index(2) == 0;
  const double length = mm ? 1000.0 : 1.0, angle = deg ? 180.0 : 3.0;
  const auto number = [&](double bound) { return shortest_decimal(decimal(random, bound, random.index(2) == 0 ? 3 : 15)); };
  std::string text = "name = \"robot \\\"é\\\\\"\nserial = \"7\"\n";
  text += mm ? "" : "length_unit = \"m\"\n";
  text += deg ? "" : "angle_unit = \"rad\"\n";
  text += standard ? "convention = \"standard\"\n" : "";
  const std::size_t count = 1 + random.index(8);
  for (std::size_t i = 0; i < count; ++i) {
    text += "[[link]]\n";
    if (random.index(4) == 0) text += "joint = \"prismatic\"\n";
    // Half of the twists are nearly parallel, in every sense of it.
    const double twists[] = {0, deg ? 90.0 : pi / 2, angle * 1e-5, angle * 0.01, -angle * 0.013, random.uniform(-angle, angle)};
    text += "alpha = " + shortest_decimal(twists[random.index(6)]) + "\n";
    text += "a = " + (random.index(3) == 0 ? "0" : number(length)) + "\n";
    text += "d = " + number(length) + "\n";
    text += "theta = " + number(angle) + "\n";
    if (random.index(3) == 0) text += "sign = -1\nmin = " + number(length / 1000) + "\n";
    if (!standard && random.index(2) == 0) {
      text += "beta = " + number(0.1 * angle) + "\nnominal = {alpha = " + number(angle) + ", a = " + number(length) +
              ", d = " + number(length) + "}\n";
    }
  }
  if (count > 2) text += "[[coupling]]\nof = 3\nby = 2\nratio = " + number(mm ? 0.03 : 1.0) + "\n";
  text += "[flange]\nxyz = [1, " + number(length) + ", 3]\nrxryrz = [" + number(angle) + ", 0.1, " + number(angle) + "]\n";
  if (random.index(2) == 0) text += "[base]\nxyz = [1, 2, 3]\nrxryrz = [0, " + number(angle) + ", " + number(angle) + "]\n";
  if (random.index(2) == 0) text += "[tool]\nxyz = [1, 2, " + number(length) + "]\n";
  text += "[[target]]\nname = \"A\"\nxyz = [" + number(length) + ", 0, 0]\n[prior]\na1 = 0.3\nbeta1 = 0.001\nalpha1 = 0.02\n";
  return text;
}

bool same_bits(const Robot& a, const Robot& b) {
  if (a.name != b.name || a.serial != b.serial || a.prior != b.prior) return false;
  if (std::memcmp(&a.geometry, &b.geometry, sizeof a.geometry) != 0) return false;
  if (std::memcmp(a.nominal.data(), b.nominal.data(), sizeof a.nominal) != 0) return false;
  if (a.tool_p_m != b.tool_p_m || a.tracker_T_base.has_value() != b.tracker_T_base.has_value()) return false;
  if (a.tracker_T_base && std::memcmp(&*a.tracker_T_base, &*b.tracker_T_base, sizeof(Pose<double>)) != 0) return false;
  if (a.targets.size() != b.targets.size()) return false;
  for (std::size_t k = 0; k < a.targets.size(); ++k) {
    if (a.targets[k].name != b.targets[k].name || a.targets[k].flange_p_m != b.targets[k].flange_p_m) return false;
  }
  return a.length_in_mm == b.length_in_mm && a.angle_in_deg == b.angle_in_deg;
}

TEST(RobotFile, WritingAndReadingGivesTheSameBits) {
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    Random random(seed);
    const std::string text = random_file(random);
    const Robot robot = parse_robot(text, "robot.toml");
    const std::string written = write_robot(robot);
    const Robot again = parse_robot(written, "robot.toml");
    ASSERT_TRUE(same_bits(robot, again)) << "seed " << seed << "\n" << text << "\n" << written;
    ASSERT_EQ(written, write_robot(again)) << "seed " << seed;
  }
}

// toml++ is undefined on these (offline/robot/toml_text.hpp).
// What stands beside the geometry of a corrected robot: read, written and read again to the same bits, in either unit.
TEST(RobotFile, JointFunctionsSagAndPayloadKeepTheirBits) {
  for (const bool in_deg : {true, false}) {
    Robot robot = parse_robot(one_link + one_link + "[gravity]\nxyz = [0, 0.6, -0.8]\n[payload]\nmass_kg = 2.5\ncom = [1.0, 2.0, 30.1]\n", "robot.toml");
    EXPECT_EQ(robot.gravity_direction, (Vector3{0, 0.6, -0.8}));
    EXPECT_EQ(robot.transmission.gravity.payload_kg, 2.5);
    robot.angle_in_deg = in_deg;
    std::mt19937_64 engine(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int joint = 0; joint < 2; ++joint) {
      JointFunction& f = robot.transmission.function[joint];
      f.seen_min_rad = -2.5;
      f.seen_max_rad = 1.25;
      f.order_count = joint == 0 ? 40 : 1;
      for (int k = 0; k < f.order_count; ++k) {
        f.cosine_rad[k] = static_cast<float>(3e-5 * uniform(engine));
        f.sine_rad[k] = static_cast<float>(3e-5 * uniform(engine));
      }
    }
    Gravity& gravity = robot.transmission.gravity;
    for (int k = 0; k < 3; ++k) gravity.direction[k] = robot.gravity_direction[static_cast<std::size_t>(k)];
    gravity.compliance[0][1] = 1e-3 / 3;
    gravity.payload_compliance[1] = 1e-5 / 3;
    const Robot once = parse_robot(write_robot(robot), "robot.toml");
    const Robot twice = parse_robot(write_robot(once), "robot.toml");
    EXPECT_EQ(std::memcmp(&once.transmission, &twice.transmission, sizeof once.transmission), 0);
    for (int joint = 0; joint < 2; ++joint) {
      const JointFunction& was = robot.transmission.function[joint];
      const JointFunction& is = once.transmission.function[joint];
      EXPECT_EQ(std::memcmp(was.cosine_rad, is.cosine_rad, sizeof was.cosine_rad), 0);
      EXPECT_EQ(std::memcmp(was.sine_rad, is.sine_rad, sizeof was.sine_rad), 0);
    }
    EXPECT_EQ(std::memcmp(&robot.transmission.gravity, &once.transmission.gravity, sizeof gravity), 0);
  }
}

TEST(RobotFile, WrongJointFunctionsSagAndGravityAreRefusedByName) {
  const std::string two = one_link + one_link;
  EXPECT_NE(message_of(two + "[gravity]\nxyz = [0, 0, 0]\n").find("a direction of gravity of length zero"), std::string::npos);
  EXPECT_NE(message_of(two + "[payload]\nmass_kg = -1\n").find("expected a mass that is not negative"), std::string::npos);
  EXPECT_NE(message_of(two + "[[sag]]\njoint = 2\nlink = 1\ncompliance_rad_per_m = 0.001\n").find("expected link >= joint"), std::string::npos);
  EXPECT_NE(message_of(two + "[[sag]]\njoint = 1\nlink = 1\n").find("needs either"), std::string::npos);
  EXPECT_NE(message_of(two + "[[joint_function]]\njoint = 1\nrange = [10.0, 5.0]\ncosine = []\nsine = []\n").find("do not rise"), std::string::npos);
  EXPECT_NE(message_of(two + "[[joint_function]]\njoint = 1\nrange = [0.0, 50.0]\ncosine = [0.1]\nsine = []\n").find("not as many sines"), std::string::npos);
  EXPECT_NE(message_of(two + "[[joint_function]]\njoint = 1\nrange = [0.0, 50.0]\ncosine = [5.0]\nsine = [0.0]\n").find("beyond what a controller accepts"),
            std::string::npos);
}

TEST(RobotFile, CharactersOutsideAsciiBelongInQuotesAndComments) {
  const std::string link = "[[link]]\nalpha = 0\na = 0\nd = 1\ntheta = 0\n";
  for (const std::string good : {"# Ï ﻀ\n", "name = \"Ï \\\" Ï\"\n", "name = 'Ï'\n", "name = \"\"\"Ï\"Ï\"\"\"\" # Ï\n",
                                 "name = '''Ï'Ï'''\n", "\xEF\xBB\xBF"}) {
    EXPECT_NO_THROW(parse_robot(good + link, "r.toml")) << good;
  }
  for (const std::string bad : {"Ï", "Ï = 1", "name = Ï", "name = \"a\" Ï", "\xC2\xA0name = 'a'", "あ"}) {
    EXPECT_THROW(parse_robot(link + bad + "\n", "r.toml"), InputError) << bad;
  }
  try {
    parse_robot("name = 'a'\n  Ï", "r.toml");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).rfind("r.toml:2:3: ", 0), 0U) << error.what();
  }
}

// toml++ assumes that these do not occur.
TEST(RobotFile, MalformedBracketsAreRefusedWithTheirLine) {
  const std::string link = "[[link]]\nalpha = 0\na = 0\nd = 1\ntheta = 0\n";
  for (const std::string bad : {"[*[l", "[[=]]", "[.a]", "[ +1]", "[[ [a]]]", "[#", "[\n+= ", "[{a=1}]", "x = [[+1],}, 2]"}) {
    try {
      parse_robot(link + bad + "\n", "r.toml");
      ADD_FAILURE() << bad;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).rfind("r.toml:6:", 0), 0U) << error.what();
    }
  }
}

TEST(RobotFile, KeepsRoundNumbersRound) {
  const std::string written = write_robot(parse_robot("[[link]]\nalpha = 90\na = 425.0\nd = 89.159\ntheta = 30\n", "r.toml"));
  for (const char* line : {"alpha = 90.0\n", "a = 425.0\n", "d = 89.159\n", "theta = 30.0\n", "rxryrz = [0.0, 0.0, 0.0]\n"}) {
    EXPECT_NE(written.find(line), std::string::npos) << written;
  }
}

}  // namespace
