// SPDX-License-Identifier: MIT
// The fuzzers' corpora as plain tests, under any compiler: each file as it is, cut, and with single bytes changed.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/fuzz/targets.hpp"
#include "tests/support/program.hpp"

namespace mdhcal::fuzz {
namespace {

void replay(const std::string& corpus, void (*target)(const std::uint8_t*, std::size_t), std::size_t variants) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(MDHCAL_SOURCE_DIR) + "/tests/fuzz/corpus/" + corpus)) {
    SCOPED_TRACE(entry.path().string());
    const std::string text = tests::read_bytes(entry.path().string());
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    target(bytes.data(), bytes.size());
    ++files;
    for (std::size_t i = 0; i < variants && !bytes.empty(); ++i) {
      const std::size_t at = i * bytes.size() / variants;
      target(bytes.data(), at);
      std::vector<std::uint8_t> changed = bytes;
      changed[at] = static_cast<std::uint8_t>(changed[at] ^ 1U << (i % 8));
      target(changed.data(), changed.size());
    }
  }
  EXPECT_GE(files, 5U);
}

TEST(Replay, Blob) { replay("blob", blob_target, 500); }
TEST(Replay, Loader) { replay("blob", loader_target, 100); }
TEST(Replay, Robot) { replay("robot", robot_target, 200); }
TEST(Replay, Dataset) { replay("dataset", dataset_target, 200); }
TEST(Replay, Urdf) { replay("urdf", urdf_target, 200); }
TEST(Replay, Kinematics) { replay("kinematics", kinematics_target, 200); }
TEST(Replay, UrCalibration) { replay("ur_calibration", ur_calibration_target, 200); }
TEST(Replay, Joints) { replay("joints", joints_target, 200); }
TEST(Replay, Poses) { replay("poses", poses_target, 200); }
TEST(Replay, Manifest) { replay("manifest", manifest_target, 200); }
TEST(Replay, Key) { replay("key", key_target, 100); }
TEST(Replay, Source) { replay("source", source_target, 100); }
TEST(Replay, Program) { replay("program", program_target, 200); }
TEST(Replay, Filter) { replay("program", filter_target, 50); }
TEST(Replay, Profile) { replay("profile", profile_target, 100); }

}  // namespace
}  // namespace mdhcal::fuzz
