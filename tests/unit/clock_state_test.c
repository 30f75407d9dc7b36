/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests how the answer of adjtimex(2) is interpreted: whether a time service such as chrony keeps the system clock
   synchronised, the clock's maximum error, and leap seconds. */
#include "base/system/clock_state.h"

#include "tests/support/test.h"

#include "base/clock.h"

TEST(what_keeps_it_right_is_believed)
{
    struct timex timex = { .status = STA_PLL, .maxerror = 12345 };
    struct clock_state clock = clock_state_of(&timex, TIME_OK);
    assert_true(clock.set);
    assert_int_equal((int)(clock.error_s * 1e6 + 0.5), 12345);
    assert_int_equal(clock_state_error_ms(&clock), 100);
    assert_int_equal(clock.leap_s, 0);
    timex.status = STA_PLL | STA_INS;
    assert_int_equal(clock_state_of(&timex, TIME_INS).leap_s, 1);
    timex.status = STA_PLL | STA_DEL;
    assert_int_equal(clock_state_of(&timex, TIME_DEL).leap_s, -1);
    /* states during an inserted leap second (TIME_OOP) and after it (TIME_WAIT), in which the clock is still synchronised */
    timex.status = STA_PLL | STA_INS;
    assert_true(clock_state_of(&timex, TIME_OOP).set);
    assert_true(clock_state_of(&timex, TIME_WAIT).set);
}

TEST(nobody_keeps_it_right)
{
    struct timex timex = { .status = STA_UNSYNC, .maxerror = 16000000 };
    for (int returned = -1; returned <= TIME_ERROR; returned++) {
        struct clock_state clock = clock_state_of(&timex, returned);
        assert_false(clock.set);
        assert_int_equal(clock_state_error_ms(&clock), 0);
    }
    timex.status = STA_PLL;
    assert_false(clock_state_of(&timex, TIME_ERROR).set);
    assert_false(clock_state_of(&timex, -1).set); /* adjtimex fails, because the system call is not permitted */
}

TEST(errors_are_told_in_steps)
{
    const struct {
        double error_s;
        int ms;
    } cases[] = { { 0, 0 }, { 1e-6, 1 }, { 0.001, 1 }, { 0.0011, 10 }, { 0.1, 100 }, { 16, 100000 } };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++)
        assert_int_equal(clock_state_error_ms(&(struct clock_state){ .error_s = cases[i].error_s }), cases[i].ms);
}

TEST(this_machine_says_something)
{
    struct clock_state clock = clock_state_read();
    assert_int_equal(clock.set, clock_utc_is_set());
    assert_true(clock.error_s >= 0 && clock.leap_s >= -1 && clock.leap_s <= 1);
    print_message("# set: %d, within %d ms\n", clock.set, clock_state_error_ms(&clock));
}
