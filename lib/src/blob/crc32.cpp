// SPDX-License-Identifier: MIT
#include "mdhcal/crc32.hpp"

#include "blob/little_endian.hpp"

namespace mdhcal {

namespace {

// entry[k][v]: what the nibble v does to the CRC when k more nibbles follow it in its word. The eight lookups of a
// word do not wait for each other; 512 bytes of constants, as many instructions as bytewise with 1024.
struct Table {
  std::uint32_t entry[8][16];
};

constexpr Table make_table() {
  Table table{};
  for (std::uint32_t value = 0; value < 16; ++value) {
    std::uint32_t crc = value;
    for (int k = 0; k < 8; ++k) {
      for (int bit = 0; bit < 4; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0U ? 0xEDB88320U : 0U);
      table.entry[k][value] = crc;
    }
  }
  return table;
}

constexpr Table table = make_table();

}  // namespace

std::uint32_t crc32(const std::uint8_t* bytes, std::size_t size, std::uint32_t start) noexcept {
  std::uint32_t crc = ~start;
  std::size_t i = 0;
  for (; size - i >= 4; i += 4) {
    const std::uint32_t word = crc ^ load_u32(bytes + i);
    crc = table.entry[7][word & 15U] ^ table.entry[6][(word >> 4U) & 15U] ^ table.entry[5][(word >> 8U) & 15U] ^
          table.entry[4][(word >> 12U) & 15U] ^ table.entry[3][(word >> 16U) & 15U] ^
          table.entry[2][(word >> 20U) & 15U] ^ table.entry[1][(word >> 24U) & 15U] ^ table.entry[0][word >> 28U];
  }
  for (; i < size; ++i) {
    const std::uint32_t byte = crc ^ bytes[i];
    crc = (crc >> 8U) ^ table.entry[1][byte & 15U] ^ table.entry[0][(byte >> 4U) & 15U];
  }
  return ~crc;
}

}  // namespace mdhcal
