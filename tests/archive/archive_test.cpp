// SPDX-License-Identifier: MIT
// What the library's object code must look like, read with binutils.
#include <gtest/gtest.h>

#include <array>
#include <cfenv>
#include <cstdio>
#include <memory>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "mdhcal/compensator.hpp"
#include "mdhcal/environment.hpp"
#include "offline/output/blob_writer.hpp"
#include "tests/lib/arms.hpp"
#include "tests/lib/golden.hpp"

extern "C" int c_consumer(const std::uint8_t* blob, std::size_t size);
extern "C" int c_consumer_float(const std::uint8_t* blob, std::size_t size);

namespace {

using namespace mdhcal;

std::string output_of(const std::string& command) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  EXPECT_NE(pipe, nullptr);
  std::string text;
  std::array<char, 4096> buffer{};
  while (pipe != nullptr && std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe.get()) != nullptr) {
    text += buffer.data();
  }
  EXPECT_FALSE(text.empty()) << command;
  return text;
}

const std::string archive = MDHCAL_ARCHIVE;
const std::string haswell_archive = MDHCAL_HASWELL_ARCHIVE;

TEST(Archive, ExportsNoWeakSymbolAndKeepsNoData) {
  std::istringstream lines(output_of("nm -C " + archive));
  std::string line;
  int symbols = 0;
  const std::regex row(R"(^[0-9a-f]{16} ([A-Za-z]) (.*)$)");
  std::smatch match;
  while (std::getline(lines, line)) {
    if (!std::regex_match(line, match, row)) continue;
    ++symbols;
    const std::string kind = match[1];
    EXPECT_TRUE(kind != "W" && kind != "w" && kind != "V" && kind != "v" && kind != "u") << line;
    EXPECT_TRUE(kind != "D" && kind != "B" && kind != "C" && kind != "b") << "writable data: " << line;
  }
  EXPECT_GT(symbols, 50);
}

TEST(Archive, NeedsNothingButItselfAndMemoryFunctions) {
  std::istringstream lines(output_of("nm -P " + archive));
  std::set<std::string> defined;
  std::set<std::string> needed;
  std::string line;
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    std::string name;
    std::string kind;
    if (!(fields >> name >> kind) || kind.size() != 1) continue;
    (kind == "U" ? needed : defined).insert(name);
  }
  const std::set<std::string> allowed = {"memcpy", "memset", "memcmp", "memmove", "_GLOBAL_OFFSET_TABLE_"};
  for (const std::string& name : needed) {
    EXPECT_TRUE(defined.count(name) == 1 || allowed.count(name) == 1) << name;
  }
  EXPECT_GE(needed.size(), 2U);
}

// Compiled for a machine that has it, the library still does not contract a * b + c.
TEST(Archive, HasNoFusedMultiplyAddEvenWhereTheMachineHasIt) {
  const std::string code = output_of("objdump -d " + haswell_archive);
  EXPECT_NE(code.find("vmulsd"), std::string::npos) << "not compiled for AVX: the test would prove nothing";
  EXPECT_FALSE(std::regex_search(code, std::regex("vfn?m(add|sub)")));
}

// Scalar and packed arithmetic in double, and conversions to it, in the float objects of the kinematics.
TEST(Archive, FloatObjectsHoldNoDoubleArithmetic) {
  const std::string code = output_of("objdump -d " MDHCAL_FLOAT_OBJECTS);
  EXPECT_NE(code.find("mulss"), std::string::npos);
  std::istringstream lines(code);
  std::string line;
  const std::regex arithmetic(R"(\t(v?(add|sub|mul|div|sqrt|min|max)[sp]d|v?cvt(ss2sd|si2sd|ps2pd|sd2ss))\b)");
  while (std::getline(lines, line)) EXPECT_FALSE(std::regex_search(line, arithmetic)) << line;
}

TEST(Archive, AConsumerBuiltForSpeedGetsTheGoldenHashes) {
  std::istringstream lines(output_of(std::string(MDHCAL_CONSUMER) + " " + std::to_string(test::golden_operations)));
  std::string word;
  std::string own;
  std::string in_double;
  std::string in_float;
  lines >> word >> own >> own >> word >> in_double >> word >> in_float;
  EXPECT_EQ(std::stoull(in_double, nullptr, 16), test::golden_double);
  EXPECT_EQ(std::stoull(in_float, nullptr, 16), test::golden_float);
}

TEST(Environment, OtherRoundingModesAreRefused) {
  for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    ASSERT_EQ(std::fesetround(mode), 0);
    const Status status = check_environment();
    std::fesetround(FE_TONEAREST);
    EXPECT_EQ(status, Status::bad_environment) << mode;
  }
  EXPECT_EQ(check_environment(), Status::ok);
}

#if defined(__SSE2__)
TEST(Environment, FlushingOfSubnormalsIsRefused) {
  const unsigned int normal = _mm_getcsr();
  for (const unsigned int bits : {0x8000U, 0x0040U}) {  // flush to zero; denormals are zero
    _mm_setcsr(normal | bits);
    const Status status = check_environment();
    CalibratedArm<double> model{};
    const Status made = make_calibrated_arm(test::ur5(), test::ur5(), model);
    _mm_setcsr(normal);
    EXPECT_EQ(status, Status::bad_environment) << bits;
    EXPECT_EQ(made, Status::bad_environment) << bits;
  }
}
#endif

TEST(CHeader, ServesACProgram) {
  offline::Robot robot;
  robot.name = "C";
  test::Random random(41);
  robot.geometry = test::with_errors(test::ur5(), random, 1e-3, 0.1 * test::deg);
  for (std::size_t i = 0; i < max_joints; ++i) robot.nominal[i] = test::ur5().link[i];
  const offline::Blob blob = offline::make_blob(robot, offline::Provenance{});
  EXPECT_EQ(c_consumer(blob.data(), blob.size()), 0) << "the line of tests/archive/c_consumer_body.h";
  EXPECT_EQ(c_consumer_float(blob.data(), blob.size()), 0) << "the line of tests/archive/c_consumer_body.h, in float";
}

}  // namespace
