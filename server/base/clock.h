/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The clocks. Only server.c, main files, net/ and the source threads read them; everything else is handed the time. */
#ifndef BASE_CLOCK_H
#define BASE_CLOCK_H
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#define NS_PER_S 1000000000LL
#define NS_PER_MS 1000000LL

int64_t clock_mono_ns(void); /* monotonic: ages, deadlines */
int64_t clock_utc_ns(void);  /* since 1970: what is shown and stored */
bool clock_utc_is_set(void);  /* somebody keeps it right (NTP, PTP): the kernel says so */
void clock_cond_init(pthread_cond_t *cond); /* timed waits on it are by clock_mono_ns */
int64_t clock_work_ns(void); /* of all threads of this process, on all cores */

#endif
