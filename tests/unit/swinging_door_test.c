/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The swinging-door filter, which decides which samples of a stream are stored, so that the line through them stays within the
   deadband of all samples. */
#include "tests/support/test.h"

#include "history/swinging_door.h"

#define S INT64_C(1000000)
#define BAD 0x80050000u
enum { MAX = 20000 };

struct door_run {
    struct swinging_door door;
    struct swinging_door_params params;
    struct history_point samples[MAX], kept[MAX * 2];
    int sample_count, kept_count;
};

static struct door_run *begin(double deadband, double deviation, int64_t override_us)
{
    static struct door_run run;
    run.door = (struct swinging_door){ 0 };
    run.params = (struct swinging_door_params){ .deadband = deadband, .deviation = deviation, .override_us = override_us };
    run.sample_count = run.kept_count = 0;
    return &run;
}

static void put(struct door_run *run, int64_t t_us, double value, uint32_t quality)
{
    struct history_point point = { t_us, value, quality };
    run->samples[run->sample_count++] = point;
    run->kept_count += swinging_door_put(&run->door, &run->params, &point, run->kept + run->kept_count);
}

static void end(struct door_run *run)
{
    run->kept_count += swinging_door_end(&run->door, &run->params, run->kept + run->kept_count);
}

/* Returns the value at t_us on the line through the stored points, and its quality in *quality. */
static double read_back(const struct door_run *run, int64_t t_us, uint32_t *quality)
{
    int i = 0;
    while (i + 1 < run->kept_count && run->kept[i + 1].t_us <= t_us)
        i++;
    const struct history_point *a = &run->kept[i], *b = i + 1 < run->kept_count ? a + 1 : NULL;
    *quality = a->quality;
    return b && history_point_joined(a, b, run->params.step) ? history_point_between(a, b, t_us) : a->value;
}

static void assert_near(const struct door_run *run, double within)
{
    for (int i = 0; i < run->sample_count; i++) {
        const struct history_point *sample = &run->samples[i];
        uint32_t quality;
        double value = read_back(run, sample->t_us, &quality);
        if (quality != sample->quality)
            fail_msg("sample %d: quality %08x, kept %08x", i, sample->quality, quality);
        if (history_point_usable(sample) && !(fabs(value - sample->value) <= within * (1 + 1e-9) + 1e-12))
            fail_msg("sample %d: %.9g was kept as %.9g, more than %g off", i, sample->value, value, within);
    }
    for (int i = 1; i < run->kept_count; i++)
        assert_true(run->kept[i].t_us > run->kept[i - 1].t_us);
}

static double noise(void)
{
    return (double)rand() / RAND_MAX - 0.5;
}

/* Streams with random walks, noise, jumps, flat parts and lost quality: the line through the stored points must never deviate
   from a sample by more than allowed. */
TEST(the_line_keeps_its_promise)
{
    for (unsigned seed = 1; seed <= 300; seed++) {
        srand(seed);
        double deadband = rand() % 3 ? fabs(noise()) : 0, deviation = rand() % 3 ? fabs(noise()) : 0, value = 0, slope = 0;
        struct door_run *run = begin(deadband, deviation, (1 + rand() % 600) * S);
        int64_t t_us = 1700000000 * S;
        uint32_t quality = 0;
        for (int i = 0; i < 2000; i++) {
            t_us += 1 + rand() % (2 * S);
            if (rand() % 50 == 0)
                slope = noise() * (rand() % 2);
            if (rand() % 80 == 0)
                quality = rand() % 3 == 0 ? BAD : rand() % 2 ? 0x40900000 : 0;
            value += slope;
            put(run, t_us, quality == BAD ? NAN : value + noise() * (seed % 4) + (rand() % 100 ? 0 : 20 * noise()), quality);
        }
        end(run);
        assert_near(run, 2 * deadband + deviation);
    }
}

TEST(a_straight_line_takes_two_points)
{
    struct door_run *run = begin(0, 1e-6, 100000 * S);
    for (int i = 0; i < 1000; i++)
        put(run, i * S, 5 + 0.25 * i, 0);
    end(run);
    assert_int_equal(run->kept_count, 2);
}

TEST(a_spike_is_kept_exactly)
{
    struct door_run *run = begin(0.1, 0.2, 100000 * S);
    for (int i = 0; i < 1000; i++)
        put(run, i * S, i == 500 ? 99.5 : 20 + 0.05 * (i % 2), 0);
    end(run);
    uint32_t quality;
    assert_true(read_back(run, 500 * S, &quality) == 99.5);
    assert_near(run, 0.4);
    assert_true(run->kept_count <= 6);
}

TEST(the_override_period_forces_a_point)
{
    struct door_run *run = begin(1, 1, 60 * S);
    for (int i = 0; i <= 600; i++)
        put(run, i * S, 7, 0);
    assert_int_equal(run->kept_count, 11);
    for (int i = 1; i < run->kept_count; i++)
        assert_int_equal(run->kept[i].t_us - run->kept[i - 1].t_us, 60 * S);
}

TEST(every_change_of_quality_is_kept)
{
    struct door_run *run = begin(1, 1, 100000 * S);
    for (int i = 0; i < 100; i++)
        put(run, i * S, i / 10 % 2 ? NAN : 7, i / 10 % 2 ? BAD : 0);
    end(run);
    assert_near(run, 0);
    assert_int_equal(run->kept_count, 20);
}

TEST(a_switch_has_steps)
{
    struct door_run *run = begin(0, 0, 100000 * S);
    run->params.step = true;
    for (int i = 0; i < 100; i++)
        put(run, i * S, i / 10 % 2, 0);
    end(run);
    assert_near(run, 0);
    assert_int_equal(run->kept_count, 11);
}

/* The clock is set back, so timestamps go back: no sample may be lost. (Daylight saving has no effect, because timestamps are
   UTC.) */
TEST(a_clock_set_back_loses_nothing)
{
    struct door_run *run = begin(0.5, 0.5, 100000 * S);
    put(run, 100 * S, 1, 0);
    put(run, 101 * S, 1.1, 0);
    put(run, 50 * S, 1.2, 0);
    put(run, 51 * S, 9, 0);
    end(run);
    assert_int_equal(run->kept_count, 4);
    assert_int_equal(run->kept[1].t_us, 101 * S);
    assert_int_equal(run->kept[2].t_us, 50 * S);
}

TEST(what_is_held_is_the_newest)
{
    struct door_run *run = begin(0.5, 0.5, 100000 * S);
    struct history_point held;
    assert_false(swinging_door_held(&run->door, &held));
    put(run, 1 * S, 1, 0);
    assert_false(swinging_door_held(&run->door, &held)); /* the sample was kept already */
    put(run, 2 * S, 3, 0);
    assert_true(swinging_door_held(&run->door, &held));
    assert_int_equal(held.t_us, 2 * S);
    put(run, 3 * S, 3.1, 0);
    assert_true(swinging_door_held(&run->door, &held));
    assert_int_equal(held.t_us, 3 * S);
}

/* Queries about the present also get the newest sample, which the filter may not store later. The line to it must be as close
   to all samples as the line through stored points; in particular, a step must not look like a ramp until the next point is
   stored. */
TEST(whoever_reads_now_is_promised_the_same)
{
    srand(20260101);
    struct door_run *run = begin(0.25, 0.5, 100000 * S);
    for (int i = 0; i < 1500; i++) {
        struct history_point held;
        double step = rand() % 10 == 0 ? rand() % 21 - 10 : 0, noise = (double)rand() / RAND_MAX * 0.2;
        static double level;
        level += step;
        put(run, (1 + i) * S + rand() % (S / 2), level + noise, 0);
        int kept = run->kept_count;
        if (swinging_door_held(&run->door, &held))
            run->kept[run->kept_count++] = held;
        assert_near(run, 2 * 0.25 + 0.5);
        run->kept_count = kept;
    }
    end(run);
    assert_true(run->kept_count < 900);
}
