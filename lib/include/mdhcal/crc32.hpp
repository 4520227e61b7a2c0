// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace mdhcal {

/// CRC-32 in the zlib flavour (reflected polynomial 0xEDB88320, initial value and final complement all ones; the
/// check value of "123456789" is 0xCBF43926). `start` is the CRC of what came before, 0 at the beginning:
/// crc32(b, n, crc32(a, m)) is the CRC of a followed by b. A null pointer with size 0 is allowed.
std::uint32_t crc32(const std::uint8_t* bytes, std::size_t size, std::uint32_t start = 0) noexcept;

}  // namespace mdhcal
