// SPDX-License-Identifier: MIT
// Private to lib/src. Comparisons and sizes of numbers that may be NaN. Internal linkage throughout.
#pragma once

namespace mdhcal {
namespace {

/// low <= x <= high; no NaN is. Unlike <= it does not signal for one (IEEE 754-2019, sec. 5.11), which traps where a caller
/// has enabled that.
template <class T>
inline bool within(T low, T x, T high) {
  return __builtin_isgreaterequal(x, low) && __builtin_islessequal(x, high);
}

/// |x| <= bound; no NaN is, silently.
inline bool within_bound(double x, double bound) { return __builtin_islessequal(__builtin_fabs(x), bound); }
inline bool within_bound(float x, float bound) { return __builtin_islessequal(__builtin_fabsf(x), bound); }

/// The nearest to x of low ... high.
template <class T>
inline T clamp(T low, T x, T high) {
  return x < low ? low : (x > high ? high : x);
}

/// |x|; the sign bit is cleared, of a zero and of a NaN too.
inline double magnitude(double x) { return __builtin_fabs(x); }
inline float magnitude(float x) { return __builtin_fabsf(x); }

}  // namespace
}  // namespace mdhcal
