// SPDX-License-Identifier: MIT
// Private to lib/src. The comparison for numbers that may be NaN. Internal linkage throughout.
#pragma once

namespace mdhcal {
namespace {

/// low <= x <= high; no NaN is. Unlike <= it does not signal for one (IEEE 754-2019, sec. 5.11), which traps where a caller
/// has enabled that.
template <class T>
inline bool within(T low, T x, T high) {
  return __builtin_isgreaterequal(x, low) && __builtin_islessequal(x, high);
}

}  // namespace
}  // namespace mdhcal
