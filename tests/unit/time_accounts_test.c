/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sharing of the render time among client addresses: simulates clients and measures how much time each address gets. */
#include "service/time_accounts.h"

#include "tests/support/test.h"

#include "base/clock.h"

enum { SHARE = SCHEDULER_MOVING };

static struct time_account *who_has_had_less(struct time_account *a, struct time_account *b)
{
    return scheduler_before(a->spent_ns[SHARE], 0, b->spent_ns[SHARE], 1) ? a : b;
}

static void serve(struct time_accounts *accounts, struct time_account *account, int64_t cost_ns)
{
    time_accounts_served(accounts, account, SHARE);
    account->spent_ns[SHARE] += cost_ns;
    time_accounts_asked(accounts, account, SHARE);
}

TEST(each_address_has_half_of_the_time)
{
    struct time_accounts accounts = { 0 };
    struct time_account *large = time_accounts_join(&accounts, 1), *small = time_accounts_join(&accounts, 2);
    int64_t had_ns[2] = { 0 };
    for (int i = 0; i < 29; i++)
        /* a second session from the same address shares the account of the first one */
        assert_ptr_equal(time_accounts_join(&accounts, 1), large);
    while (had_ns[0] + had_ns[1] < 60 * NS_PER_S) {
        struct time_account *next = who_has_had_less(large, small);
        int64_t cost_ns = next == large ? 300 * NS_PER_MS : 20 * NS_PER_MS;
        serve(&accounts, next, cost_ns);
        had_ns[next == small] += cost_ns;
    }
    assert_true(had_ns[1] > 29 * NS_PER_S && had_ns[1] < 31 * NS_PER_S);
    time_accounts_finish(&accounts);
}

TEST(who_comes_anew_owes_what_it_had)
{
    struct time_accounts accounts = { 0 };
    struct time_account *greedy = time_accounts_join(&accounts, 1), *other = time_accounts_join(&accounts, 2);
    serve(&accounts, greedy, NS_PER_S);
    time_accounts_leave(&accounts, &greedy);
    greedy = time_accounts_join(&accounts, 1);
    assert_ptr_equal(who_has_had_less(greedy, other), other);
    for (int i = 0; i < 60; i++)
        serve(&accounts, other, 20 * NS_PER_MS);
    /* the address has got as much time as the others, so its account need not be kept after it has left */
    time_accounts_leave(&accounts, &greedy);
    assert_int_equal(accounts.count, 1);
    greedy = time_accounts_join(&accounts, 1);
    time_accounts_asked(&accounts, greedy, SHARE);
    assert_int_equal(greedy->spent_ns[SHARE], accounts.served_ns[SHARE]);
    time_accounts_finish(&accounts);
}

/* One address requests large frames all the time and abandons each. Another address, which has used more time so far, refines a
   session and requests one snapshot. The snapshot must be drawn after a limited number of the large frames. */
TEST(no_request_waits_for_frames_without_end)
{
    enum { GREEDY, SESSION, SNAPSHOT, CLAIMS };
    static const int64_t cost_ns[CLAIMS] = { 900 * NS_PER_MS, 300 * NS_PER_MS, 50 * NS_PER_MS };
    struct time_accounts accounts = { 0 };
    struct time_account *greedy = time_accounts_join(&accounts, 1), *other = time_accounts_join(&accounts, 2);
    struct time_claim claims[CLAIMS] = { { greedy, 0, 0 }, { other, 0, 1 }, { other, 0, 2 } };
    int64_t served_ns = 0;
    int turns[CLAIMS] = { 0 }, first = GREEDY;
    other->spent_ns[SCHEDULER_LONG] = 5 * NS_PER_S;
    for (int64_t now = CLAIMS; first != SNAPSHOT && now < 100; now++) {
        first = GREEDY;
        for (int i = 1; i < CLAIMS; i++)
            if (time_claim_before(&claims[i], &claims[first], SCHEDULER_LONG))
                first = i;
        struct time_claim *claim = &claims[first];
        struct time_account *account = first == GREEDY ? greedy : other;
        turns[first]++;
        served_ns = scheduler_asked(claim->spent_ns, served_ns);
        time_accounts_served(&accounts, account, SCHEDULER_LONG);
        if (first == GREEDY)
            /* the frame was abandoned, so its time is charged to address 1 and not to the claim of a session */
            time_accounts_charge(&accounts, 1, SCHEDULER_LONG, cost_ns[GREEDY]);
        else
            account->spent_ns[SCHEDULER_LONG] += cost_ns[first];
        claim->spent_ns = scheduler_asked(claim->spent_ns + (first == GREEDY ? 0 : cost_ns[first]), served_ns);
        claim->asked_ns = now;
        time_accounts_asked(&accounts, account, SCHEDULER_LONG);
    }
    assert_int_equal(turns[SNAPSHOT], 1);
    /* expected number of the large frames: those of 0.9 s each that fit into the 5 s by which the other address was ahead */
    assert_in_range(turns[GREEDY], 1, 7);
    assert_in_range(turns[SESSION], 0, 1);
    time_accounts_finish(&accounts);
}
