// SPDX-License-Identifier: MIT
// Layouts that no built-in profile was made for: nine at least are read as they are or with a profile of at most eight lines,
// the others are refused with a sentence that says what is missing.
#include <cmath>
#include <cstdio>
#include <functional>

#include <gtest/gtest.h>

#include "offline/base/error.hpp"
#include "offline/import/import.hpp"
#include "offline/measure/dataset.hpp"
#include "offline/robot/rotation.hpp"
#include "offline/robot/units.hpp"
#include "tests/support/program.hpp"

namespace {

using namespace mdhcal::offline;
using namespace mdhcal::tests;

// Six joints [deg], a point [mm] and a turn about (1, 2, 2)/3 [deg]: invented, all different in size.
struct Pose {
  double q[6], p[3], turn;
};
constexpr Pose poses[] = {{{-46.944, 29.7672, -43.5983, -144.4965, -33.7468, -76.8682}, {-2317.4227, 2867.0612, 2016.6331}, 20},
                          {{-94.7745, -57.8244, 22.2115, 81.0072, -15.9328, 169.3825}, {-1518.8793, 3454.4543, 1617.2828}, 75},
                          {{-138.7412, 81.9338, 30.312, 84.4012, 40.9254, -8.5566}, {-1663.3393, 2425.2147, -312.6232}, -110},
                          {{97.037, 73.1165, -7.4196, 77.3105, 11.6074, -151.3851}, {2518.9915, 2574.0812, 528.0425}, 160},
                          {{-139.6698, -29.5581, -109.2599, 153.0148, -61.1203, -101.004}, {-864.1753, 3106.8421, 2099.0658}, 5}};

std::array<double, 4> quaternion(const Pose& pose) {
  const double half = 0.5 * pose.turn * rad_per_deg;
  const double s = std::sin(half) / 3;
  return {std::cos(half), s, 2 * s, 2 * s};
}

std::string format(const char* pattern, double a, double b, double c) {
  char text[200];
  (void)std::snprintf(text, sizeof text, pattern, a, b, c);
  return text;
}

std::string with_commas(std::string text) {
  for (char& c : text) c = c == '.' ? ',' : c;
  return text;
}

// The rows, one a pose: `row` is given the number from 1.
std::string rows(const std::function<std::string(std::size_t, const Pose&)>& row) {
  std::string text;
  std::size_t number = 0;
  for (const Pose& pose : poses) text += row(++number, pose) + '\n';
  return text;
}

std::string xyz(const Pose& p, const char* pattern = "%.4f,%.4f,%.4f", double scale = 1) {
  return format(pattern, p.p[0] * scale, p.p[1] * scale, p.p[2] * scale);
}

std::string in_quotes_of_json(std::size_t n, const Pose& p) {
  return "{\"name\":\"P" + std::to_string(n) + "\",\"xyz\":[" + xyz(p) + "]}";
}

std::string joint_log() {
  return "id,J1,J2,J3,J4,J5,J6\n" + rows([](std::size_t n, const Pose& p) {
           return "P" + std::to_string(n) + ',' + format("%.4f,%.4f,%.4f", p.q[0], p.q[1], p.q[2]) + ',' + format("%.4f,%.4f,%.4f", p.q[3], p.q[4], p.q[5]);
         });
}

struct Layout {
  const char* name;
  std::string text;
  std::string profile;       // TOML, at most eight lines; empty for none
  std::string refused;       // a part of the message, if it cannot be read
  bool rotation = false;
};

std::vector<Layout> layouts() {
  const auto name = [](std::size_t n) { return "P" + std::to_string(n); };
  std::vector<Layout> all;
  all.push_back({"inspection report with nominal and actual values",
                 "Inspection report\nPart;robot\n\nName;Nominal X;Nominal Y;Nominal Z;Actual X;Actual Y;Actual Z;Dev X;Dev Y;Dev Z\n" +
                     rows([&](std::size_t n, const Pose& p) { return name(n) + ";0.0;0.0;0.0;" + xyz(p, "%.4f;%.4f;%.4f") + ";0.1;0.2;0.3"; }),
                 "", ""});
  all.push_back({"measured and nominal columns, inches",
                 "NAME,NOM X (in),NOM Y (in),NOM Z (in),MEAS X (in),MEAS Y (in),MEAS Z (in)\n" +
                     rows([&](std::size_t n, const Pose& p) { return name(n) + ",1.0,2.0,3.0," + xyz(p, "%.12f,%.12f,%.12f", 1 / 25.4); }),
                 "", ""});
  all.push_back({"point cloud with its header in a comment",
                 "# Name X Y Z Nx Ny Nz\n" + rows([&](std::size_t n, const Pose& p) { return name(n) + ' ' + xyz(p, "%.4f %.4f %.4f") + " 0.0 0.0 1.0"; }), "", ""});
  all.push_back({"spreadsheet with a title, a row of units and decimal commas",
                 "Messprotokoll Roboter\nDatum;02.03.2026\n\nPunkt;X;Y;Z;Temperatur\n;mm;mm;mm;\n" +
                     rows([&](std::size_t n, const Pose& p) { return name(n) + ';' + with_commas(xyz(p, "%.4f;%.4f;%.4f")) + ";21,5"; }),
                 "", ""});
  all.push_back({"motion capture: objects above their columns, metres by a profile",
                 "Trajectories\n100\n,,Probe:Root,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n" +
                     rows([&](std::size_t n, const Pose& p) { return std::to_string(n) + ",0," + xyz(p); }),
                 "[rename]\nid = \"Frame\"\n", ""});
  all.push_back({"optical tracker: tools, states and missing points",
                 "Tools,Frame,Face,State,Q0,Qx,Qy,Qz,Tx,Ty,Tz,Error\n" + rows([&](std::size_t n, const Pose& p) {
                   const auto q = quaternion(p);
                   return "Port 1,P" + std::to_string(n) + ",0,OK," + format("%.9f,%.9f,%.9f", q[0], q[1], q[2]) + format(",%.9f,", q[3], 0, 0) + xyz(p) + ",0.12";
                 }) + "Port 1,P9,0,MISSING,-3.697314E28,-3.697314E28,-3.697314E28,-3.697314E28,-3.697314E28,-3.697314E28,-3.697314E28,0\n",
                 "", "", true});
  all.push_back({"messages of ROS as a table, metres and quaternions with the scalar last",
                 "%time,field.header.seq,field.header.frame_id,field.pose.position.x,field.pose.position.y,field.pose.position.z,"
                 "field.pose.orientation.x,field.pose.orientation.y,field.pose.orientation.z,field.pose.orientation.w\n" +
                     rows([&](std::size_t n, const Pose& p) {
                       const auto q = quaternion(p);
                       return "17724429000000000" + std::to_string(10 + n) + ',' + name(n) + ",tracker," + xyz(p, "%.7f,%.7f,%.7f", 1e-3) + ',' +
                              format("%.9f,%.9f,%.9f", q[1], q[2], q[3]) + format(",%.9f", q[0], 0, 0);
                     }),
                 "", "", true});
  all.push_back({"tracker with tabs, RMS and date",
                 "Point Name\tX\tY\tZ\tRMS\tTime\n" +
                     rows([&](std::size_t n, const Pose& p) { return name(n) + '\t' + xyz(p, "%.4f\t%.4f\t%.4f") + "\t0.004\t02.03.2026 09:15:0" + std::to_string(n); }),
                 "", ""});
  all.push_back({"theodolite: gon, elevation, slope distance",
                 "Name,Hz [gon],Elevation [gon],Range [m]\n" + rows([&](std::size_t n, const Pose& p) {
                   const double range = std::hypot(p.p[0], p.p[1], p.p[2]);
                   return name(n) + ',' + format("%.11f,%.11f,%.11f", std::atan2(p.p[1], p.p[0]) / pi * 200, std::asin(p.p[2] / range) / pi * 200, range * 1e-3);
                 }),
                 "", ""});
  all.push_back({"six numbers and Euler angles without a header, by a profile",
                 rows([&](std::size_t n, const Pose& p) {
                   // Rz(A) Ry(B) Rx(C) of the turn.
                   const auto q = quaternion(p);
                   const double c = std::atan2(2 * (q[0] * q[1] + q[2] * q[3]), 1 - 2 * (q[1] * q[1] + q[2] * q[2]));
                   const double b = std::asin(2 * (q[0] * q[2] - q[3] * q[1]));
                   const double a = std::atan2(2 * (q[0] * q[3] + q[1] * q[2]), 1 - 2 * (q[2] * q[2] + q[3] * q[3]));
                   return name(n) + ' ' + xyz(p, "%.4f %.4f %.4f") + format(" %.9f %.9f %.9f", a * deg_per_rad, b * deg_per_rad, c * deg_per_rad);
                 }),
                 "columns = [\"id\", \"x_mm\", \"y_mm\", \"z_mm\", \"r1\", \"r2\", \"r3\"]\nrotation = \"kuka\"\n", "", true});
  all.push_back({"Latin-1, apostrophes between thousands",
                 "Messpunkt;Ist X;Ist Y;Ist Z;Pr\xFC" "fer\n" + rows([&](std::size_t n, const Pose& p) {
                   std::string text = name(n);
                   for (const double v : p.p) {
                     char digits[40];
                     const long whole = static_cast<long>(std::abs(v));
                     (void)std::snprintf(digits, sizeof digits, whole >= 1000 ? "%s%ld'%03ld.%04ld" : "%s%.0ld%03ld.%04ld", v < 0 ? "-" : "", whole / 1000, whole % 1000,
                                         std::lround((std::abs(v) - static_cast<double>(whole)) * 1e4));
                     text += std::string(";") + digits;
                   }
                   return text + ";M\xFCller";
                 }),
                 "[rename]\nid = \"Messpunkt\"\n", ""});
  all.push_back({"an axis a row", rows([&](std::size_t n, const Pose& p) {
                   return name(n) + "\tX\t" + format("%.4f", p.p[0], 0, 0) + '\n' + name(n) + "\tY\t" + format("%.4f", p.p[1], 0, 0) + '\n' + name(n) + "\tZ\t" +
                          format("%.4f", p.p[2], 0, 0);
                 }),
                 "", "--columns"});
  all.push_back({"JSON", rows([](std::size_t n, const Pose& p) { return in_quotes_of_json(n, p); }), "", "expected"});
  return all;
}

TEST(Layouts, UnseenOnesAreReadOrAskedFor) {
  const Robot robot = read_robot(MDHCAL_SOURCE_DIR "/offline/examples/li2022/robot.toml");
  std::size_t read = 0;
  for (const Layout& layout : layouts()) {
    SCOPED_TRACE(layout.name);
    const TemporaryFolder folder;
    write_bytes(folder / "export.txt", layout.text);
    std::string log = joint_log();
    if (std::string(layout.name).starts_with("motion")) {  // frames in place of names
      for (std::size_t at = log.find('P'); at != std::string::npos; at = log.find('P')) log.erase(at, 1);
    }
    write_bytes(folder / "log.csv", log);
    ImportOptions options;
    options.exports = {folder / "export.txt"};
    options.log = folder / "log.csv";
    if (!layout.profile.empty()) {
      EXPECT_LE(std::count(layout.profile.begin(), layout.profile.end(), '\n'), 8);
      options.profile = parse_profile(layout.profile, "own.toml", "own");
    }
    try {
      const Dataset data = parse_dataset(import_measurements(options, robot).text, "imported", robot);
      EXPECT_TRUE(layout.refused.empty());
      ASSERT_EQ(data.rows.size(), std::size(poses));
      for (std::size_t i = 0; i < data.rows.size(); ++i) {
        for (std::size_t j = 0; j < 6; ++j) EXPECT_NEAR(data.rows[i].q[j], poses[i].q[j] * rad_per_deg, 1e-12);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(data.rows[i].position_m[k], 1e-3 * poses[i].p[k], 1e-9);
        ASSERT_EQ(data.rows[i].kind == MeasurementKind::pose, layout.rotation);
        if (!layout.rotation) continue;
        const auto q = quaternion(poses[i]);
        const double sign = q[0] < 0 ? -1 : 1;
        for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(data.rows[i].quaternion[k], sign * q[k], 2e-9);
      }
      ++read;
    } catch (const InputError& error) {
      EXPECT_FALSE(layout.refused.empty()) << error.what();
      EXPECT_NE(std::string(error.what()).find(layout.refused), std::string::npos) << error.what();
    }
  }
  EXPECT_GE(read, 9u);
}

}  // namespace
