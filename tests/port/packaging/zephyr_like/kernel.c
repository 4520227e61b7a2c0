/* SPDX-License-Identifier: MIT */
/* A kernel of one thread and a flash of 64 KiB with a partition of 32 KiB, kept in the file that FLASH names. A write block of 8
 * bytes is programmed once between two erases. */
#define _POSIX_C_SOURCE 199309L
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <zephyr/kernel.h>
#include <zephyr/storage/flash_map.h>

enum { page = 4096, block = 8, begin = 32768, size = 32768 };
static const struct device chip = {"flash"};
static const struct flash_area area = {FIXED_PARTITION_ID(any), 0, begin, size, &chip};
static unsigned char cells[begin + size];
static int ready;

static void load_cells(void) {
  const char* name = getenv("FLASH");
  FILE* file = name != NULL ? fopen(name, "rb") : NULL;
  memset(cells, 0xFF, sizeof cells);
  if (file != NULL && fread(cells + begin, 1, size, file) > 0) fclose(file);
  ready = 1;
}

static void keep_cells(void) {
  const char* name = getenv("FLASH");
  FILE* file = name != NULL ? fopen(name, "wb") : NULL;
  if (file != NULL && fwrite(cells + begin, 1, size, file) > 0) fclose(file);
}

bool device_is_ready(const struct device* device) { return device == &chip; }

int flash_get_page_info_by_offs(const struct device* device, off_t offset, struct flash_pages_info* info) {
  if (device != &chip || offset < 0 || offset >= begin + size) return -22;
  info->start_offset = offset / page * page;
  info->size = page;
  info->index = (uint32_t)(offset / page);
  return 0;
}

int flash_area_open(uint8_t id, const struct flash_area** found) {
  if (!ready) load_cells();
  if (id != area.fa_id) return -2;
  *found = &area;
  return 0;
}

static int outside(off_t offset, size_t count) { return offset < 0 || (size_t)offset + count > size; }

int flash_area_read(const struct flash_area* from, off_t offset, void* to, size_t count) {
  if (outside(offset, count)) return -22;
  memcpy(to, cells + from->fa_off + offset, count);
  return 0;
}

int flash_area_write(const struct flash_area* to, off_t offset, const void* from, size_t count) {
  unsigned char* at = cells + to->fa_off + offset;
  size_t i;
  if (outside(offset, count) || offset % block != 0 || count % block != 0) return -22;
  for (i = 0; i < count; ++i) {
    if (at[i] != 0xFF) return -5;
  }
  memcpy(at, from, count);
  keep_cells();
  return 0;
}

int flash_area_erase(const struct flash_area* of, off_t offset, size_t count) {
  if (outside(offset, count) || offset % page != 0 || count % page != 0) return -22;
  memset(cells + of->fa_off + offset, 0xFF, count);
  keep_cells();
  return 0;
}

uint32_t flash_area_align(const struct flash_area* of) { return of == &area ? block : 0; }
uint8_t flash_area_erased_val(const struct flash_area* of) { return of == &area ? 0xFF : 0; }
const struct device* flash_area_get_device(const struct flash_area* of) { return of->fa_dev; }

static int64_t now(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (int64_t)time.tv_sec * 1000000000 + time.tv_nsec;
}

void k_timer_start(struct k_timer* timer, k_timeout_t first, k_timeout_t period) {
  timer->period_ns = period;
  timer->next_ns = now() + first;
}

uint32_t k_timer_status_sync(struct k_timer* timer) {
  while (now() < timer->next_ns) {
    const struct timespec rest = {0, (long)(timer->next_ns - now() > 0 ? timer->next_ns - now() : 0)};
    nanosleep(&rest, NULL);
  }
  timer->next_ns += timer->period_ns;
  return 1;
}
