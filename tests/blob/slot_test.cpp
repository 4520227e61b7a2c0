// SPDX-License-Identifier: MIT
#include "mdhcal/slot.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>

namespace mdhcal {
namespace {

// By hand from docs/blob.md; the last four bytes are zlib's CRC-32 of the 28 before.
constexpr std::array<std::uint8_t, 32> by_hand{0xFD, 0xA0, 0xB2, 0xEC, 0x04, 0x03, 0x02, 0x01, 0xDD, 0xCC, 0xBB,
                                               0xAA, 0,    0,    0,    0,    0,    0,    0,    0,    0,    0,
                                               0,    0,    0,    0,    0,    0,    0x3F, 0xAD, 0xE9, 0x36};

TEST(SlotHeader, IsTheOneMadeByHand) {
  std::array<std::uint8_t, 32> bytes;
  bytes.fill(0xFF);
  encode_slot_header({0x01020304U, 0xAABBCCDDU}, bytes.data());
  EXPECT_EQ(bytes, by_hand);
  SlotHeader header{};
  ASSERT_EQ(decode_slot_header(by_hand.data(), header), Status::ok);
  EXPECT_EQ(header.sequence, 0x01020304U);
  EXPECT_EQ(header.blob_crc, 0xAABBCCDDU);
}

TEST(SlotHeader, RefusesErasedAndDamagedBytes) {
  SlotHeader header{7, 8};
  for (const int fill : {0x00, 0xFF}) {
    std::array<std::uint8_t, 32> erased;
    erased.fill(static_cast<std::uint8_t>(fill));
    EXPECT_EQ(decode_slot_header(erased.data(), header), Status::blob_magic);
  }
  for (std::size_t bit = 0; bit < 256; ++bit) {
    auto damaged = by_hand;
    damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ 1U << (bit % 8));
    EXPECT_NE(decode_slot_header(damaged.data(), header), Status::ok) << bit;
  }
  EXPECT_EQ(header.sequence, 7U);
  EXPECT_EQ(header.blob_crc, 8U);
}

TEST(SlotHeader, SequencesWrap) {
  EXPECT_TRUE(newer(1, 0));
  EXPECT_FALSE(newer(0, 1));
  EXPECT_FALSE(newer(5, 5));
  EXPECT_TRUE(newer(0, 0xFFFFFFFFU));
  EXPECT_TRUE(newer(0x7FFFFFFFU, 0));
  EXPECT_FALSE(newer(0x80000000U, 0));
}

}  // namespace
}  // namespace mdhcal
