// SPDX-License-Identifier: MIT
#include "emulated_flash.hpp"

#include <cstring>

#include "trace.hpp"

namespace firmware {

namespace {

using mdhcal::Status;

constexpr mdhcal::FlashGeometry geometry{32, 8192, 2, 0xFF};

EmulatedFlash& self(void* context) { return *static_cast<EmulatedFlash*>(context); }

void changed(EmulatedFlash& flash, const char* what, std::uint32_t address) {
  ++flash.changes;
  Line("flash: ") << what << " " << address;
  if (flash.changes == flash.cut_after) {
    Line("flash: power cut");
    semihosting_exit(3);
  }
}

Status read(void* context, std::uint32_t address, std::uint8_t* to, std::uint32_t size) {
  const EmulatedFlash& flash = self(context);
  if (flash.read_fails) return Status::flash_read;
  std::memcpy(to, flash.bytes + address, size);
  return Status::ok;
}

Status program(void* context, std::uint32_t address, const std::uint8_t* granule) {
  EmulatedFlash& flash = self(context);
  if (flash.fail_after != 0 && flash.changes >= flash.fail_after) return Status::flash_program;
  for (std::uint32_t i = 0; i < geometry.granule_bytes; ++i) {
    if (flash.bytes[address + i] != geometry.erased_value) return Status::flash_program;
  }
  std::memcpy(flash.bytes + address, granule, geometry.granule_bytes);
  changed(flash, "program", address);
  return Status::ok;
}

Status erase(void* context, std::uint32_t address) {
  EmulatedFlash& flash = self(context);
  std::memset(flash.bytes + address, geometry.erased_value, geometry.sector_bytes);
  changed(flash, "erase", address);
  return Status::ok;
}

}  // namespace

EmulatedFlash::EmulatedFlash(std::uintptr_t region)
    : flash{geometry, read, program, erase, this}, bytes(reinterpret_cast<std::uint8_t*>(region)) {}

}  // namespace firmware
