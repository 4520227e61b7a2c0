/* SPDX-License-Identifier: MIT */
/* What a C program does with the library; compiled as C99 by the C compiler. Returns the number of the first check that
 * did not hold, 0 if all did. */
#include <string.h>

#include "mdhcal.h"

int c_consumer(const uint8_t* blob, size_t size);

int c_consumer(const uint8_t* blob, size_t size) {
  static const double start[8] = {0.3, -1.2, 1.5, 0.4, 1.1, -0.6, 0, 0};
  static mdhcal_model model;
  mdhcal_state loop_a, loop_b;
  mdhcal_options options;
  mdhcal_report report;
  mdhcal_pose nominal, corrected, command;
  mdhcal_solutions solutions;
  mdhcal_demands demands;
  double q[8], velocity[8], limit[8], jacobian[8][6];
  const double wanted[6] = {0.01, 0, 0, 0, 0, 0};
  int i;

  if (mdhcal_joint_count(&model) != 0) return 1;
  if (mdhcal_load(&model, sizeof model, MDHCAL_ABI_VERSION + 1u, blob, size, NULL) != MDHCAL_BAD_INPUT) return 2;
  if (mdhcal_load(&model, sizeof model - 1, MDHCAL_ABI_VERSION, blob, size, NULL) != MDHCAL_BAD_INPUT) return 3;
  if (mdhcal_load(&model, sizeof model, MDHCAL_ABI_VERSION, blob, size - 1, NULL) != MDHCAL_BLOB_SIZE) return 4;
  memset(&demands, 0, sizeof demands);
  demands.serial = "another";
  if (mdhcal_load(&model, sizeof model, MDHCAL_ABI_VERSION, blob, size, &demands) != MDHCAL_BLOB_SERIAL) return 5;
  if (mdhcal_joint_count(&model) != 0) return 6;
  if (mdhcal_load(&model, sizeof model, MDHCAL_ABI_VERSION, blob, size, NULL) != MDHCAL_OK) return 7;
  if (mdhcal_joint_count(&model) != 6) return 8;

  if (mdhcal_forward(&model, MDHCAL_NOMINAL, start, &nominal, NULL) != MDHCAL_OK) return 9;
  if (mdhcal_forward(&model, MDHCAL_CORRECTED, start, &corrected, jacobian) != MDHCAL_OK) return 10;
  if (memcmp(&nominal, &corrected, sizeof nominal) == 0) return 11;
  if (mdhcal_forward(&model, 2, start, &nominal, NULL) != MDHCAL_BAD_INPUT) return 12;

  memset(&loop_a, 0, sizeof loop_a);
  if (mdhcal_advance(&loop_a, 0.001) != MDHCAL_BAD_INPUT) return 13;
  if (mdhcal_start(&loop_a, sizeof loop_a, &model, MDHCAL_CORRECTED) != MDHCAL_OK) return 14;
  if (mdhcal_start(&loop_b, sizeof loop_b, &model, MDHCAL_NOMINAL) != MDHCAL_OK) return 15;
  if (mdhcal_default_options(&model, &options) != MDHCAL_OK) return 16;
  memcpy(q, start, sizeof q);
  if (mdhcal_pose_to_joints(&model, &loop_a, &options, &nominal, q, &report) != MDHCAL_OK) return 17;
  if (!(report.position_error_m <= 1e-10)) return 18;
  memcpy(q, start, sizeof q);
  if (mdhcal_joints_to_joints(&model, &loop_a, &options, start, q, &report) != MDHCAL_OK) return 19;
  memcpy(q, start, sizeof q);
  if (mdhcal_pose_to_pose(&model, &loop_b, &options, &nominal, q, &command, NULL) != MDHCAL_OK) return 20;
  for (i = 0; i < 3; ++i) {
    const double d = command.position_m[i] - nominal.position_m[i];
    if (d > 1e-9 || d < -1e-9) return 21;  /* on the nominal model the command is the pose */
  }
  if (mdhcal_start_ramp(&loop_b, MDHCAL_CORRECTED, 0.1) != MDHCAL_OK) return 22;
  for (i = 0; i < 200; ++i) {
    if (mdhcal_advance(&loop_b, 0.001) != MDHCAL_OK) return 23;
  }
  if (mdhcal_pose_to_joints(&model, &loop_b, &options, &corrected, q, NULL) != MDHCAL_OK) return 24;
  for (i = 0; i < 6; ++i) {
    if (q[i] - start[i] > 1e-8 || start[i] - q[i] > 1e-8) return 25;
  }

  for (i = 0; i < 8; ++i) limit[i] = 10;
  if (mdhcal_joint_velocities(&model, start, wanted, limit, velocity) != MDHCAL_OK) return 26;
  if (mdhcal_find_solutions(&model, &options, 0, &corrected, start, &solutions) != MDHCAL_OK) return 27;
  if (solutions.count < 2 || !(solutions.distance[0] < 1e-8)) return 28;
  if (mdhcal_cold_start(&model, &options, 0, &corrected, q) != MDHCAL_OK) return 29;
  if (mdhcal_pose_to_joints(NULL, &loop_a, &options, &nominal, q, NULL) != MDHCAL_BAD_INPUT) return 30;
  if (mdhcal_pose_to_joints(&model, &loop_a, &options, &nominal, NULL, NULL) != MDHCAL_BAD_INPUT) return 31;
  if (strcmp(mdhcal_text(MDHCAL_OK), "ok") != 0) return 32;

  {
    static mdhcalf_model small;
    mdhcalf_pose pose;
    const float at[8] = {0.3F, -1.2F, 1.5F, 0.4F, 1.1F, -0.6F, 0, 0};
    if (mdhcalf_load(&small, sizeof small, MDHCAL_ABI_VERSION, blob, size, NULL) != MDHCAL_OK) return 33;
    if (mdhcalf_forward(&small, MDHCAL_CORRECTED, at, &pose, NULL) != MDHCAL_OK) return 34;
    for (i = 0; i < 3; ++i) {
      const double d = (double)pose.position_m[i] - corrected.position_m[i];
      if (d > 1e-6 || d < -1e-6) return 35;
    }
  }
  return 0;
}
