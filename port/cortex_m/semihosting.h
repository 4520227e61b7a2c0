// SPDX-License-Identifier: MIT
// The semihosting calls that the Cortex-M images use (Arm, "Semihosting for AArch32 and AArch64").
#pragma once

#include <stdint.h>

static inline uintptr_t semihosting_call(uintptr_t operation, const void* argument) {
  register uintptr_t r0 __asm("r0") = operation;
  register const void* r1 __asm("r1") = argument;
  __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

/// Prints a string on the debugger's console.
static inline void semihosting_write(const char* text) { (void)semihosting_call(0x04, text); }

/// Ends the image with an exit status.
__attribute__((noreturn)) static inline void semihosting_exit(uint32_t status) {
  const uintptr_t block[2] = {0x20026U /* application exit */, status};
  (void)semihosting_call(0x20, block);
  for (;;) {
  }
}

/// Copies the command line into `to`, an empty string where there is none.
static inline void semihosting_command_line(char* to, uint32_t size) {
  const struct {
    char* buffer;
    uintptr_t size;
  } block = {to, size};
  if (semihosting_call(0x15, &block) != 0U) to[0] = '\0';
}
