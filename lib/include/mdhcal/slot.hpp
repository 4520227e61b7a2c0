// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "mdhcal/status.hpp"

namespace mdhcal {

/// The size of the header before a blob in flash: one granule of 32 bytes (docs/blob.md, The slot).
inline constexpr std::size_t slot_header_size = 32;

/// What a slot header says of the blob behind it. Written last, so that its presence commits the slot.
struct SlotHeader {
  std::uint32_t sequence;  ///< one more with every update, modulo 2^32
  std::uint32_t blob_crc;  ///< the blob's own CRC-32, its last four bytes
};

/// The header's 32 bytes.
void encode_slot_header(const SlotHeader& header, std::uint8_t* bytes) noexcept;

/// Reads a header from 32 bytes. Returns ok, or blob_magic (erased, or no header), blob_crc (damaged),
/// blob_reserved (a reserved byte is not zero); the header is written only on ok.
Status decode_slot_header(const std::uint8_t* bytes, SlotHeader& header) noexcept;

/// Whether sequence a is newer than b, with wrap: at most 2^31 - 1 updates lie between the two slots.
constexpr bool newer(std::uint32_t a, std::uint32_t b) noexcept {
  const std::uint32_t ahead = a - b;
  return ahead != 0U && ahead < 0x80000000U;
}

}  // namespace mdhcal
