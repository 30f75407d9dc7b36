/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the monotonic clock and the UTC clock. */
#include "base/clock.h"

#include <errno.h>
#include <stdatomic.h>
#include <time.h>

static int64_t read_ns(clockid_t id)
{
    struct timespec t;
    clock_gettime(id, &t);
    return (int64_t)t.tv_sec * NS_PER_S + t.tv_nsec;
}

int64_t clock_mono_ns(void)
{
    return read_ns(CLOCK_MONOTONIC);
}

int64_t clock_utc_ns(void)
{
    return read_ns(CLOCK_REALTIME);
}

void clock_follow(struct plant_clock *clock, int64_t ahead_ns)
{
    atomic_store(&clock->ahead_ns, ahead_ns);
}

int64_t clock_plant_ns(const struct plant_clock *clock)
{
    return clock_utc_ns() + (clock ? atomic_load(&clock->ahead_ns) : 0);
}

int64_t clock_work_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return now.tv_sec * NS_PER_S + now.tv_nsec;
}

void clock_cond_init(pthread_cond_t *cond)
{
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(cond, &attributes);
    pthread_condattr_destroy(&attributes);
}

bool clock_cond_wait(pthread_cond_t *cond, pthread_mutex_t *lock, int64_t until_mono_ns)
{
    const struct timespec until = { .tv_sec = until_mono_ns / NS_PER_S, .tv_nsec = until_mono_ns % NS_PER_S };
    if (until_mono_ns == INT64_MAX)
        return pthread_cond_wait(cond, lock) == 0;
    return pthread_cond_timedwait(cond, lock, &until) != ETIMEDOUT;
}
