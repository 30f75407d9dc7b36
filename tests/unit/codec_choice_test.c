/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The choice between H.264 (less data) and JPEG (less processor time) by network throughput and free processor time. The choice
   must not oscillate. */
#include "session/pacing/codec_choice.h"

#include "tests/support/test.h"

#include "base/clock.h"

enum { FULL_HD = 1920 * 1080 };

/* Updates the choice ten times per second for `seconds` with a constant throughput and share of free processor time. Returns
   how often the codec changed. */
static int run(struct codec_choice *choice, double mbyte_per_s, double cpu_free, int seconds, int64_t *now_ns)
{
    int changes = 0;
    for (int i = 0; i < seconds * 10; i++, *now_ns += NS_PER_S / 10) {
        bool before = choice->jpeg;
        codec_choice_update(choice, &(struct codec_facts){ mbyte_per_s * 1e6, cpu_free, FULL_HD }, *now_ns);
        changes += before != choice->jpeg;
    }
    return changes;
}

TEST(h264_unless_there_is_plenty_and_no_processor)
{
    struct codec_choice choice = { 0 };
    int64_t now_ns = NS_PER_S;
    assert_int_equal(run(&choice, 0, 0, 60, &now_ns), 0);     /* throughput 0: not measured yet, so the codec stays */
    assert_int_equal(run(&choice, 10, 0.02, 60, &now_ns), 0); /* 80 Mbit/s */
    assert_int_equal(run(&choice, 500, 0.5, 60, &now_ns), 0);
    assert_false(choice.jpeg);
    assert_int_equal(run(&choice, 500, 0.02, 60, &now_ns), 1);
    assert_true(choice.jpeg);
}

TEST(a_short_time_decides_nothing)
{
    struct codec_choice choice = { 0 };
    int64_t now_ns = NS_PER_S;
    for (int i = 0; i < 20; i++) {
        assert_int_equal(run(&choice, 500, 0.02, 4, &now_ns), 0);
        assert_int_equal(run(&choice, 500, 0.6, 1, &now_ns), 0);
    }
    run(&choice, 500, 0.02, 6, &now_ns);
    assert_true(choice.jpeg);
    for (int i = 0; i < 20; i++) { /* still, and moving again */
        assert_int_equal(run(&choice, 500, 0.9, 20, &now_ns), 0);
        assert_int_equal(run(&choice, 500, 0.3, 1, &now_ns), 0);
    }
    assert_int_equal(run(&choice, 500, 0.9, 31, &now_ns), 1);
}

TEST(a_network_that_gets_narrow_decides_at_once)
{
    struct codec_choice choice = { .jpeg = true };
    int64_t now_ns = NS_PER_S;
    assert_int_equal(run(&choice, 3, 0.02, 1, &now_ns), 1);
    assert_false(choice.jpeg);
}

TEST(processor_time_is_what_proc_says)
{
    struct cpu_meter meter = { 0 };
    assert_true(cpu_meter_free(&meter, "cpu  100 0 100 700 100 0 0 0 0 0\ncpu0 1 1 1 1\n") == 1);
    assert_true(cpu_meter_free(&meter, "cpu  150 10 115 715 110 0 0 0 0 0\n") == 0.25);
    assert_true(cpu_meter_free(&meter, "cpu  150 10 115 715 110 0 0 0 0 0\n") == 1);
    assert_true(cpu_meter_free(&meter, "nothing") == 1);
}
