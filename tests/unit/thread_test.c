/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A ticking thread: evenly spaced ticks, and an immediate stop. */
#include "tests/support/test.h"
#include <stdatomic.h>

#include "base/clock.h"
#include "base/thread.h"
#include "tests/support/sleep.h"

static struct thread thread;
static atomic_int ticks;

static void *count_ticks(void *arg)
{
    int64_t next_ns = clock_mono_ns();
    do
        ticks++;
    while (thread_wait_for_tick(&thread, *(const int64_t *)arg, &next_ns));
    return NULL;
}

static void run_for(int64_t period_ns, int least)
{
    ticks = 0;
    thread_init(&thread);
    assert_true(thread_start(&thread, NULL, "test", count_ticks, &period_ns));
    for (int64_t until_ns = clock_mono_ns() + 20 * NS_PER_S; ticks < least && clock_mono_ns() < until_ns;)
        sleep_ns(NS_PER_MS);
    assert_false(thread_is_stopping(&thread));
    thread_stop(&thread);
    assert_true(thread_is_stopping(&thread) && !thread.started);
    thread_finish(&thread);
}

TEST(it_ticks)
{
    int64_t begin_ns = clock_mono_ns();
    run_for(2 * NS_PER_MS, 20);
    assert_true(ticks >= 20 && clock_mono_ns() - begin_ns >= 19 * 2 * NS_PER_MS);
}

TEST(it_ends_within_a_long_wait)
{
    int64_t begin_ns = clock_mono_ns();
    run_for(3600 * NS_PER_S, 1);
    assert_int_equal(ticks, 1);
    assert_true(clock_mono_ns() - begin_ns < 600 * NS_PER_S);
}
