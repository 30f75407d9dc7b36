/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Baselines (snapshots with which later readings are compared): which are stored, replaced and deleted. A baseline that a
   reader holds must stay valid until it is released. */
#include "value/baselines.h"

#include "tests/support/test.h"
#include <pthread.h>

static struct snapshot *readings(double value, int64_t taken_utc_ns)
{
    struct snapshot *snapshot = snapshot_create(3);
    snapshot->taken_utc_ns = taken_utc_ns;
    for (int i = 0; i < 3; i++)
        snapshot->readings[i].value = value;
    return snapshot;
}

static uint32_t set(struct baselines *baselines, const char *name, double value)
{
    struct snapshot *snapshot = readings(value, 1000 + (int64_t)value);
    uint32_t id = baselines_set(baselines, name, snapshot);
    snapshot_destroy(&snapshot);
    return id;
}

static uint32_t keep(struct baselines *baselines, int64_t taken_utc_ns)
{
    struct snapshot *snapshot = readings(1, taken_utc_ns);
    uint32_t id = baselines_keep(baselines, snapshot);
    snapshot_destroy(&snapshot);
    return id;
}

TEST(test_a_name_is_found_replaced_and_removed)
{
    struct baselines *baselines = baselines_create();
    struct baseline what;
    uint32_t id = set(baselines, "calm", 4), other = set(baselines, "storm", 9);
    assert_true(id && other && id != other);
    assert_int_equal(baselines_find(baselines, "calm"), id);
    const struct snapshot *held = baselines_take(baselines, id);
    assert_int_equal(set(baselines, "calm", 5), id);
    /* the baseline was replaced, but a reader that holds the old one must still see its values */
    assert_true(held->readings[2].value == 4);
    const struct snapshot *now = baselines_take(baselines, id);
    assert_true(now->readings[2].value == 5 && now->taken_utc_ns == 1005);
    assert_true(baselines_describe(baselines, id, &what) && what.taken_utc_ns == 1005);
    assert_string_equal(what.name, "calm");
    baselines_remove(baselines, "calm");
    baselines_remove(baselines, "never there");
    assert_true(now->readings[0].value == 5);
    baselines_give(baselines, &held);
    baselines_give(baselines, &now);
    assert_null(now);
    assert_int_equal(baselines_find(baselines, "calm"), 0);
    assert_null(baselines_take(baselines, id));
    assert_true(set(baselines, "calm", 6) > other); /* ids are never used again */
    baselines_destroy(&baselines);
}

TEST(test_names_are_bounded)
{
    struct baselines *baselines = baselines_create();
    struct baseline list[BASELINES_NAMED];
    for (int i = 0; i < BASELINES_NAMED; i++) {
        char *name = test_printf("b%d", i);
        assert_true(baselines_may_set(baselines, name));
        assert_int_not_equal(set(baselines, name, i), 0);
    }
    assert_false(baselines_may_set(baselines, "more"));
    assert_int_equal(set(baselines, "more", 1), 0);
    assert_true(baselines_may_set(baselines, "b7"));
    assert_int_equal(baselines_list(baselines, list), BASELINES_NAMED);
    assert_string_equal(list[31].name, "b31");
    /* accepted: the limit applies to baselines with a name only */
    assert_int_not_equal(keep(baselines, 5), 0);
    baselines_destroy(&baselines);
}

TEST(test_without_a_name_the_oldest_goes)
{
    struct baselines *baselines = baselines_create();
    uint32_t name = set(baselines, "stays", 1), first = keep(baselines, 100), last = first;
    /* storing a snapshot of the same instant again must give the same id, so it is stored once */
    assert_int_equal(keep(baselines, 100), first);
    for (int i = 1; i < BASELINES_UNNAMED; i++)
        last = keep(baselines, 100 + i);
    const struct snapshot *held = baselines_take(baselines, first);
    assert_int_equal(held->taken_utc_ns, 100);
    keep(baselines, 9000);
    assert_null(baselines_take(baselines, first));
    assert_int_equal(held->taken_utc_ns, 100);
    baselines_give(baselines, &held);
    for (uint32_t id = first + 1; id <= last + 1; id++) {
        held = baselines_take(baselines, id);
        assert_non_null(held);
        baselines_give(baselines, &held);
    }
    assert_int_equal(baselines_find(baselines, "stays"), name);
    baselines_destroy(&baselines);
}

static void *replace_often(void *arg)
{
    for (int i = 0; i < 2000; i++)
        set(arg, "busy", i);
    return NULL;
}

TEST(test_readers_see_whole_ones)
{
    struct baselines *baselines = baselines_create();
    pthread_t thread;
    uint32_t id = set(baselines, "busy", 0);
    assert_int_equal(pthread_create(&thread, NULL, replace_often, baselines), 0);
    for (int i = 0; i < 2000; i++) {
        const struct snapshot *snapshot = baselines_take(baselines, id);
        assert_true(snapshot->readings[0].value == snapshot->readings[2].value);
        assert_true(snapshot->taken_utc_ns == 1000 + (int64_t)snapshot->readings[1].value);
        baselines_give(baselines, &snapshot);
    }
    pthread_join(thread, NULL);
    baselines_destroy(&baselines);
}
