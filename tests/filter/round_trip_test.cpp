// SPDX-License-Identifier: MIT
// A simulated controller reads the filtered program, solves it on the nominal arm and moves the arm as it is: it gets to the poses that the
// program meant. Over random arms and programs; poses are read and written here by formulas of their own.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "mdhcal/kinematics.hpp"
#include "offline/filter/filter.hpp"
#include "tests/lib/arms.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using test::deg;
using test::Random;

using Transform = Eigen::Isometry3d;

// Six turning joints with a spherical wrist, or with three parallel axes, of random lengths; the corrected arm is off by up to a millimetre
// and 0.2 degrees in each parameter.
BlobContent random_arm(Random& random, bool spherical) {
  const double a = random.uniform(0.0, 0.2), b = random.uniform(0.4, 0.7), c = random.uniform(0.05, 0.15), d = random.uniform(0.4, 0.7);
  BlobContent blob{};
  blob.geometry = spherical ? test::from_table({{0, 0, 0, 0.4}, {-90, a, -90, 0}, {0, b, 0, 0}, {-90, c, 0, d}, {90, 0, 0, 0}, {-90, 0, 0, 0.1}})
                            : test::from_table({{0, 0, 0, 0.1}, {90, 0, 0, 0.11}, {0, b, 0, 0}, {0, d, 0, 0}, {-90, 0, 0, 0.095}, {90, 0, 0, 0.085}});
  for (std::size_t i = 0; i < 6; ++i) {
    blob.nominal[i] = blob.geometry.link[i];
    Link& link = blob.geometry.link[i];
    link.alpha_rad += random.symmetric(0.2 * deg);
    link.theta_rad += random.symmetric(0.2 * deg);
    link.a_m += random.symmetric(1e-3);
    link.d_m += random.symmetric(1e-3);
  }
  return blob;
}

Transform transform_of(const Pose<double>& p) {
  Transform t = Transform::Identity();
  t.linear() = Eigen::Quaterniond(p.quaternion[0], p.quaternion[1], p.quaternion[2], p.quaternion[3]).toRotationMatrix();
  t.translation() = Eigen::Vector3d(p.position_m[0], p.position_m[1], p.position_m[2]);
  return t;
}

Pose<double> pose_from(const Transform& t) {
  Eigen::Quaterniond q(t.linear());
  if (q.w() < 0) q.coeffs() *= -1;
  return {{q.w(), q.x(), q.y(), q.z()}, {t.translation().x(), t.translation().y(), t.translation().z()}};
}

Transform turned(double x, double y, double z, const Eigen::Matrix3d& rotation) {
  Transform t = Transform::Identity();
  t.linear() = rotation;
  t.translation() = Eigen::Vector3d(x, y, z) / 1e3;
  return t;
}

Eigen::Matrix3d about(int axis, double angle_deg) { return Eigen::AngleAxisd(angle_deg * deg, Eigen::Vector3d::Unit(axis)).toRotationMatrix(); }
Eigen::Matrix3d kuka(double a, double b, double c) { return about(2, a) * about(1, b) * about(0, c); }

// The pose of six numbers as the languages state it, and the numbers of a pose.
struct Language {
  const char* name;
  Transform (*read)(const double* n);
  void (*write)(const Transform& t, double* n);
};

void lengths(const Transform& t, double* n, double unit) {
  for (int k = 0; k < 3; ++k) n[k] = t.translation()[k] / unit;
}

const Language krl{"krl", [](const double* n) { return turned(n[0], n[1], n[2], kuka(n[3], n[4], n[5])); },
                   [](const Transform& t, double* n) {
                     lengths(t, n, 1e-3);
                     const Eigen::Matrix3d r = t.linear();
                     n[3] = std::atan2(r(1, 0), r(0, 0)) / deg;
                     n[4] = std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0))) / deg;
                     n[5] = std::atan2(r(2, 1), r(2, 2)) / deg;
                   }};
const Language val3{"val3", [](const double* n) { return turned(n[0], n[1], n[2], about(0, n[3]) * about(1, n[4]) * about(2, n[5])); },
                    [](const Transform& t, double* n) {
                      lengths(t, n, 1e-3);
                      const Eigen::Matrix3d r = t.linear();
                      n[3] = std::atan2(-r(1, 2), r(2, 2)) / deg;
                      n[4] = std::atan2(r(0, 2), std::hypot(r(0, 0), r(0, 1))) / deg;
                      n[5] = std::atan2(-r(0, 1), r(0, 0)) / deg;
                    }};
const Language ur{"ur",
                  [](const double* n) {
                    const Eigen::Vector3d w(n[3], n[4], n[5]);
                    const Eigen::Matrix3d r = w.norm() > 0 ? Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix() : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
                    return turned(1e3 * n[0], 1e3 * n[1], 1e3 * n[2], r);
                  },
                  [](const Transform& t, double* n) {
                    lengths(t, n, 1);
                    const Eigen::AngleAxisd w(t.linear());
                    for (int k = 0; k < 3; ++k) n[3 + k] = w.angle() * w.axis()[k];
                  }};

std::string six(const char* format, const double* n) {
  char buffer[400];
  std::snprintf(buffer, sizeof buffer, format, n[0], n[1], n[2], n[3], n[4], n[5]);
  return buffer;
}

struct Program {
  std::string text;
  std::vector<Transform> meant;  // of the tool in the frame
  std::vector<Joints> q;         // the nominal joints
  Transform frame, tool;
};

constexpr double tool_numbers[6] = {42.5, -3.2, 185.4, 10, 25, -5};
constexpr double frame_numbers[6] = {150, -120, 95, 30, 5, -3};

Program random_program(Random& random, const Language& language, const Arm<double>& nominal, std::size_t count) {
  Program out;
  const bool is_ur = language.name == ur.name;
  double tool[6], frame[6];
  krl.write(krl.read(tool_numbers), tool);
  out.tool = krl.read(tool_numbers);
  out.frame = is_ur ? Transform::Identity() : krl.read(frame_numbers);
  language.write(out.tool, tool);
  language.write(out.frame, frame);
  std::string& text = out.text;
  if (language.name == krl.name) text = "DEFDAT T\nDECL FDAT FALL={TOOL_NO 1,BASE_NO 1}\n";
  if (is_ur) text = six("def t():\n  set_tcp(p[%.9f,%.9f,%.9f,%.9f,%.9f,%.9f])\n", tool);
  if (language.name == val3.name) {
    text = six("<Database><Data name=\"f\" type=\"frame\"><Value key=\"0\" x=\"%.9f\" y=\"%.9f\" z=\"%.9f\" rx=\"%.9f\" ry=\"%.9f\" rz=\"%.9f\" fatherId=\"world[0]\"/></Data>", frame) +
           six("<Data name=\"t\" type=\"tool\"><Value key=\"0\" x=\"%.9f\" y=\"%.9f\" z=\"%.9f\" rx=\"%.9f\" ry=\"%.9f\" rz=\"%.9f\" fatherId=\"flange[0]\"/></Data>\n", tool) +
           "<Data name=\"p\" type=\"pointRx\">\n";
  }
  while (out.q.size() < count) {
    Joints q{random.symmetric(60 * deg), random.uniform(-20, 40) * deg, random.uniform(-30, 30) * deg, random.symmetric(90 * deg), random.uniform(20, 100) * deg, random.symmetric(90 * deg)};
    // Away from a straight elbow, a wrist in one line and the wrist above the base.
    if (is_ur) q = {random.symmetric(60 * deg), random.uniform(-100, -60) * deg, random.uniform(60, 110) * deg, random.uniform(-120, -60) * deg, random.uniform(-110, -60) * deg, random.symmetric(90 * deg)};
    if (!is_ur && random.uniform(0, 1) < 0.3) q[4] = -q[4];
    Pose<double> flange{};
    EXPECT_EQ(forward(nominal, q.data(), flange), Status::ok);
    double n[6];
    language.write(out.frame.inverse() * transform_of(flange) * out.tool, n);
    if (language.name == krl.name) {
      int t = 0;
      for (std::size_t j = 0; j < 6; ++j) t |= q[j] < 0 ? 1 << j : 0;
      text += "DECL E6POS XP" + std::to_string(out.q.size()) + six("={X %.6f,Y %.6f,Z %.6f,A %.7f,B %.7f,C %.7f", n) + ",S " + (q[4] < 0 ? "6" : "2") + ",T " + std::to_string(t) + ",E1 0.0}\r\n";
    } else if (is_ur) {
      text += six("  movej(get_inverse_kin(p[%.9f, %.9f, %.9f, %.9f, %.9f, %.9f], ", n) + six("qnear=[%.5f,%.5f,%.5f,%.5f,%.5f,%.5f]))\n", q.data());
    } else {
      text += "<Value key=\"" + std::to_string(out.q.size()) + six("\"  x=\"%.6f\" y=\"%.6f\" z=\"%.6f\" rx=\"%.7f\" ry=\"%.7f\" rz=\"%.7f\"", n) +
              " shoulder=\"righty\" elbow=\"epositive\" wrist=\"" + (q[4] < 0 ? "wnegative" : "wpositive") + "\" fatherId=\"f[0]\"/>\n";
    }
    out.meant.push_back(out.frame.inverse() * transform_of(flange) * out.tool);
    out.q.push_back(q);
  }
  if (language.name == val3.name) text += "</Data></Database>\n";
  return out;
}

// The six numbers behind `start` of the k-th line that has it.
std::vector<std::vector<double>> numbers_behind(const std::string& text, const std::string& start) {
  std::vector<std::vector<double>> all;
  for (std::size_t at = text.find(start); at != std::string::npos; at = text.find(start, at + 1)) {
    std::vector<double> n;
    const char* p = text.c_str() + at + start.size();
    while (n.size() < 6 && *p != 0) {
      char* end = nullptr;
      const bool here = (*p >= '0' && *p <= '9') || *p == '-';
      if (here) {
        n.push_back(std::strtod(p, &end));
        p = end;
      } else {
        ++p;
      }
    }
    all.push_back(n);
  }
  return all;
}

void expect_round_trip(std::uint64_t seed, const Language& language, const std::string& start) {
  SCOPED_TRACE("seed " + std::to_string(seed) + ", " + language.name);
  Random random(seed);
  const BlobContent blob = random_arm(random, language.name != ur.name);
  Geometry nominal_geometry = blob.geometry;
  std::copy(std::begin(blob.nominal), std::end(blob.nominal), nominal_geometry.link);
  Arm<double> nominal{}, actual{};
  ASSERT_EQ(make_arm(nominal_geometry, nominal), Status::ok);
  ASSERT_EQ(make_arm(blob.geometry, actual), Status::ok);
  const Program program = random_program(random, language, nominal, 30);
  FilterOptions options;
  if (language.name == krl.name) options.frames = read_frames(six("TOOL_DATA[1]={X %.9f,Y %.9f,Z %.9f,A %.9f,B %.9f,C %.9f}\n", tool_numbers) + six("BASE_DATA[1]={X %.9f,Y %.9f,Z %.9f,A %.9f,B %.9f,C %.9f}\n", frame_numbers), ProgramLanguage::krl, "frames");
  const ProgramLanguage which = language.name == krl.name ? ProgramLanguage::krl : language.name == val3.name ? ProgramLanguage::val3 : ProgramLanguage::urscript;
  const FilterResult result = filter_program(program.text, which, "program", blob, options);
  for (const FilterNote& note : result.stopped) ADD_FAILURE() << note.text;
  const auto numbers = numbers_behind(result.text, start);
  ASSERT_EQ(numbers.size(), program.q.size());
  double worst_m = 0, before_m = 0;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const Transform flange = program.frame * language.read(numbers[k].data()) * program.tool.inverse();
    Joints q = program.q[k];
    ASSERT_EQ(tick(nominal, default_tick_options(nominal), pose_from(flange), q.data()), Status::ok);
    Pose<double> reached{}, unfiltered{};
    ASSERT_EQ(forward(actual, q.data(), reached), Status::ok);
    ASSERT_EQ(forward(actual, program.q[k].data(), unfiltered), Status::ok);
    const Transform got = program.frame.inverse() * transform_of(reached) * program.tool, without = program.frame.inverse() * transform_of(unfiltered) * program.tool;
    worst_m = std::max(worst_m, (got.translation() - program.meant[k].translation()).norm());
    before_m = std::max(before_m, (without.translation() - program.meant[k].translation()).norm());
    EXPECT_LT((got.linear() - program.meant[k].linear()).norm(), 1e-6);
  }
  EXPECT_LT(worst_m, 1e-6);
  EXPECT_GT(before_m, 1e-3);
}

TEST(FilterRoundTrip, ASimulatedControllerGetsToThePosesMeant) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    expect_round_trip(seed, krl, "={X ");
    expect_round_trip(100 + seed, val3, "\"  x=\"");
    expect_round_trip(200 + seed, ur, "get_inverse_kin(p[");
  }
}

// The processor's time, so that others on the machine do not count.
TEST(FilterRoundTrip, AHundredThousandTargetsTakeLessThanTenSeconds) {
  Random random(7);
  const BlobContent blob = random_arm(random, true);
  Geometry nominal_geometry = blob.geometry;
  std::copy(std::begin(blob.nominal), std::end(blob.nominal), nominal_geometry.link);
  Arm<double> nominal{};
  ASSERT_EQ(make_arm(nominal_geometry, nominal), Status::ok);
  const Program program = random_program(random, val3, nominal, 100000);
  const std::clock_t start = std::clock();
  const FilterResult result = filter_program(program.text, ProgramLanguage::val3, "program", blob, {});
  EXPECT_EQ(result.filtered, 100000U);
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 10.0);
}

}  // namespace
