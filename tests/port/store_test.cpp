// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "store_fixture.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

constexpr FlashGeometry h7{32, 8192, 2, 0xFF};

TEST(Store, SlotsAreWholeSectors) {
  EXPECT_EQ(slot_bytes({32, 8192, 2, 0xFF}), 8192U);
  EXPECT_EQ(slot_bytes({8, 2048, 8, 0xFF}), 8192U);
  EXPECT_EQ(slot_bytes({8, 3072, 6, 0xFF}), 9216U);
  EXPECT_EQ(slot_bytes({1, 8192, 2, 0x00}), 8192U);
  EXPECT_EQ(slot_bytes({32, 131072, 2, 0xFF}), 131072U);
}

TEST(Store, RefusesAGeometryThatItCannotUse) {
  const FlashGeometry unusable[] = {{0, 8192, 2, 0xFF},  {24, 8184, 2, 0xFF},   {512, 8192, 2, 0xFF}, {32, 0, 2, 0xFF},
                                    {32, 8200, 2, 0xFF}, {32, 8192, 1, 0xFF},   {8, 2048, 7, 0xFF},   {32, 8192, 2, 0x55},
                                    {32, 16, 1000, 0xFF}, {32, 1U << 30, 3, 0xFF}, {32, 0xFFFFFFE0U, 2, 0xFF}};
  for (const FlashGeometry& geometry : unusable) {
    EXPECT_EQ(slot_bytes(geometry), 0U);
    FakeFlash fake(h7);
    fake.flash.geometry = geometry;
    TestStore store(fake);
    EXPECT_EQ(store.start(), Status::flash_geometry);
    EXPECT_EQ(erase_store(fake.flash, store.state), Status::flash_geometry);
    EXPECT_EQ(store.state.examined, 0);
    store.state = {1, -1, 0, {Status::ok, Status::ok}};
    EXPECT_EQ(store.put(blob_of(1)), Status::flash_geometry);
    EXPECT_EQ(fake.operations, 0);
  }
}

TEST(Store, AnErasedFlashIsEmptyAndTakesAFirstBlob) {
  FakeFlash fake(h7);
  TestStore store(fake);
  ASSERT_EQ(store.start(), Status::store_empty);
  EXPECT_EQ(store.state.slot[0], Status::blob_magic);
  EXPECT_EQ(store.state.slot[1], Status::blob_magic);
  ASSERT_EQ(store.put(blob_of(1)), Status::ok);
  TestStore again(fake);
  ASSERT_EQ(again.start(), Status::ok);
  EXPECT_EQ(again.loader.taken, blob_of(1));
  EXPECT_EQ(fake.violations, 0);
}

TEST(Store, UpdatesTakeTurnsAndTheNewestWins) {
  FakeFlash fake(h7);
  TestStore store(fake);
  ASSERT_EQ(store.start(), Status::store_empty);
  for (std::uint32_t i = 1; i <= 20; ++i) {
    const std::int32_t before = store.state.active;
    ASSERT_EQ(store.put(blob_of(i)), Status::ok);
    EXPECT_NE(store.state.active, before);
    TestStore again(fake);
    ASSERT_EQ(again.start(), Status::ok);
    EXPECT_EQ(again.loader.taken, blob_of(i));
    EXPECT_EQ(again.state.sequence, i);
    EXPECT_EQ(again.loader.asked, 1);
  }
  EXPECT_EQ(fake.violations, 0);
}

TEST(Store, AFactoryImageInEitherSlotIsFound) {
  for (std::uint32_t slot : {0U, 1U}) {
    FakeFlash fake(h7);
    ASSERT_EQ(flash_factory(fake, slot, 7, blob_of(3)), Status::ok);
    TestStore store(fake);
    ASSERT_EQ(store.start(), Status::ok);
    EXPECT_EQ(store.state.active, static_cast<std::int32_t>(slot));
    EXPECT_EQ(store.loader.taken, blob_of(3));
  }
}

TEST(Store, ABadNewBlobNeverHidesAGoodOldOne) {
  FakeFlash fake(h7);
  ASSERT_EQ(flash_factory(fake, 0, 4, blob_of(1)), Status::ok);
  ASSERT_EQ(flash_factory(fake, 1, 9, blob_of(2)), Status::ok);
  TestStore store(fake);
  const Blob bad = blob_of(2);
  store.loader.refused = &bad;
  ASSERT_EQ(store.start(), Status::ok);
  EXPECT_EQ(store.state.active, 0);
  EXPECT_EQ(store.state.slot[1], Status::blob_serial);
  EXPECT_EQ(store.loader.taken, blob_of(1));
  // The next update goes over the bad one, and wins.
  ASSERT_EQ(store.put(blob_of(3)), Status::ok);
  TestStore again(fake);
  ASSERT_EQ(again.start(), Status::ok);
  EXPECT_EQ(again.loader.taken, blob_of(3));
  EXPECT_EQ(fake.violations, 0);
}

TEST(Store, ARefusedUpdateTouchesNothing) {
  FakeFlash fake(h7);
  ASSERT_EQ(flash_factory(fake, 0, 1, blob_of(1)), Status::ok);
  TestStore store(fake);
  ASSERT_EQ(store.start(), Status::ok);
  const Blob refused = blob_of(2);
  Blob damaged = blob_of(3);
  damaged[100] ^= 1;
  store.loader.refused = &refused;
  const std::vector<std::uint8_t> before = fake.bytes;
  const StoreState state = store.state;
  EXPECT_EQ(store.put(refused), Status::blob_serial);
  EXPECT_EQ(store.put(damaged), Status::blob_crc);
  EXPECT_EQ(update(fake.flash, store.loader.loader, refused.data(), blob_size - 1, store.state), Status::blob_size);
  EXPECT_EQ(update(fake.flash, store.loader.loader, nullptr, blob_size, store.state), Status::bad_input);
  StoreState unknown{};
  EXPECT_EQ(update(fake.flash, store.loader.loader, refused.data(), blob_size, unknown), Status::bad_input);
  EXPECT_EQ(fake.bytes, before);
  EXPECT_EQ(store.state.active, state.active);
  EXPECT_EQ(store.state.sequence, state.sequence);
}

// A header that belongs to another blob, as a mix of two images would leave it.
TEST(Store, AHeaderOfAnotherBlobIsRefused) {
  FakeFlash fake(h7);
  ASSERT_EQ(flash_factory(fake, 0, 1, blob_of(1)), Status::ok);
  const Blob other = blob_of(2);
  std::memcpy(fake.bytes.data() + slot_header_size, other.data(), other.size());
  TestStore store(fake);
  ASSERT_EQ(store.start(), Status::store_empty);
  EXPECT_EQ(store.state.slot[0], Status::blob_crc);
  EXPECT_EQ(store.loader.asked, 0);
}

TEST(Store, AFlashThatCannotBeReadIsNotCalledEmpty) {
  FakeFlash fake(h7);
  ASSERT_EQ(flash_factory(fake, 0, 1, blob_of(1)), Status::ok);
  fake.readable = false;
  TestStore store(fake);
  EXPECT_EQ(store.start(), Status::store_unreadable);
  EXPECT_EQ(store.state.slot[0], Status::flash_read);
  EXPECT_EQ(store.state.slot[1], Status::flash_read);
}

TEST(Store, TheSequenceWrapsAround) {
  for (std::uint32_t first : {0xFFFFFFFEU, 0x7FFFFFFEU, 0xFFFFFFFFU}) {
    FakeFlash fake(h7);
    ASSERT_EQ(flash_factory(fake, 0, first, blob_of(100)), Status::ok);
    TestStore store(fake);
    ASSERT_EQ(store.start(), Status::ok);
    for (std::uint32_t i = 0; i < 5; ++i) {
      ASSERT_EQ(store.put(blob_of(i)), Status::ok);
      TestStore again(fake);
      ASSERT_EQ(again.start(), Status::ok);
      EXPECT_EQ(again.loader.taken, blob_of(i));
      EXPECT_EQ(again.state.sequence, first + 1 + i);
    }
  }
}

// Every operation fails once, power on: the update says so, the old blob stays, and stays after a restart too.
TEST(Store, AFailedOperationKeepsTheOldBlob) {
  for (const FlashGeometry& geometry : {h7, FlashGeometry{256, 2048, 8, 0x00}}) {
    FakeFlash factory(geometry);
    ASSERT_EQ(flash_factory(factory, 0, 1, blob_of(1)), Status::ok);
    FakeFlash fake(geometry);
    int failures = 0;
    for (int operation = 0;; ++operation) {
      fake.restore(factory);
      TestStore store(fake);
      ASSERT_EQ(store.start(), Status::ok);
      const int begin = fake.operations;
      fake.fail_at(begin + operation);
      const Status status = store.put(blob_of(2));
      const bool reached = fake.operations > begin + operation;
      if (!reached) break;
      TestStore again(fake);
      fake.fail_at(-1);
      ASSERT_EQ(again.start(), Status::ok);
      if (status == Status::ok) {
        ASSERT_EQ(again.loader.taken, blob_of(2));
      } else {
        ++failures;
        ASSERT_EQ(store.state.active, 0);
        ASSERT_EQ(again.loader.taken, blob_of(1)) << "operation " << operation;
      }
      ASSERT_EQ(again.put(blob_of(3)), Status::ok);
      ASSERT_EQ(fake.violations, 0);
    }
    EXPECT_GT(failures, 30);
  }
}

}  // namespace
