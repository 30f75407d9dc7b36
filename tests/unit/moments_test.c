/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Moments: what is held stays, what is not goes in the end, and two that are held never share a slot. */
#include "value/moments.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static void add(struct moments *moments, int64_t at_us, double value)
{
    struct snapshot *snapshot = snapshot_create(2);
    snapshot->readings[0] = (struct reading){ .value = value };
    snapshot->taken_utc_ns = at_us * 1000;
    moments_add(moments, at_us, snapshot);
    snapshot_destroy(&snapshot);
}

static void test_what_was_added_is_there_once(void **state)
{
    struct moments *moments = moments_create();
    (void)state;
    assert_null(moments_take(moments, 5));
    add(moments, 5, 1.5);
    add(moments, 5, 9);
    const struct moment *first = moments_take(moments, 5), *second = moments_take(moments, 5);
    assert_ptr_equal(first, second);
    assert_true(first->at_us == 5 && first->snapshot.count == 2 && first->snapshot.taken_utc_ns == 5000);
    assert_true(first->snapshot.readings[0].value == 1.5);
    moments_give(moments, &first);
    moments_give(moments, &second);
    assert_null(first);
    moments_destroy(&moments);
}

static void test_changes_tell_values_and_qualities_apart(void **state)
{
    struct moments *moments = moments_create();
    (void)state;
    add(moments, 1, 1.5);
    add(moments, 2, 1.5);
    add(moments, 3, 1.6);
    const struct moment *at[3];
    for (int i = 0; i < 3; i++)
        at[i] = moments_take(moments, i + 1);
    const uint32_t same = at[0]->snapshot.readings[0].changes;
    assert_int_equal(at[1]->snapshot.readings[0].changes, same);
    assert_int_not_equal(at[2]->snapshot.readings[0].changes, same);
    assert_int_not_equal(at[0]->snapshot.readings[1].changes, same); /* bad, and 0 */
    for (int i = 0; i < 3; i++)
        moments_give(moments, &at[i]);
    moments_destroy(&moments);
}

static void test_slots_are_apart_while_held_and_used_again(void **state)
{
    struct moments *moments = moments_create();
    (void)state;
    for (int i = 1; i <= 3; i++)
        add(moments, i, i);
    const struct moment *a = moments_take(moments, 1), *b = moments_take(moments, 2);
    assert_int_equal(a->slot, 1);
    assert_int_equal(b->slot, 2);
    moments_give(moments, &a);
    const struct moment *c = moments_take(moments, 3);
    assert_int_equal(c->slot, 1);
    a = moments_take(moments, 1);
    assert_int_equal(a->slot, 3);
    moments_give(moments, &a);
    moments_give(moments, &b);
    moments_give(moments, &c);
    moments_destroy(&moments);
}

static void test_only_the_newest_stay_that_nobody_holds(void **state)
{
    struct moments *moments = moments_create();
    (void)state;
    add(moments, 1, 1);
    add(moments, 2, 2);
    const struct moment *held = moments_take(moments, 1);
    for (int i = 0; i < MOMENTS_SPARE; i++)
        add(moments, 100 + i, i);
    assert_null(moments_take(moments, 2));
    const struct moment *spare = moments_take(moments, 100);
    assert_non_null(spare);
    assert_true(held->snapshot.readings[0].value == 1);
    moments_give(moments, &spare);
    moments_give(moments, &held);
    moments_destroy(&moments);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_what_was_added_is_there_once),
        cmocka_unit_test(test_changes_tell_values_and_qualities_apart),
        cmocka_unit_test(test_slots_are_apart_while_held_and_used_again),
        cmocka_unit_test(test_only_the_newest_stay_that_nobody_holds),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
