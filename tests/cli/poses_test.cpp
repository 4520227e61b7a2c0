// SPDX-License-Identifier: MIT
// Full poses, conventions of rotations and other programs' robot files, end to end with the built program.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include <nlohmann/json.hpp>

#include "tests/cli/cli.hpp"
#include "tests/support/shared_data.hpp"

namespace {

using namespace mdhcal::tests;

// The header and every row whose number `wanted` takes.
template <class Wanted>
std::string rows_of(const std::string& text, Wanted&& wanted) {
  std::istringstream in(text);
  std::string line, out;
  for (int row = -1; std::getline(in, line); ++row) {
    if (row < 0 || wanted(row)) out += line + '\n';
  }
  return out;
}

nlohmann::json calibrated(const std::vector<std::string>& arguments) {
  std::vector<std::string> all{"calibrate"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  all.insert(all.end(), {"--json", "--quiet"});
  const Outcome run = run_mdhcal(all);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return run.exit_code == 0 ? nlohmann::json::parse(run.out) : nlohmann::json();
}

// A UR10 with a 6-D probe that is turned by about 90 degrees about z: as full poses it is as good as from its positions, and
// the rotations of the held-out rows have their figures.
MDHCAL_SHARED_DATA_TEST(PosesCommand, AProbeTurnedByAQuarterIsCalibratedWith) {
  const TemporaryFolder folder;
  const std::string all = read_bytes(shared_data("ur10_b/poses.csv"));
  write_bytes(folder / "train.csv", rows_of(all, [](int row) { return row % 8 == 3; }));
  write_bytes(folder / "test.csv", rows_of(all, [](int row) { return row % 8 == 6; }));
  const std::vector<std::string> arguments{shared_data("ur10_b/robot.toml"), folder / "train.csv", "--test", folder / "test.csv", "-o"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), arguments.begin(), arguments.end());
    return calibrated(more);
  };
  const nlohmann::json poses = with({folder / "poses"});
  const nlohmann::json positions = with({folder / "positions", "--rotation", "none"});
  ASSERT_FALSE(poses.is_null() || positions.is_null());
  const auto mean = [](const nlohmann::json& result) { return result["test"]["after"]["mean_mm"].get<double>(); };
  EXPECT_LT(mean(poses), 1.05 * mean(positions));
  EXPECT_EQ(poses["test"]["after"]["rotation_count"], poses["test"]["after"]["count"]);
  EXPECT_LT(poses["test"]["after"]["rotation_mean_deg"], 0.1);
  EXPECT_LT(poses["test"]["after"]["rotation_mean_deg"], 0.9 * poses["test"]["before"]["rotation_mean_deg"].get<double>());
  EXPECT_FALSE(positions["test"]["after"].contains("rotation_mean_deg"));
  const auto turn = poses["targets"][0]["rotation_vector_deg"].get<std::vector<double>>();
  EXPECT_NEAR(std::hypot(turn[0], turn[1], turn[2]), 90, 3);
  EXPECT_NEAR(std::fabs(turn[2]), 90, 3);
  const std::string residuals = read_bytes(folder / "poses/residuals.csv");
  EXPECT_NE(residuals.substr(0, residuals.find('\n')).find(",rotation_after_z_mrad"), std::string::npos);
  EXPECT_NE(read_bytes(folder / "poses/corrected.toml").find("[tool]\nxyz = ["), std::string::npos);
  // The corrected robot's own tool is held. On the rows that corrected it nothing gets better, hence the reason.
  const Outcome again = run_mdhcal({"calibrate", folder / "poses/corrected.toml", folder / "train.csv", "--tool", "given", "--accept",
                                    "corrected on these rows", "-o", folder / "again"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  // The same rows with the quaternion's columns named in the wrong order: refused with a report of the positions alone.
  std::string wrong = read_bytes(folder / "train.csv");
  wrong.replace(wrong.find("qw,qx,qy,qz"), 11, "qx,qy,qz,qw");
  write_bytes(folder / "wrong.csv", wrong);
  const Outcome refused = run_mdhcal({"calibrate", shared_data("ur10_b/robot.toml"), folder / "wrong.csv", "-o", folder / "wrong"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.err.find("They fit as qw, qx, qy, qz (--rotation quaternion)"), std::string::npos) << refused.err;
  EXPECT_EQ(names_in(folder / "wrong"), (std::vector<std::string>{"report.html", "residuals.csv", "result.json"}));
  const nlohmann::json result = nlohmann::json::parse(read_bytes(folder / "wrong/result.json"));
  EXPECT_FALSE(result["usable"]);
  EXPECT_EQ(result["reasons"].size(), 1U) << result["reasons"];
}

const char* const two_joints = "[[link]]\nalpha = 0\na = 0\nd = 300\ntheta = 0\n[[link]]\nalpha = -90\na = 100\nd = 0\ntheta = 0\n";

TEST(PosesCommand, RotationsAreAskedAboutAndNamed) {
  const TemporaryFolder folder;
  write_bytes(folder / "r.toml", two_joints);
  write_bytes(folder / "m.csv", "q1,q2,x,y,z,a,b,c\n1,2,3,4,5,6,7,8\n");
  const Outcome asked = run_mdhcal({"calibrate", folder / "r.toml", folder / "m.csv", "-o", folder / "o"});
  EXPECT_EQ(asked.exit_code, 2);
  EXPECT_NE(asked.err.find("m.csv:1:13: Column \"a\": found a, b, c, which look like a rotation; expected --rotation"), std::string::npos)
      << asked.err;
  const Outcome unknown = run_mdhcal({"calibrate", folder / "r.toml", folder / "m.csv", "--rotation", "kukka", "-o", folder / "o"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("expected one of rpy, kuka"), std::string::npos) << unknown.err;
  // Poses that `inverse` reads, in a controller's angles.
  ASSERT_EQ(run_mdhcal({"pack", folder / "r.toml", "-o", folder / "r.blob"}).exit_code, 0);
  write_bytes(folder / "joints.csv", "id,q1,q2\n1,30,40\n");
  const Outcome pose = run_mdhcal({"forward", folder / "r.blob", folder / "joints.csv"});
  ASSERT_EQ(pose.exit_code, 0) << pose.err;
  const CsvTable table(pose.out);
  // Rz(30) Rx(-90) Rz(40) written out as A, B, C: sine and cosine of 30 and 40 degrees.
  const double s1 = 0.5, c1 = std::sqrt(0.75), s2 = std::sin(40 * 3.14159265358979324 / 180), c2 = std::sqrt(1 - s2 * s2);
  const double deg = 180 / 3.14159265358979324;
  const double a = std::atan2(s1 * c2, c1 * c2), b = std::atan2(s2, c2), c = -90 / deg;
  std::ostringstream text;
  text.precision(17);
  text << "id,x,y,z,a,b,c,s1,s2\n1," << table.number(0, "x_mm") << ',' << table.number(0, "y_mm") << ',' << table.number(0, "z_mm")
       << ',' << a * deg << ',' << b * deg << ',' << c * deg << ",25,35\n";
  write_bytes(folder / "poses.csv", text.str());
  const Outcome answer = run_mdhcal({"inverse", folder / "r.blob", folder / "poses.csv", "--rotation", "kuka"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const CsvTable solved(answer.out);
  EXPECT_NEAR(solved.number(0, "q1_deg"), 30, 1e-6) << answer.out << text.str();
  EXPECT_NEAR(solved.number(0, "q2_deg"), 40, 1e-6) << answer.out;
}

// Two URDFs that differ by the rounding of one angle: `forward` prints the same place for both, and what is not the root link's
// frame is said to be another one.
TEST(PosesCommand, AUrdfsBaseFrameDoesNotMoveInSilence) {
  const auto urdf = [](const std::string& roll) {
    return "<robot name=\"g\"><link name=\"root\"/><link name=\"l1\"/><link name=\"l2\"/><link name=\"tip\"/>"
           "<joint name=\"turn\" type=\"continuous\"><origin xyz=\"0 0 0.21\" rpy=\"" + roll + " 0 0\"/><parent link=\"root\"/><child link=\"l1\"/>"
           "<axis xyz=\"0 0 1\"/></joint><joint name=\"tilt\" type=\"revolute\"><origin xyz=\"0 0.004 -0.12\" rpy=\"1.5708 0 0\"/>"
           "<parent link=\"l1\"/><child link=\"l2\"/><axis xyz=\"0 0 1\"/><limit lower=\"0\" upper=\"0\" effort=\"0\" velocity=\"0\"/></joint>"
           "<joint name=\"end\" type=\"fixed\"><origin xyz=\"0 -0.37 0\"/><parent link=\"l2\"/><child link=\"tip\"/></joint></robot>";
  };
  const TemporaryFolder folder;
  write_bytes(folder / "j.csv", "id,turn_deg,tilt_deg\n1,0,0\n");
  double z[2] = {0, 0};
  for (int k = 0; k < 2; ++k) {
    write_bytes(folder / "a.urdf", urdf(k == 0 ? "3.141592653589793" : "3.1416"));
    const Outcome convert = run_mdhcal({"convert", folder / "a.urdf", "-o", folder / "a.toml"});
    ASSERT_EQ(convert.exit_code, 0) << convert.err;
    EXPECT_NE(convert.err.find("joint \"tilt\" has the limits 0.0 and 0.0"), std::string::npos) << convert.err;
    EXPECT_EQ(convert.err.find("the URDF's root link") != std::string::npos, k == 1) << convert.err;
    ASSERT_EQ(run_mdhcal({"pack", folder / "a.toml", "-o", folder / "a.blob"}).exit_code, 0);
    write_bytes(folder / "q.csv", "id,q1,q2\n1,0,0\n");
    const Outcome forward = run_mdhcal({"forward", folder / "a.blob", folder / "q.csv"});
    ASSERT_EQ(forward.exit_code, 0) << forward.err;
    z[k] = CsvTable(forward.out).number(0, "z_mm");
    EXPECT_NE(read_bytes(folder / "a.toml").find("joint_name = \"tilt\""), std::string::npos);
  }
  // 210 + 120 + 370 mm above the root link, by hand.
  EXPECT_NEAR(z[0], 700, 0.01);
  EXPECT_NEAR(z[1], 700, 0.01);
}

}  // namespace
