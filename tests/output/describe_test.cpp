// SPDX-License-Identifier: MIT
#include "offline/output/blob_describe.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/output/sample_robot.hpp"
#include "tests/support/program.hpp"

namespace mdhcal::offline {
namespace {

using nlohmann::json;
using tests::run_mdhcal;

void save(const std::string& path, const Blob& blob) {
  tests::write_bytes(path, std::string(reinterpret_cast<const char*>(blob.data()), blob.size()));
}

TEST(Show, JsonHasEverythingInMillimetresAndDegrees) {
  const tests::TemporaryFolder folder;
  save(folder / "a.blob", make_blob(sample_robot(), sample_provenance()));
  const auto run = run_mdhcal({"show", "--json", folder / "a.blob"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json blob = json::parse(run.out);
  EXPECT_EQ(blob["name"], "sample arm");
  EXPECT_EQ(blob["serial"], "SN-0007");
  EXPECT_EQ(blob["format"], "2.0");
  ASSERT_EQ(blob["links"].size(), 6U);
  EXPECT_DOUBLE_EQ(blob["links"][0]["nominal"]["d_mm"], 360.0);
  EXPECT_NEAR(blob["links"][0]["deviation"]["d_mm"], 1.0, 1e-12);
  EXPECT_NEAR(blob["links"][1]["corrected"]["beta_deg"], 0.11459155902616465, 1e-15);
  EXPECT_NEAR(blob["links"][0]["max_deg"], 171.88733853924697, 1e-12);
  EXPECT_TRUE(blob["links"][1]["max_deg"].is_null());
  EXPECT_EQ(blob["links"][3]["sign"], -1);
  EXPECT_EQ(blob["links"][2]["coupling"][1], 0.5);
  EXPECT_DOUBLE_EQ(blob["tracker_T_base"]["xyz_mm"][0], 1500.0);
  EXPECT_EQ(blob["targets"][1]["name"], "B");
  EXPECT_DOUBLE_EQ(blob["provenance"]["held_out"]["after"]["max_mm"], 0.2);
  EXPECT_EQ(blob["provenance"]["measurements_sha256"], sample_provenance().measurements_sha256);
  EXPECT_EQ(blob["self_test"]["double_here"], "same bits");
  EXPECT_EQ(blob["self_test"]["float_here"], "same bits");
  EXPECT_EQ(blob["self_test"]["double"].size(), 4U);
  EXPECT_TRUE(blob["signature"].is_null());
}

TEST(Show, TextNamesEveryPart) {
  const auto run = run_mdhcal({"show", std::string(MDHCAL_SOURCE_DIR) + "/tests/blob/golden/every-field-2.0.blob"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* part :
       {"Prüfling 8", "SN/2026-0815", "golden_blob.py for format 2.0", "2026-11-21", "rpim", "0.015625", "quasi-optimality",
        "1234 poses", "808182", "567 poses", "2.6500 -> 0.0320 mm", "5.1000 -> 0.1480 mm", "c0c1c2c3c4c5c6c7", "77",
        "305419896", "three parallel axes", "1e-07 mm", "1250.000000", "\"target-7\": 7100.000000", "link 8",
        "2.8 of 1", "-143.2394 deg", "2750.0000 mm", "268.800000", "19.9389313", "-1.200000", "vector 4 in float"}) {
    EXPECT_NE(run.out.find(part), std::string::npos) << part;
  }
}

TEST(Show, RefusesWhatIsNoBlob) {
  const tests::TemporaryFolder folder;
  tests::write_bytes(folder / "short.blob", "not a blob");
  const auto run = run_mdhcal({"show", folder / "short.blob"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("short.blob"), std::string::npos);
  EXPECT_NE(run.err.find("wrong size"), std::string::npos) << run.err;
  EXPECT_EQ(run.out, "");
}

TEST(Diff, NamesWhatChangedAndHowFarTheFlangeMoves) {
  const tests::TemporaryFolder folder;
  Robot robot = sample_robot();
  save(folder / "a.blob", make_blob(robot, sample_provenance()));
  robot.geometry.link[0].d_m += 0.0005;  // lifts the whole arm: the flange moves by this everywhere
  robot.targets.pop_back();
  robot.geometry.joint[0].has_max = 0;
  save(folder / "b.blob", make_blob(robot, sample_provenance()));
  const auto run = run_mdhcal({"diff", "--json", folder / "a.blob", folder / "b.blob"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json difference = json::parse(run.out);
  ASSERT_EQ(difference["changes"].size(), 3U) << run.out;
  EXPECT_EQ(difference["changes"][0]["name"], "max1_deg");
  EXPECT_EQ(difference["changes"][1]["name"], "d1_mm");
  EXPECT_NEAR(difference["changes"][1]["change"], 0.5, 1e-9);
  EXPECT_EQ(difference["changes"][2]["name"], "target \"B\"");
  EXPECT_NEAR(difference["flange_movement"]["mean_mm"], 0.5, 1e-9);
  EXPECT_NEAR(difference["flange_movement"]["max_mm"], 0.5, 1e-9);
  EXPECT_NEAR(difference["flange_movement"]["max_deg"], 0.0, 1e-6);
  const auto text = run_mdhcal({"diff", folder / "a.blob", folder / "b.blob"});
  EXPECT_NE(text.out.find("d1_mm"), std::string::npos);
  EXPECT_NE(text.out.find("moves by 0.5000 mm"), std::string::npos) << text.out;
  EXPECT_EQ(run_mdhcal({"diff", folder / "a.blob", folder / "a.blob"}).out, "No difference.\n");
}

TEST(Diff, TurnsAreSeenToo) {
  const tests::TemporaryFolder folder;
  Robot robot = sample_robot();
  save(folder / "a.blob", make_blob(robot, sample_provenance()));
  robot.geometry.link[0].theta_rad += 0.001;  // turns the whole arm about the base's z
  save(folder / "b.blob", make_blob(robot, sample_provenance()));
  const json difference = json::parse(run_mdhcal({"diff", "--json", folder / "a.blob", folder / "b.blob"}).out);
  EXPECT_NEAR(difference["flange_movement"]["mean_deg"], 0.001 * 57.29577951308232, 1e-9);
  EXPECT_NEAR(difference["flange_movement"]["max_deg"], 0.001 * 57.29577951308232, 1e-9);
}

TEST(Diff, RefusesOtherArms) {
  const std::string golden = std::string(MDHCAL_SOURCE_DIR) + "/tests/blob/golden/";
  const auto run = run_mdhcal({"diff", golden + "every-field-2.0.blob", golden + "six-joints-2.0.blob"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.out, "");
}

}  // namespace
}  // namespace mdhcal::offline
