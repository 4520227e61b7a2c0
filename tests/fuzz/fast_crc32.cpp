// SPDX-License-Identifier: MIT
// mdhcal::crc32 for mutate_blobs in place of the library's, which is small rather than fast: with 10^8 blobs to decode the
// CRC would take two thirds of the time. Eight bytes at a time (Kounavis, Berry 2005).
#include <array>
#include <cstring>

#include "mdhcal/crc32.hpp"

namespace mdhcal {

namespace {

using Tables = std::array<std::array<std::uint32_t, 256>, 8>;

constexpr Tables make_tables() {
  Tables tables{};
  for (std::uint32_t v = 0; v < 256; ++v) {
    std::uint32_t c = v;
    for (int bit = 0; bit < 8; ++bit) c = (c >> 1U) ^ ((c & 1U) != 0U ? 0xEDB88320U : 0U);
    tables[0][v] = c;
  }
  for (std::size_t k = 1; k < 8; ++k) {
    for (std::size_t v = 0; v < 256; ++v) tables[k][v] = (tables[k - 1][v] >> 8U) ^ tables[0][tables[k - 1][v] & 0xFFU];
  }
  return tables;
}

constexpr Tables tables = make_tables();

}  // namespace

std::uint32_t crc32(const std::uint8_t* bytes, std::size_t size, std::uint32_t start) noexcept {
  std::uint32_t crc = ~start;
  for (; size >= 8; size -= 8, bytes += 8) {
    std::uint32_t word = crc;
    for (unsigned k = 0; k < 4; ++k) word ^= static_cast<std::uint32_t>(bytes[k]) << (8U * k);
    crc = tables[7][word & 0xFFU] ^ tables[6][(word >> 8U) & 0xFFU] ^ tables[5][(word >> 16U) & 0xFFU] ^
          tables[4][word >> 24U] ^ tables[3][bytes[4]] ^ tables[2][bytes[5]] ^ tables[1][bytes[6]] ^ tables[0][bytes[7]];
  }
  for (; size > 0; --size, ++bytes) crc = (crc >> 8U) ^ tables[0][(crc ^ *bytes) & 0xFFU];
  return ~crc;
}

}  // namespace mdhcal
