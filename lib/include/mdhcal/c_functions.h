/* SPDX-License-Identifier: MIT
 * Included by mdhcal.h only, once a precision; hence no guard. Every function returns an int32_t status; with
 * MDHCAL_BAD_INPUT (a null pointer, storage that was not initialised or is not aligned as a double, a value out of range)
 * outputs are untouched.
 */

/* Storage of a calibrated arm and of a compensator; the double is there for alignment. An arm with joint functions is not
 * copied to other storage (every function refuses the copy), and stays until refers_to() says 0 for every compensator. */
typedef union MDHCAL_C_NAME(calibrated_arm) {
  double align;
  unsigned char bytes[MDHCAL_ARM_BYTES];
} MDHCAL_C_NAME(calibrated_arm);
typedef union MDHCAL_C_NAME(compensator) {
  double align;
  unsigned char bytes[MDHCAL_COMPENSATOR_BYTES];
} MDHCAL_C_NAME(compensator);

/* As struct Pose, TickOptions with its parts, TickReport and Solutions of the C++ headers, whose comments hold. */
typedef struct MDHCAL_C_NAME(pose) {
  MDHCAL_REAL_TYPE quaternion[4];  /* w, x, y, z */
  MDHCAL_REAL_TYPE position_m[3];
} MDHCAL_C_NAME(pose);
typedef struct MDHCAL_C_NAME(goal_options) {
  MDHCAL_REAL_TYPE position_tolerance_m;
  MDHCAL_REAL_TYPE rotation_tolerance_rad;
  MDHCAL_REAL_TYPE position_weight;
  MDHCAL_REAL_TYPE rotation_weight;
  int32_t task;
} MDHCAL_C_NAME(goal_options);
typedef struct MDHCAL_C_NAME(step_limits) {
  MDHCAL_REAL_TYPE max_step[MDHCAL_MAX_JOINTS];  /* [rad] or [m] a tick */
} MDHCAL_C_NAME(step_limits);
typedef struct MDHCAL_C_NAME(posture_options) {
  MDHCAL_REAL_TYPE q[MDHCAL_MAX_JOINTS];  /* [rad] or [m] */
  MDHCAL_REAL_TYPE gain;
} MDHCAL_C_NAME(posture_options);
typedef struct MDHCAL_C_NAME(tick_options) {
  MDHCAL_C_NAME(goal_options) goal;
  MDHCAL_C_NAME(step_limits) limits;
  MDHCAL_C_NAME(posture_options) posture;
  int32_t max_iterations;
} MDHCAL_C_NAME(tick_options);
typedef struct MDHCAL_C_NAME(tick_report) {
  MDHCAL_REAL_TYPE position_error_m;
  MDHCAL_REAL_TYPE rotation_error_rad;
  MDHCAL_REAL_TYPE smallest_singular_value;
  int32_t iterations;
  uint32_t step_mask;
  uint32_t limit_mask;
  uint32_t unseen_mask;
} MDHCAL_C_NAME(tick_report);
typedef struct MDHCAL_C_NAME(solutions) {
  int32_t count;
  MDHCAL_REAL_TYPE q[MDHCAL_MAX_SOLUTIONS][MDHCAL_MAX_JOINTS];
  MDHCAL_REAL_TYPE distance[MDHCAL_MAX_SOLUTIONS];
} MDHCAL_C_NAME(solutions);

typedef struct MDHCAL_C_NAME(rate_limits) {
  MDHCAL_REAL_TYPE max_velocity[MDHCAL_MAX_JOINTS];      /* [rad/s] or [m/s] */
  MDHCAL_REAL_TYPE max_acceleration[MDHCAL_MAX_JOINTS];  /* [rad/s^2] or [m/s^2] */
} MDHCAL_C_NAME(rate_limits);

/* load() of mdhcal/calibrated_arm.hpp. `arm_size` is sizeof *arm and `abi_version` MDHCAL_ABI_VERSION of the header that the
 * caller was compiled with: another one is MDHCAL_BAD_INPUT. mdhcal_usable() says of the status whether the arm may be
 * used; otherwise it is untouched. `demands` may be NULL: the blob's serial, signature and counter are then not looked at.
 * Needs about 18 KiB of stack; once, before the loop. */
int32_t MDHCAL_C_NAME(load)(MDHCAL_C_NAME(calibrated_arm)* arm, size_t arm_size, uint32_t abi_version,
                            const uint8_t* blob, size_t blob_size, const mdhcal_demands* demands);
/* 1 ... 8, or 0 if the arm was not loaded. */
int32_t MDHCAL_C_NAME(joint_count)(const MDHCAL_C_NAME(calibrated_arm)* arm);
/* Kind and limits of joint 0 ... joint_count - 1 on the corrected model. */
int32_t MDHCAL_C_NAME(describe_joint)(const MDHCAL_C_NAME(calibrated_arm)* arm, int32_t index, mdhcal_joint* joint);
int32_t MDHCAL_C_NAME(describe)(const MDHCAL_C_NAME(calibrated_arm)* arm, mdhcal_description* description);
/* The calibrated target point of this name as flange_T_target, not turned: a tool for start_frame_ramp(). */
int32_t MDHCAL_C_NAME(find_target)(const MDHCAL_C_NAME(calibrated_arm)* arm, const char* name,
                                   MDHCAL_C_NAME(pose)* flange_T_target);

/* base_T_flange at q; `model` is MDHCAL_NOMINAL or MDHCAL_CORRECTED. `jacobian` [8][6], a row a joint, may be NULL. */
int32_t MDHCAL_C_NAME(forward)(const MDHCAL_C_NAME(calibrated_arm)* arm, int32_t model, const MDHCAL_REAL_TYPE* q,
                               MDHCAL_C_NAME(pose)* base_T_flange, MDHCAL_REAL_TYPE (*jacobian)[6]);
/* base_T_0 (identity), base_T_1 ... base_T_N, base_T_flange: joint_count + 2 poses. */
int32_t MDHCAL_C_NAME(link_frames)(const MDHCAL_C_NAME(calibrated_arm)* arm, int32_t model, const MDHCAL_REAL_TYPE* q,
                                   MDHCAL_C_NAME(pose)* frames);
/* multiply() and invert() of mdhcal/pose.hpp. */
int32_t MDHCAL_C_NAME(multiply)(const MDHCAL_C_NAME(pose)* a_T_b, const MDHCAL_C_NAME(pose)* b_T_c,
                                MDHCAL_C_NAME(pose)* a_T_c);
int32_t MDHCAL_C_NAME(invert)(const MDHCAL_C_NAME(pose)* a_T_b, MDHCAL_C_NAME(pose)* b_T_a);

/* The functions of mdhcal/compensator.hpp. `size` is sizeof *compensator. */
int32_t MDHCAL_C_NAME(start_at_rest)(MDHCAL_C_NAME(compensator)* compensator, size_t size,
                                     const MDHCAL_C_NAME(calibrated_arm)* arm, int32_t model);
int32_t MDHCAL_C_NAME(start_ramp)(MDHCAL_C_NAME(compensator)* compensator, const MDHCAL_C_NAME(calibrated_arm)* arm,
                                  int32_t model, uint32_t ticks);
int32_t MDHCAL_C_NAME(start_frame_ramp)(MDHCAL_C_NAME(compensator)* compensator,
                                        const MDHCAL_C_NAME(pose)* base_T_user,
                                        const MDHCAL_C_NAME(pose)* flange_T_tool, uint32_t ticks);
int32_t MDHCAL_C_NAME(start_payload_ramp)(MDHCAL_C_NAME(compensator)* compensator, MDHCAL_REAL_TYPE payload_kg,
                                          uint32_t ticks);
int32_t MDHCAL_C_NAME(advance_ramp)(MDHCAL_C_NAME(compensator)* compensator);
/* Ticks until it is at rest; 0 for one that was not started, too. */
uint32_t MDHCAL_C_NAME(ramp_ticks_left)(const MDHCAL_C_NAME(compensator)* compensator);
/* 1 as long as the arm must not change for the compensator's sake, else 0. */
int32_t MDHCAL_C_NAME(refers_to)(const MDHCAL_C_NAME(compensator)* compensator, const MDHCAL_C_NAME(calibrated_arm)* arm);

/* default_tick_options() of mdhcal/calibrated_arm.hpp: the blob's tolerances, and step limits for the loop's period [s]. */
int32_t MDHCAL_C_NAME(default_tick_options)(const MDHCAL_C_NAME(calibrated_arm)* arm, MDHCAL_REAL_TYPE period_s,
                                            MDHCAL_C_NAME(tick_options)* options);

/* The three forms of the compensator, one tick each; `report` may be NULL. */
int32_t MDHCAL_C_NAME(pose_to_joints)(const MDHCAL_C_NAME(compensator)* compensator,
                                      const MDHCAL_C_NAME(tick_options)* options,
                                      const MDHCAL_C_NAME(pose)* user_T_tool, MDHCAL_REAL_TYPE* q,
                                      MDHCAL_C_NAME(tick_report)* report);
int32_t MDHCAL_C_NAME(joints_to_joints)(const MDHCAL_C_NAME(compensator)* compensator,
                                        const MDHCAL_C_NAME(tick_options)* options, const MDHCAL_REAL_TYPE* nominal_q,
                                        MDHCAL_REAL_TYPE* q, MDHCAL_C_NAME(tick_report)* report);
int32_t MDHCAL_C_NAME(pose_to_pose)(const MDHCAL_C_NAME(compensator)* compensator,
                                    const MDHCAL_C_NAME(tick_options)* options,
                                    const MDHCAL_C_NAME(pose)* user_T_tool, MDHCAL_REAL_TYPE* q,
                                    MDHCAL_C_NAME(pose)* command, MDHCAL_C_NAME(tick_report)* report);

/* joint_velocities() with the ramp's motion taken out, and joint_accelerations() on the corrected model. */
int32_t MDHCAL_C_NAME(joint_velocities)(const MDHCAL_C_NAME(compensator)* compensator, const MDHCAL_REAL_TYPE* q,
                                        const MDHCAL_REAL_TYPE tool_velocity[6], MDHCAL_REAL_TYPE period_s,
                                        const MDHCAL_C_NAME(rate_limits)* limits, MDHCAL_REAL_TYPE* velocity);
int32_t MDHCAL_C_NAME(joint_accelerations)(const MDHCAL_C_NAME(calibrated_arm)* arm, const MDHCAL_REAL_TYPE* q,
                                           const MDHCAL_REAL_TYPE* velocity,
                                           const MDHCAL_REAL_TYPE flange_acceleration[6],
                                           const MDHCAL_C_NAME(rate_limits)* limits, MDHCAL_REAL_TYPE* acceleration);

/* find_solutions() and cold_start() on the corrected model; the goal of default_tick_options() will do. `restarts`, 0 ... 400:
 * 0 for an arm with a closed form (description.family), else 100. */
int32_t MDHCAL_C_NAME(find_solutions)(const MDHCAL_C_NAME(calibrated_arm)* arm, const MDHCAL_C_NAME(goal_options)* goal,
                                      int32_t restarts, const MDHCAL_C_NAME(pose)* base_T_flange,
                                      const MDHCAL_REAL_TYPE* posture, MDHCAL_C_NAME(solutions)* solutions);
int32_t MDHCAL_C_NAME(cold_start)(const MDHCAL_C_NAME(calibrated_arm)* arm, const MDHCAL_C_NAME(goal_options)* goal,
                                  int32_t restarts, const MDHCAL_C_NAME(pose)* base_T_flange, MDHCAL_REAL_TYPE* q);
