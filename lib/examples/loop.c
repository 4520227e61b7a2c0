/* SPDX-License-Identifier: MIT */
#include <mdhcal.h>
#include <stdio.h>
#include <time.h>

static mdhcal_calibrated_arm arm;
static mdhcal_compensator loop;

int main(int count, char** arguments) {
  static uint8_t bytes[8160];
  mdhcal_tick_options options;
  double nominal_q[MDHCAL_MAX_JOINTS] = {0.5, 0.4, 0.6, 0.5, 0.7, 0.5}, q[MDHCAL_MAX_JOINTS] = {0.5, 0.4, 0.6, 0.5, 0.7, 0.5};
  FILE* file = count == 2 ? fopen(arguments[1], "rb") : NULL;
  const size_t size = file != NULL ? fread(bytes, 1, sizeof bytes, file) : 0;
  if (!mdhcal_usable(mdhcal_load(&arm, sizeof arm, MDHCAL_ABI_VERSION, bytes, size, NULL))) return 1;
  if (mdhcal_start_at_rest(&loop, sizeof loop, &arm, MDHCAL_CORRECTED) != MDHCAL_OK) return 1;
  if (mdhcal_default_tick_options(&arm, 0.001, &options) != MDHCAL_OK) return 1;
  for (int tick = 0; tick < 1000; ++tick) {
    nanosleep(&(struct timespec){0, 1000000}, NULL);
    nominal_q[0] += 0.0001;                                                               /* of your controller's inverse */
    if (!mdhcal_usable(mdhcal_joints_to_joints(&loop, &options, nominal_q, q, NULL))) return 2; /* q: to command instead */
  }
  return printf("joint 1 at %.6f rad\n", q[0]) > 0 ? 0 : 3;
}
