// SPDX-License-Identifier: MIT
// Start-up of a Cortex-M image that runs under semihosting: vectors, memory, FPU, arguments, named faults.
#include <stdint.h>
#include <stdlib.h>

#include "semihosting.h"

extern uint32_t data_load[], data_start[], data_end[], bss_start[], bss_end[], stack_top[];
extern int main(int argc, char** argv);
extern void initialise_monitor_handles(void);
extern void __libc_init_array(void);

void reset_handler(void);
void fault_handler(void);
void timer0_handler(void);
void uart0_receive_handler(void);
void unexpected_handler(void);

// Asked for by newlib's constructors and destructors; there is nothing to do in them here.
void* __dso_handle = 0;
void _init(void) {}
void _fini(void) {}

static volatile uint32_t* const cpacr = (volatile uint32_t*)0xE000ED88U;
static volatile uint32_t* const cfsr = (volatile uint32_t*)0xE000ED28U;

// Exit status of an image that met a fault: not one of a test program's.
enum { fault_status = 70 };

static void write_hex(uint32_t value) {
  char text[11] = "0x00000000";
  for (int digit = 9; digit >= 2; --digit) {
    text[digit] = "0123456789abcdef"[value & 15U];
    value >>= 4;
  }
  semihosting_write(text);
}

void fault_handler(void) {
  // Bits of the configurable fault status register (Armv7-M and Armv8-M Architecture Reference Manuals).
  static const struct {
    uint32_t bit;
    const char* name;
  } names[] = {{1U << 0, " instruction access violation"}, {1U << 1, " data access violation"},
               {1U << 8, " instruction bus error"},        {1U << 9, " precise data bus error"},
               {1U << 10, " imprecise data bus error"},    {1U << 16, " undefined instruction"},
               {1U << 17, " invalid state"},               {1U << 18, " invalid return address"},
               {1U << 19, " no coprocessor"},              {1U << 20, " stack overflow"},
               {1U << 24, " unaligned access"},            {1U << 25, " division by zero"}};
  const uint32_t cause = *cfsr;
  semihosting_write("fault: CFSR ");
  write_hex(cause);
  for (unsigned i = 0; i < sizeof names / sizeof names[0]; ++i) {
    if ((cause & names[i].bit) != 0U) semihosting_write(names[i].name);
  }
  semihosting_write("\n");
  semihosting_exit(fault_status);
}

void unexpected_handler(void) {
  semihosting_write("fault: unexpected exception\n");
  semihosting_exit(fault_status);
}

// An image that uses UART 0 or timer 0 defines its own.
__attribute__((weak)) void uart0_receive_handler(void) { unexpected_handler(); }
__attribute__((weak)) void timer0_handler(void) { unexpected_handler(); }

// Interrupts 0 and 8 of the MPS2 boards; the images for the MPS3 board use none.
__attribute__((section(".vectors"), used)) static void (*const vectors[])(void) = {
    (void (*)(void))(uintptr_t)stack_top,
    reset_handler,
    unexpected_handler,
    fault_handler,
    fault_handler,
    fault_handler,
    fault_handler,
    fault_handler,
    0,
    0,
    0,
    unexpected_handler,
    unexpected_handler,
    0,
    unexpected_handler,
    unexpected_handler,
    uart0_receive_handler,
    unexpected_handler,
    unexpected_handler,
    unexpected_handler,
    unexpected_handler,
    unexpected_handler,
    unexpected_handler,
    unexpected_handler,
    timer0_handler,
};

enum { argument_bytes = 4096, max_arguments = 64 };
static char command_line[argument_bytes];
static char* arguments[max_arguments + 1];

static int split_arguments(void) {
  int count = 0;
  char* at = command_line;
  while (*at != '\0' && count < max_arguments) {
    while (*at == ' ') ++at;
    if (*at == '\0') break;
    arguments[count++] = at;
    while (*at != ' ' && *at != '\0') ++at;
    if (*at == ' ') *at++ = '\0';
  }
  return count;
}

void reset_handler(void) {
  // The FPU first: the compiler may use its registers anywhere from here on.
  *cpacr |= 0xFU << 20;
  __asm volatile("dsb\nisb" ::: "memory");
  const uint32_t* from = data_load;
  for (uint32_t* to = data_start; to < data_end; ++to) *to = *from++;
  for (uint32_t* to = bss_start; to < bss_end; ++to) *to = 0U;
  semihosting_command_line(command_line, argument_bytes);
  initialise_monitor_handles();
  __libc_init_array();
  exit(main(split_arguments(), arguments));
}
