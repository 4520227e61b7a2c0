// SPDX-License-Identifier: MIT
// The store through its C header does what it does in C++: the same operations on the same flash, the same state.
#include <gtest/gtest.h>

#include "mdhcal_port.h"
#include "store_fixture.hpp"

namespace mdhcal::test {

namespace {

constexpr FlashGeometry geometry = {32, 4096, 4, 0xFF};

// The fake behind a driver in C, whose failures have numbers of their own.
mdhcal_flash in_c(FakeFlash& fake) {
  return {{geometry.granule_bytes, geometry.sector_bytes, geometry.sector_count, geometry.erased_value},
          [](void* context, std::uint32_t address, std::uint8_t* to, std::uint32_t size) -> std::int32_t {
            const Flash& flash = static_cast<FakeFlash*>(context)->flash;
            return flash.read(flash.context, address, to, size) == Status::ok ? 0 : -5;
          },
          [](void* context, std::uint32_t address, const std::uint8_t* granule) -> std::int32_t {
            const Flash& flash = static_cast<FakeFlash*>(context)->flash;
            return flash.program(flash.context, address, granule) == Status::ok ? 0 : -6;
          },
          [](void* context, std::uint32_t address) -> std::int32_t {
            const Flash& flash = static_cast<FakeFlash*>(context)->flash;
            return flash.erase(flash.context, address) == Status::ok ? 0 : 7;
          },
          &fake};
}

std::int32_t take(const std::uint8_t* blob, std::size_t size, void* context) {
  const Loader& loader = static_cast<TestLoader*>(context)->loader;
  return static_cast<std::int32_t>(loader.load(blob, size, loader.context));
}

struct StoreInC {
  explicit StoreInC(FakeFlash& fake) : flash(in_c(fake)) {}
  std::int32_t start() { return mdhcal_load_newest(&flash, &judge, buffer, &state); }
  std::int32_t put(const Blob& blob) { return mdhcal_update(&flash, &judge, blob.data(), blob.size(), &state); }

  mdhcal_flash flash;
  TestLoader loader;
  mdhcal_judge judge{take, &loader};
  mdhcal_store_state state{};
  std::uint8_t buffer[MDHCAL_BLOB_BYTES]{};
};

void expect_same(const mdhcal_store_state& c, const StoreState& cpp) {
  EXPECT_EQ(c.examined, cpp.examined);
  EXPECT_EQ(c.active, cpp.active);
  EXPECT_EQ(c.sequence, cpp.sequence);
  for (int k = 0; k < 2; ++k) EXPECT_EQ(c.slot[k], static_cast<std::int32_t>(cpp.slot[k]));
}

}  // namespace

// Whatever operation of a start and two updates fails or is cut, both report and keep the same.
TEST(StoreInC, DoesAtEveryFailureWhatTheStoreDoes) {
  int failed = 0;
  for (int operation = -1; operation < 1200; operation = operation < 8 ? operation + 1 : operation + 37) {
    FakeFlash one(geometry), other(geometry);
    one.fail_at(operation);
    other.fail_at(operation);
    StoreInC c(one);
    TestStore cpp(other);
    const Blob first = blob_of(1), second = blob_of(2);
    EXPECT_EQ(c.start(), static_cast<std::int32_t>(cpp.start())) << operation;
    expect_same(c.state, cpp.state);
    for (const Blob* blob : {&first, &second}) {
      cpp.loader.refused = c.loader.refused = operation % 2 == 0 ? &second : nullptr;
      const std::int32_t status = c.put(*blob);
      EXPECT_EQ(status, static_cast<std::int32_t>(cpp.put(*blob))) << operation;
      expect_same(c.state, cpp.state);
      failed += status == MDHCAL_FLASH_READ || status == MDHCAL_FLASH_PROGRAM || status == MDHCAL_FLASH_ERASE ? 1 : 0;
    }
    EXPECT_EQ(c.start(), static_cast<std::int32_t>(cpp.start())) << operation;
    expect_same(c.state, cpp.state);
    EXPECT_EQ(one.bytes, other.bytes) << operation;
    EXPECT_EQ(mdhcal_erase_store(&c.flash, &c.state), static_cast<std::int32_t>(erase_store(other.flash, cpp.state)));
    expect_same(c.state, cpp.state);
  }
  EXPECT_GT(failed, 5);
}

TEST(StoreInC, RefusesWhatIsMissing) {
  FakeFlash fake(geometry);
  StoreInC store(fake);
  EXPECT_EQ(mdhcal_slot_bytes(&store.flash.geometry), slot_bytes(geometry));
  EXPECT_EQ(mdhcal_slot_bytes(nullptr), 0U);
  const Blob blob = blob_of(1);
  EXPECT_EQ(store.put(blob), MDHCAL_BAD_INPUT);  // before load_newest
  EXPECT_EQ(mdhcal_load_newest(nullptr, &store.judge, store.buffer, &store.state), MDHCAL_BAD_INPUT);
  EXPECT_EQ(mdhcal_load_newest(&store.flash, nullptr, store.buffer, &store.state), MDHCAL_BAD_INPUT);
  EXPECT_EQ(mdhcal_load_newest(&store.flash, &store.judge, nullptr, &store.state), MDHCAL_BAD_INPUT);
  EXPECT_EQ(mdhcal_load_newest(&store.flash, &store.judge, store.buffer, nullptr), MDHCAL_BAD_INPUT);
  EXPECT_EQ(mdhcal_update(&store.flash, &store.judge, nullptr, blob_size, &store.state), MDHCAL_BAD_INPUT);
  EXPECT_EQ(mdhcal_erase_store(&store.flash, nullptr), MDHCAL_BAD_INPUT);
  mdhcal_flash without = store.flash;
  without.erase = nullptr;
  EXPECT_EQ(mdhcal_erase_store(&without, &store.state), MDHCAL_BAD_INPUT);
  EXPECT_EQ(store.state.examined, 0);
}

}  // namespace mdhcal::test
