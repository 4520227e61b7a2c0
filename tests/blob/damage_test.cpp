// SPDX-License-Identifier: MIT
// Damaged bytes: every one is refused and leaves the model alone.
#include <gtest/gtest.h>

#include <random>

#include "tests/blob/support.hpp"

namespace mdhcal::test {
namespace {

// The reason that is due when the byte at `offset` is damaged and the CRC is not repaired.
Status reason(std::size_t offset) {
  if (offset < blob_layout::major) return Status::blob_magic;
  if (offset < blob_layout::minor) return Status::blob_version;
  if (offset < blob_layout::stated_size) return Status::blob_crc;
  if (offset < blob_layout::layout_id) return Status::blob_size;
  if (offset < blob_layout::flags) return Status::blob_layout;
  return Status::blob_crc;
}

TEST(Damage, EverySingleBitFlipIsRefusedWithItsReason) {
  Bytes bytes = copy_of(golden::every_field);
  Watched watched;
  for (std::size_t bit = 0; bit < 8 * blob_size; ++bit) {
    const auto mask = static_cast<std::uint8_t>(1U << (bit % 8));
    bytes[bit / 8] ^= mask;
    ASSERT_EQ(decode(bytes.data(), bytes.size(), {}, *watched.model), reason(bit / 8)) << "bit " << bit;
    bytes[bit / 8] ^= mask;
  }
  EXPECT_TRUE(watched.untouched());
  EXPECT_EQ(decode(bytes.data(), bytes.size(), {}, *watched.model), Status::ok);
}

TEST(Damage, EveryOtherSizeIsRefused) {
  // A copy of exactly that size, so that a sanitizer sees any read behind its end.
  Watched watched;
  for (std::size_t size = 0; size < blob_size; ++size) {
    const auto part = std::make_unique<std::uint8_t[]>(size);
    std::memcpy(part.get(), golden::every_field, size);
    ASSERT_EQ(decode(part.get(), size, {}, *watched.model), Status::blob_size) << size;
  }
  EXPECT_EQ(decode(golden::every_field, blob_size + 1, {}, *watched.model), Status::blob_size);
  EXPECT_EQ(decode(golden::every_field, SIZE_MAX, {}, *watched.model), Status::blob_size);
  EXPECT_EQ(decode(nullptr, 0, {}, *watched.model), Status::blob_size);
  EXPECT_EQ(decode(nullptr, blob_size, {}, *watched.model), Status::blob_size);
  EXPECT_TRUE(watched.untouched());
}

// A burst begins with a flipped bit, is at most 32 bits long, and lies inside the blob.
void refuse_bursts(std::size_t offset_step, int bursts, std::uint32_t seed) {
  std::mt19937_64 random(seed);
  Bytes bytes = copy_of(golden::every_field);
  Watched watched;
  for (std::size_t offset = seed % offset_step; offset < 8 * blob_size; offset += offset_step) {
    for (int burst = 0; burst < bursts; ++burst) {
      const std::uint64_t pattern = (random() & 0xFFFFFFFFU) | 1U;
      for (int pass = 0; pass < 2; ++pass) {
        for (std::size_t k = 0; k < 32 && offset + k < 8 * blob_size; ++k) {
          const std::size_t bit = offset + k;
          bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ ((pattern >> k) & 1U) << (bit % 8));
        }
        if (pass == 0) {
          ASSERT_NE(decode(bytes.data(), bytes.size(), {}, *watched.model), Status::ok)
              << "offset " << offset << " pattern " << pattern;
        }
      }
    }
  }
  EXPECT_TRUE(watched.untouched());
}

// 64 bursts at each of the 32 768 bit offsets, in four parts; thinned on emulated targets.
#ifdef MDHCAL_EMULATED
constexpr std::size_t thinning = 97;
constexpr int bursts_at_an_offset = 4;
#else
constexpr std::size_t thinning = 1;
constexpr int bursts_at_an_offset = 64;
#endif
class Bursts : public testing::TestWithParam<std::uint32_t> {};
TEST_P(Bursts, AreRefusedAtEveryOffset) { refuse_bursts(4 * thinning, bursts_at_an_offset, GetParam()); }
INSTANTIATE_TEST_SUITE_P(Damage, Bursts, testing::Range<std::uint32_t>(0, 4));

}  // namespace
}  // namespace mdhcal::test
