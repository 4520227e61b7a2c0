/* SPDX-License-Identifier: MIT */
/* A program of somebody else in C. */
#include <mdhcal.h>
#include <mdhcal_port.h>

static mdhcal_calibrated_arm model;

int main(void) {
  const uint8_t bytes[4] = {0, 0, 0, 0};
  const mdhcal_demands demands = {NULL, NULL, NULL, 0};
  const int32_t status = mdhcal_load(&model, sizeof model, MDHCAL_ABI_VERSION, bytes, sizeof bytes, &demands);
  const mdhcal_flash_geometry geometry = {32, 8192, 2, 0xFF};
  if (mdhcal_slot_bytes(&geometry) != 8192) return 2;
  return status == MDHCAL_BLOB_SIZE && mdhcal_status_text(status)[0] != '\0' ? 0 : 1;
}
