// SPDX-License-Identifier: MIT
#include "mdhcal/port/zephyr_flash.hpp"

#include <zephyr/drivers/flash.h>
#include <zephyr/storage/flash_map.h>

#include "mdhcal/port/store.hpp"

namespace mdhcal {

namespace {

constexpr std::uint32_t largest_region = 0x80000000U;  // FlashGeometry

Status read(void* context, std::uint32_t address, std::uint8_t* to, std::uint32_t size) {
  const ZephyrFlash& open = *static_cast<const ZephyrFlash*>(context);
  return flash_area_read(open.area, static_cast<off_t>(address), to, size) == 0 ? Status::ok : Status::flash_read;
}

Status program(void* context, std::uint32_t address, const std::uint8_t* granule) {
  const ZephyrFlash& open = *static_cast<const ZephyrFlash*>(context);
  const int done = flash_area_write(open.area, static_cast<off_t>(address), granule, open.flash.geometry.granule_bytes);
  return done == 0 ? Status::ok : Status::flash_program;
}

Status erase(void* context, std::uint32_t address) {
  const ZephyrFlash& open = *static_cast<const ZephyrFlash*>(context);
  const int done = flash_area_erase(open.area, static_cast<off_t>(address), open.flash.geometry.sector_bytes);
  return done == 0 ? Status::ok : Status::flash_erase;
}

// The pages of the partition: all of one size, the first at its begin. 0 otherwise. One look a page.
std::uint32_t page_bytes(const struct flash_area* area, const struct device* device) {
  std::uint32_t size = 0;
  for (std::uint64_t at = 0; at < area->fa_size; at += size) {
    struct flash_pages_info page = {};
    const off_t offset = area->fa_off + static_cast<off_t>(at);
    if (flash_get_page_info_by_offs(device, offset, &page) != 0 || page.start_offset != offset) return 0;
    if (page.size == 0 || page.size > largest_region || (size != 0 && page.size != size)) return 0;
    size = static_cast<std::uint32_t>(page.size);
  }
  return size;
}

}  // namespace

Status open_zephyr_flash(std::uint8_t partition_id, ZephyrFlash& out) noexcept {
  const struct flash_area* area = nullptr;
  if (flash_area_open(partition_id, &area) != 0 || area == nullptr) return Status::flash_read;
  const struct device* device = flash_area_get_device(area);
  if (device == nullptr || !device_is_ready(device)) return Status::flash_read;
  const std::uint32_t size = page_bytes(area, device);
  if (size == 0 || area->fa_size > largest_region) return Status::flash_geometry;
  const FlashGeometry geometry = {flash_area_align(area), size, static_cast<std::uint32_t>(area->fa_size) / size,
                                  flash_area_erased_val(area)};
  const std::uint32_t slot = slot_bytes(geometry);
  if (slot == 0 || 2ULL * slot > area->fa_size) return Status::flash_geometry;
  out.area = area;
  out.flash = {geometry, read, program, erase, &out};
  return Status::ok;
}

}  // namespace mdhcal
