// SPDX-License-Identifier: MIT
// verify as an acceptance test, and monitor, end to end on a simulated arm.
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "mdhcal/kinematics.hpp"

#include "offline/simulate/family.hpp"
#include "offline/simulate/measurement_text.hpp"
#include "offline/simulate/simulate.hpp"
#include "tests/support/program.hpp"

namespace {

using namespace mdhcal::offline;
using namespace mdhcal::tests;

class Acceptance : public testing::Test {
 protected:
  void SetUp() override {
    SimulationOptions options;
    options.configurations = 60;
    options.test_configurations = 60;
    simulation_ = simulate(family_robot("three-parallel"), options);
    write_bytes(folder_ / "robot.toml", write_robot(simulation_.nominal));
    write_bytes(folder_ / "train.csv", measurement_text(simulation_.train, simulation_.nominal));
    write_bytes(folder_ / "test.csv", measurement_text(simulation_.test, simulation_.nominal));
    const auto run = run_mdhcal({"--quiet", "calibrate", folder_ / "robot.toml", folder_ / "train.csv", "--test",
                                 folder_ / "test.csv", "-o", folder_ / "result"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    blob_ = folder_ / "result/calibration.blob";
  }

  // A check series of the true arm: `visits` of each of `count` configurations, in a tracker frame moved by `motion`,
  // with the second link longer by that much.
  std::string series(std::size_t count, std::size_t visits, const Eigen::Isometry3d& motion, double longer_m) {
    mdhcal::Geometry geometry = simulation_.truth.geometry;
    geometry.link[2].a_m += longer_m;
    mdhcal::Arm<double> arm{};
    EXPECT_EQ(make_arm(geometry, arm), mdhcal::Status::ok);
    const auto& b = *simulation_.truth.tracker_T_base;
    Eigen::Isometry3d base = Eigen::Translation3d(b.position_m[0], b.position_m[1], b.position_m[2]) *
                             Eigen::Quaterniond(b.quaternion[0], b.quaternion[1], b.quaternion[2], b.quaternion[3]);
    base = motion * base;
    const Vector3& p = simulation_.truth.targets[0].flange_p_m;
    mdhcal::offline::Random random(17);
    Dataset data;
    data.joint_count = 6;
    data.targets = {""};
    for (std::size_t c = 0; c < count; ++c) {
      data.groups.push_back("P" + std::to_string(c + 1));
      const auto q = random_readings(geometry, random);
      mdhcal::Pose<double> pose{};
      EXPECT_EQ(forward(arm, q.data(), pose), mdhcal::Status::ok);
      const Eigen::Isometry3d flange =
          Eigen::Translation3d(pose.position_m[0], pose.position_m[1], pose.position_m[2]) *
          Eigen::Quaterniond(pose.quaternion[0], pose.quaternion[1], pose.quaternion[2], pose.quaternion[3]);
      for (std::size_t v = 0; v < visits; ++v) {
        Measurement row;
        row.id = std::to_string(data.rows.size() + 1);
        row.group = static_cast<std::uint32_t>(c);
        row.q = q;
        const Eigen::Vector3d at = base * (flange * Eigen::Vector3d(p[0], p[1], p[2]));
        for (std::size_t k = 0; k < 3; ++k) row.position_m[k] = at[static_cast<int>(k)] + 0.02e-3 * random.normal();
        data.rows.push_back(row);
      }
    }
    write_bytes(folder_ / "check.csv", measurement_text(data, simulation_.nominal));
    return folder_ / "check.csv";
  }

  TemporaryFolder folder_;
  Simulation simulation_;
  std::string blob_;
};

TEST_F(Acceptance, RepeatedPosesGiveIso9283FiguresAndLimits) {
  const std::string check = series(5, 30, Eigen::Isometry3d::Identity(), 0);
  const auto run = run_mdhcal({"verify", blob_, check, "--iso9283", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  ASSERT_EQ(json["iso9283"]["poses"].size(), 5u);
  EXPECT_EQ(json["iso9283"]["fewest_visits"], 30);
  // 0.02 mm in each axis: distances from the barycentre have mean 0.0319 and standard deviation 0.0135, so RP is near 0.072.
  EXPECT_NEAR(json["iso9283"]["rp_mm"].get<double>(), 0.075, 0.02);
  EXPECT_LT(json["iso9283"]["ap_mm"].get<double>(), 0.1);
  EXPECT_EQ(run_mdhcal({"verify", blob_, check, "--max-rp", "0.2", "--max-ap", "0.2"}).exit_code, 0);
  const auto over = run_mdhcal({"verify", blob_, check, "--max-rp", "0.01"});
  EXPECT_EQ(over.exit_code, 1);
  EXPECT_NE(over.err.find("repeatability RP"), std::string::npos) << over.err;
  EXPECT_EQ(run_mdhcal({"verify", blob_, folder_ / "test.csv", "--iso9283"}).exit_code, 2);  // nothing is repeated
}

TEST_F(Acceptance, DriftIsTheDifferenceOfTwoBlobs) {
  ASSERT_EQ(run_mdhcal({"--quiet", "calibrate", folder_ / "robot.toml", folder_ / "train.csv", "--fix", "a3", "-o",
                        folder_ / "earlier"}).exit_code, 0);
  const std::string earlier = folder_ / "earlier/calibration.blob";
  const auto same = nlohmann::json::parse(run_mdhcal({"verify", blob_, folder_ / "test.csv", "--against", blob_, "--json"}).out);
  EXPECT_EQ(same["drift"]["max_mm"], 0);
  const auto run = run_mdhcal({"verify", blob_, folder_ / "test.csv", "--against", earlier, "--json", "--max-drift", "0.001"});
  EXPECT_EQ(run.exit_code, 1);
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_GT(json["drift"]["max_mm"].get<double>(), 0.001);
  EXPECT_FALSE(json["passed"].get<bool>());
}

TEST_F(Acceptance, MonitorTellsWhetherARecalibrationIsDue) {
  const auto condition = [&](const Eigen::Isometry3d& motion, double longer_m, int expected_exit) {
    const auto run = run_mdhcal({"monitor", blob_, series(12, 1, motion, longer_m), "--json"});
    EXPECT_EQ(run.exit_code, expected_exit) << run.err;
    return nlohmann::json::parse(run.out)["condition"].get<std::string>();
  };
  Eigen::Isometry3d moved(Eigen::AngleAxisd(2e-4, Eigen::Vector3d::UnitZ()));
  moved.translation() << 3e-4, 0, 0;
  EXPECT_EQ(condition(Eigen::Isometry3d::Identity(), 0, 0), "good");
  EXPECT_EQ(condition(moved, 0, 1), "frame_moved");
  EXPECT_EQ(condition(Eigen::Isometry3d::Identity(), 0.5e-3, 1), "recalibrate");
  // A blob that was never tested knows of no error to compare with.
  ASSERT_EQ(run_mdhcal({"--quiet", "pack", folder_ / "robot.toml", "-o", folder_ / "nominal.blob"}).exit_code, 0);
  EXPECT_EQ(run_mdhcal({"monitor", folder_ / "nominal.blob", folder_ / "check.csv"}).exit_code, 2);
}

}  // namespace
