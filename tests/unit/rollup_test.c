/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rollups (summaries of the line through recorded points over a time interval) compared with plain sums over microseconds;
   names and borders of month files. */
#include "tests/support/test.h"

#include "history/month.h"
#include "history/rollup.h"

enum { POINTS = 60, LENGTH = 10000, BUCKETS = 200 };

static const struct history_point *at(const struct history_point *points, int count, int64_t t_us)
{
    int i = 0;
    while (i + 1 < count && points[i + 1].t_us <= t_us)
        i++;
    return &points[i];
}

/* Computes what the rollup of LENGTH microseconds from begin_us must contain, microsecond by microsecond. */
static void slow_truth(const struct history_point *points, int count, bool step, int64_t begin_us, struct history_bucket *out)
{
    double sum = 0;
    *out = (struct history_bucket){ .t_us = begin_us, .low = NAN, .high = NAN, .last = NAN };
    for (int64_t t = begin_us; t < begin_us + LENGTH; t++) {
        const struct history_point *a = at(points, count, t), *b = a + 1 < points + count ? a + 1 : NULL;
        if (t < points[0].t_us || !b)
            continue;
        if (!history_point_usable(a)) {
            out->bad_us++;
            continue;
        }
        double value = a->value;
        if (history_point_joined(a, b, step))
            value += (b->value - a->value) * ((double)(t - a->t_us) + 0.5) / (double)(b->t_us - a->t_us);
        sum += value;
        out->good_us++;
        out->low = fmin(out->low, value);
        out->high = fmax(out->high, value);
    }
    const struct history_point *left = at(points, count, begin_us - 1), *right = left + 1;
    out->first = begin_us <= points[0].t_us || !history_point_usable(left) ? NAN
                 : history_point_joined(left, right, step)                 ? history_point_between(left, right, begin_us)
                                                                           : left->value;
    const struct history_point *before = at(points, count, begin_us + LENGTH - 1), *after = before + 1;
    if (history_point_usable(before))
        out->last = history_point_joined(before, after, step) ? history_point_between(before, after, begin_us + LENGTH) : before->value;
    out->mean = sum / (double)out->good_us;
}

static void assert_like(const struct history_bucket *got, const struct history_bucket *wanted)
{
    assert_int_equal(got->bad_us, wanted->bad_us);
    assert_int_equal(got->good_us, wanted->good_us);
    assert_true(isnan(got->last) == isnan(wanted->last) && (isnan(got->last) || fabs(got->last - wanted->last) < 1e-9));
    assert_true(isnan(wanted->first) || fabs(got->first - wanted->first) < 1e-9);
    if (wanted->good_us == 0)
        return;
    assert_true(fabs(got->mean - wanted->mean) < 1e-9 * fabs(wanted->mean) + 1e-6);
    assert_true(got->low <= wanted->low && got->low > wanted->low - 0.1);
    assert_true(got->high >= wanted->high && got->high < wanted->high + 0.1);
}

static int make_points(struct history_point *points, unsigned seed)
{
    int64_t t = 12345;
    srand(seed);
    for (int i = 0; i < POINTS; i++) {
        bool bad = rand() % 7 == 0;
        t += 1000 + rand() % (rand() % 5 ? 3000 : 40000);
        if (seed % 3 == 0 && i % 2) /* some points lie exactly on the boundary of two buckets */
            t += LENGTH - t % LENGTH;
        points[i] = (struct history_point){ t, bad ? NAN : rand() % 100, bad ? 0x80050000u : rand() % 9 ? 0 : 0x40900000u };
    }
    return POINTS;
}

TEST(buckets_are_the_integral)
{
    int compared = 0;
    for (unsigned seed = 1; seed <= 20; seed++) {
        struct history_point points[POINTS];
        int count = make_points(points, seed);
        struct rollup rollup = { .length_us = LENGTH, .step = seed % 2 };
        struct history_bucket closed, wanted;
        for (int i = 0; i < count; i++) {
            if (!rollup_put(&rollup, &points[i], &closed))
                continue;
            slow_truth(points, count, rollup.step, closed.t_us, &wanted);
            assert_like(&closed, &wanted);
            compared++;
        }
    }
    assert_true(compared > 200);
}

TEST(merged_buckets_are_longer_ones)
{
    struct history_bucket a = { .low = 1, .high = 2, .mean = 1.5, .first = 1, .last = 2, .good_us = 10 };
    struct history_bucket b = { .low = 0, .high = 9, .mean = 4, .first = 2, .last = 9, .good_us = 30, .bad_us = 5, .quality = 7 };
    struct history_bucket none = { .low = NAN, .high = NAN, .mean = NAN, .first = NAN, .last = NAN, .bad_us = 100, .quality = 8 };
    rollup_merge(&a, &b);
    rollup_merge(&a, &none);
    assert_true(a.low == 0 && a.high == 9 && a.first == 1 && isnan(a.last) && fabs(a.mean - 3.375) < 1e-12);
    assert_int_equal(a.good_us, 40);
    assert_int_equal(a.bad_us, 105);
    assert_int_equal(a.quality, 8);
    rollup_merge(&none, &b);
    assert_true(none.low == 0 && none.high == 9 && none.mean == 4);
}

/* rollup_bridge() adds the line from bucket a's last value, 0 at 100 s, to bucket b's first value, 30 at 400 s, for the time
   from 200 s to 300 s. */
TEST(a_bridge_is_a_straight_line)
{
    struct history_bucket a = { .t_us = 90 * US_PER_S, .last = 0 }, b = { .t_us = 400 * US_PER_S, .first = 30 };
    struct history_bucket into = { .low = 12, .high = 14, .mean = 13, .first = 12, .last = 14, .good_us = 100 * US_PER_S };
    rollup_bridge(&into, &a, 100 * US_PER_S, &b, 200 * US_PER_S, 300 * US_PER_S);
    assert_true(fabs(into.low - 10) < 1e-9 && fabs(into.high - 20) < 1e-9 && fabs(into.mean - 14) < 1e-9);
    assert_true(fabs(into.last - 20) < 1e-9 && into.first == 12);
    a.last = NAN;
    rollup_bridge(&into, &a, 100 * US_PER_S, &b, 300 * US_PER_S, 340 * US_PER_S);
    assert_int_equal(into.bad_us, 40 * US_PER_S);
}

TEST(months_follow_each_other)
{
    char name[MONTH_NAME_BYTES];
    int month;
    for (int m = -30; m < 1200; m++) {
        int64_t begin_us = month_begin_us(m);
        assert_int_equal(month_of(begin_us), m);
        assert_int_equal(month_of(begin_us - 1), m - 1);
        month_name(m, name);
        assert_true(month_parse(name, &month) && month == m);
    }
    month_name(month_of(INT64_C(1793491200) * US_PER_S), name);
    assert_string_equal(name, "history-2026-11.sqlite");
    assert_false(month_parse("history-2026-13.sqlite", &month));
    assert_false(month_parse("history-2026-11.sqlite-wal", &month));
    assert_false(month_parse("history-2026-11.damaged-20261120T000000Z.sqlite", &month));
}
