// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/port/flash.hpp"

struct flash_area;

namespace mdhcal {

/// A flash partition of Zephyr, for the store. Plain data; one owner.
struct ZephyrFlash {
  Flash flash = {};                    ///< what the store is given; its context points at this object, which must stay where it is
  const struct flash_area* area = nullptr;
};

/// Takes the partition of this id, FIXED_PARTITION_ID(label), as a flash: its driver's write block is the granule, its pages
/// are the sectors, as many as lie whole in the partition. Returns ok, flash_read (there is no such partition, or its driver
/// is not ready) or flash_geometry (its pages are not all of one size or do not begin with it, its write block is no power of
/// two up to max_granule_bytes, or two slots do not fit in); `out` untouched unless ok. Module option CONFIG_MDHCAL_FLASH.
Status open_zephyr_flash(std::uint8_t partition_id, ZephyrFlash& out) noexcept;

}  // namespace mdhcal
