/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clocks. Only the threads and main files read them; all other code takes the time as an argument. Thread: any. */
#ifndef BASE_CLOCK_H
#define BASE_CLOCK_H
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#define NS_PER_S 1000000000LL
#define NS_PER_MS 1000000LL

int64_t clock_mono_ns(void); /* returns monotonic time, for ages and deadlines */
int64_t clock_utc_ns(void);  /* returns UTC since 1970, for what is stored, and for who may do what */
/* Returns UTC as the plant has it: the core's, of a node that follows one, else clock_utc_ns(). For what is shown, and for what people do:
   readings, alarms and notes have times of that clock. */
int64_t clock_plant_ns(void);
void clock_follow(int64_t ahead_ns); /* by so much the core's clock is ahead of this machine's. 0: this node follows nobody */
bool clock_utc_is_set(void); /* returns whether NTP or PTP synchronizes the clock, according to the kernel */
void clock_cond_init(pthread_cond_t *cond); /* initializes a condition variable whose timed waits use clock_mono_ns() */
/* Waits for that condition, or until then; INT64_MAX: without limit. Returns false when that time has come. Under the lock. */
bool clock_cond_wait(pthread_cond_t *cond, pthread_mutex_t *lock, int64_t until_mono_ns);
int64_t clock_work_ns(void); /* returns the CPU time of this process, of all threads */

#endif
