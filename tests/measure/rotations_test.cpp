// SPDX-License-Identifier: MIT
// Conventions of rotations against products of elementary rotation matrices that are written out here.
#include <gtest/gtest.h>

#include <cmath>

#include "offline/base/error.hpp"
#include "offline/measure/dataset.hpp"
#include "offline/measure/joint_file.hpp"
#include "offline/measure/rotations.hpp"
#include "offline/base/random.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;

constexpr double degree_rad = 3.14159265358979323846 / 180.0;
using Matrix = std::array<std::array<double, 3>, 3>;

Matrix times(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  }
  return c;
}

Matrix rot_x(double t) { return {{{1, 0, 0}, {0, std::cos(t), -std::sin(t)}, {0, std::sin(t), std::cos(t)}}}; }
Matrix rot_y(double t) { return {{{std::cos(t), 0, std::sin(t)}, {0, 1, 0}, {-std::sin(t), 0, std::cos(t)}}}; }
Matrix rot_z(double t) { return {{{std::cos(t), -std::sin(t), 0}, {std::sin(t), std::cos(t), 0}, {0, 0, 1}}}; }
Matrix about(char axis, double t) { return axis == 'x' ? rot_x(t) : axis == 'y' ? rot_y(t) : rot_z(t); }

Matrix transposed(const Matrix& a) {
  Matrix c{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) c[i][j] = a[j][i];
  }
  return c;
}

Matrix matrix_of(const std::array<double, 4>& q) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  return {{{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
           {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
           {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}}};
}

void expect_near(const Matrix& a, const Matrix& b, double tolerance, const std::string& what) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) ASSERT_NEAR(a[i][j], b[i][j], tolerance) << what << ' ' << i << j;
  }
}

std::array<double, 4> random_quaternion(Random& random) {
  std::array<double, 4> q{};
  double norm = 0;
  for (double& c : q) {
    c = random.normal();
    norm += c * c;
  }
  for (double& c : q) c /= std::copysign(std::sqrt(norm), q[0]);
  return q;
}

// Every order, intrinsic and extrinsic, is the product that its letters say.
TEST(Rotations, OrdersAreProductsOfElementaryRotations) {
  Random random(1);
  for (const std::string& name : rotation_names()) {
    const bool extrinsic = name.ends_with("-extrinsic");
    const std::string order = name.substr(0, name.find('-'));
    if (order.size() != 3 || order.find_first_not_of("xyz") != std::string::npos) continue;
    for (int k = 0; k < 50; ++k) {
      const std::array<double, 4> n{random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-4, 4), 0};
      Matrix product = about(order[0], n[0]);
      for (std::size_t i = 1; i < 3; ++i) {
        const Matrix each = about(order[i], n[i]);
        product = extrinsic ? times(each, product) : times(product, each);
      }
      expect_near(matrix_of(quaternion_from(*rotation_convention(name), n)), product, 1e-14, name);
      expect_near(matrix_of(quaternion_from(*rotation_convention(name + "-inverse"), n)), transposed(product), 1e-14, name);
    }
  }
}

// What the controllers' manuals say, products written out, angles in the order of their columns.
TEST(Rotations, ControllersWordsMeanWhatTheirManualsSay) {
  const double a = 0.3, b = -0.7, c = 1.9;
  const std::array<double, 4> n{a, b, c, 0};
  const auto of = [&](const char* name) { return matrix_of(quaternion_from(*rotation_convention(name), n)); };
  expect_near(of("kuka"), times(times(rot_z(a), rot_y(b)), rot_x(c)), 1e-14, "kuka A B C");
  expect_near(of("fanuc"), times(times(rot_z(c), rot_y(b)), rot_x(a)), 1e-14, "fanuc W P R");
  expect_near(of("staubli"), times(times(rot_x(a), rot_y(b)), rot_z(c)), 1e-14, "staubli rx ry rz");
  expect_near(of("abb"), times(times(rot_z(a), rot_y(b)), rot_x(c)), 1e-14, "abb EZ EY EX");
  expect_near(of("yaskawa"), times(times(rot_z(c), rot_y(b)), rot_x(a)), 1e-14, "yaskawa Rx Ry Rz");
  expect_near(of("rpy"), times(times(rot_z(c), rot_y(b)), rot_x(a)), 1e-14, "roll pitch yaw");
  expect_near(of("comau"), times(times(rot_z(a), rot_y(b)), rot_z(c)), 1e-14, "comau");
  expect_near(of("kawasaki"), times(times(rot_z(a), rot_y(b)), rot_z(c)), 1e-14, "kawasaki O A T");
  expect_near(of("mitsubishi"), times(times(rot_z(c), rot_y(b)), rot_x(a)), 1e-14, "mitsubishi A B C");
  expect_near(of("epson"), times(times(rot_z(a), rot_y(b)), rot_x(c)), 1e-14, "epson U V W");
  // Rodrigues: along the axis nothing moves, across it the turn is by the length.
  const double length = std::sqrt(a * a + b * b + c * c);
  const Matrix ur = of("ur");
  EXPECT_NEAR(ur[0][0] + ur[1][1] + ur[2][2], 1 + 2 * std::cos(length), 1e-14);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(ur[i][0] * a + ur[i][1] * b + ur[i][2] * c, n[i], 1e-14);
  EXPECT_GT((ur[1][0] - ur[0][1]) * c / std::sin(length), 0);
}

// There and back for every name: the numbers of a rotation are that rotation again.
TEST(Rotations, NumbersLeadBackToTheRotation) {
  Random random(2);
  std::vector<std::string> names = rotation_names();
  for (const std::string& name : rotation_names()) names.push_back(name + "-inverse");
  for (const std::string& name : names) {
    const RotationConvention convention = *rotation_convention(name);
    EXPECT_EQ(convention.name, name);
    for (int k = 0; k < 200; ++k) {
      std::array<double, 4> q = random_quaternion(random);
      // A third of them where angles of Euler are ill-defined: few and axis-parallel components.
      if (k % 3 == 0) {
        q = {std::sqrt(0.5), 0, 0, 0};
        q[1 + random.index(3)] = (random.index(2) == 0 ? 1 : -1) * std::sqrt(0.5);
        if (k % 2 == 0) {
          for (double& c : q) c += 1e-9 * random.normal();
        }
      }
      expect_near(matrix_of(quaternion_from(convention, numbers_of(convention, q))), matrix_of(q), k % 3 == 0 ? 1e-8 : 1e-13,
                  name + " case " + std::to_string(k));
    }
  }
}

TEST(Rotations, UnknownNamesAreRefusedWithTheList) {
  EXPECT_FALSE(rotation_convention("zzx"));
  EXPECT_FALSE(rotation_convention("xyz-inverse-inverse"));
  EXPECT_FALSE(rotation_convention(""));
  EXPECT_TRUE(rotation_convention("KUKA"));
  try {
    (void)require_rotation_convention("motoman", "--rotation");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("yaskawa"), std::string::npos) << error.what();
  }
}

Robot two_joint_arm() {
  Robot robot;
  robot.geometry.joint_count = 2;
  for (int i = 0; i < 2; ++i) robot.geometry.joint[i].sign = 1;
  robot.geometry.last_T_flange.quaternion[0] = 1;
  return robot;
}

// The quaternion that a row under `header` is read as.
std::array<double, 4> read(const std::string& header, const std::string& numbers, const std::string& rotation) {
  const Dataset data = parse_dataset(header + "\n" + numbers + "\n", "m.csv", two_joint_arm(), rotation);
  EXPECT_EQ(data.rows.at(0).kind, MeasurementKind::pose) << header;
  return data.rows.at(0).quaternion;
}

std::string refusal(const std::string& header, const std::string& numbers, const std::string& rotation) {
  try {
    (void)parse_dataset(header + "\n" + numbers + "\n", "m.csv", two_joint_arm(), rotation);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(RotationColumns, AreReadByTheNameOfTheirConvention) {
  const auto expect = [&](const std::string& columns, const std::string& numbers, const std::string& rotation,
                          const Matrix& truth) {
    expect_near(matrix_of(read("q1,q2,x,y,z," + columns, "0,0,1,2,3," + numbers, rotation)), truth, 1e-14,
                columns + " as " + rotation);
  };
  const Matrix zyx = times(times(rot_z(10 * degree_rad), rot_y(20 * degree_rad)), rot_x(30 * degree_rad));
  expect("a,b,c", "10,20,30", "kuka", zyx);
  expect("C,A,B", "30,10,20", "kuka", zyx);
  expect("w,p,r", "30,20,10", "fanuc", zyx);
  expect("roll,pitch,yaw", "30,20,10", "rpy", zyx);
  expect("rx,ry,rz", "30,20,10", "rpy", zyx);
  expect("rx_deg,ry_deg,rz_deg", "30,20,10", "zyx", zyx);  // by their axes, whatever the order
  expect("rx,ry,rz", "30,20,10", "abb", zyx);
  expect("ez,ey,ex", "10,20,30", "abb", zyx);
  expect("a,b,c", "30,20,10", "mitsubishi", zyx);
  expect("u,v,w", "10,20,30", "epson", zyx);
  expect("rx,ry,rz", "30,20,10", "staubli", times(times(rot_x(30 * degree_rad), rot_y(20 * degree_rad)), rot_z(10 * degree_rad)));
  expect("o,a,t", "10,20,30", "kawasaki", times(times(rot_z(10 * degree_rad), rot_y(20 * degree_rad)), rot_z(30 * degree_rad)));
  expect("rx,ry,rz", "10,20,30", "zyz", times(times(rot_z(10 * degree_rad), rot_y(20 * degree_rad)), rot_z(30 * degree_rad)));
  expect("rx,ry,rz", "0,0,0.5", "ur", rot_z(0.5));       // radians by name
  expect("rx,ry,rz", "0,0,30", "", rot_z(30 * degree_rad));     // the robot file's unit
  expect("rx_rad,ry_rad,rz_rad", "0,0,0.5", "", rot_z(0.5));
  expect("rx,ry,rz", "0,0,30", "vector-inverse", rot_z(-30 * degree_rad));
  const std::string half = "0.7071067811865476";
  const Matrix right = rot_z(90 * degree_rad);
  expect("qx,qy,qz,qw", "0,0," + half + "," + half, "", right);
  expect("qw,qx,qy,qz", half + ",0,0," + half, "", right);
  expect("qw,qx,qy,qz", "0,0," + half + "," + half, "quaternion-xyzw", right);  // wrongly labelled
  expect("qx,qy,qz,qw", half + ",0,0," + half, "quaternion", right);            // likewise
}

TEST(RotationColumns, AQuaternionInQ0ToQ3IsToldFromJoints) {
  const std::string half = "0.7071067811865476";
  for (const char* columns : {"j1,j2,x,y,z,q0,q1,q2,q3", "a1,a2,x,y,z,q0,q1,q2,q3"}) {
    const auto q = read(columns, "10,20,1,2,3," + half + ",0,0," + half, "quaternion");
    expect_near(matrix_of(q), rot_z(90 * degree_rad), 1e-14, columns);
    EXPECT_NE(refusal(columns, "10,20,1,2,3,1,0,0,0", "").find("--rotation"), std::string::npos);
  }
  // ABB's own names.
  const auto q = read("j1,j2,x,y,z,q1,q2,q3,q4", "10,20,1,2,3," + half + ",0,0," + half, "quaternion");
  expect_near(matrix_of(q), rot_z(90 * degree_rad), 1e-14, "q1 ... q4");
}

// What looks like a rotation is read or asked about, never ignored.
TEST(RotationColumns, AreNeverIgnoredInSilence) {
  for (const char* columns : {"a,b,c", "w,p,r", "Roll,Pitch,Yaw", "ez,ey,ex", "o,a,t", "a_deg,b_deg,c_deg"}) {
    const std::string message = refusal(std::string("q1,q2,x,y,z,") + columns, "0,0,1,2,3,1,2,3", "");
    EXPECT_NE(message.find("--rotation"), std::string::npos) << columns << ": " << message;
    const Dataset data = parse_dataset(std::string("q1,q2,x,y,z,") + columns + "\n0,0,1,2,3,1,2,3\n", "m.csv", two_joint_arm(), "none");
    EXPECT_EQ(data.rows[0].kind, MeasurementKind::position);
  }
  EXPECT_NE(refusal("q1,q2,x,y,z", "0,0,1,2,3", "kuka").find("a, b, c"), std::string::npos);
  EXPECT_NE(refusal("q1,q2,x,y,z,a,b,c,rx,ry,rz", "0,0,1,2,3,1,2,3,1,2,3", "kuka").find("another rotation"), std::string::npos);
  EXPECT_NE(refusal("q1,q2,x,y,z,a,b,c", "0,0,1,2,3,1,2,3", "motoman").find("--rotation names"), std::string::npos);
}

// The rows of a file read in another convention, as if the name had been given at first.
TEST(RotationColumns, RowsAreReadAgainInAnotherConvention) {
  Random random(3);
  for (const char* columns : {"rx,ry,rz", "a,b,c"}) {
    std::string text = std::string("q1,q2,x,y,z,") + columns + '\n';
    for (int row = 0; row < 20; ++row) {
      text += "1,2,3,4,5";
      for (int k = 0; k < 3; ++k) text += ',' + std::to_string(random.uniform(-180, 180));
      text += '\n';
    }
    const Dataset kuka = parse_dataset(text, "m.csv", two_joint_arm(), "kuka");
    for (const std::string& name : rotation_names()) {
      const RotationConvention convention = *rotation_convention(name);
      if (convention.form == RotationForm::quaternion || convention.radians) continue;
      const Dataset truth = parse_dataset(text, "m.csv", two_joint_arm(), name);
      const Dataset again = with_rotations_read_as(kuka, convention);
      for (std::size_t i = 0; i < truth.rows.size(); ++i) EXPECT_EQ(truth.rows[i].quaternion, again.rows[i].quaternion) << name;
    }
  }
}

TEST(JointColumns, NamesOfOtherSystemsAreReadByARule) {
  for (const char* names : {"A1,A2", "J1,J2", "joint_1,joint_2", "Joint1,Joint2", "axis_1,axis_2", "A1 [deg],A2 [deg]"}) {
    const Dataset data = parse_dataset(std::string(names) + ",X,Y,Z\n10,20,1,2,3\n", "m.csv", two_joint_arm());
    EXPECT_DOUBLE_EQ(data.rows.at(0).q[0], 10 * degree_rad) << names;
    EXPECT_DOUBLE_EQ(data.rows.at(0).q[1], 20 * degree_rad) << names;
  }
  // The names of the robot file, in any order of columns.
  Robot robot = two_joint_arm();
  robot.joint_name = {"shoulder_pan_joint", "Elbow"};
  const Dataset data = parse_dataset("elbow,x,shoulder_pan_joint_rad,y,z\n20,1,0.5,2,3\n", "m.csv", robot);
  EXPECT_DOUBLE_EQ(data.rows.at(0).q[0], 0.5);
  EXPECT_DOUBLE_EQ(data.rows.at(0).q[1], 20 * degree_rad);
  // A part of them, or none: the mapping is asked for.
  const auto message = [&](const std::string& header) {
    try {
      (void)parse_dataset(header + "\n1,2,3,4,5\n", "m.csv", robot);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_NE(message("elbow,base,x,y,z").find("shoulder_pan_joint"), std::string::npos);
  EXPECT_NE(message("first,second,x,y,z").find("joint_name"), std::string::npos);
}

}  // namespace
