// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/port/flash.hpp"

namespace firmware {

/// Flash words of 32 bytes in two sectors of 8 KiB, in the board's RAM. Programs a granule once between two erases, as
/// the real part does. Traces every change, so that a test can cut the power there.
struct EmulatedFlash {
  explicit EmulatedFlash(std::uintptr_t region);
  EmulatedFlash(const EmulatedFlash&) = delete;
  EmulatedFlash& operator=(const EmulatedFlash&) = delete;

  mdhcal::Flash flash;
  std::uint8_t* bytes;
  bool read_fails = false;        ///< every read reports an error, as an ECC error would
  std::uint32_t cut_after = 0;    ///< the power goes after so many changes; 0: never
  std::uint32_t fail_after = 0;   ///< from this change on, programming fails; 0: never
  std::uint32_t changes = 0;
};

}  // namespace firmware
