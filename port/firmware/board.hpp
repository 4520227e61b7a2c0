// SPDX-License-Identifier: MIT
// The MPS2 board with a Cortex-M7 (AN500): a timer, a UART, and 16 MiB of RAM that stands in for flash.
#pragma once

#include <cstdint>

namespace firmware::board {

inline volatile std::uint32_t& device(std::uintptr_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

/// Timer 0 runs at 25 MHz and interrupts every `period` of its ticks.
inline constexpr std::uint32_t timer_hz = 25000000;
inline void start_timer(std::uint32_t period) {
  device(0x40000008U) = period - 1U;  // reload
  device(0x40000004U) = period - 1U;  // value
  device(0x40000000U) = 0x9U;         // count, interrupt
  device(0xE000E408U) = 0U;           // before every other interrupt
  device(0xE000E100U) = 1U << 8;      // the NVIC lets interrupt 8 through
}
inline void acknowledge_timer() { device(0x4000000CU) = 1U; }
/// Ticks of the timer until it interrupts again.
inline std::uint32_t until_interrupt() { return device(0x40000004U); }

/// UART 0 interrupts for every byte.
inline void start_uart() {
  device(0x40004010U) = 16U;    // the shortest bit
  device(0x40004008U) = 0xBU;   // send, receive, interrupt when a byte is there
  device(0xE000E400U) = 0x80U;  // after the timer
  device(0xE000E100U) = 1U;     // the NVIC lets interrupt 0 through
}
inline bool receive(std::uint8_t& byte) {
  device(0x4000400CU) = 2U;  // acknowledge
  if ((device(0x40004004U) & 2U) == 0U) return false;
  byte = static_cast<std::uint8_t>(device(0x40004000U));
  return true;
}

inline void wait_for_interrupt() { __asm volatile("wfi" ::: "memory"); }

inline constexpr std::uintptr_t flash_region = 0x60000000U;

}  // namespace firmware::board
