// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "mdhcal/status.hpp"

namespace mdhcal {

/// The largest granule that the store can use [bytes].
inline constexpr std::uint32_t max_granule_bytes = 256;

/// What a driver states of its region. Addresses are offsets from the region's begin [bytes].
struct FlashGeometry {
  std::uint32_t granule_bytes;  ///< programmed at once, and once per erase: a power of two, 1 ... max_granule_bytes
  std::uint32_t sector_bytes;   ///< erased at once: a multiple of granule_bytes
  std::uint32_t sector_count;   ///< of equal sectors in the region; the region is at most 2^31 bytes
  std::uint8_t erased_value;    ///< what an erased byte reads as, 0xFF or 0x00
};

/// A flash driver: three functions over one region, filled in by the port. Each returns only when it is done, does what
/// the part needs around it (unlocking, caches, watchdog: docs/porting.md) and passes `context` through. The store never
/// calls two of them at once, and never passes a range outside the region.
struct Flash {
  FlashGeometry geometry;
  /// Copies `size` bytes, any address and size. Returns ok or flash_read; an ECC error is flash_read, not a fault.
  Status (*read)(void* context, std::uint32_t address, std::uint8_t* to, std::uint32_t size);
  /// Programs the one granule at `address`, a multiple of granule_bytes. Returns ok or flash_program.
  Status (*program)(void* context, std::uint32_t address, const std::uint8_t* granule);
  /// Erases the one sector at `address`, a multiple of sector_bytes. Returns ok or flash_erase.
  Status (*erase)(void* context, std::uint32_t address);
  void* context;
};

}  // namespace mdhcal
