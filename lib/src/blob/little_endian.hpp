// SPDX-License-Identifier: MIT
// Private to lib/src. Little-endian numbers at any alignment, on a machine of either endianness.
#pragma once

#include <cstdint>
#include <string.h>

namespace mdhcal {

static inline std::uint32_t load_u16(const std::uint8_t* p) {
  return static_cast<std::uint32_t>(p[0]) | static_cast<std::uint32_t>(p[1]) << 8U;
}

static inline std::uint32_t load_u32(const std::uint8_t* p) {
  return static_cast<std::uint32_t>(p[0]) | static_cast<std::uint32_t>(p[1]) << 8U |
         static_cast<std::uint32_t>(p[2]) << 16U | static_cast<std::uint32_t>(p[3]) << 24U;
}

static inline std::int32_t load_i32(const std::uint8_t* p) {
  const std::uint32_t bits = load_u32(p);
  std::int32_t value = 0;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static inline double load_f64(const std::uint8_t* p) {
  const std::uint64_t bits = static_cast<std::uint64_t>(load_u32(p)) | static_cast<std::uint64_t>(load_u32(p + 4)) << 32U;
  double value = 0.0;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static inline float load_f32(const std::uint8_t* p) {
  const std::uint32_t bits = load_u32(p);
  float value = 0.0F;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static inline void store_u32(std::uint8_t* p, std::uint32_t value) {
  for (int k = 0; k < 4; ++k) p[k] = static_cast<std::uint8_t>(value >> (8U * static_cast<std::uint32_t>(k)));
}

}  // namespace mdhcal
