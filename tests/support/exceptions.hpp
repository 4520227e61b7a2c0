// SPDX-License-Identifier: MIT
// The floating-point exceptions that trap where a caller has enabled that: invalid operation, division by zero, overflow.
#pragma once

#include <cfenv>
#include <cstdint>

namespace mdhcal::test {

#ifdef FE_INVALID
inline void clear_exceptions() { std::feclearexcept(FE_ALL_EXCEPT); }
inline bool exceptions_raised() { return std::fetestexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW) != 0; }
#else
// A C library without fenv.h's flags: FPSCR, bits 0 to 2 (Arm Architecture Reference Manual, FPSCR).
inline std::uint32_t status_register() {
  std::uint32_t value = 0;
  __asm__ volatile("vmrs %0, fpscr" : "=r"(value));
  return value;
}
inline void clear_exceptions() { __asm__ volatile("vmsr fpscr, %0" : : "r"(status_register() & ~0x9FU)); }
inline bool exceptions_raised() { return (status_register() & 7U) != 0U; }
#endif

}  // namespace mdhcal::test
