/* SPDX-License-Identifier: MIT
 *
 * The blob store for C99: two slots of flash, of which one always holds the last blob that was committed. The comments of
 * mdhcal/port/store.hpp hold. Library mdhcal::port. Every function returns a status of mdhcal.h; MDHCAL_BAD_INPUT besides for a
 * null pointer. Outside the servo loop: erasing takes seconds. One caller at a time.
 */
#ifndef MDHCAL_PORT_H
#define MDHCAL_PORT_H

#include "mdhcal.h"

#ifdef __cplusplus
extern "C" {
#endif

#define MDHCAL_BLOB_BYTES 8160

/* What a driver states of its region: struct FlashGeometry (mdhcal/port/flash.hpp). */
typedef struct mdhcal_flash_geometry {
  uint32_t granule_bytes; /* programmed at once, and once per erase: a power of two, 1 ... 256 */
  uint32_t sector_bytes;  /* erased at once: a multiple of granule_bytes */
  uint32_t sector_count;
  uint8_t erased_value;   /* what an erased byte reads as, 0xFF or 0x00 */
} mdhcal_flash_geometry;

/* A flash driver: struct Flash. Addresses are offsets from the region's begin. Each function returns when it is done, 0 if
 * all is well and anything else if not: for `read` that is MDHCAL_FLASH_READ, an ECC error for one. */
typedef struct mdhcal_flash {
  mdhcal_flash_geometry geometry;
  int32_t (*read)(void* context, uint32_t address, uint8_t* to, uint32_t size);
  int32_t (*program)(void* context, uint32_t address, const uint8_t* granule);
  int32_t (*erase)(void* context, uint32_t address);
  void* context;
} mdhcal_flash;

/* Judges a blob, and takes it: mdhcal_load() into an arm that the loop does not use, for one. MDHCAL_OK, or why it is refused. */
typedef struct mdhcal_judge {
  int32_t (*load)(const uint8_t* blob, size_t size, void* context);
  void* context;
} mdhcal_judge;

/* What the store knows of its slots: struct StoreState. All zero before the first mdhcal_load_newest(). */
typedef struct mdhcal_store_state {
  int32_t examined, active;
  uint32_t sequence;
  int32_t slot[2];
} mdhcal_store_state;

/* slot_bytes(): 0 if the geometry is unusable. */
uint32_t mdhcal_slot_bytes(const mdhcal_flash_geometry* geometry);
/* load_newest(), update(), erase_store(). `blob` [MDHCAL_BLOB_BYTES] is room to read into. */
int32_t mdhcal_load_newest(const mdhcal_flash* flash, const mdhcal_judge* judge, uint8_t* blob, mdhcal_store_state* state);
int32_t mdhcal_update(const mdhcal_flash* flash, const mdhcal_judge* judge, const uint8_t* blob, size_t size,
                      mdhcal_store_state* state);
int32_t mdhcal_erase_store(const mdhcal_flash* flash, mdhcal_store_state* state);

#ifdef __cplusplus
}
#endif

#endif
