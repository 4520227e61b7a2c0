// SPDX-License-Identifier: MIT
#include "mdhcal/port/store.hpp"

#include "mdhcal/crc32.hpp"

namespace mdhcal {

namespace {

constexpr std::uint32_t content_bytes = static_cast<std::uint32_t>(slot_header_size + blob_size);

std::uint32_t crc_field(const std::uint8_t* blob) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(blob[blob_size - 4 + i]) << (8 * i);
  return value;
}

bool sound(const std::uint8_t* blob) { return crc32(blob, blob_size - 4) == crc_field(blob); }

Status read_header(const Flash& flash, std::uint32_t slot, SlotHeader& header) {
  std::uint8_t bytes[slot_header_size];
  const Status status =
      flash.read(flash.context, slot * slot_bytes(flash.geometry), bytes, static_cast<std::uint32_t>(slot_header_size));
  return status == Status::ok ? decode_slot_header(bytes, header) : status;
}

Status load_slot(const Flash& flash, const Loader& loader, std::uint32_t slot, const SlotHeader& header,
                 std::uint8_t (&blob)[blob_size]) {
  const std::uint32_t address = slot * slot_bytes(flash.geometry) + static_cast<std::uint32_t>(slot_header_size);
  const Status status = flash.read(flash.context, address, blob, static_cast<std::uint32_t>(blob_size));
  if (status != Status::ok) return status;
  if (header.blob_crc != crc_field(blob) || !sound(blob)) return Status::blob_crc;
  return loader.load(blob, blob_size, loader.context);
}

// A slot's content, granule by granule: header, blob, erased bytes as padding.
struct Content {
  const Flash& flash;
  std::uint32_t base;
  const std::uint8_t* header;
  const std::uint8_t* blob;

  std::uint8_t at(std::uint32_t offset) const {
    if (offset < slot_header_size) return header[offset];
    return offset < content_bytes ? blob[offset - slot_header_size] : flash.geometry.erased_value;
  }

  Status program(std::uint32_t offset) const {
    std::uint8_t granule[max_granule_bytes];
    for (std::uint32_t i = 0; i < flash.geometry.granule_bytes; ++i) granule[i] = at(offset + i);
    return flash.program(flash.context, base + offset, granule);
  }

  Status verify(std::uint32_t offset) const {
    std::uint8_t granule[max_granule_bytes];
    const Status status = flash.read(flash.context, base + offset, granule, flash.geometry.granule_bytes);
    if (status != Status::ok) return status;
    for (std::uint32_t i = 0; i < flash.geometry.granule_bytes; ++i) {
      if (granule[i] != at(offset + i)) return Status::flash_verify;
    }
    return Status::ok;
  }
};

Status write(const Content& content) {
  const FlashGeometry& geometry = content.flash.geometry;
  for (std::uint32_t offset = 0; offset < slot_bytes(geometry); offset += geometry.sector_bytes) {
    const Status status = content.flash.erase(content.flash.context, content.base + offset);
    if (status != Status::ok) return status;
  }
  for (std::uint32_t offset = geometry.granule_bytes; offset < content_bytes; offset += geometry.granule_bytes) {
    const Status status = content.program(offset);
    if (status != Status::ok) return status;
  }
  // Read back before the header commits the slot, not after.
  for (std::uint32_t offset = geometry.granule_bytes; offset < content_bytes; offset += geometry.granule_bytes) {
    const Status status = content.verify(offset);
    if (status != Status::ok) return status;
  }
  const Status status = content.program(0);
  return status == Status::ok ? content.verify(0) : status;
}

// Whether every byte of a slot's header and blob can be read, whatever they are.
bool readable(const Flash& flash, std::uint32_t slot) {
  std::uint8_t granule[max_granule_bytes];
  const std::uint32_t base = slot * slot_bytes(flash.geometry);
  for (std::uint32_t offset = 0; offset < content_bytes; offset += flash.geometry.granule_bytes) {
    if (flash.read(flash.context, base + offset, granule, flash.geometry.granule_bytes) != Status::ok) return false;
  }
  return true;
}

// Where an update goes: the slot that is erased for it, and its sequence.
struct Plan {
  std::uint32_t slot;
  std::uint32_t sequence;
};

// A slot may be erased if the other one is active, or if it has been read whole and refused. A slot that could not be read
// may hold the newest blob, so it is neither erased nor outnumbered on a guess.
Status make_plan(const Flash& flash, const StoreState& state, Plan& plan) {
  SlotHeader header[2] = {};
  Status found[2];
  for (std::uint32_t slot = 0; slot < 2; ++slot) found[slot] = read_header(flash, slot, header[slot]);
  if (state.active >= 0) {
    const auto kept = static_cast<std::uint32_t>(state.active);
    plan.slot = 1 - kept;
    if (found[kept] == Status::flash_read) return Status::store_unreadable;
    // Cells that were cut in the middle of programming cannot be read until they are erased: that goes on. A slot that can be
    // read by now would have been the one to load.
    const bool unread = state.slot[plan.slot] == Status::flash_read || found[plan.slot] == Status::flash_read;
    if (unread && readable(flash, plan.slot)) return Status::store_unreadable;
    plan.sequence = (found[kept] == Status::ok ? header[kept].sequence : state.sequence) + 1U;
    return Status::ok;
  }
  if (found[0] == Status::flash_read || found[1] == Status::flash_read) return Status::store_unreadable;
  // The newer of the two is kept all the same: it may have been refused for a passing reason.
  const bool both = found[0] == Status::ok && found[1] == Status::ok;
  const std::uint32_t newest = found[1] == Status::ok && (!both || newer(header[1].sequence, header[0].sequence)) ? 1 : 0;
  plan.slot = state.slot[1 - newest] != Status::flash_read ? 1 - newest : newest;
  if (state.slot[plan.slot] == Status::flash_read) return Status::store_unreadable;
  plan.sequence = (found[newest] == Status::ok ? header[newest].sequence : 0U) + 1U;
  return Status::ok;
}

}  // namespace

std::uint32_t slot_bytes(const FlashGeometry& geometry) noexcept {
  const std::uint32_t granule = geometry.granule_bytes;
  const std::uint32_t sector = geometry.sector_bytes;
  constexpr std::uint32_t max_region_bytes = 0x80000000U;
  if (granule < 1 || granule > max_granule_bytes || (granule & (granule - 1)) != 0) return 0;
  if (sector < granule || sector % granule != 0 || sector > max_region_bytes) return 0;
  if (geometry.erased_value != 0x00 && geometry.erased_value != 0xFF) return 0;
  const std::uint32_t sectors = (content_bytes + sector - 1) / sector;
  if (geometry.sector_count < 2 * sectors || geometry.sector_count > max_region_bytes / sector) return 0;
  return sectors * sector;
}

Status load_newest(const Flash& flash, const Loader& loader, std::uint8_t (&blob)[blob_size],
                   StoreState& state) noexcept {
  if (slot_bytes(flash.geometry) == 0) return Status::flash_geometry;
  SlotHeader header[2] = {};
  StoreState found = {1, -1, 0, {Status::ok, Status::ok}};
  for (std::uint32_t slot = 0; slot < 2; ++slot) found.slot[slot] = read_header(flash, slot, header[slot]);
  const bool both = found.slot[0] == Status::ok && found.slot[1] == Status::ok;
  const std::uint32_t first = both && newer(header[1].sequence, header[0].sequence) ? 1 : 0;
  for (std::uint32_t turn = 0; turn < 2 && found.active < 0; ++turn) {
    const std::uint32_t slot = turn == 0 ? first : 1 - first;
    if (found.slot[slot] != Status::ok) continue;
    found.slot[slot] = load_slot(flash, loader, slot, header[slot], blob);
    if (found.slot[slot] == Status::ok) {
      found.active = static_cast<std::int32_t>(slot);
      found.sequence = header[slot].sequence;
    }
  }
  state = found;
  if (found.active >= 0) return Status::ok;
  const bool unread = found.slot[0] == Status::flash_read || found.slot[1] == Status::flash_read;
  return unread ? Status::store_unreadable : Status::store_empty;
}

Status update(const Flash& flash, const Loader& loader, const std::uint8_t* blob, std::size_t size,
              StoreState& state) noexcept {
  if (state.examined != 1 || state.active < -1 || state.active > 1 || blob == nullptr) return Status::bad_input;
  if (slot_bytes(flash.geometry) == 0) return Status::flash_geometry;
  if (size != blob_size) return Status::blob_size;
  if (!sound(blob)) return Status::blob_crc;
  const Status accepted = loader.load(blob, size, loader.context);
  if (accepted != Status::ok) return accepted;

  Plan plan = {};
  const Status planned = make_plan(flash, state, plan);
  if (planned != Status::ok) return planned;

  std::uint8_t bytes[slot_header_size];
  encode_slot_header({plan.sequence, crc_field(blob)}, bytes);
  const std::uint32_t base = plan.slot * slot_bytes(flash.geometry);
  const Status written = write({flash, base, bytes, blob});
  if (written != Status::ok) {
    // An update that was reported as failed must not come to life at the next start.
    const Status erased = flash.erase(flash.context, base);
    state.slot[plan.slot] = erased == Status::ok ? Status::blob_magic : erased;
    return written;
  }
  state.slot[plan.slot] = Status::ok;
  state.active = static_cast<std::int32_t>(plan.slot);
  state.sequence = plan.sequence;
  return Status::ok;
}

Status erase_store(const Flash& flash, StoreState& state) noexcept {
  const std::uint32_t slot_size = slot_bytes(flash.geometry);
  if (slot_size == 0) return Status::flash_geometry;
  // The first sector of a slot holds its header: without it the slot is none.
  for (std::uint32_t slot = 0; slot < 2; ++slot) {
    const Status status = flash.erase(flash.context, slot * slot_size);
    if (status != Status::ok) return status;
  }
  state = {1, -1, 0, {Status::blob_magic, Status::blob_magic}};
  return Status::ok;
}

}  // namespace mdhcal
