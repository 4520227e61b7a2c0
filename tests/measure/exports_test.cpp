// SPDX-License-Identifier: MIT
// Exports as other programs write them, made by hand from three published poses: what is read is those poses.
#include <cmath>

#include <gtest/gtest.h>

#include "offline/measure/dataset.hpp"
#include "offline/simulate/measurement_text.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;

// (Li 2022, Table 3), the first three rows [deg], [mm].
constexpr double published[3][9] = {
    {-7.5005, -234.484, -106.745, -92.3875, -61.5425, 20.7451, 228.695, -99.613, 532.386},
    {-5.9954, -230.002, -100.029, -89.976, -59.9825, 20.7314, 179.731, -86.189, 611.039},
    {0.0524, -220.048, -100.076, -80.0114, -60.0704, 20.0858, 93.86, -66.969, 656.105}};

class Exports : public testing::TestWithParam<const char*> {
 protected:
  const Robot robot = read_robot(MDHCAL_SOURCE_DIR "/offline/examples/li2022/robot.toml");

  void expect_published(const Dataset& data) const {
    ASSERT_EQ(data.rows.size(), 3u) << data.path;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(data.rows[i].id, std::to_string(i + 1));
      EXPECT_EQ(data.rows[i].kind, MeasurementKind::position);
      for (std::size_t j = 0; j < 6; ++j) EXPECT_NEAR(data.rows[i].q[j], published[i][j] * 3.14159265358979324 / 180, 1e-12);
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(data.rows[i].position_m[k], 1e-3 * published[i][6 + k], 1e-12);
    }
  }
};

TEST_P(Exports, AreReadAndWrittenBackTheSame) {
  const Dataset data = read_dataset(std::string(MDHCAL_SOURCE_DIR "/tests/measure/exports/") + GetParam(), robot);
  expect_published(data);
  // A point that was not measured is left out, and that is said with its line.
  const bool lost = std::string(GetParam()) != "metres_and_radians.txt";
  bool said = false;
  for (const std::string& note : data.notes) said = said || note.find("without a measured point") != std::string::npos;
  EXPECT_EQ(said, lost);
  expect_published(parse_dataset(measurement_text(data, robot), "again.csv", robot));
}

INSTANTIATE_TEST_SUITE_P(Dialects, Exports,
                         testing::Values("joints_and_points.csv",     // joints J1 ..., units in brackets, CRLF, 0,0,0 for a lost point
                                         "tracker_semicolons.csv",    // byte order mark, // and # comments, blank lines, decimal commas, degree signs
                                         "metres_and_radians.txt"),   // tabs, empty quaternion columns
                         [](const auto& each) {
                           const std::string name = each.param;
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
