/* SPDX-License-Identifier: MIT */
#include "arrays.h"

#include <math.h>
#include <string.h>

/* A row of an array is a pose, number for number. */
typedef char pose_has_no_gaps[sizeof(mdhcal_pose) == 7 * sizeof(double) ? 1 : -1];

static mdhcal_pose pose_at(const double* poses, size_t row) {
  mdhcal_pose pose;
  memcpy(&pose, poses + 7 * row, sizeof pose);
  return pose;
}

static void put_pose(int32_t status, const mdhcal_pose* pose, double* poses, size_t row) {
  size_t k;
  if (mdhcal_usable(status)) {
    memcpy(poses + 7 * row, pose, sizeof *pose);
  } else {
    for (k = 0; k < 7; ++k) poses[7 * row + k] = (double)NAN;
  }
}

static void fill(double* values, size_t count) {
  size_t k;
  for (k = 0; k < count; ++k) values[k] = (double)NAN;
}

uint32_t mdhcal_abi_version(void) { return MDHCAL_ABI_VERSION; }

size_t mdhcal_bytes_of(int32_t structure) {
  switch (structure) {
    case MDHCAL_BYTES_OF_ARM: return sizeof(mdhcal_calibrated_arm);
    case MDHCAL_BYTES_OF_COMPENSATOR: return sizeof(mdhcal_compensator);
    case MDHCAL_BYTES_OF_DEMANDS: return sizeof(mdhcal_demands);
    case MDHCAL_BYTES_OF_DESCRIPTION: return sizeof(mdhcal_description);
    case MDHCAL_BYTES_OF_JOINT: return sizeof(mdhcal_joint);
    case MDHCAL_BYTES_OF_TICK_OPTIONS: return sizeof(mdhcal_tick_options);
    case MDHCAL_BYTES_OF_TICK_REPORT: return sizeof(mdhcal_tick_report);
    case MDHCAL_BYTES_OF_GOAL_OPTIONS: return sizeof(mdhcal_goal_options);
    default: return 0;
  }
}

void mdhcal_forward_rows(const mdhcal_calibrated_arm* arm, int32_t model, size_t rows, const double* q, double* pose,
                         double* jacobian, int32_t* status) {
  const size_t joints = (size_t)mdhcal_joint_count(arm);
  size_t row;
  for (row = 0; row < rows; ++row) {
    mdhcal_pose one;
    double columns[MDHCAL_MAX_JOINTS][6];
    status[row] = mdhcal_forward(arm, model, q + joints * row, &one, jacobian == NULL ? NULL : columns);
    put_pose(status[row], &one, pose, row);
    if (jacobian == NULL) continue;
    if (mdhcal_usable(status[row])) {
      memcpy(jacobian + 6 * joints * row, columns, 6 * joints * sizeof(double));
    } else {
      fill(jacobian + 6 * joints * row, 6 * joints);
    }
  }
}

void mdhcal_link_frames_rows(const mdhcal_calibrated_arm* arm, int32_t model, size_t rows, const double* q, double* frames,
                             int32_t* status) {
  const size_t joints = (size_t)mdhcal_joint_count(arm);
  size_t row, k;
  for (row = 0; row < rows; ++row) {
    mdhcal_pose along[MDHCAL_MAX_JOINTS + 2];
    status[row] = mdhcal_link_frames(arm, model, q + joints * row, along);
    for (k = 0; k < joints + 2; ++k) put_pose(status[row], &along[k], frames, (joints + 2) * row + k);
  }
}

void mdhcal_multiply_rows(size_t rows, const double* a_T_b, const double* b_T_c, double* a_T_c, int32_t* status) {
  size_t row;
  for (row = 0; row < rows; ++row) {
    const mdhcal_pose first = pose_at(a_T_b, row), second = pose_at(b_T_c, row);
    mdhcal_pose product;
    status[row] = mdhcal_multiply(&first, &second, &product);
    put_pose(status[row], &product, a_T_c, row);
  }
}

void mdhcal_invert_rows(size_t rows, const double* a_T_b, double* b_T_a, int32_t* status) {
  size_t row;
  for (row = 0; row < rows; ++row) {
    const mdhcal_pose pose = pose_at(a_T_b, row);
    mdhcal_pose inverse;
    status[row] = mdhcal_invert(&pose, &inverse);
    put_pose(status[row], &inverse, b_T_a, row);
  }
}

void mdhcal_inverse_rows(const mdhcal_compensator* compensator, int32_t joints, const mdhcal_tick_options* options,
                         size_t rows, const double* pose, double* q, mdhcal_tick_report* report, int32_t* status) {
  size_t row;
  for (row = 0; row < rows; ++row) {
    const mdhcal_pose target = pose_at(pose, row);
    double* reading = q + (size_t)joints * row;
    memset(&report[row], 0, sizeof report[row]);
    status[row] = mdhcal_pose_to_joints(compensator, options, &target, reading, &report[row]);
    if (!mdhcal_usable(status[row])) fill(reading, (size_t)joints);
  }
}

void mdhcal_find_solutions_rows(const mdhcal_calibrated_arm* arm, const mdhcal_goal_options* goal, int32_t restarts,
                                size_t rows, const double* pose, const double* posture, int32_t* count, double* q,
                                double* distance, int32_t* status) {
  const size_t joints = (size_t)mdhcal_joint_count(arm);
  size_t row, k;
  fill(q, rows * MDHCAL_MAX_SOLUTIONS * joints);
  fill(distance, rows * MDHCAL_MAX_SOLUTIONS);
  for (row = 0; row < rows; ++row) {
    const mdhcal_pose target = pose_at(pose, row);
    mdhcal_solutions found;
    found.count = 0;
    status[row] = mdhcal_find_solutions(arm, goal, restarts, &target, posture + joints * row, &found);
    count[row] = found.count;
    for (k = 0; k < (size_t)found.count; ++k) {
      const size_t at = MDHCAL_MAX_SOLUTIONS * row + k;
      memcpy(q + joints * at, found.q[k], joints * sizeof(double));
      distance[at] = found.distance[k];
    }
  }
}

/* The joints of a tick, into the path. */
static void keep(size_t joints, size_t row, const double* q, double* path) {
  memcpy(path + joints * row, q, joints * sizeof(double));
}

void mdhcal_loop_poses_to_joints(mdhcal_compensator* compensator, int32_t joints, const mdhcal_tick_options* options,
                                 size_t rows, const double* user_T_tool, double* q, double* path,
                                 mdhcal_tick_report* report, int32_t* status) {
  size_t row;
  for (row = 0; row < rows; ++row) {
    const mdhcal_pose target = pose_at(user_T_tool, row);
    memset(&report[row], 0, sizeof report[row]);
    status[row] = mdhcal_advance_ramp(compensator);
    if (status[row] == MDHCAL_OK) {
      status[row] = mdhcal_pose_to_joints(compensator, options, &target, q, &report[row]);
    }
    keep((size_t)joints, row, q, path);
  }
}

void mdhcal_loop_joints_to_joints(mdhcal_compensator* compensator, int32_t joints, const mdhcal_tick_options* options,
                                  size_t rows, const double* nominal_q, double* q, double* path,
                                  mdhcal_tick_report* report, int32_t* status) {
  size_t row;
  for (row = 0; row < rows; ++row) {
    memset(&report[row], 0, sizeof report[row]);
    status[row] = mdhcal_advance_ramp(compensator);
    if (status[row] == MDHCAL_OK) {
      status[row] = mdhcal_joints_to_joints(compensator, options, nominal_q + (size_t)joints * row, q, &report[row]);
    }
    keep((size_t)joints, row, q, path);
  }
}

void mdhcal_loop_poses_to_poses(mdhcal_compensator* compensator, int32_t joints, const mdhcal_tick_options* options,
                                size_t rows, const double* user_T_tool, double* q, double* path, double* command,
                                mdhcal_tick_report* report, int32_t* status) {
  size_t row;
  for (row = 0; row < rows; ++row) {
    const mdhcal_pose target = pose_at(user_T_tool, row);
    mdhcal_pose pose;
    memset(&report[row], 0, sizeof report[row]);
    status[row] = mdhcal_advance_ramp(compensator);
    if (status[row] == MDHCAL_OK) {
      status[row] = mdhcal_pose_to_pose(compensator, options, &target, q, &pose, &report[row]);
    }
    put_pose(status[row], &pose, command, row);
    keep((size_t)joints, row, q, path);
  }
}
