// SPDX-License-Identifier: MIT
// Every sample of the shared exports gives the poses of its expected.csv, without a profile where that can be told.
#include <cmath>

#include <gtest/gtest.h>

#include "offline/base/error.hpp"
#include "offline/import/import.hpp"
#include "offline/measure/dataset.hpp"
#include "tests/support/program.hpp"
#include "tests/support/shared_data.hpp"

namespace {

using namespace mdhcal::offline;
using mdhcal::tests::shared_data;

struct Sample {
  const char* folder;
  std::vector<const char*> exports;
  const char* log;
  const char* profile;         // empty: told from the file
  double length_m = 1e-9;      // of a coordinate
  double quaternion = 1e-9;    // of an entry
};

// The bound of 06 is its digits: a range to 0.01 um, angles to 1e-7 degrees over four metres.
const std::vector<Sample>& samples() {
  static const std::vector<Sample> all{
      {"01-sa-space", {"tracker.txt"}, "joints.csv", ""},
      {"01-sa-space", {"tracker.txt"}, "joints.csv", "sa-space"},
      {"02-sa-comma", {"tracker.csv"}, "joints.csv", ""},
      {"02-sa-comma", {"tracker.csv"}, "joints.csv", "sa-comma"},
      {"03-sa-tab-header", {"tracker.txt"}, "joints.csv", ""},
      {"03-sa-tab-header", {"tracker.txt"}, "joints.csv", "sa-table"},
      {"04-sa-colons-uncert-time", {"tracker.csv"}, "joints.csv", ""},
      {"04-sa-colons-uncert-time", {"tracker.csv"}, "joints.csv", "sa-uncertainty"},
      {"06-sa-spherical", {"tracker.csv"}, "joints.csv", "sa-spherical", 1e-8},
      {"07-leica-pilot-point", {"tracker.csv"}, "joints.csv", ""},
      {"07-leica-pilot-point", {"tracker.csv"}, "joints.csv", "leica-pilot"},
      {"08-leica-pilot-tmac", {"tracker.csv"}, "joints.csv", ""},
      {"10-powerinspect-ijk", {"tracker.txt"}, "joints.csv", ""},
      {"10-powerinspect-ijk", {"tracker.txt"}, "joints.csv", "powerinspect"},
      {"11-cam2-latin1", {"tracker.csv"}, "joints.csv", ""},
      {"11-cam2-latin1", {"tracker.csv"}, "joints.csv", "report-semicolon"},
      {"12-delmia-autoid", {"data.txt"}, "", ""},
      {"12-delmia-autoid", {"data.txt"}, "", "delmia-auto-id"},
      {"13-ipa-semicolon-comma", {"measurements.csv"}, "", ""},
      {"13-ipa-semicolon-comma", {"measurements.csv"}, "", "ipa"},
      {"15-optitrack-motive", {"tracker.csv"}, "joints.csv", ""},
      {"15-optitrack-motive", {"tracker.csv"}, "joints.csv", "motive-millimetres"},
      {"17-wide-3smr-header", {"data.csv"}, "", ""},
      {"19-one-file-a-reflector", {"position_SMR_1.txt", "position_SMR_2.txt", "position_SMR_3.txt"}, "joints_SMR_tool.txt", ""},
      {"20-missing-points", {"tracker.csv"}, "joints.csv", ""},
      {"20-missing-points", {"data.csv"}, "", ""},
      {"21-utf16-tab", {"data.txt"}, "", ""},
      {"23-thousands-separators", {"data.csv"}, "", ""},
      {"23-thousands-separators", {"data_de.csv"}, "", ""},
      {"30-kuka-dat", {"tracker.csv"}, "calib.dat", ""},
      {"31-kuka-log-csv", {"tracker.csv"}, "axis_log.csv", ""},
      {"32-rapid-jointtarget", {"tracker.csv"}, "Calib.mod", ""},
      {"34-fanuc-ls", {"tracker.csv"}, "CALIB.LS", ""},
      {"37-urscript", {"tracker.csv"}, "calib.script", ""},
      {"40-staubli-dtx", {"tracker.csv"}, "calib.dtx", ""},
      {"42-ros-jointstate-yaml", {"tracker.csv"}, "joint_states.yaml", ""},
      {"43-time-join", {"tracker.csv"}, "joints.csv", ""}};
  return all;
}

MDHCAL_SHARED_DATA_TEST(Exports, GiveThePosesOfExpectedCsv) {
  for (const Sample& sample : samples()) {
    const std::string folder = shared_data(std::string("exports/") + sample.folder + '/');
    SCOPED_TRACE(folder + ' ' + sample.profile);
    const bool three = std::string(sample.folder).starts_with("17") || std::string(sample.folder).starts_with("19");
    const Robot robot = read_robot(shared_data(three ? "exports/robot3.toml" : "exports/robot.toml"));
    ImportOptions options;
    for (const char* file : sample.exports) options.exports.push_back(folder + file);
    if (sample.log[0] != 0) options.log = folder + sample.log;
    if (sample.profile[0] != 0) options.profile = find_profile(sample.profile);
    if (std::string(sample.folder).starts_with("43")) {
      options.join.by = JoinBy::time;
      options.join.clock_offset_s = 0.35;
      options.join.max_gap_s = 0.3;
    }
    try {
      const Dataset got = parse_dataset(import_measurements(options, robot).text, "imported", robot);
      const Dataset expected = read_dataset(folder + "expected.csv", robot);
      ASSERT_EQ(got.rows.size(), expected.rows.size());
      for (std::size_t i = 0; i < got.rows.size(); ++i) {
        const Measurement& a = got.rows[i];
        const Measurement& b = expected.rows[i];
        EXPECT_EQ(a.id, b.id);
        EXPECT_EQ(got.targets[a.target], expected.targets[b.target]);
        EXPECT_EQ(a.kind, b.kind);
        for (std::size_t j = 0; j < 6; ++j) EXPECT_NEAR(a.q[j], b.q[j], 1e-9);
        double along = 0;
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(a.position_m[k], b.position_m[k], sample.length_m);
        for (std::size_t k = 0; k < 4; ++k) along += a.quaternion[k] * b.quaternion[k];
        for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(a.quaternion[k], (along < 0 ? -1 : 1) * b.quaternion[k], sample.quaternion);
        // 08's expected.csv leaves out the uncertainties that its export states.
        if (!std::string(sample.folder).starts_with("08")) {
          for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(a.sigma_m[k], b.sigma_m[k], 1e-12);
        }
      }
    } catch (const InputError& error) {
      ADD_FAILURE() << error.what();
    }
  }
}

// Two angles and a range could be a point: that is asked, not guessed.
MDHCAL_SHARED_DATA_TEST(Exports, SphericalCoordinatesWithoutAHeaderAreAsked) {
  const std::string folder = shared_data("exports/06-sa-spherical/");
  ImportOptions options;
  options.exports = {folder + "tracker.csv"};
  options.log = folder + "joints.csv";
  try {
    (void)import_measurements(options, read_robot(shared_data("exports/robot.toml")));
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("azimuth_deg,zenith_deg,range_mm"), std::string::npos) << error.what();
  }
}

}  // namespace
