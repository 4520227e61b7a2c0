// SPDX-License-Identifier: MIT
// Every arm of the catalogue against the joints of its public description, multiplied out here apart from the library.
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "mdhcal/kinematics.hpp"
#include "offline/base/error.hpp"
#include "offline/robots/catalogue.hpp"
#include "tests/support/program.hpp"
#include "tests/support/wide_frame.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using namespace mdhcal::tests;

struct DescribedJoint {
  std::string type;
  WideFrame parent_T_joint;
  std::array<long double, 3> xyz{}, rpy{}, axis{};
  bool has_limits = false;
  double min = 0, max = 0;
};

std::map<std::string, std::vector<DescribedJoint>> descriptions() {
  std::map<std::string, std::vector<DescribedJoint>> arms;
  std::ifstream file(MDHCAL_SOURCE_DIR "/tests/robots/descriptions.csv");
  bool header = true;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#')) continue;
    if (header) {
      header = false;
      continue;
    }
    std::vector<std::string> fields(1);
    for (const char c : line) {
      if (c == ',') {
        fields.emplace_back();
      } else {
        fields.back() += c;
      }
    }
    EXPECT_EQ(fields.size(), 14u) << line;
    if (fields.size() != 14) continue;
    DescribedJoint joint;
    joint.type = fields[2];
    for (std::size_t k = 0; k < 3; ++k) {
      joint.xyz[k] = std::stold(fields[3 + k]);
      joint.rpy[k] = std::stold(fields[6 + k]);
      joint.axis[k] = std::stold(fields[9 + k]);
    }
    joint.parent_T_joint = wide_translation(joint.xyz[0], joint.xyz[1], joint.xyz[2]) * wide_rot_z(joint.rpy[2]) *
                           wide_rot_y(joint.rpy[1]) * wide_rot_x(joint.rpy[0]);
    joint.has_limits = !fields[12].empty();
    if (joint.has_limits) {
      joint.min = std::stod(fields[12]);
      joint.max = std::stod(fields[13]);
    }
    arms[fields[0]].push_back(joint);
  }
  return arms;
}

// Rodrigues' formula: the turn by `angle` about a unit vector.
WideFrame turn_about(const std::array<long double, 3>& axis, long double angle) {
  const long double c = std::cos(angle), s = std::sin(angle);
  WideFrame t;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) t.m[i][j] = (i == j ? c : 0) + (1 - c) * axis[i] * axis[j];
  }
  t.m[0][1] -= s * axis[2];
  t.m[1][0] += s * axis[2];
  t.m[0][2] += s * axis[1];
  t.m[2][0] -= s * axis[1];
  t.m[1][2] -= s * axis[0];
  t.m[2][1] += s * axis[0];
  return t;
}

WideFrame described_forward(const std::vector<DescribedJoint>& chain, const std::vector<long double>& angles) {
  WideFrame t;
  std::size_t next = 0;
  for (const DescribedJoint& joint : chain) {
    t = t * joint.parent_T_joint;
    if (joint.type != "fixed") t = t * turn_about(joint.axis, angles[next++]);
  }
  return t;
}

// What a controller's readings are to the description's joints: FANUC counts joint 3 from the horizontal, so that the
// description's is J3 + J2; so does the IRB 2400, whose joint 2 counts the other way: J3 - J2.
long double coupled(const std::string& arm) { return arm.starts_with("fanuc") ? 1 : arm.starts_with("abb-irb2400") ? -1 : 0; }

TEST(Catalogue, IsTheForwardKinematicsOfTheDescriptions) {
  const auto arms = descriptions();
  ASSERT_EQ(arms.size(), embedded::robots().size());
  std::mt19937_64 generator(20);
  std::uniform_real_distribution<double> turn(-3.2, 3.2);
  for (const embedded::File& file : embedded::robots()) {
    const std::string name(file.name);
    const Robot robot = parse_robot(std::string(file.text), name);
    EXPECT_EQ(robot.name, name);
    ASSERT_EQ(arms.count(name), 1u) << name;
    const auto& chain = arms.at(name);
    const auto count = static_cast<std::size_t>(robot.geometry.joint_count);
    // Their descriptions state angles to five digits, 1.5708: 4e-6 rad off over half a metre.
    const double bound = name == "ufactory-lite6" || name == "kinova-gen3-7dof" ? 3e-6 : 1e-6;
    Arm<double> arm;
    ASSERT_EQ(make_arm(robot.geometry, arm), Status::ok);
    double worst = 0, worst_rotation = 0;
    for (int k = 0; k < 1000; ++k) {
      Joints q{};
      std::vector<long double> angles;
      for (std::size_t j = 0; j < count; ++j) {
        q[j] = turn(generator);
        angles.push_back(static_cast<long double>(q[j]));
      }
      if (count > 2) angles[2] += coupled(name) * static_cast<long double>(q[1]);
      const WideFrame truth = described_forward(chain, angles);
      Pose<double> pose{};
      ASSERT_EQ(forward(arm, q.data(), pose), Status::ok);
      worst = std::max(worst, position_difference(truth, pose));
      worst_rotation = std::max(worst_rotation, rotation_difference(truth, pose));
    }
    EXPECT_LE(worst, bound) << name;
    EXPECT_LE(worst_rotation, 1e-5) << name;
  }
}

TEST(Catalogue, HasTheDescriptionsLimits) {
  const auto arms = descriptions();
  for (const embedded::File& file : embedded::robots()) {
    const std::string name(file.name);
    const Robot robot = parse_robot(std::string(file.text), name);
    std::size_t j = 0;
    for (const DescribedJoint& joint : arms.at(name)) {
      if (joint.type == "fixed") continue;
      const Joint& ours = robot.geometry.joint[j];
      // A coupled joint's limits hold for the sum of two readings, which a robot file cannot state.
      const bool limited = joint.has_limits && !(j == 2 && std::abs(coupled(name)) > 0);
      EXPECT_EQ(ours.has_min != 0, limited) << name << " joint " << j + 1;
      EXPECT_EQ(ours.has_max != 0, limited) << name << " joint " << j + 1;
      if (limited) {
        // The files state hundredths of a degree.
        EXPECT_NEAR(ours.min, joint.min, 2e-4) << name << " joint " << j + 1;
        EXPECT_NEAR(ours.max, joint.max, 2e-4) << name << " joint " << j + 1;
      }
      ++j;
    }
    EXPECT_EQ(j, static_cast<std::size_t>(robot.geometry.joint_count)) << name;
  }
}

TEST(Catalogue, SaysWhereEachArmComesFromAndWhatIsNotConfirmed) {
  std::size_t confirmed = 0;
  for (const CatalogueEntry& arm : catalogue()) {
    EXPECT_FALSE(arm.maker.empty()) << arm.name;
    EXPECT_GE(arm.sources, 1u) << arm.name;
    const std::string text(find_in_catalogue(arm.name)->text);
    if (arm.sources < 2) {
      EXPECT_NE(text.find("# not confirmed: "), std::string::npos) << arm.name;
    }
    if (arm.sources > 1) ++confirmed;
    // From a table-top arm to a large one, and no arm reaches further than its lengths added up.
    EXPECT_GT(arm.reach_m, 0.2) << arm.name;
    const Robot robot = parse_robot(text, arm.name);
    double length = std::hypot(robot.geometry.link[0].a_m, 0.0);
    for (std::int32_t j = 1; j < robot.geometry.joint_count; ++j) {
      length += std::hypot(robot.geometry.link[j].a_m, robot.geometry.link[j].d_m);
    }
    const double* flange = robot.geometry.last_T_flange.position_m;
    EXPECT_LE(arm.reach_m, length + std::hypot(flange[0], flange[1], flange[2]) + 1e-9) << arm.name;
  }
  EXPECT_GE(confirmed, 55u);
}

TEST(Catalogue, FindsAnArmByItsNameAndByWordsThatOnlyItHas) {
  const auto name = [](const char* asked) {
    const embedded::File* file = find_in_catalogue(asked);
    return file == nullptr ? std::string("none") : std::string(file->name);
  };
  EXPECT_EQ(name("ur5e"), "ur5e");
  EXPECT_EQ(name("UR5e"), "ur5e");
  EXPECT_EQ(name("ur5"), "ur5");
  EXPECT_EQ(name("kuka-kr210-r2700-2"), "kuka-kr210-r2700-2");
  EXPECT_EQ(name("kr210-r2700"), "kuka-kr210-r2700-2");
  EXPECT_EQ(name("KR210 R2700"), "kuka-kr210-r2700-2");
  EXPECT_EQ(name("iiwa14"), "kuka-lbr-iiwa14-r820");
  EXPECT_EQ(name("lrmate200id"), "fanuc-lrmate200id");  // not the 7L, whose name only begins so
  EXPECT_EQ(name("panda"), "franka-panda-fer");
  EXPECT_EQ(name("ur"), "none");
  EXPECT_EQ(name("r27"), "none");
  EXPECT_EQ(name(""), "none");
  try {
    (void)find_in_catalogue("kr6");
    ADD_FAILURE() << "kr6 means several";
  } catch (const InputError& error) {
    const std::string message = error.what();
    for (const char* each : {"kuka-kr6-r700-sixx", "kuka-kr6-r900-2", "kuka-kr6-r900-sixx"}) {
      EXPECT_NE(message.find(each), std::string::npos) << message;
    }
  }
}

TEST(Catalogue, EveryNameCanBeTypedWithoutTheMaker) {
  std::set<std::string> names;
  for (const embedded::File& file : embedded::robots()) {
    const std::string name(file.name);
    const std::string rest = name.substr(name.find('-') + 1);
    EXPECT_TRUE(names.insert(name).second);
    const embedded::File* found = find_in_catalogue(rest);
    ASSERT_NE(found, nullptr) << rest;
    EXPECT_EQ(found->name, file.name);
  }
}

TEST(RobotsCommand, ListsPrintsAndIsTakenForARobot) {
  const auto list = run_mdhcal({"robots"});
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_NE(list.out.find("ur5e "), std::string::npos);
  EXPECT_EQ(static_cast<std::size_t>(std::count(list.out.begin(), list.out.end(), '\n')), embedded::robots().size() + 1);
  const auto file = run_mdhcal({"robots", "ur5e"});
  EXPECT_EQ(file.exit_code, 0);
  EXPECT_EQ(file.out, read_bytes(MDHCAL_SOURCE_DIR "/offline/robots/ur5e.toml"));

  const TemporaryFolder folder;
  const auto pack = run_mdhcal({"pack", "UR5e", "-o", folder / "ur5e.blob"});
  EXPECT_EQ(pack.exit_code, 0) << pack.err;
  EXPECT_NE(pack.err.find("ur5e from the catalogue"), std::string::npos) << pack.err;
  write_bytes(folder / "my.toml", file.out);
  EXPECT_EQ(run_mdhcal({"pack", folder / "my.toml", "-o", folder / "my.blob"}).exit_code, 0);
  EXPECT_EQ(read_bytes(folder / "my.blob"), read_bytes(folder / "ur5e.blob"));
}

TEST(RobotsCommand, SaysWhichRobotsAreNear) {
  const auto near = run_mdhcal({"robots", "ur5x"});
  EXPECT_EQ(near.exit_code, 2);
  EXPECT_NE(near.err.find("ur5"), std::string::npos) << near.err;
  const TemporaryFolder folder;
  const auto pack = run_mdhcal({"pack", "kr211", "-o", folder / "x.blob"});
  EXPECT_EQ(pack.exit_code, 2);
  EXPECT_NE(pack.err.find("mdhcal robots"), std::string::npos) << pack.err;
  EXPECT_TRUE(names_in(folder.path()).empty());
}

TEST(RobotsCommand, AFileOfThatNameWins) {
  const TemporaryFolder folder;
  write_bytes(folder / "ur5e", read_bytes(MDHCAL_SOURCE_DIR "/offline/robots/denso-vs060.toml"));
  RunOptions options;
  options.folder = folder.path();
  const auto pack = run_mdhcal({"pack", "ur5e", "-o", "x.blob"}, options);
  EXPECT_EQ(pack.exit_code, 0) << pack.err;
  EXPECT_NE(pack.err.find("from the file"), std::string::npos) << pack.err;
  EXPECT_NE(run_mdhcal({"show", "x.blob"}, options).out.find("denso-vs060"), std::string::npos);
}

}  // namespace
