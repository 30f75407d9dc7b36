/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A renderer that has lost its core moves its sessions to other renderers, depending on what the load balancer reports and on
   when it reports it. */
#include "tests/support/test.h"

#include "base/clock.h"
#include "net/core_loss.h"

#define OTHERS "DOWN 2/2; name=renderers/r1; node=lb; weight=100/97; scur=3/9; qcur=0"
#define NONE "DOWN 2/2; name=renderers/r1; node=lb; weight=100/0; scur=3/9; qcur=0"

static const int64_t S = NS_PER_S, BEGIN = 1000 * NS_PER_S;

/* Simulates 60 s after the loss of the core, with a tick every 100 ms. state: the load balancer's report, given every second
   from checks_from_ns on; core_back_ns: time at which the core returns. Returns after how many nanoseconds the sessions are
   moved; -1: never. */
static int64_t moved_after(const char *state, int64_t checks_from_ns, int64_t core_back_ns)
{
    struct core_loss loss = { 0 };
    assert_false(core_loss_on_tick(&loss, true, BEGIN - S));
    for (int64_t ns = 0; ns < 60 * S; ns += S / 10) {
        if (ns >= checks_from_ns && ns % S == 0)
            core_loss_on_check(&loss, state, BEGIN + ns);
        if (core_loss_on_tick(&loss, ns >= core_back_ns, BEGIN + ns))
            return ns;
    }
    return -1;
}

TEST(sessions_move_3_s_after_the_loss_if_only_other_nodes_get_users)
{
    assert_int_equal(moved_after(OTHERS, 0, 60 * S), 3 * S);
    assert_int_equal(moved_after(OTHERS, 10 * S, 60 * S), 10 * S);
}

TEST(sessions_stay_if_no_node_gets_users_or_this_one_does)
{
    static const char *const states[] = {
        NONE, "UP; name=renderers/r1; node=lb; weight=100/200; scur=0/0; qcur=0", "UP 1/2; weight=1/2", "no check", "", "DOWN 0/2",
        "DOWN 0/2; weight=", "DOWN 0/2; weight=1", "DOWN 0/2; weight=1/-1",
    };
    for (size_t i = 0; i < sizeof(states) / sizeof(states[0]); i++)
        assert_int_equal(moved_after(states[i], 0, 60 * S), -1);
}

TEST(sessions_stay_if_the_core_is_back_in_time_or_nobody_asks)
{
    assert_int_equal(moved_after(OTHERS, 0, 29 * S / 10), -1);
    assert_int_equal(moved_after(OTHERS, 61 * S, 60 * S), -1);
}

TEST(a_word_from_before_the_loss_does_not_count)
{
    struct core_loss loss = { 0 };
    core_loss_on_check(&loss, OTHERS, BEGIN - S);
    for (int64_t ns = 0; ns < 60 * S; ns += S)
        assert_false(core_loss_on_tick(&loss, false, BEGIN + ns));
}

TEST(moving_ends_when_the_core_is_back_or_no_other_node_is_left)
{
    for (int back = 0; back < 2; back++) {
        struct core_loss loss = { 0 };
        core_loss_on_tick(&loss, false, BEGIN);
        core_loss_on_check(&loss, OTHERS, BEGIN + 3 * S);
        assert_true(core_loss_on_tick(&loss, false, BEGIN + 3 * S));
        assert_false(core_loss_on_tick(&loss, false, BEGIN + 4 * S));
        assert_int_equal(loss.moves_ns, BEGIN + 3 * S);
        if (!back)
            core_loss_on_check(&loss, NONE, BEGIN + 4 * S);
        core_loss_on_tick(&loss, back, BEGIN + 5 * S);
        assert_int_equal(loss.moves_ns, 0);
    }
}
