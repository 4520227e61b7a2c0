// SPDX-License-Identifier: MIT
// Exported images, read back by programs that are not ours.
#include "offline/output/export.hpp"

#include <gtest/gtest.h>

#include <ostream>

#include "offline/base/error.hpp"
#include "tests/support/program.hpp"

namespace mdhcal::offline {
namespace {

using tests::read_bytes;
using tests::run_mdhcal;
using tests::run_program;

const std::string blob_path = std::string(MDHCAL_SOURCE_DIR) + "/tests/blob/golden/written-arithmetic-8-2.0.blob";

// The slot header by hand: magic, sequence, the blob's last four bytes, zeros, CRC-32 by zlib.
std::string with_header(const std::string& blob, const std::string& sequence_hex) {
  const auto run = run_program(
      "python3", {"-c",
                  "import sys,zlib\n"
                  "blob=open(sys.argv[1],'rb').read()\n"
                  "head=bytes.fromhex('FDA0B2EC'+sys.argv[2])+blob[-4:]+bytes(16)\n"
                  "print((head+zlib.crc32(head).to_bytes(4,'little')).hex())",
                  blob, sequence_hex});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  std::string bytes;
  for (std::size_t i = 0; i + 1 < 64; i += 2) bytes += static_cast<char>(std::stoi(run.out.substr(i, 2), nullptr, 16));
  return bytes + read_bytes(blob);
}

struct Case {
  const char* format;
  const char* srecord_type;  // how srec_cat names it
  const char* bfd;           // how objcopy names it
  const char* address;
};

void PrintTo(const Case& one, std::ostream* to) { *to << one.format << " at " << one.address; }

class Images : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Export, Images,
                         testing::Values(Case{"hex", "-intel", "ihex", "0x08040000"},
                                         Case{"srec", "-motorola", "srec", "0x08040000"},
                                         // Across a boundary of 64 KiB; at 0; up to the last byte of 32 bits.
                                         Case{"hex", "-intel", "ihex", "0x0803F820"},
                                         Case{"srec", "-motorola", "srec", "0x0803F820"},
                                         Case{"hex", "-intel", "ihex", "0"}, Case{"srec", "-motorola", "srec", "0"},
                                         Case{"hex", "-intel", "ihex", "0xFFFFE020"},
                                         Case{"srec", "-motorola", "srec", "4294959136"}));

TEST_P(Images, AreReadBackBySrecCatAndObjcopy) {
  const Case& c = GetParam();
  const tests::TemporaryFolder folder;
  const auto run = run_mdhcal({"export", blob_path, "--format", c.format, "--address", c.address, "-o", folder / "image"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string blob = read_bytes(blob_path);
  const std::string back = std::to_string(std::stoull(c.address, nullptr, 0));
  const auto cat = run_program("srec_cat", {folder / "image", c.srecord_type, "-offset", "-" + back, "-o",
                                            folder / "by_srec_cat", "-binary"});
  ASSERT_EQ(cat.exit_code, 0) << cat.err;
  EXPECT_EQ(cat.err, "") << "srec_cat warns";
  EXPECT_EQ(read_bytes(folder / "by_srec_cat"), blob);
  const auto copy = run_program("objcopy", {"-I", c.bfd, "-O", "binary", folder / "image", folder / "by_objcopy"});
  ASSERT_EQ(copy.exit_code, 0) << copy.err;
  EXPECT_EQ(read_bytes(folder / "by_objcopy"), blob);
}

TEST(Export, SrecCatFindsTheSlotAtItsAddress) {
  const tests::TemporaryFolder folder;
  const auto run = run_mdhcal({"export", blob_path, "--format", "hex", "--address", "0x08040000", "--slot", "--sequence",
                               "4294967295", "-o", folder / "slot.hex"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  tests::write_bytes(folder / "expected", with_header(blob_path, "FFFFFFFF"));
  const auto same = run_program("srec_cmp", {folder / "slot.hex", "-intel", folder / "expected", "-binary", "-offset", "0x08040000"});
  EXPECT_EQ(same.exit_code, 0) << same.err;
}

TEST(Export, BinIsTheBytes) {
  const tests::TemporaryFolder folder;
  ASSERT_EQ(run_mdhcal({"export", blob_path, "--format", "bin", "-o", folder / "a.bin"}).exit_code, 0);
  EXPECT_EQ(read_bytes(folder / "a.bin"), read_bytes(blob_path));
  ASSERT_EQ(run_mdhcal({"export", blob_path, "--format", "bin", "--slot", "--sequence", "513", "-o", folder / "b.bin"}).exit_code, 0);
  EXPECT_EQ(read_bytes(folder / "b.bin"), with_header(blob_path, "01020000"));
}

TEST(Export, TheArrayCompilesInCAndInCxx) {
  const tests::TemporaryFolder folder;
  ASSERT_EQ(run_mdhcal({"export", blob_path, "--format", "c", "--symbol", "factory_blob", "-o", folder / "blob.c"}).exit_code, 0);
  tests::write_bytes(folder / "main.c",
                     "#include <stdio.h>\n"
                     "extern const unsigned char factory_blob[8160];\n"
                     "int main(void) { return fwrite(factory_blob, 1, sizeof factory_blob, stdout) != 8160; }\n");
  const std::vector<std::string> strict{"-Wall", "-Wextra", "-pedantic", "-Werror"};
  const std::vector<std::string> languages[] = {{"gcc", "-std=c99"}, {"gcc", "-x", "c++", "-std=c++17"}};
  for (const auto& language : languages) {
    std::vector<std::string> arguments(language.begin() + 1, language.end());
    arguments.insert(arguments.end(), strict.begin(), strict.end());
    for (const std::string& more : {std::string("-c"), folder / "blob.c", std::string("-o"), folder / "blob.o"}) arguments.push_back(more);
    const auto compile = run_program(language[0], arguments);
    ASSERT_EQ(compile.exit_code, 0) << compile.err;
    // Linked with C either way: the C++ array has C linkage.
    const auto link = run_program("gcc", {folder / "main.c", folder / "blob.o", "-o", folder / "print"});
    ASSERT_EQ(link.exit_code, 0) << link.err;
    EXPECT_EQ(run_program(folder / "print", {}).out, read_bytes(blob_path));
  }
}

TEST(Export, RefusesWhatItCannotPlace) {
  const tests::TemporaryFolder folder;
  const std::vector<std::vector<std::string>> wrong{
      {"--format", "hex"},                                         // no address
      {"--format", "srec", "--address", "0xFFFFF020"},             // beyond 32 bits
      {"--format", "hex", "--address", "0x100000000"},
      {"--format", "hex", "--address", "0x08040004"},              // not on a granule
      {"--format", "hex", "--address", "0x"},
      {"--format", "hex", "--address", "-32"},
      {"--format", "hex", "--address", "here"},
      {"--format", "elf", "--address", "0"},
      {"--format", "c", "--symbol", "9lives"},
      {"--format", "c", "--symbol", "a;b"},
      {"--format", "bin", "--sequence", "2"},                      // without --slot
  };
  for (const auto& options : wrong) {
    std::vector<std::string> arguments{"export", blob_path, "-o", folder / "none"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const auto run = run_mdhcal(arguments);
    EXPECT_NE(run.exit_code, 0) << options.back();
    EXPECT_NE(run.err, "") << options.back();
    EXPECT_TRUE(tests::names_in(folder.path()).empty());
  }
  tests::write_bytes(folder / "damaged.blob", read_bytes(blob_path).replace(200, 1, "x"));
  EXPECT_NE(run_mdhcal({"export", folder / "damaged.blob", "--format", "bin", "-o", folder / "none"}).exit_code, 0);
}

}  // namespace
}  // namespace mdhcal::offline
