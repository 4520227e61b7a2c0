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
  return found.active < 0 ? Status::store_empty : Status::ok;
}

Status update(const Flash& flash, const Loader& loader, const std::uint8_t* blob, std::size_t size,
              StoreState& state) noexcept {
  if (state.examined != 1 || state.active < -1 || state.active > 1 || blob == nullptr) return Status::bad_input;
  if (slot_bytes(flash.geometry) == 0) return Status::flash_geometry;
  if (size != blob_size) return Status::blob_size;
  if (!sound(blob)) return Status::blob_crc;
  const Status accepted = loader.load(blob, size, loader.context);
  if (accepted != Status::ok) return accepted;

  // Without an active slot the newer of the two is kept all the same: it may have been refused for a passing reason.
  SlotHeader header[2] = {};
  bool has_header[2];
  for (std::uint32_t slot = 0; slot < 2; ++slot) has_header[slot] = read_header(flash, slot, header[slot]) == Status::ok;
  std::uint32_t kept = has_header[1] && (!has_header[0] || newer(header[1].sequence, header[0].sequence)) ? 1 : 0;
  if (state.active >= 0) kept = static_cast<std::uint32_t>(state.active);
  const std::uint32_t slot = 1 - kept;
  std::uint32_t sequence = has_header[kept] ? header[kept].sequence : state.sequence;
  ++sequence;

  std::uint8_t bytes[slot_header_size];
  encode_slot_header({sequence, crc_field(blob)}, bytes);
  const std::uint32_t base = slot * slot_bytes(flash.geometry);
  state.slot[slot] = write({flash, base, bytes, blob});
  if (state.slot[slot] != Status::ok) {
    // An update that was reported as failed must not come to life at the next start.
    static_cast<void>(flash.erase(flash.context, base));
    return state.slot[slot];
  }
  state.active = static_cast<std::int32_t>(slot);
  state.sequence = sequence;
  return Status::ok;
}

}  // namespace mdhcal
