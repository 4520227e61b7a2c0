// SPDX-License-Identifier: MIT
// Private to lib/src. The kinematics are compiled twice from one source, once a precision: templates with external
// linkage would be weak symbols, which a consumer's own copy could replace at link time.
#pragma once

#include <float.h>

#include "number/square_root.hpp"

#ifndef MDHCAL_REAL
#error "compile with MDHCAL_REAL=double or MDHCAL_REAL=float"
#endif

// The flags that -ffast-math stands for, where the compiler tells; self_test() notices the others.
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ > 0) || defined(__ASSOCIATIVE_MATH__) || \
    defined(__RECIPROCAL_MATH__) || defined(__NO_SIGNED_ZEROS__) || defined(__NO_TRAPPING_MATH__)
#error "compile mdhcal without -ffast-math and the flags that it stands for: its bits rest on IEEE arithmetic"
#endif

// Excess precision would change the bits between machines.
static_assert(FLT_EVAL_METHOD == 0, "float and double must be evaluated in their own precision");

namespace mdhcal {

using Real = MDHCAL_REAL;

static inline Real square_root(Real x) {
  if constexpr (sizeof(Real) == sizeof(double)) {
#if defined(__arm__) && (!defined(__ARM_FP) || (__ARM_FP & 8) == 0)
    return static_cast<Real>(integer_square_root(static_cast<double>(x)));
#else
    return static_cast<Real>(__builtin_sqrt(static_cast<double>(x)));
#endif
  } else {
    return static_cast<Real>(__builtin_sqrtf(static_cast<float>(x)));
  }
}

}  // namespace mdhcal
