/* SPDX-License-Identifier: MIT */
/* A servo loop in C: load a blob, check it, follow a pose with the arm as it is.
 *   servo_loop_c BLOB */
#include <stdio.h>

#include "mdhcal.h"

static uint8_t bytes[8160];
static mdhcal_calibrated_arm arm;
static mdhcal_compensator loop;

int main(int count, char** arguments) {
  FILE* file = count == 2 ? fopen(arguments[1], "rb") : NULL;
  const size_t size = file != NULL ? fread(bytes, 1, sizeof bytes, file) : 0;
  mdhcal_tick_options options;
  mdhcal_tick_report report;
  mdhcal_pose pose;
  double q[MDHCAL_MAX_JOINTS] = {0.5, 0.4, 0.6, 0.5, 0.7, 0.5, 0.5, 0.5};
  int32_t status = mdhcal_load(&arm, sizeof arm, MDHCAL_ABI_VERSION, bytes, size, NULL);
  int tick;
  if (file != NULL) fclose(file);
  printf("load: %s\n", mdhcal_status_text(status));
  if (!mdhcal_usable(status)) return 1;

  /* One compensator a loop, options for its period. */
  if (mdhcal_start_at_rest(&loop, sizeof loop, &arm, MDHCAL_CORRECTED) != MDHCAL_OK) return 1;
  if (mdhcal_default_tick_options(&arm, 0.001, &options) != MDHCAL_OK) return 1;
  if (mdhcal_forward(&arm, MDHCAL_CORRECTED, q, &pose, NULL) != MDHCAL_OK) return 1;

  /* Every millisecond: a pose in, the joints to command out, in place of the last ones. */
  for (tick = 0; tick < 1000; ++tick) {
    pose.position_m[2] += 0.00001;
    status = mdhcal_pose_to_joints(&loop, &options, &pose, q, &report);
    if (!mdhcal_usable(status)) return 1; /* stop the drives; any other status keeps every limit */
    if (tick % 250 == 249) printf("tick %d: %s, %.1e m off\n", tick, mdhcal_status_text(status), report.position_error_m);
  }
  return 0;
}
