/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scheduler, which decides whose request is drawn next. The tests simulate a slow render thread and count each client's
   frames. */
#include "service/scheduler.h"

#include "tests/support/test.h"

#include "base/clock.h"

static const int64_t MS = NS_PER_MS;
#define NONE INT64_MAX

static enum urgency choose(const struct scheduler *scheduler, int64_t input, int64_t data, int64_t refine, int64_t snapshot, int64_t now_ns)
{
    int64_t wait_until_ns;
    return scheduler_choose(scheduler, (int64_t[]){ input, data, refine, snapshot }, now_ns, &wait_until_ns);
}

TEST(nothing_to_do_waits_for_ever)
{
    struct scheduler scheduler = { 0 };
    int64_t wait_until_ns = 0;
    assert_int_equal(scheduler_choose(&scheduler, (int64_t[]){ NONE, NONE, NONE, NONE }, NS_PER_S, &wait_until_ns), URGENCY_COUNT);
    assert_true(wait_until_ns == INT64_MAX);
}

TEST(an_idle_renderer_refines_at_once)
{
    struct scheduler scheduler = { 0 };
    assert_int_equal(choose(&scheduler, NONE, NONE, 10 * NS_PER_S, NONE, 10 * NS_PER_S), URGENCY_REFINE);
    assert_int_equal(choose(&scheduler, NONE, NONE, 10 * NS_PER_S, 9 * NS_PER_S, 10 * NS_PER_S), URGENCY_SNAPSHOT);
    assert_int_equal(choose(&scheduler, NONE, 10 * NS_PER_S, 9 * NS_PER_S, NONE, 10 * NS_PER_S), URGENCY_DATA);
}

TEST(slow_pictures_wait_for_a_pause)
{
    struct scheduler scheduler = { 0 };
    int64_t now_ns = 100 * NS_PER_S, wait_until_ns;
    scheduler_done(&scheduler, URGENCY_INPUT, now_ns);
    assert_int_equal(scheduler_choose(&scheduler, (int64_t[]){ NONE, NONE, now_ns, NONE }, now_ns + MS, &wait_until_ns), URGENCY_COUNT);
    assert_true(wait_until_ns > now_ns + MS && wait_until_ns < now_ns + 500 * MS);
    assert_int_equal(choose(&scheduler, NONE, NONE, now_ns, NONE, wait_until_ns), URGENCY_REFINE);
    assert_int_equal(choose(&scheduler, wait_until_ns, NONE, now_ns, NONE, wait_until_ns), URGENCY_INPUT);
}

/* Simulates 60 s in which a request of each urgency is always waiting. Frames for input and for data take 30 ms; a refinement and a
   snapshot take 50 steps of 10 ms. Frames for input and data must be complete within 100 ms, and each urgency must get its share. */
TEST(everyone_gets_a_share)
{
    enum { STEPS = 50 };
    static const int64_t cost_ns[] = { 30 * NS_PER_MS, 30 * NS_PER_MS, 10 * NS_PER_MS, 10 * NS_PER_MS };
    struct scheduler scheduler = { 0 };
    int64_t now_ns = 100 * NS_PER_S, end_ns = now_ns + 60 * NS_PER_S;
    int64_t asked_ns[URGENCY_COUNT] = { now_ns, now_ns, now_ns, now_ns }, longest_ns[URGENCY_COUNT] = { 0 }, wait_until_ns;
    int drawn[URGENCY_COUNT] = { 0 }, left[URGENCY_COUNT] = { 1, 1, STEPS, STEPS };
    enum urgency begun = URGENCY_COUNT;
    while (now_ns < end_ns) {
        int64_t asked[URGENCY_COUNT];
        for (int i = 0; i < URGENCY_COUNT; i++)
            asked[i] = i >= URGENCY_REFINE && begun != URGENCY_COUNT && (enum urgency)i != begun ? NONE : asked_ns[i];
        enum urgency urgency = scheduler_choose(&scheduler, asked, now_ns, &wait_until_ns);
        assert_int_not_equal(urgency, URGENCY_COUNT);
        now_ns += cost_ns[urgency];
        if (urgency >= URGENCY_REFINE) {
            scheduler_stepped(&scheduler);
            begun = urgency;
        }
        if (--left[urgency] > 0)
            continue;
        left[urgency] = urgency >= URGENCY_REFINE ? STEPS : 1;
        begun = urgency >= URGENCY_REFINE ? URGENCY_COUNT : begun;
        longest_ns[urgency] = now_ns - asked_ns[urgency] > longest_ns[urgency] ? now_ns - asked_ns[urgency] : longest_ns[urgency];
        asked_ns[urgency] = now_ns;
        drawn[urgency]++;
        scheduler_done(&scheduler, urgency, now_ns);
    }
    assert_true(drawn[URGENCY_INPUT] > 750 && drawn[URGENCY_DATA] > 750);
    assert_true(drawn[URGENCY_REFINE] >= 4 && drawn[URGENCY_SNAPSHOT] >= 4);
    assert_true(longest_ns[URGENCY_INPUT] <= 100 * MS && longest_ns[URGENCY_DATA] <= 100 * MS);
    assert_true(longest_ns[URGENCY_REFINE] <= 15 * NS_PER_S && longest_ns[URGENCY_SNAPSHOT] <= 15 * NS_PER_S);
}

/* While refinements have been waiting for long, a client that begins to move must be served first. */
TEST(a_queue_of_refinements_does_not_hold_up_a_move)
{
    struct scheduler scheduler = { .long_ns = 99 * NS_PER_S };
    int64_t now_ns = 100 * NS_PER_S;
    for (int i = 0; i < 60; i++, now_ns += 30 * MS) {
        assert_int_equal(choose(&scheduler, now_ns, NONE, 50 * NS_PER_S, NONE, now_ns), URGENCY_INPUT);
        scheduler_done(&scheduler, URGENCY_INPUT, now_ns);
    }
}

/* Simulates three clients that always have a request, with frames of 5, 10 and 40 ms, and a fourth that requests a frame now
   and then. The three must get equal time, and the fourth must not wait long. */
TEST(time_is_shared_by_what_pictures_cost)
{
    static const int64_t cost_ns[] = { 5 * NS_PER_MS, 10 * NS_PER_MS, 40 * NS_PER_MS, 10 * NS_PER_MS };
    int64_t spent_ns[4] = { 0 }, had_ns[4] = { 0 }, asked_ns[4] = { 0 }, served_ns = 0, now_ns = 0, longest_ns = 0;
    while (now_ns < 60 * NS_PER_S) {
        int first = 0;
        for (int i = 1; i < 4; i++)
            if (asked_ns[i] <= now_ns && scheduler_before(spent_ns[i], asked_ns[i], spent_ns[first], asked_ns[first]))
                first = i;
        served_ns = scheduler_asked(spent_ns[first], served_ns);
        longest_ns = first == 3 && now_ns - asked_ns[3] > longest_ns ? now_ns - asked_ns[3] : longest_ns;
        now_ns += cost_ns[first];
        had_ns[first] += cost_ns[first];
        spent_ns[first] += cost_ns[first];
        asked_ns[first] = now_ns + (first == 3 ? 2 * NS_PER_S : 0);
        spent_ns[first] = scheduler_asked(spent_ns[first], served_ns);
    }
    for (int i = 0; i < 3; i++)
        assert_in_range(had_ns[i] / NS_PER_MS, 19000, 21000);
    assert_true(had_ns[3] > 200 * NS_PER_MS && longest_ns < 150 * MS);
}
