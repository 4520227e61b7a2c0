// SPDX-License-Identifier: MIT
// Instructions and stack of a call, on the emulated machines. QEMU runs with `-icount shift=10`: one instruction takes
// 1024 ns of the machine's time, so a timer of the machine counts instructions exactly, the same in every run.
#pragma once

#include <cstdint>

namespace footprint {

inline volatile std::uint32_t& device(std::uintptr_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

#if __ARM_ARCH >= 8
// SSE-300: the system timestamp counter, 32 MHz; control frame and read frame.
inline void start_counter() { device(0x58100000U) = 1U; }
inline std::uint32_t ticks() { return device(0x58101000U); }
inline constexpr std::uint64_t ticks_per_1024_us = 32768;
#else
// MPS2: CMSDK timer 0, 25 MHz, counting down.
inline void start_counter() {
  device(0x40000008U) = 0xFFFFFFFFU;
  device(0x40000004U) = 0xFFFFFFFFU;
  device(0x40000000U) = 1U;
}
inline std::uint32_t ticks() { return ~device(0x40000004U); }
inline constexpr std::uint64_t ticks_per_1024_us = 25600;
#endif

using Call = void (*)();

/// The instructions between the two readings of the counter, the overhead of reading it included.
[[gnu::noinline]] inline std::uint32_t raw_instructions(Call call) {
  const std::uint32_t begin = ticks();
  call();
  const std::uint64_t spent = ticks() - begin;
  return static_cast<std::uint32_t>((spent * 1000U + ticks_per_1024_us / 2U) / ticks_per_1024_us);
}

/// The bytes of stack that a call uses: the stack below is painted before and looked at afterwards.
[[gnu::noinline]] inline std::uint32_t painted_stack(Call call) {
  constexpr std::uint32_t paint = 0xA5C35A3CU;
  constexpr std::uintptr_t depth = 64U * 1024U;
  std::uintptr_t top = 0;
  __asm volatile("mov %0, sp" : "=r"(top));
  const std::uintptr_t bottom = top - depth;
  for (std::uintptr_t at = bottom; at < top; at += 4) device(at) = paint;
  call();
  std::uintptr_t reached = bottom;
  while (reached < top && device(reached) == paint) reached += 4;
  return static_cast<std::uint32_t>(top - reached);
}

}  // namespace footprint
