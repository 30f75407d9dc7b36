/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The queue of requests deferred by the render thread: it returns them in their order, loses none, and lets other requests have
   every second turn. */
#include "tests/support/test.h"

#include "service/deferred_requests.h"

static void fill(struct request_group *group, uint64_t first, int count)
{
    group->count = 0;
    for (int i = 0; i < count; i++)
        request_group_add(group, &(struct request_ticket){ .client = first + (uint64_t)i });
}

static void assert_batch(const struct request_group *group, uint64_t first, size_t count)
{
    assert_int_equal(group->count, count);
    for (size_t i = 0; i < count; i++)
        assert_int_equal(group->tickets[i].client, first + i);
}

TEST(test_the_oldest_comes_first)
{
    struct deferred_requests deferred = { 0 };
    struct request_group group = { 0 };
    for (uint64_t round = 0; round < 50; round++) {
        for (uint64_t i = 0; i < 3; i++) {
            fill(&group, 100 * round + 10 * i, 1 + (int)((round + i) % 4));
            assert_true(deferred_requests_push(&deferred, &group));
            assert_int_equal(group.count, 0);
        }
        for (uint64_t i = 0; i < 3; i++) {
            fill(&group, 7, 2); /* pop() replaces the group's content */
            deferred_requests_pop(&deferred, &group);
            assert_batch(&group, 100 * round + 10 * i, 1 + (round + i) % 4);
        }
    }
    request_group_finish(&group);
    deferred_requests_finish(&deferred);
}

TEST(test_a_full_list_takes_no_more)
{
    struct deferred_requests deferred = { 0 };
    struct request_group group = { 0 };
    for (uint64_t i = 0; i < DEFERRED_MOST; i++) {
        fill(&group, 10 * i, 2);
        assert_true(deferred_requests_push(&deferred, &group));
    }
    fill(&group, 5000, 3);
    assert_false(deferred_requests_push(&deferred, &group));
    assert_batch(&group, 5000, 3);
    deferred_requests_pop(&deferred, &group);
    assert_batch(&group, 0, 2);
    assert_true(deferred_requests_push(&deferred, &group));
    for (uint64_t i = 1; i <= DEFERRED_MOST; i++) {
        deferred_requests_pop(&deferred, &group);
        assert_batch(&group, 10 * (i % DEFERRED_MOST), 2);
    }
    assert_int_equal(deferred.count, 0);
    request_group_finish(&group);
    deferred_requests_finish(&deferred);
}

TEST(test_turns)
{
    struct deferred_requests deferred = { 0 };
    struct request_group group = { 0 };
    assert_false(deferred_requests_due(&deferred, true));
    assert_false(deferred_requests_due(&deferred, false));
    fill(&group, 1, 1);
    assert_true(deferred_requests_push(&deferred, &group));
    bool last = deferred_requests_due(&deferred, true);
    for (int i = 0; i < 10; i++, last = !last)
        assert_true(deferred_requests_due(&deferred, true) == !last);
    assert_true(deferred_requests_due(&deferred, false) && deferred_requests_due(&deferred, false));
    request_group_finish(&group);
    deferred_requests_finish(&deferred);
}
