// SPDX-License-Identifier: MIT
// Instructions and stack of a call, in the emulator. On the machines QEMU runs with `-icount shift=10`: one instruction
// takes 1024 ns of the machine's time, so a timer of the machine counts instructions exactly, the same in every run. On
// Linux a plugin of QEMU's counts (count_plugin.c); here the counter stands still, and only marks the moment.
#pragma once

#include <cstdint>

#if defined(__linux__)
#include <unistd.h>
#endif

namespace footprint {

inline volatile std::uint32_t& device(std::uintptr_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

#if defined(__linux__)
inline void start_counter() {}
inline std::uint32_t ticks() {
  syscall(0x6D64);
  return 0;
}
inline constexpr std::uint64_t ticks_per_1024_us = 1;
#elif __ARM_ARCH >= 8
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

/// The instructions between two readings of the counter, the overhead of reading it included.
inline std::uint32_t instructions(std::uint32_t begin, std::uint32_t end) {
  const std::uint64_t spent = end - begin;
  return static_cast<std::uint32_t>((spent * 1000U + ticks_per_1024_us / 2U) / ticks_per_1024_us);
}

[[gnu::noinline]] inline std::uint32_t raw_instructions(Call call) {
  const std::uint32_t begin = ticks();
  call();
  return instructions(begin, ticks());
}

struct Cost {
  std::uint32_t instructions;  ///< as raw_instructions() counts
  std::uint32_t stack_bytes;   ///< the stack below is painted before the call and looked at after it
};

[[gnu::noinline]] inline Cost cost_of(Call call) {
  constexpr std::uint32_t paint = 0xA5C35A3CU;
  constexpr std::uintptr_t depth = 16U * 1024U;
  std::uintptr_t top = 0;
#if defined(__x86_64__)
  __asm volatile("mov %%rsp, %0" : "=r"(top));
#else
  __asm volatile("mov %0, sp" : "=r"(top));
#endif
  const std::uintptr_t bottom = top - depth;
  for (std::uintptr_t at = bottom; at < top; at += 4) device(at) = paint;
  const std::uint32_t begin = ticks();
  call();
  const std::uint32_t end = ticks();
  std::uintptr_t reached = bottom;
  while (reached < top && device(reached) == paint) reached += 4;
  return {instructions(begin, end), static_cast<std::uint32_t>(top - reached)};
}

}  // namespace footprint
