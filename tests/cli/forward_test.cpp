// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "tests/cli/cli.hpp"
#include "mdhcal/blob.hpp"
#include "offline/base/random.hpp"
#include "offline/robot/robot.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/wide_frame.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::tests;

// (Li 2022, Table 2), but for the misprinted y of row 2: the measured value stands there.
TEST(Forward, NominalRobotReproducesThePublishedReferencePositions) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_mdhcal({"pack", example("robot.toml"), "-o", folder / "nominal.blob"}).exit_code, 0);
  const Outcome run = run_mdhcal({"forward", folder / "nominal.blob", example("reference.csv")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const CsvTable computed(run.out);
  const CsvTable published(read_bytes(example("reference.csv")));
  ASSERT_EQ(computed.rows(), 9U);
  for (std::size_t row = 0; row < 9; ++row) {
    for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
      EXPECT_NEAR(computed.number(row, axis), published.number(row, axis), 0.006) << axis << " of row " << row + 1;
    }
  }
}

// The printed text holds every bit: held against the 4x4 product in long double on the geometry in the blob.
void expect_exact(const std::string& robot, const std::string& expected_source, int poses, std::uint64_t seed) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_mdhcal({"pack", robot, "-o", folder / "a.blob"}).exit_code, 0);
  offline::Random random(seed);
  std::string joints = "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad\n";
  std::vector<std::array<double, 6>> q(static_cast<std::size_t>(poses));
  for (auto& row : q) {
    for (std::size_t j = 0; j < 6; ++j) {
      row[j] = random.uniform(-6.28, 6.28);
      char text[40];
      std::snprintf(text, sizeof text, "%.17g", row[j]);
      joints += (j == 0 ? "" : ",") + std::string(text);
    }
    joints += '\n';
  }
  write_bytes(folder / "joints.csv", joints);
  const Outcome run = run_mdhcal({"forward", folder / "a.blob", folder / "joints.csv"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const CsvTable out(run.out);
  ASSERT_EQ(out.rows(), q.size());
  const Geometry geometry = offline::read_robot(expected_source).geometry;
  double worst_m = 0, worst_rotation = 0;
  for (std::size_t row = 0; row < q.size(); ++row) {
    const WideFrame truth = wide_forward(geometry, q[row].data());
    const Pose<double> pose{{out.number(row, "qw"), out.number(row, "qx"), out.number(row, "qy"), out.number(row, "qz")},
                            {out.number(row, "x_mm") / 1000, out.number(row, "y_mm") / 1000, out.number(row, "z_mm") / 1000}};
    worst_m = std::max(worst_m, position_difference(truth, pose));
    worst_rotation = std::max(worst_rotation, rotation_difference(truth, pose));
  }
  EXPECT_LE(worst_m, 1e-12);
  EXPECT_LE(worst_rotation, 1e-14);
}

TEST(Forward, FromTheBlobIsThePlainProduct) { expect_exact(example("robot.toml"), example("robot.toml"), 1000, 3); }

MDHCAL_SHARED_DATA_TEST(Forward, FactoryRobotsFromTheBlobAreThePlainProductAndHaveNoLongLength) {
  for (const char* name : {"ur_factory/ur10_a.toml", "ur_factory/ur10e_c.toml"}) {
    expect_exact(shared_data(name), shared_data(name), 1000, 4);
    const TemporaryFolder folder;
    ASSERT_EQ(run_mdhcal({"pack", shared_data(name), "-o", folder / "a.blob"}).exit_code, 0);
    const std::string bytes = read_bytes(folder / "a.blob");
    ASSERT_EQ(bytes.size(), blob_size);
    BlobContent model;
    ASSERT_EQ(decode(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), {}, model), Status::ok);
    for (int i = 0; i < 6; ++i) {
      EXPECT_LE(std::abs(model.geometry.link[i].a_m), 2.0);
      EXPECT_LE(std::abs(model.geometry.link[i].d_m), 2.0);
    }
  }
}

TEST(Forward, FrameAndTargetAreThoseOfTheBlob) {
  const TemporaryFolder folder;
  write_bytes(folder / "r.toml", "name = \"slide\"\n[[link]]\njoint = \"prismatic\"\nalpha = 0\na = 0\nd = 100\n"
                                 "[base]\nxyz = [1000, 0, 0]\nrxryrz = [0, 0, 90]\n[[target]]\nname = \"A\"\nxyz = [10, 0, 0]\n");
  write_bytes(folder / "q.csv", "id;q1\none;5,5\n");
  ASSERT_EQ(run_mdhcal({"pack", folder / "r.toml", "-o", folder / "r.blob"}).exit_code, 0);
  const CsvTable flange(run_mdhcal({"forward", folder / "r.blob", folder / "q.csv"}).out);
  EXPECT_EQ(flange.text(0, "id"), "one");
  EXPECT_DOUBLE_EQ(flange.number(0, "z_mm"), 105.5);
  const CsvTable target(
      run_mdhcal({"forward", folder / "r.blob", folder / "q.csv", "--frame", "tracker", "--target", "A"}).out);
  EXPECT_NEAR(target.number(0, "x_mm"), 1000, 1e-10);
  EXPECT_NEAR(target.number(0, "y_mm"), 10, 1e-10);
  EXPECT_NEAR(target.number(0, "qz"), std::sqrt(0.5), 1e-15);
  const Outcome missing = run_mdhcal({"forward", folder / "r.blob", folder / "q.csv", "--target", "B"});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_NE(missing.err.find("no target \"B\" in the blob; expected one of: \"A\""), std::string::npos) << missing.err;
}

}  // namespace
