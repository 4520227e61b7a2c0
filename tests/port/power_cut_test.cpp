// SPDX-License-Identifier: MIT
// The power is cut at every operation of an update, and then at every operation of the recovery: start, and the next
// update. What the store finds is always the old blob or the new one, and the next update works.
#include <gtest/gtest.h>

#include <cstdio>

#include "store_fixture.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

struct Sweep {
  FakeFlash work;
  const Blob old_blob = blob_of(1);
  const Blob new_blob = blob_of(2);
  const Blob next_blob = blob_of(3);
  const Blob last_blob = blob_of(4);
  int cuts = 0;

  explicit Sweep(const FlashGeometry& geometry) : work(geometry) {}

  // Starts on what `work` holds and makes one more update; both must succeed with the power on.
  void expect_sound(bool may_be_old, bool may_be_new, bool may_be_next) {
    TestStore store(work);
    work.power_up();
    ASSERT_EQ(store.start(), Status::ok);
    const bool known = (may_be_old && store.loader.taken == old_blob) || (may_be_new && store.loader.taken == new_blob) ||
                       (may_be_next && store.loader.taken == next_blob);
    ASSERT_TRUE(known);
    ASSERT_EQ(store.put(last_blob), Status::ok);
    TestStore again(work);
    ASSERT_EQ(again.start(), Status::ok);
    ASSERT_EQ(again.loader.taken, last_blob);
    ASSERT_EQ(work.violations, 0);
  }

  // One start and one update with the power cut at `operation`. Returns whether the cut was met.
  bool attempt(const FakeFlash& from, const Blob& blob, int operation, Torn mode, Status& status) {
    work.restore(from);
    work.cut_at(operation, mode);
    TestStore store(work);
    status = store.start();
    if (status == Status::ok) status = store.put(blob);
    return !work.powered;
  }

  // `every_mode`: each second cut in all five modes, else in one that changes from cut to cut. The second cuts lie
  // `stride` operations apart, their first moving on with the first cut.
  void run(std::uint32_t sequence, std::uint32_t slot, bool every_mode, int stride) {
    FakeFlash factory(work.flash.geometry);
    ASSERT_EQ(flash_factory(factory, slot, sequence, old_blob), Status::ok);
    ASSERT_EQ(flash_factory(factory, 1 - slot, sequence - 1, blob_of(0)), Status::ok);
    FakeFlash after(work.flash.geometry);
    for (Torn first_mode : torn_modes) {
      Status status = Status::ok;
      for (int first = 0; attempt(factory, new_blob, first, first_mode, status); ++first) {
        // A cut read leaves the flash as it is, whatever the mode.
        if (work.cut_met_a_read && first_mode != Torn::untouched) continue;
        after.restore(work);
        const bool committed = status == Status::ok;
        ++cuts;
        expect_sound(!committed, true, false);
        if (::testing::Test::HasFatalFailure()) {
          FAIL() << "first cut at operation " << first << ", mode " << static_cast<int>(first_mode);
        }
        int turn = first;
        for (Torn second_mode : torn_modes) {
          if (!every_mode && second_mode != torn_modes.front()) break;
          const auto mode_of = [&](int second) {
            return every_mode ? second_mode : torn_modes[static_cast<std::size_t>(turn + second) % torn_modes.size()];
          };
          for (int second = first % stride; attempt(after, next_blob, second, mode_of(second), status); second += stride) {
            if (work.cut_met_a_read && mode_of(second) != Torn::untouched) continue;
            ++cuts;
            const bool replaced = status == Status::ok;
            expect_sound(!replaced && !committed, !replaced, true);
            if (::testing::Test::HasFatalFailure()) {
              FAIL() << "cuts at operations " << first << " and " << second << ", modes " << static_cast<int>(first_mode)
                     << " and " << static_cast<int>(mode_of(second));
            }
          }
        }
      }
    }
  }
};

void sweep(const FlashGeometry& geometry, std::initializer_list<std::uint32_t> sequences, bool every_mode, int stride) {
  int cuts = 0;
  for (std::uint32_t sequence : sequences) {
    Sweep run(geometry);
    run.run(sequence, sequence == 5U ? 0 : 1, every_mode, stride);
    if (::testing::Test::HasFatalFailure()) return;
    cuts += run.cuts;
  }
  std::printf("granule %u, sector %u, erased 0x%02X: %d power cuts, always the old blob or the new one\n",
              static_cast<unsigned>(geometry.granule_bytes), static_cast<unsigned>(geometry.sector_bytes),
              static_cast<unsigned>(geometry.erased_value), cuts);
  EXPECT_GT(cuts, 2000);
}

TEST(PowerCut, OldOrNewOnLargeGranulesInEveryMode) { sweep({256, 8192, 2, 0xFF}, {0xFFFFFFFFU}, true, 1); }

TEST(PowerCut, OldOrNewOnSlotsOfSeveralSectorsErasedToZero) {
  sweep({256, 1536, 12, 0x00}, {5U, 0xFFFFFFFFU, 0x7FFFFFFFU}, false, 1);
}

// The flash word of an STM32H7: more than 130 operations that change the flash. An emulator would take minutes for
// every pair of cuts.
TEST(PowerCut, OldOrNewOnGranulesOf32Bytes) {
#ifdef MDHCAL_EMULATED
  constexpr int stride = 20;
#else
  constexpr int stride = 1;
#endif
  sweep({32, 8192, 2, 0xFF}, {0xFFFFFFFFU}, false, stride);
}

}  // namespace
