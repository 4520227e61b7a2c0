// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <bit>
#include <cstring>
#include <memory>

#include "golden_blobs.hpp"
#include "mdhcal/blob.hpp"
#include "mdhcal/crc32.hpp"

namespace mdhcal::test {

using Bytes = std::array<std::uint8_t, blob_size>;

inline Bytes copy_of(const std::uint8_t (&golden)[blob_size]) {
  Bytes bytes;
  std::memcpy(bytes.data(), golden, blob_size);
  return bytes;
}

/// Writes the low `size` bytes of a number, little-endian.
inline void put(Bytes& bytes, std::size_t offset, std::uint64_t value, std::size_t size) {
  for (std::size_t k = 0; k < size; ++k) bytes[offset + k] = static_cast<std::uint8_t>(value >> (8 * k));
}
inline void put(Bytes& bytes, std::size_t offset, double value) { put(bytes, offset, std::bit_cast<std::uint64_t>(value), 8); }
inline void put(Bytes& bytes, std::size_t offset, float value) { put(bytes, offset, std::bit_cast<std::uint32_t>(value), 4); }

inline void repair_crc(Bytes& bytes) { put(bytes, blob_layout::crc, crc32(bytes.data(), blob_layout::crc), 4); }

/// A model filled with a pattern, to see whether decode() touched it.
struct Watched {
  std::unique_ptr<BlobContent> model = std::make_unique<BlobContent>();
  Watched() { std::memset(static_cast<void*>(model.get()), 0x5A, sizeof(BlobContent)); }
  bool untouched() const {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(model.get());
    for (std::size_t i = 0; i < sizeof(BlobContent); ++i) {
      if (bytes[i] != 0x5A) return false;
    }
    return true;
  }
};

/// decode() after repairing the CRC.
inline Status decode_repaired(Bytes bytes, const DecodeOptions& options = {}) {
  repair_crc(bytes);
  Watched watched;
  const Status status = decode(bytes.data(), bytes.size(), options, *watched.model);
  return status;
}

}  // namespace mdhcal::test
