/* SPDX-License-Identifier: MIT
 *
 * The library for C99. Everything below exists twice: mdhcal_... in double, mdhcalf_... in float.
 * A model is constant after mdhcal_load() and shared by any number of loops; each loop has a state of its own. Both are
 * opaque storage of a stated size that the caller owns; nothing is allocated.
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
#define MDHCAL_ABI_VERSION 1u

#define MDHCAL_MAX_JOINTS 8
#define MDHCAL_MAX_SOLUTIONS 16
#define MDHCAL_MODEL_SIZE 3072   /* [byte] */
#define MDHCAL_STATE_SIZE 64     /* [byte] */

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
  MDHCAL_SELF_TEST_TOLERANCE = 29
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

/* The status in words: static, never NULL. */
const char* mdhcal_status_text(int32_t status);

#define MDHCAL_REAL_TYPE double
#define MDHCAL_C_NAME(name) mdhcal_##name
#include "mdhcal/c_functions.h"
#undef MDHCAL_REAL_TYPE
#undef MDHCAL_C_NAME

#define MDHCAL_REAL_TYPE float
#define MDHCAL_C_NAME(name) mdhcalf_##name
#include "mdhcal/c_functions.h"
#undef MDHCAL_REAL_TYPE
#undef MDHCAL_C_NAME

#ifdef __cplusplus
}
#endif

#endif
