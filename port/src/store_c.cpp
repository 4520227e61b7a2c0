// SPDX-License-Identifier: MIT
#include "mdhcal_port.h"

#include "mdhcal/port/store.hpp"

namespace mdhcal {

namespace {

static_assert(MDHCAL_BLOB_BYTES == blob_size);
static_assert(MDHCAL_FLASH_READ == static_cast<int>(Status::flash_read) &&
              MDHCAL_STORE_UNREADABLE == static_cast<int>(Status::store_unreadable));

// What the C functions were given, behind the C++ ones: a driver's number other than 0 is the failure of its function.
Status read_for_c(void* context, std::uint32_t address, std::uint8_t* to, std::uint32_t size) {
  const mdhcal_flash& c = *static_cast<const mdhcal_flash*>(context);
  return c.read(c.context, address, to, size) == 0 ? Status::ok : Status::flash_read;
}

Status program_for_c(void* context, std::uint32_t address, const std::uint8_t* granule) {
  const mdhcal_flash& c = *static_cast<const mdhcal_flash*>(context);
  return c.program(c.context, address, granule) == 0 ? Status::ok : Status::flash_program;
}

Status erase_for_c(void* context, std::uint32_t address) {
  const mdhcal_flash& c = *static_cast<const mdhcal_flash*>(context);
  return c.erase(c.context, address) == 0 ? Status::ok : Status::flash_erase;
}

Status load_for_c(const std::uint8_t* blob, std::size_t size, void* context) {
  const mdhcal_judge& c = *static_cast<const mdhcal_judge*>(context);
  return static_cast<Status>(c.load(blob, size, c.context));
}

bool whole(const mdhcal_flash* flash) {
  return flash != nullptr && flash->read != nullptr && flash->program != nullptr && flash->erase != nullptr;
}

FlashGeometry from_c(const mdhcal_flash_geometry& geometry) {
  return {geometry.granule_bytes, geometry.sector_bytes, geometry.sector_count, geometry.erased_value};
}

Flash from_c(mdhcal_flash& flash) { return {from_c(flash.geometry), read_for_c, program_for_c, erase_for_c, &flash}; }

StoreState from_c(const mdhcal_store_state& state) {
  return {state.examined, state.active, state.sequence,
          {static_cast<Status>(state.slot[0]), static_cast<Status>(state.slot[1])}};
}

std::int32_t finish(Status status, const StoreState& state, mdhcal_store_state& out) {
  out = {state.examined, state.active, state.sequence,
         {static_cast<std::int32_t>(state.slot[0]), static_cast<std::int32_t>(state.slot[1])}};
  return static_cast<std::int32_t>(status);
}

}  // namespace

}  // namespace mdhcal

extern "C" {

using namespace mdhcal;

std::uint32_t mdhcal_slot_bytes(const mdhcal_flash_geometry* geometry) {
  return geometry == nullptr ? 0U : slot_bytes(from_c(*geometry));
}

std::int32_t mdhcal_load_newest(const mdhcal_flash* flash, const mdhcal_judge* judge, std::uint8_t* blob,
                                mdhcal_store_state* state) {
  if (!whole(flash) || judge == nullptr || judge->load == nullptr || blob == nullptr || state == nullptr) {
    return MDHCAL_BAD_INPUT;
  }
  mdhcal_flash driver = *flash;
  mdhcal_judge loader = *judge;
  StoreState known = from_c(*state);
  const Status status = load_newest(from_c(driver), {load_for_c, &loader},
                                    *reinterpret_cast<std::uint8_t(*)[blob_size]>(blob), known);
  return finish(status, known, *state);
}

std::int32_t mdhcal_update(const mdhcal_flash* flash, const mdhcal_judge* judge, const std::uint8_t* blob, std::size_t size,
                           mdhcal_store_state* state) {
  if (!whole(flash) || judge == nullptr || judge->load == nullptr || blob == nullptr || state == nullptr) {
    return MDHCAL_BAD_INPUT;
  }
  mdhcal_flash driver = *flash;
  mdhcal_judge loader = *judge;
  StoreState known = from_c(*state);
  const Status status = update(from_c(driver), {load_for_c, &loader}, blob, size, known);
  return finish(status, known, *state);
}

std::int32_t mdhcal_erase_store(const mdhcal_flash* flash, mdhcal_store_state* state) {
  if (!whole(flash) || state == nullptr) return MDHCAL_BAD_INPUT;
  mdhcal_flash driver = *flash;
  StoreState known = from_c(*state);
  return finish(erase_store(from_c(driver), known), known, *state);
}

}  // extern "C"
