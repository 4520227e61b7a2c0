// SPDX-License-Identifier: MIT
// Two slots of flash, of which one always holds the last blob that was committed. A slot is a 32-byte header and the blob
// behind it, padded to whole granules; it begins at a sector. An update goes to the slot that is not active and programs
// granule 0, with the header, last: before that the slot is none, so a power cut leaves the old blob or the new one.
#pragma once

#include <cstdint>

#include "mdhcal/blob.hpp"
#include "mdhcal/port/flash.hpp"
#include "mdhcal/slot.hpp"

namespace mdhcal {

/// Judges a blob, and takes it: decode() into a model of the caller's, for one. The store has checked the CRC-32 before
/// it asks. Returns ok, or why the blob is refused.
struct Loader {
  Status (*load)(const std::uint8_t* blob, std::size_t size, void* context);
  void* context;
};

/// What the store knows of its slots. Filled in by load_newest(), kept up by update().
struct StoreState {
  std::int32_t examined;   ///< 1 after load_newest() has looked
  std::int32_t active;     ///< the slot whose blob is in use, 0 or 1; -1: none
  std::uint32_t sequence;  ///< of the active slot; 0 without one
  Status slot[2];          ///< ok, or why the slot was refused: a status of its reading (flash_read), its header or the loader
};

/// The size of a slot on this flash [bytes]: whole sectors. Slot 1 begins there. 0 if the geometry is unusable.
std::uint32_t slot_bytes(const FlashGeometry& geometry) noexcept;

/// Offers the newer slot's blob to the loader, and if that is refused the older one's: a new blob that is bad never hides
/// a good old one. Reads into `blob`. Returns ok, store_empty (both slots have been read and neither is acceptable;
/// state.slot says why), store_unreadable (nothing acceptable, and a slot could not be read: it may hold a good blob), or
/// flash_geometry (state untouched).
Status load_newest(const Flash& flash, const Loader& loader, std::uint8_t (&blob)[blob_size], StoreState& state) noexcept;

/// Commits a blob as the newest. The loader is asked first; nothing is erased for a blob that it refuses, nor for one
/// while what lies in flash is not known. Returns ok (the blob has been read back, and is now active), bad_input
/// (load_newest() has not been called), flash_geometry, blob_size, blob_crc, the loader's refusal, store_unreadable
/// (nothing is changed: the active slot's header cannot be read; or there is no active slot, and none that was read and refused;
/// or a slot that could not be read before can be read now: call load_newest() again), flash_erase, flash_program,
/// flash_read or flash_verify. After an error the active slot is what it was. A slot that still cannot be read is erased
/// for the update only while the other one is active. Blocks for the time of the erase and the programming: call it outside
/// the servo tick.
Status update(const Flash& flash, const Loader& loader, const std::uint8_t* blob, std::size_t size,
              StoreState& state) noexcept;

/// Erases both slots, whatever they hold: for a factory, or when a person gives up what store_unreadable protects. The
/// store is then empty and takes a first blob. Returns ok, flash_geometry or flash_erase (state untouched).
Status erase_store(const Flash& flash, StoreState& state) noexcept;

}  // namespace mdhcal
