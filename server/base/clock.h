/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clocks. Only the main loops of threads read them; all other code takes the time as an argument. Call from any thread. */
#ifndef BASE_CLOCK_H
#define BASE_CLOCK_H
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#define NS_PER_S 1000000000LL
#define NS_PER_MS 1000000LL

int64_t clock_mono_ns(void); /* Returns monotonic time, for ages and deadlines. */
int64_t clock_utc_ns(void);  /* Returns UTC in nanoseconds since 1970, for stored times and for access control. */

struct plant_clock {          /* the plant's clock; zero-initialise */
    _Atomic int64_t ahead_ns; /* nanoseconds by which the plant's clock is ahead of this machine's UTC clock */
};
/* Returns the plant's UTC: the core's clock on a node that follows a core, else clock_utc_ns(). This clock gives the times of
   readings, alarms, notes and user actions. NULL: clock_utc_ns(). */
int64_t clock_plant_ns(const struct plant_clock *clock);
/* Sets by how many nanoseconds the plant's clock is ahead of this machine's UTC clock; 0: clock_plant_ns() equals clock_utc_ns(). */
void clock_follow(struct plant_clock *clock, int64_t ahead_ns);

bool clock_utc_is_set(void);                /* Returns true if the clock is synchronised by NTP or PTP, according to the kernel. */
void clock_cond_init(pthread_cond_t *cond); /* Initialises a condition variable whose timed waits use clock_mono_ns(). */
/* Waits for the condition variable until the given time; INT64_MAX: no limit. Returns true if the thread was woken, false if
   the time was reached. The caller holds the lock. */
bool clock_cond_wait(pthread_cond_t *cond, pthread_mutex_t *lock, int64_t until_mono_ns);
int64_t clock_work_ns(void); /* Returns the CPU time used by all threads of this process. */

#endif
