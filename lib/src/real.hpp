// SPDX-License-Identifier: MIT
// Private to lib/src. The kinematics are compiled twice from one source, once a precision: templates with external
// linkage would be weak symbols, which a consumer's own copy could replace at link time.
#pragma once

#include <cfloat>

#ifndef MDHCAL_REAL
#error "compile with MDHCAL_REAL=double or MDHCAL_REAL=float"
#endif

// Excess precision would change the bits between machines.
static_assert(FLT_EVAL_METHOD == 0, "float and double must be evaluated in their own precision");

namespace mdhcal {
using Real = MDHCAL_REAL;
}
