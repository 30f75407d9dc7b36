/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cache of snapshots of the past: snapshots in use stay, unused ones are evicted at some time, and two in use never share a
   slot (the number by which fields refer to a snapshot). */
#include "value/snapshot_cache.h"

#include "tests/support/test.h"

#include "base/clock.h"
#include "value/quality.h"

static void add(struct snapshot_cache *snapshot_cache, int64_t at_us, double value)
{
    struct snapshot *snapshot = test_snapshot(2);
    snapshot->readings[0] = (struct reading){ .value = value };
    snapshot->taken_utc_ns = at_us * 1000;
    snapshot_cache_add(snapshot_cache, at_us, snapshot);
}

TEST(test_what_was_added_is_there_once)
{
    struct snapshot_cache *snapshot_cache = snapshot_cache_create();
    assert_null(snapshot_cache_take(snapshot_cache, 5));
    add(snapshot_cache, 5, 1.5);
    add(snapshot_cache, 5, 9);
    const struct historical_snapshot *first = snapshot_cache_take(snapshot_cache, 5), *second = snapshot_cache_take(snapshot_cache, 5);
    assert_ptr_equal(first, second);
    assert_true(first->at_us == 5 && first->snapshot.count == 2 && first->snapshot.taken_utc_ns == 5000);
    assert_true(first->snapshot.readings[0].value == 1.5);
    snapshot_cache_give(snapshot_cache, &first);
    snapshot_cache_give(snapshot_cache, &second);
    assert_null(first);
    snapshot_cache_destroy(&snapshot_cache);
}

TEST(test_changes_tell_values_and_qualities_apart)
{
    struct snapshot_cache *snapshot_cache = snapshot_cache_create();
    add(snapshot_cache, 1, 1.5);
    add(snapshot_cache, 2, 1.5);
    add(snapshot_cache, 3, 1.6);
    const struct historical_snapshot *at[3];
    for (int i = 0; i < 3; i++)
        at[i] = snapshot_cache_take(snapshot_cache, i + 1);
    const uint32_t same = at[0]->snapshot.readings[0].changes;
    assert_int_equal(at[1]->snapshot.readings[0].changes, same);
    assert_int_not_equal(at[2]->snapshot.readings[0].changes, same);
    assert_int_not_equal(at[0]->snapshot.readings[1].changes, same); /* bad, and 0 */
    for (int i = 0; i < 3; i++)
        snapshot_cache_give(snapshot_cache, &at[i]);
    snapshot_cache_destroy(&snapshot_cache);
}

TEST(test_changes_tell_ages_apart)
{
    struct snapshot_cache *snapshot_cache = snapshot_cache_create();
    const struct historical_snapshot *at[3];
    for (int i = 0; i < 3; i++) { /* tag 0: 5, 5 and 65 s since its last usable value */
        struct snapshot *snapshot = test_snapshot(1);
        snapshot->readings[0] = (struct reading){ .quality = QUALITY_BAD_COMMUNICATION_ERROR, .age_ns = (i < 2 ? 5 : 65) * NS_PER_S };
        snapshot_cache_add(snapshot_cache, i + 1, snapshot);
        at[i] = snapshot_cache_take(snapshot_cache, i + 1);
    }
    assert_int_equal(at[1]->snapshot.readings[0].changes, at[0]->snapshot.readings[0].changes);
    assert_int_not_equal(at[2]->snapshot.readings[0].changes, at[0]->snapshot.readings[0].changes);
    for (int i = 0; i < 3; i++)
        snapshot_cache_give(snapshot_cache, &at[i]);
    snapshot_cache_destroy(&snapshot_cache);
}

TEST(test_slots_are_apart_while_held_and_used_again)
{
    struct snapshot_cache *snapshot_cache = snapshot_cache_create();
    for (int i = 1; i <= 3; i++)
        add(snapshot_cache, i, i);
    const struct historical_snapshot *a = snapshot_cache_take(snapshot_cache, 1), *b = snapshot_cache_take(snapshot_cache, 2);
    assert_int_equal(a->slot, 1);
    assert_int_equal(b->slot, 2);
    snapshot_cache_give(snapshot_cache, &a);
    const struct historical_snapshot *c = snapshot_cache_take(snapshot_cache, 3);
    assert_int_equal(c->slot, 1);
    a = snapshot_cache_take(snapshot_cache, 1);
    assert_int_equal(a->slot, 3);
    snapshot_cache_give(snapshot_cache, &a);
    snapshot_cache_give(snapshot_cache, &b);
    snapshot_cache_give(snapshot_cache, &c);
    snapshot_cache_destroy(&snapshot_cache);
}

TEST(test_only_the_newest_stay_that_nobody_holds)
{
    struct snapshot_cache *snapshot_cache = snapshot_cache_create();
    add(snapshot_cache, 1, 1);
    add(snapshot_cache, 2, 2);
    const struct historical_snapshot *held = snapshot_cache_take(snapshot_cache, 1);
    for (int i = 0; i < SNAPSHOT_CACHE_SPARE; i++)
        add(snapshot_cache, 100 + i, i);
    assert_null(snapshot_cache_take(snapshot_cache, 2));
    const struct historical_snapshot *spare = snapshot_cache_take(snapshot_cache, 100);
    assert_non_null(spare);
    assert_true(held->snapshot.readings[0].value == 1);
    snapshot_cache_give(snapshot_cache, &spare);
    snapshot_cache_give(snapshot_cache, &held);
    snapshot_cache_destroy(&snapshot_cache);
}
