// SPDX-License-Identifier: MIT
// Reads fail, for one operation or for many, in one slot or in both, and the power may go as well. A session is a start and an
// update. After a reset, with all reads working again:
// - an update that reported success is what the next start takes;
// - otherwise that is the new blob, or one no older than the blob that was in use;
// - in a session in which no blob came into use, nothing was lost: the newest good blob is still found;
// - the update after that works, and is found.
#include <gtest/gtest.h>

#include <cstdio>

#include "store_fixture.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

constexpr int until_reset = 1 << 30;
constexpr std::uint32_t sequence = 0xFFFFFFFFU;  // the next one wraps
#ifdef MDHCAL_EMULATED
constexpr int stride = 19;  // an emulator takes minutes for every operation
#else
constexpr int stride = 1;
#endif

// The numbers that the blobs of a flash have in blob_of(), oldest first. The newest good one is always 2.
enum : std::uint32_t { older = 1, newest = 2, fresh = 3, last = 4, damaged = 5 };

void damage(FakeFlash& flash, std::uint32_t slot) {
  flash.bytes[slot * slot_bytes(flash.flash.geometry) + 1000] ^= 1U;
}

// What a flash may hold when the session begins.
using Fill = void (*)(FakeFlash&, std::uint32_t slot);
void only_one(FakeFlash& flash, std::uint32_t slot) {
  ASSERT_EQ(flash_factory(flash, slot, sequence, blob_of(newest)), Status::ok);
}
void two_good(FakeFlash& flash, std::uint32_t slot) {
  only_one(flash, slot);
  ASSERT_EQ(flash_factory(flash, 1 - slot, sequence - 1U, blob_of(older)), Status::ok);
}
void beside_a_damaged_newer_one(FakeFlash& flash, std::uint32_t slot) {
  only_one(flash, slot);
  ASSERT_EQ(flash_factory(flash, 1 - slot, sequence + 1U, blob_of(damaged)), Status::ok);
  damage(flash, 1 - slot);
}
void beside_a_damaged_older_one(FakeFlash& flash, std::uint32_t slot) {
  only_one(flash, slot);
  ASSERT_EQ(flash_factory(flash, 1 - slot, sequence - 1U, blob_of(damaged)), Status::ok);
  damage(flash, 1 - slot);
}
void beside_a_torn_header(FakeFlash& flash, std::uint32_t slot) {
  only_one(flash, slot);
  flash.cut_at(flash.operations, Torn::ecc);
  std::vector<std::uint8_t> granule(flash.flash.geometry.granule_bytes);
  ASSERT_NE(flash.flash.program(&flash, (1 - slot) * slot_bytes(flash.flash.geometry), granule.data()), Status::ok);
  flash.power_up();
}
constexpr Fill fills[] = {only_one, two_good, beside_a_damaged_newer_one, beside_a_damaged_older_one, beside_a_torn_header};

struct Session {
  Status started = Status::ok, updated = Status::ok;
  std::uint32_t in_use = 0;  // number of its blob; 0: none
  int operations = 0;
};

std::uint32_t number_of(const Blob& blob) {
  for (std::uint32_t number : {older, newest, fresh, last}) {
    if (blob == blob_of(number)) return number;
  }
  return 0;
}

// One start and, whatever came of it, one update.
Session run(FakeFlash& flash) {
  Session session;
  TestStore store(flash);
  session.started = store.start();
  if (session.started == Status::ok) session.in_use = number_of(store.loader.taken);
  session.updated = store.put(blob_of(fresh));
  session.operations = flash.operations;
  return session;
}

void expect_nothing_lost(FakeFlash& flash, const Session& session) {
  flash.power_up();
  TestStore next(flash);
  ASSERT_EQ(next.start(), Status::ok);
  const std::uint32_t found = number_of(next.loader.taken);
  if (session.updated == Status::ok) {
    ASSERT_EQ(found, fresh);
  } else if (found != fresh) {
    ASSERT_EQ(found == newest || (session.in_use != 0 && found >= session.in_use), true) << "found blob " << found;
  }
  ASSERT_EQ(next.put(blob_of(last)), Status::ok);
  TestStore again(flash);
  ASSERT_EQ(again.start(), Status::ok);
  ASSERT_EQ(number_of(again.loader.taken), last);
  ASSERT_EQ(flash.violations, 0);
}

// Reads that fail for a while: `length` operations from each one on, in one slot or in both.
template <class Visit>
void for_each_failure(const FakeFlash& full, FakeFlash& work, int step, Visit visit) {
  const std::uint32_t slot_size = slot_bytes(full.flash.geometry);
  const std::uint32_t begins[] = {0, 0, slot_size}, ends[] = {2 * slot_size, slot_size, 2 * slot_size};
  for (int where = 0; where < 3; ++where) {
    for (int length : {1, 2, 5, until_reset}) {
      for (int from = 0;; from += step) {
        const auto fail = [&] {
          work.restore(full);
          work.fail_reads(from, length == until_reset ? until_reset : from + length, begins[where], ends[where]);
        };
        fail();
        const Session session = run(work);
        if (session.operations <= from) break;
        if (work.failed_reads == 0) continue;
        visit(fail, session, from);
        if (::testing::Test::HasFatalFailure()) {
          FAIL() << "operation " << from << ", " << length << " long, place " << where;
        }
      }
    }
  }
}

TEST(ReadFailure, LosesNoBlobAndIsNeverTakenForAnEmptySlot) {
  for (const FlashGeometry& geometry : {FlashGeometry{32, 8192, 2, 0xFF}, FlashGeometry{256, 1536, 12, 0x00}}) {
    FakeFlash work(geometry);
    int sessions = 0;
    for (std::size_t kind = 0; kind < std::size(fills); ++kind) {
      for (std::uint32_t slot : {0U, 1U}) {
        FakeFlash full(geometry);
        fills[kind](full, slot);
        for_each_failure(full, work, stride, [&](const auto&, const Session& session, int) {
          ++sessions;
          expect_nothing_lost(work, session);
          if (::testing::Test::HasFatalFailure()) FAIL() << "fill " << kind << ", slot " << slot;
        });
        if (::testing::Test::HasFatalFailure()) return;
      }
    }
    std::printf("granule %u: %d sessions with failing reads, no blob lost\n", static_cast<unsigned>(geometry.granule_bytes),
                sessions);
    EXPECT_GT(sessions, 200);
  }
}

// The same with a power cut at every later operation.
TEST(ReadFailure, AndAPowerCutLoseNoBlob) {
  const FlashGeometry geometry{256, 8192, 2, 0xFF};
  FakeFlash work(geometry);
  int cuts = 0;
  for (std::size_t kind = 0; kind < std::size(fills); ++kind) {
    FakeFlash full(geometry);
    fills[kind](full, kind % 2 == 0 ? 0U : 1U);
    for_each_failure(full, work, stride, [&](const auto& fail, const Session& session, int from) {
      for (int cut = from + 1; cut < session.operations; cut += stride) {
        fail();
        work.cut_at(cut, torn_modes[static_cast<std::size_t>(cut + from) % torn_modes.size()]);
        const Session torn = run(work);
        ++cuts;
        expect_nothing_lost(work, torn);
        if (::testing::Test::HasFatalFailure()) FAIL() << "fill " << kind << ", cut at " << cut;
      }
    });
    if (::testing::Test::HasFatalFailure()) return;
  }
  std::printf("%d power cuts among failing reads, no blob lost\n", cuts);
  EXPECT_GT(cuts, 50);
}

// A controller whose flash interface has locked up until the next reset.
TEST(ReadFailure, NothingIsErasedWhileNothingCanBeRead) {
  for (std::uint32_t slot : {0U, 1U}) {
    FakeFlash flash({32, 8192, 2, 0xFF});
    only_one(flash, slot);
    const std::vector<std::uint8_t> before = flash.bytes;
    flash.power_up();
    flash.readable = false;
    const Session session = run(flash);
    EXPECT_EQ(session.started, Status::store_unreadable);
    EXPECT_EQ(session.updated, Status::store_unreadable);
    EXPECT_EQ(flash.bytes, before);
  }
}

// The blob in use cannot be read any more: the other slot is the last that is left.
TEST(ReadFailure, OfTheActiveSlotStopsAnUpdate) {
  FakeFlash flash({32, 8192, 2, 0xFF});
  two_good(flash, 1);
  TestStore store(flash);
  ASSERT_EQ(store.start(), Status::ok);
  const std::vector<std::uint8_t> before = flash.bytes;
  flash.fail_reads(0, until_reset, 8192, 16384);
  EXPECT_EQ(store.put(blob_of(fresh)), Status::store_unreadable);
  EXPECT_EQ(flash.bytes, before);
  EXPECT_EQ(store.state.active, 1);
}

// At the start the newer slot could not be read, at the update it can: the store is looked at again first.
TEST(ReadFailure, ThatHasPassedAsksForAnotherStart) {
  FakeFlash flash({32, 8192, 2, 0xFF});
  two_good(flash, 1);
  flash.power_up();
  flash.fail_reads(0, 4, 8192, 16384);
  TestStore store(flash);
  ASSERT_EQ(store.start(), Status::ok);
  ASSERT_EQ(number_of(store.loader.taken), older);
  EXPECT_EQ(store.put(blob_of(fresh)), Status::store_unreadable);
  ASSERT_EQ(store.start(), Status::ok);
  EXPECT_EQ(number_of(store.loader.taken), newest);
  EXPECT_EQ(store.put(blob_of(fresh)), Status::ok);
}

// A first update that was cut at its header leaves cells that cannot be read, and no other blob: only a person knows
// that nothing is lost.
TEST(ReadFailure, ForGoodIsGivenUpByNameOnly) {
  FakeFlash flash({32, 8192, 2, 0xFF});
  beside_a_torn_header(flash, 0);
  ASSERT_EQ(flash.flash.erase(&flash, 0), Status::ok);
  TestStore store(flash);
  ASSERT_EQ(store.start(), Status::store_unreadable);
  ASSERT_EQ(store.put(blob_of(fresh)), Status::store_unreadable);
  flash.fail_at(flash.operations + 1);
  EXPECT_EQ(erase_store(flash.flash, store.state), Status::flash_erase);
  EXPECT_EQ(store.state.slot[1], Status::flash_read);
  ASSERT_EQ(erase_store(flash.flash, store.state), Status::ok);
  ASSERT_EQ(store.put(blob_of(fresh)), Status::ok);
  TestStore again(flash);
  ASSERT_EQ(again.start(), Status::ok);
  EXPECT_EQ(number_of(again.loader.taken), fresh);
}

}  // namespace
