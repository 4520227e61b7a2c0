/* SPDX-License-Identifier: MIT
 *
 * The library for C99. Everything below exists twice: mdhcal_... in double, mdhcalf_... in float.
 * A calibrated arm is constant after mdhcal_load() and shared by any number of loops and threads; each loop has a
 * compensator of its own, whose functions belong to the loop's thread: none locks, none may run beside another on the same
 * compensator. A new calibration is loaded elsewhere and handed over to the loop's thread, which calls start_ramp(); the
 * arm before it may change or go once refers_to() is 0. Both are opaque storage of a stated size that the caller owns; nothing is allocated.
 * Units: metres, radians, quaternions w, x, y, z with w >= 0. Joints are readings of the controller [rad] or [m].
 */
#ifndef MDHCAL_H
#define MDHCAL_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Changes with every change of a size, a struct or a signature below. */
#define MDHCAL_ABI_VERSION 3u

#define MDHCAL_MAX_JOINTS 8
#define MDHCAL_MAX_SOLUTIONS 16
#define MDHCAL_MAX_TARGETS 8

/* What each function returns: the numbers of enum class Status (mdhcal/status.hpp), whose comments hold. */
enum {
  MDHCAL_OK = 0,
  MDHCAL_STEP_LIMITED = 1,
  MDHCAL_JOINT_LIMITED = 2,
  MDHCAL_NEAR_SINGULAR = 3,
  MDHCAL_OUT_OF_REACH = 4,
  MDHCAL_NOT_CONVERGED = 5,
  MDHCAL_BAD_INPUT = 6,
  MDHCAL_BAD_ENVIRONMENT = 7,
  MDHCAL_BLOB_MAGIC = 16,
  MDHCAL_BLOB_VERSION = 17,
  MDHCAL_BLOB_SIZE = 18,
  MDHCAL_BLOB_LAYOUT = 19,
  MDHCAL_BLOB_CRC = 20,
  MDHCAL_BLOB_SERIAL = 21,
  MDHCAL_BLOB_VALUE = 22,
  MDHCAL_BLOB_RESERVED = 23,
  MDHCAL_BLOB_DEVIATION = 24,
  MDHCAL_BLOB_UNSIGNED = 25,
  MDHCAL_BLOB_SIGNATURE = 26,
  MDHCAL_BLOB_COUNTER = 27,
  MDHCAL_SELF_TEST_FAILED = 28,
  MDHCAL_SELF_TEST_TOLERANCE = 29,
  /* Of the store, mdhcal_port.h. */
  MDHCAL_FLASH_READ = 48,
  MDHCAL_FLASH_PROGRAM = 49,
  MDHCAL_FLASH_ERASE = 50,
  MDHCAL_FLASH_VERIFY = 51,
  MDHCAL_FLASH_GEOMETRY = 52,
  MDHCAL_STORE_EMPTY = 53,
  MDHCAL_STORE_UNREADABLE = 54
};

/* Which model of the arm. */
enum { MDHCAL_NOMINAL = 0, MDHCAL_CORRECTED = 1 };

/* Which part of a pose an inverse has to meet: enum class Task (mdhcal/inverse.hpp). */
enum { MDHCAL_TASK_POSE = 0, MDHCAL_TASK_POSITION = 1, MDHCAL_TASK_POSITION_AXIS = 2, MDHCAL_TASK_PLANAR = 3 };

/* A check of a signature, brought by the port: 1 if `signature` [64] is the one of `size` bytes at `message`, else 0. */
typedef int32_t (*mdhcal_verify)(const uint8_t* message, size_t size, const uint8_t* signature, void* context);

/* What a caller demands of a blob; all zero: nothing. */
typedef struct mdhcal_demands {
  const char* serial;        /* the robot's serial, zero-terminated; NULL: any */
  mdhcal_verify verify;      /* NULL: signatures are not looked at */
  void* verify_context;      /* passed to verify */
  uint32_t minimum_counter;  /* the least security counter that is accepted */
} mdhcal_demands;

/* What a blob says beside the geometry: struct BlobDescription (mdhcal/blob.hpp), whose comments hold. Texts are UTF-8 and end
 * with a zero byte. */
typedef struct mdhcal_target {
  char name[16];
  double flange_p_m[3];
} mdhcal_target;
typedef struct mdhcal_provenance {
  char tool_version[32], date[16], method[16], lambda_rule[32];
  uint8_t measurements_sha256[32];
  uint32_t pose_count, held_out_count;
  int32_t has_measurements, has_lambda, has_held_out;
  double lambda, mean_before_m, max_before_m, mean_after_m, max_after_m;
  int32_t has_region;
  double region_min_m[3], region_max_m[3], lean_min_m, lean_max_m;
} mdhcal_provenance;
typedef struct mdhcal_tolerances {
  double position_m, rotation_rad;
  float float_position_m, float_rotation_rad;
} mdhcal_tolerances;
typedef struct mdhcal_description {
  char name[64], serial[32];
  int32_t has_base, target_count;
  double tracker_T_base_quaternion[4], tracker_T_base_position_m[3];
  mdhcal_target target[MDHCAL_MAX_TARGETS];
  int32_t family;
  uint32_t security_counter;
  mdhcal_tolerances tolerances;
  double max_velocity[MDHCAL_MAX_JOINTS];
  mdhcal_provenance provenance;
} mdhcal_description;

/* One joint of a calibrated arm. Without a limit its value is 0. */
typedef struct mdhcal_joint {
  int32_t slides;            /* 1: prismatic, readings in [m]; 0: [rad] */
  int32_t has_min, has_max;
  double min, max;
} mdhcal_joint;

/* The status in words: static, never NULL. */
const char* mdhcal_status_text(int32_t status);
/* 1 if what was asked for may be used (usable() of mdhcal/status.hpp), else 0. */
int32_t mdhcal_usable(int32_t status);
/* For each thread that computes: MDHCAL_OK or MDHCAL_BAD_ENVIRONMENT (mdhcal/environment.hpp). */
int32_t mdhcal_check_environment(void);

#define MDHCAL_REAL_TYPE double
#define MDHCAL_ARM_BYTES 26624
#define MDHCAL_COMPENSATOR_BYTES 10240
#define MDHCAL_C_NAME(name) mdhcal_##name
#include "mdhcal/c_functions.h"
#undef MDHCAL_REAL_TYPE
#undef MDHCAL_ARM_BYTES
#undef MDHCAL_COMPENSATOR_BYTES
#undef MDHCAL_C_NAME

#define MDHCAL_REAL_TYPE float
#define MDHCAL_ARM_BYTES 24064
#define MDHCAL_COMPENSATOR_BYTES 5376
#define MDHCAL_C_NAME(name) mdhcalf_##name
#include "mdhcal/c_functions.h"
#undef MDHCAL_REAL_TYPE
#undef MDHCAL_ARM_BYTES
#undef MDHCAL_COMPENSATOR_BYTES
#undef MDHCAL_C_NAME

#ifdef __cplusplus
}
#endif

#endif
