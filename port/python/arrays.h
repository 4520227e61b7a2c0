/* SPDX-License-Identifier: MIT
 *
 * The C interface (mdhcal.h) over arrays, in double: loops that a language with slow loops calls once. Rows lie one behind
 * the other: a pose is 7 numbers (quaternion w, x, y, z; position [m]), readings are joint_count numbers ([rad] or [m]).
 * `status` has a number a row, of the function that the loop calls. A row whose status is not usable is NaN in the
 * outputs, and 0 in its report. Null pointers are for the caller to keep out: only those marked may be NULL.
 */
#ifndef MDHCAL_ARRAYS_H
#define MDHCAL_ARRAYS_H

#include "mdhcal.h"

#ifdef __cplusplus
extern "C" {
#endif

/* MDHCAL_ABI_VERSION of this library, and the size of a struct of the C interface, by the order of this list. */
enum {
  MDHCAL_BYTES_OF_ARM,
  MDHCAL_BYTES_OF_COMPENSATOR,
  MDHCAL_BYTES_OF_DEMANDS,
  MDHCAL_BYTES_OF_DESCRIPTION,
  MDHCAL_BYTES_OF_JOINT,
  MDHCAL_BYTES_OF_TICK_OPTIONS,
  MDHCAL_BYTES_OF_TICK_REPORT,
  MDHCAL_BYTES_OF_GOAL_OPTIONS
};
uint32_t mdhcal_abi_version(void);
size_t mdhcal_bytes_of(int32_t structure);

/* mdhcal_forward() a row: q [rows][joints], pose [rows][7], jacobian [rows][joints][6] or NULL. */
void mdhcal_forward_rows(const mdhcal_calibrated_arm* arm, int32_t model, size_t rows, const double* q, double* pose,
                         double* jacobian, int32_t* status);
/* mdhcal_link_frames() a row: frames [rows][joints + 2][7]. */
void mdhcal_link_frames_rows(const mdhcal_calibrated_arm* arm, int32_t model, size_t rows, const double* q, double* frames,
                             int32_t* status);
/* mdhcal_multiply() and mdhcal_invert() a row. */
void mdhcal_multiply_rows(size_t rows, const double* a_T_b, const double* b_T_c, double* a_T_c, int32_t* status);
void mdhcal_invert_rows(size_t rows, const double* a_T_b, double* b_T_a, int32_t* status);

/* mdhcal_pose_to_joints() a row, each from a seed of its own: q [rows][joints], in: seeds, out: joints. */
void mdhcal_inverse_rows(const mdhcal_compensator* compensator, int32_t joints, const mdhcal_tick_options* options,
                         size_t rows, const double* pose, double* q, mdhcal_tick_report* report, int32_t* status);
/* mdhcal_find_solutions() a row: posture [rows][joints], count [rows], q [rows][MDHCAL_MAX_SOLUTIONS][joints],
 * distance [rows][MDHCAL_MAX_SOLUTIONS]; what is beyond count is NaN. */
void mdhcal_find_solutions_rows(const mdhcal_calibrated_arm* arm, const mdhcal_goal_options* goal, int32_t restarts,
                                size_t rows, const double* pose, const double* posture, int32_t* count, double* q,
                                double* distance, int32_t* status);

/* A loop: a row a tick. Each tick advances the ramp, then computes one form of the compensator from the joints of the tick
 * before. `q` [joints], in: the joints before the first tick, out: after the last; `path` [rows][joints]: after each. A tick
 * that is refused leaves the joints where they are. */
void mdhcal_loop_poses_to_joints(mdhcal_compensator* compensator, int32_t joints, const mdhcal_tick_options* options,
                                 size_t rows, const double* user_T_tool, double* q, double* path,
                                 mdhcal_tick_report* report, int32_t* status);
void mdhcal_loop_joints_to_joints(mdhcal_compensator* compensator, int32_t joints, const mdhcal_tick_options* options,
                                  size_t rows, const double* nominal_q, double* q, double* path,
                                  mdhcal_tick_report* report, int32_t* status);
/* The same with `command` [rows][7]: the poses to command to a controller that keeps its nominal model. */
void mdhcal_loop_poses_to_poses(mdhcal_compensator* compensator, int32_t joints, const mdhcal_tick_options* options,
                                size_t rows, const double* user_T_tool, double* q, double* path, double* command,
                                mdhcal_tick_report* report, int32_t* status);

#ifdef __cplusplus
}
#endif

#endif
