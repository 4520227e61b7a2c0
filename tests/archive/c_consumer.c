/* SPDX-License-Identifier: MIT */
/* What a C program does with the library, right and wrong; compiled as C99 by the C compiler. Each function returns the
 * number of the first check that did not hold, 0 if all did; the body is compiled once a precision. */
#include <string.h>

#include "mdhcal.h"

int c_consumer(const uint8_t* blob, size_t size);
int c_consumer_float(const uint8_t* blob, size_t size);

/* The sizes that the header states. */
typedef char arm_size_is_stated[sizeof(mdhcal_calibrated_arm) == 26624 ? 1 : -1];
typedef char compensator_size_is_stated[sizeof(mdhcal_compensator) == 10240 ? 1 : -1];
typedef char float_arm_size_is_stated[sizeof(mdhcalf_calibrated_arm) == 24064 ? 1 : -1];
typedef char float_compensator_size_is_stated[sizeof(mdhcalf_compensator) == 5376 ? 1 : -1];

#define CHECK(condition) \
  do {                   \
    if (!(condition)) return __LINE__; \
  } while (0)
#define REFUSED(call) CHECK((call) == MDHCAL_BAD_INPUT)

static int untouched(const void* a, const void* b, size_t size) { return memcmp(a, b, size) == 0; }

static int32_t say_no(const uint8_t* message, size_t size, const uint8_t* signature, void* context) {
  (void)message;
  (void)signature;
  *(size_t*)context = size;
  return 0;
}

#define REAL double
#define NAME(name) mdhcal_##name
#define CONSUMER c_consumer
#define CLOSE 1e-8
#define TOLERANCE 1.01e-10
#include "c_consumer_body.h"
#undef REAL
#undef NAME
#undef CONSUMER
#undef CLOSE
#undef TOLERANCE

#define REAL float
#define NAME(name) mdhcalf_##name
#define CONSUMER c_consumer_float
#define CLOSE 1e-3F
#define TOLERANCE 5.05e-6F
#include "c_consumer_body.h"
