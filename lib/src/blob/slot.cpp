// SPDX-License-Identifier: MIT
#include "mdhcal/slot.hpp"

#include "blob/little_endian.hpp"
#include "mdhcal/crc32.hpp"

namespace mdhcal {

namespace {

constexpr std::uint32_t slot_magic = 0xECB2A0FDU;
constexpr std::size_t sequence_at = 4;
constexpr std::size_t blob_crc_at = 8;
constexpr std::size_t reserved_at = 12;
constexpr std::size_t header_crc_at = 28;
static_assert(header_crc_at + 4 == slot_header_size);

}  // namespace

void encode_slot_header(const SlotHeader& header, std::uint8_t* bytes) noexcept {
  for (std::size_t i = 0; i < slot_header_size; ++i) bytes[i] = 0;
  store_u32(bytes, slot_magic);
  store_u32(bytes + sequence_at, header.sequence);
  store_u32(bytes + blob_crc_at, header.blob_crc);
  store_u32(bytes + header_crc_at, crc32(bytes, header_crc_at));
}

Status decode_slot_header(const std::uint8_t* bytes, SlotHeader& header) noexcept {
  if (load_u32(bytes) != slot_magic) return Status::blob_magic;
  if (load_u32(bytes + header_crc_at) != crc32(bytes, header_crc_at)) return Status::blob_crc;
  for (std::size_t i = reserved_at; i < header_crc_at; ++i) {
    if (bytes[i] != 0) return Status::blob_reserved;
  }
  header.sequence = load_u32(bytes + sequence_at);
  header.blob_crc = load_u32(bytes + blob_crc_at);
  return Status::ok;
}

}  // namespace mdhcal
