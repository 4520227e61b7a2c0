/* SPDX-License-Identifier: MIT
 * c_loop BLOB ROWS JOINTS INPUT OUTPUT: what the Python package is held against. INPUT has ROWS readings; OUTPUT gets, in
 * doubles, poses, Jacobians, joints of the inverse from readings 0.01 off, and of a loop at 1 kHz over the readings. Prints the
 * processor time of each [s], the least of five. */
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "mdhcal.h"

static mdhcal_calibrated_arm arm;
static mdhcal_compensator loop;
static mdhcal_tick_options at_once, by_step;
static size_t rows, joints;
static double *q, *results, *seeds;
static mdhcal_pose* poses;
static mdhcal_tick_report* reports;
static int32_t* statuses;
static uint8_t bytes[8160];

static void forward_only(void) {
  size_t row;
  for (row = 0; row < rows; ++row) {
    statuses[row] = mdhcal_forward(&arm, MDHCAL_CORRECTED, q + joints * row, &poses[row], NULL);
  }
}

static void with_jacobian(void) {
  size_t row;
  for (row = 0; row < rows; ++row) {
    statuses[row] = mdhcal_forward(&arm, MDHCAL_CORRECTED, q + joints * row, &poses[row],
                                   (double(*)[6])(results + 6 * joints * row));
  }
}

static void inverse(void) {
  size_t row, k;
  for (row = 0; row < rows; ++row) {
    for (k = 0; k < joints; ++k) results[joints * row + k] = seeds[joints * row + k];
    statuses[row] = mdhcal_pose_to_joints(&loop, &at_once, &poses[row], results + joints * row, &reports[row]);
  }
}

static void servo(void) {
  double last[MDHCAL_MAX_JOINTS];
  size_t row, k;
  for (k = 0; k < joints; ++k) last[k] = q[k];
  for (row = 0; row < rows; ++row) {
    statuses[row] = mdhcal_advance_ramp(&loop);
    if (statuses[row] == MDHCAL_OK) {
      statuses[row] = mdhcal_joints_to_joints(&loop, &by_step, q + joints * row, last, &reports[row]);
    }
    for (k = 0; k < joints; ++k) results[joints * row + k] = last[k];
  }
}

static double now(void) {
  struct timespec time;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void take(void (*work)(void), const void* outcome, size_t size, FILE* out) {
  double least = 1e9;
  int turn;
  for (turn = 0; turn < 5; ++turn) {
    const double begin = now();
    double spent;
    work();
    spent = now() - begin;
    if (spent < least) least = spent;
  }
  printf("%.9f\n", least);
  fwrite(outcome, 1, size, out);
}

int main(int count, char** arguments) {
  FILE *blob, *in, *out;
  size_t size, k;
  if (count != 6) return 2;
  blob = fopen(arguments[1], "rb");
  rows = (size_t)strtoul(arguments[2], NULL, 10);
  joints = (size_t)strtoul(arguments[3], NULL, 10);
  in = fopen(arguments[4], "rb");
  out = fopen(arguments[5], "wb");
  if (blob == NULL || in == NULL || out == NULL) return 2;
  size = fread(bytes, 1, sizeof bytes, blob);
  if (!mdhcal_usable(mdhcal_load(&arm, sizeof arm, MDHCAL_ABI_VERSION, bytes, size, NULL))) return 3;
  if (mdhcal_start_at_rest(&loop, sizeof loop, &arm, MDHCAL_CORRECTED) != MDHCAL_OK ||
      mdhcal_default_tick_options(&arm, 1000.0, &at_once) != MDHCAL_OK ||
      mdhcal_default_tick_options(&arm, 0.001, &by_step) != MDHCAL_OK) {
    return 3;
  }
  q = malloc(rows * joints * sizeof *q);
  seeds = malloc(rows * joints * sizeof *seeds);
  results = malloc(rows * joints * 6 * sizeof *results);
  poses = malloc(rows * sizeof *poses);
  reports = malloc(rows * sizeof *reports);
  statuses = malloc(rows * sizeof *statuses);
  if (q == NULL || seeds == NULL || results == NULL || poses == NULL || reports == NULL || statuses == NULL) return 4;
  if (fread(q, sizeof *q, rows * joints, in) != rows * joints) return 5;
  for (k = 0; k < rows * joints; ++k) seeds[k] = q[k] + 0.01;
  take(forward_only, poses, rows * sizeof *poses, out);
  take(with_jacobian, results, rows * joints * 6 * sizeof *results, out);
  take(inverse, results, rows * joints * sizeof *results, out);
  take(servo, results, rows * joints * sizeof *results, out);
  return fclose(out) == 0 ? 0 : 6;
}
