/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fair sharing of render time among addresses, tested by simulating clients and measuring the time of each. */
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
        /* further sessions from an address share the account of its first session */
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
    /* the address with less past render time has caught up, so nothing about it needs to be remembered */
    time_accounts_leave(&accounts, &greedy);
    assert_int_equal(accounts.count, 1);
    greedy = time_accounts_join(&accounts, 1);
    time_accounts_asked(&accounts, greedy, SHARE);
    assert_int_equal(greedy->spent_ns[SHARE], accounts.served_ns[SHARE]);
    time_accounts_finish(&accounts);
}

/* An address requests large frames one after another and abandons each. Another address, which was charged more, keeps refining
   a session and requests one snapshot. */
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
            /* the frame was given up, so only the address is charged */
            time_accounts_charge(&accounts, 1, SCHEDULER_LONG, cost_ns[GREEDY]);
        else
            account->spent_ns[SCHEDULER_LONG] += cost_ns[first];
        claim->spent_ns = scheduler_asked(claim->spent_ns + (first == GREEDY ? 0 : cost_ns[first]), served_ns);
        claim->asked_ns = now;
        time_accounts_asked(&accounts, account, SCHEDULER_LONG);
    }
    assert_int_equal(turns[SNAPSHOT], 1);
    /* at most as many frames of 0.9 s as fit into the 5 s charged to the other address beforehand */
    assert_in_range(turns[GREEDY], 1, 7);
    assert_in_range(turns[SESSION], 0, 1);
    time_accounts_finish(&accounts);
}
