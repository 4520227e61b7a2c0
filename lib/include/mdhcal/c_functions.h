/* SPDX-License-Identifier: MIT
 * Included by mdhcal.h only, once a precision; hence no guard. Every function returns an int32_t status; with
 * MDHCAL_BAD_INPUT (a null pointer, storage that was not initialised or is not aligned as a double, a value out of range)
 * outputs are untouched.
 */

/* Storage of a model and of a loop's state; the double is there for alignment. */
typedef union MDHCAL_C_NAME(model) {
  double align;
  unsigned char bytes[MDHCAL_MODEL_SIZE];
} MDHCAL_C_NAME(model);
typedef union MDHCAL_C_NAME(state) {
  double align;
  unsigned char bytes[MDHCAL_STATE_SIZE];
} MDHCAL_C_NAME(state);

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
} MDHCAL_C_NAME(tick_report);
typedef struct MDHCAL_C_NAME(solutions) {
  int32_t count;
  MDHCAL_REAL_TYPE q[MDHCAL_MAX_SOLUTIONS][MDHCAL_MAX_JOINTS];
  MDHCAL_REAL_TYPE distance[MDHCAL_MAX_SOLUTIONS];
} MDHCAL_C_NAME(solutions);

/* Decodes a blob into a model and runs its self-test. `model_size` is sizeof *model and `abi_version`
 * MDHCAL_ABI_VERSION of the header that the caller was compiled with: another one is MDHCAL_BAD_INPUT. Returns
 * MDHCAL_OK; MDHCAL_SELF_TEST_TOLERANCE (the model is usable: another arithmetic, within tolerance);
 * MDHCAL_BAD_ENVIRONMENT; MDHCAL_SELF_TEST_FAILED; or the decoder's refusal; then the model is untouched. `demands` may be
 * NULL. Needs about 8 KiB of stack; once, before the loop. */
int32_t MDHCAL_C_NAME(load)(MDHCAL_C_NAME(model)* model, size_t model_size, uint32_t abi_version, const uint8_t* blob,
                            size_t blob_size, const mdhcal_demands* demands);
/* 1 ... 8, or 0 if the model was not loaded. */
int32_t MDHCAL_C_NAME(joint_count)(const MDHCAL_C_NAME(model)* model);

/* base_T_flange at q; `which` is MDHCAL_NOMINAL or MDHCAL_CORRECTED. `jacobian` [8][6], a row a joint, may be NULL. */
int32_t MDHCAL_C_NAME(forward)(const MDHCAL_C_NAME(model)* model, int32_t which, const MDHCAL_REAL_TYPE* q,
                               MDHCAL_C_NAME(pose)* base_T_flange, MDHCAL_REAL_TYPE (*jacobian)[6]);

/* A loop's state at rest on one of the two models. `state_size` is sizeof *state. */
int32_t MDHCAL_C_NAME(start)(MDHCAL_C_NAME(state)* state, size_t state_size, const MDHCAL_C_NAME(model)* model,
                             int32_t which);
/* start_ramp() and advance() of mdhcal/compensator.hpp. */
int32_t MDHCAL_C_NAME(start_ramp)(MDHCAL_C_NAME(state)* state, int32_t which, MDHCAL_REAL_TYPE duration_s);
int32_t MDHCAL_C_NAME(advance)(MDHCAL_C_NAME(state)* state, MDHCAL_REAL_TYPE period_s);

/* default_tick_options() of the corrected model. */
int32_t MDHCAL_C_NAME(default_tick_options)(const MDHCAL_C_NAME(model)* model, MDHCAL_C_NAME(tick_options)* options);

/* The three forms of the compensator, one tick each; `report` may be NULL. */
int32_t MDHCAL_C_NAME(pose_to_joints)(const MDHCAL_C_NAME(model)* model, const MDHCAL_C_NAME(state)* state,
                                      const MDHCAL_C_NAME(tick_options)* options,
                                      const MDHCAL_C_NAME(pose)* base_T_flange, MDHCAL_REAL_TYPE* q,
                                      MDHCAL_C_NAME(tick_report)* report);
int32_t MDHCAL_C_NAME(joints_to_joints)(const MDHCAL_C_NAME(model)* model, const MDHCAL_C_NAME(state)* state,
                                        const MDHCAL_C_NAME(tick_options)* options, const MDHCAL_REAL_TYPE* nominal_q,
                                        MDHCAL_REAL_TYPE* q, MDHCAL_C_NAME(tick_report)* report);
int32_t MDHCAL_C_NAME(pose_to_pose)(const MDHCAL_C_NAME(model)* model, const MDHCAL_C_NAME(state)* state,
                                    const MDHCAL_C_NAME(tick_options)* options, const MDHCAL_C_NAME(pose)* base_T_flange,
                                    MDHCAL_REAL_TYPE* q, MDHCAL_C_NAME(pose)* command,
                                    MDHCAL_C_NAME(tick_report)* report);

/* joint_velocities(), find_solutions() and cold_start() on the corrected model. */
int32_t MDHCAL_C_NAME(joint_velocities)(const MDHCAL_C_NAME(model)* model, const MDHCAL_REAL_TYPE* q,
                                        const MDHCAL_REAL_TYPE flange_velocity[6],
                                        const MDHCAL_REAL_TYPE* max_velocity, MDHCAL_REAL_TYPE* velocity);
int32_t MDHCAL_C_NAME(find_solutions)(const MDHCAL_C_NAME(model)* model, const MDHCAL_C_NAME(goal_options)* goal,
                                      int32_t restarts, const MDHCAL_C_NAME(pose)* base_T_flange,
                                      const MDHCAL_REAL_TYPE* posture, MDHCAL_C_NAME(solutions)* solutions);
int32_t MDHCAL_C_NAME(cold_start)(const MDHCAL_C_NAME(model)* model, const MDHCAL_C_NAME(goal_options)* goal,
                                  int32_t restarts, const MDHCAL_C_NAME(pose)* base_T_flange, MDHCAL_REAL_TYPE* q);
