// SPDX-License-Identifier: MIT
// A program a maker, filtered by the built program, against what was worked out apart from it (shared data, controllers).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "tests/support/program.hpp"
#include "tests/support/shared_data.hpp"

namespace {

using namespace mdhcal::tests;

bool in_number(char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-'; }

// Numbers within two units of their last digit, every other byte the same.
void expect_same_program(const std::string& got, const std::string& expected) {
  std::size_t a = 0, b = 0, numbers = 0;
  while (a < got.size() && b < expected.size()) {
    if (!in_number(got[a]) || !in_number(expected[b])) {
      ASSERT_EQ(got[a], expected[b]) << "at byte " << b << ": " << expected.substr(b, 60);
      ++a;
      ++b;
      continue;
    }
    std::size_t c = a, d = b;
    while (c < got.size() && in_number(got[c])) ++c;
    while (d < expected.size() && in_number(expected[d])) ++d;
    const std::string x = got.substr(a, c - a), y = expected.substr(b, d - b);
    const std::size_t point = y.find('.');
    const double decimals = point == std::string::npos ? 0 : static_cast<double>(y.size() - point - 1);
    EXPECT_EQ(x.find('.') == std::string::npos ? 0 : x.size() - x.find('.'), point == std::string::npos ? 0 : y.size() - point) << x << " for " << y;
    EXPECT_LE(std::abs(std::strtod(x.c_str(), nullptr) - std::strtod(y.c_str(), nullptr)), 2.01 * std::pow(10, -decimals)) << expected.substr(b, 60);
    ++numbers;
    a = c;
    b = d;
  }
  EXPECT_EQ(a, got.size());
  EXPECT_EQ(b, expected.size());
  EXPECT_GT(numbers, 50U);
}

Outcome filtered(const TemporaryFolder& folder, const std::string& maker, const std::string& program, const std::string& frames, std::vector<std::string> more = {}) {
  const Outcome packed = run_mdhcal({"pack", shared_data("controllers/" + maker + "/corrected.toml"), "-o", folder / "arm.blob"});
  EXPECT_EQ(packed.exit_code, 0) << packed.err;
  std::vector<std::string> arguments{"filter", shared_data("controllers/" + maker + '/' + program), folder / "arm.blob", "-o", folder / "out"};
  if (!frames.empty()) arguments.insert(arguments.end(), {"--frames", shared_data("controllers/" + maker + '/' + frames)});
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_mdhcal(arguments);
}

void expect_sample(const std::string& maker, const std::string& program, const std::string& expected, const std::string& frames = "") {
  const TemporaryFolder folder;
  const Outcome run = filtered(folder, maker, program, frames);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  expect_same_program(read_bytes(folder / "out"), read_bytes(shared_data("controllers/" + maker + '/' + expected)));
}

MDHCAL_SHARED_DATA_TEST(FilterSamples, Rapid) { expect_sample("abb", "MdhTest.mod", "MdhTest_filtered.mod"); }
MDHCAL_SHARED_DATA_TEST(FilterSamples, Krl) { expect_sample("kuka", "MDHTEST.dat", "MDHTEST_filtered.dat", "config_excerpt.dat"); }
MDHCAL_SHARED_DATA_TEST(FilterSamples, FanucLs) { expect_sample("fanuc", "MDHTEST.LS", "MDHTEST_filtered.LS", "frames.txt"); }
MDHCAL_SHARED_DATA_TEST(FilterSamples, Inform) { expect_sample("yaskawa", "MDHTEST.JBI", "MDHTEST_filtered.JBI", "frames.txt"); }
MDHCAL_SHARED_DATA_TEST(FilterSamples, Val3) { expect_sample("staubli", "mdhtest.dtx", "mdhtest_filtered.dtx"); }
MDHCAL_SHARED_DATA_TEST(FilterSamples, UrScript) { expect_sample("ur", "mdhtest.script", "mdhtest_filtered.script"); }

// What cannot be filtered as text is named by its line.
MDHCAL_SHARED_DATA_TEST(FilterSamples, ComputedTargetsAreNamed) {
  const TemporaryFolder folder;
  EXPECT_NE(filtered(folder, "abb", "MdhTest.mod", "").err.find("MdhTest.mod:20: the target is computed by the program"), std::string::npos);
  const std::string fanuc = filtered(folder, "fanuc", "MDHTEST.LS", "frames.txt").err;
  EXPECT_NE(fanuc.find("MDHTEST.LS:24: the target is moved by a position register"), std::string::npos) << fanuc;
  EXPECT_NE(fanuc.find("MDHTEST.LS:27: the target is a position register"), std::string::npos) << fanuc;
  EXPECT_NE(filtered(folder, "ur", "mdhtest.script", "").err.find("mdhtest.script:10: the target is computed"), std::string::npos);
  const std::string ur = filtered(folder, "ur", "mdhtest.script", "").err;
  EXPECT_NE(ur.find("compute with a factory calibration"), std::string::npos) << ur;
  EXPECT_EQ(filtered(folder, "ur", "mdhtest.script", "", {"--controller", "nominal"}).err.find("factory calibration"), std::string::npos);
}

// Taught joint targets stay byte for byte; the poses do not.
MDHCAL_SHARED_DATA_TEST(FilterSamples, TaughtTargetsAreKept) {
  const TemporaryFolder folder;
  ASSERT_EQ(filtered(folder, "kuka", "MDHTEST.dat", "config_excerpt.dat", {"--keep-taught", "--keep", "P2"}).exit_code, 0);
  const std::string before = read_bytes(shared_data("controllers/kuka/MDHTEST.dat")), after = read_bytes(folder / "out");
  const auto line = [](const std::string& text, const std::string& start) { return text.substr(text.find(start), text.find('\n', text.find(start)) - text.find(start)); };
  for (const char* name : {"DECL E6AXIS XHOME1", "DECL E6AXIS XREADY", "DECL E6POS XP2"}) EXPECT_EQ(line(before, name), line(after, name));
  EXPECT_NE(line(before, "DECL E6POS XP1"), line(after, "DECL E6POS XP1"));
}

MDHCAL_SHARED_DATA_TEST(FilterSamples, NothingIsCorrectedTwice) {
  const TemporaryFolder folder;
  const Outcome run = filtered(folder, "abb", "MdhTest.mod", "", {"--controller", "absolute"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("a second time"), std::string::npos) << run.err;
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"arm.blob"});
}

// A table of the same joints gives the same poses, in the program's tool, frame and convention.
MDHCAL_SHARED_DATA_TEST(FilterSamples, CorrectPrintsThePosesToCommand) {
  const TemporaryFolder folder;
  ASSERT_EQ(filtered(folder, "kuka", "MDHTEST.dat", "config_excerpt.dat").exit_code, 0);
  write_bytes(folder / "q.csv", "id,q1,q2,q3,q4,q5,q6\nXP2,12,28,-5,15,55,-20\n");
  const Outcome run = run_mdhcal({"correct", folder / "arm.blob", folder / "q.csv", "--as", "poses", "--rotation", "kuka", "--tool", "42.5,-3.2,185.4,0,25,0",
                                  "--frame", "850,-120,95,30,5,-3"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  double n[6] = {};
  ASSERT_EQ(std::sscanf(run.out.c_str(), "id,status,x_mm,y_mm,z_mm,e1_deg,e2_deg,e3_deg\nXP2,ok,%lf,%lf,%lf,%lf,%lf,%lf", n, n + 1, n + 2, n + 3, n + 4, n + 5), 6) << run.out;
  const double expected[6] = {412.6261, 204.8479, 533.0747, -15.7802, -43.5757, -162.4150};
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(n[k], expected[k], 2e-4);  // the program's joints are those of its rounded pose
  EXPECT_EQ(run_mdhcal({"correct", folder / "arm.blob", folder / "q.csv", "--as", "poses", "--tool", "1,2,3"}).exit_code, 2);
}

}  // namespace
