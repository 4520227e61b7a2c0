/* SPDX-License-Identifier: MIT */
/* What the sample asks of the kernel. */
#pragma once
#include <stdint.h>
#include <stdio.h>
#define printk printf
struct k_timer {
  int64_t period_ns, next_ns;
};
typedef int64_t k_timeout_t;
#define K_MSEC(ms) ((k_timeout_t)((ms) * 1000000))
#define K_TIMER_DEFINE(name, expire, stop) struct k_timer name = {0, 0}
#ifdef __cplusplus
extern "C" {
#endif
void k_timer_start(struct k_timer* timer, k_timeout_t first, k_timeout_t period);
uint32_t k_timer_status_sync(struct k_timer* timer);
#ifdef __cplusplus
}
#endif
