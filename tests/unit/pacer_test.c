/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures under way: the window, acknowledgements in and out of order, and acknowledgements of what was never sent. */
#include "net/pacer.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <time.h>

#include <cmocka.h>

static uint32_t send_one(struct pacer *pacer, size_t bytes, int64_t now_ns)
{
    assert_true(pacer_may_ask(pacer));
    pacer_asked(pacer);
    return pacer_sent(pacer, bytes, now_ns);
}

static void window_closes_until_acknowledged(void **state)
{
    (void)state;
    struct pacer pacer = { 0 };
    assert_int_equal(send_one(&pacer, 100, 1000), 1);
    assert_int_equal(send_one(&pacer, 50, 2000), 2);
    assert_false(pacer_may_ask(&pacer));
    assert_int_equal(pacer_bytes_in_flight(&pacer), 150);
    assert_int_equal(pacer_acked(&pacer, 1, 5000), PACER_ACK_NEW);
    assert_int_equal(pacer.ack_ns, 4000);
    assert_int_equal(pacer_bytes_in_flight(&pacer), 50);
    assert_true(pacer_may_ask(&pacer));
}

static void what_is_asked_for_counts(void **state)
{
    (void)state;
    struct pacer pacer = { 0 };
    for (int i = 0; i < PACER_WINDOW; i++)
        pacer_asked(&pacer);
    assert_false(pacer_may_ask(&pacer));
    pacer_dropped(&pacer);
    assert_true(pacer_may_ask(&pacer));
}

static void a_newer_ack_stands_for_older_frames(void **state)
{
    (void)state;
    struct pacer pacer = { 0 };
    send_one(&pacer, 1, 0);
    send_one(&pacer, 1, 0);
    assert_int_equal(pacer_acked(&pacer, 2, 0), PACER_ACK_NEW);
    assert_int_equal(pacer.flight_count, 0);
    assert_int_equal(pacer_acked(&pacer, 1, 0), PACER_ACK_OLD);
    assert_int_equal(pacer_acked(&pacer, 2, 0), PACER_ACK_OLD);
}

static void an_ack_for_nothing_opens_nothing(void **state)
{
    (void)state;
    struct pacer pacer = { 0 };
    assert_int_equal(pacer_acked(&pacer, 1, 0), PACER_ACK_NEVER_SENT);
    send_one(&pacer, 1, 0);
    send_one(&pacer, 1, 0);
    static const uint32_t never[] = { 0, 3, 4, 1000, UINT32_MAX, 0x80000002 };
    for (size_t i = 0; i < sizeof(never) / sizeof(never[0]); i++)
        assert_int_equal(pacer_acked(&pacer, never[i], 0), PACER_ACK_NEVER_SENT);
    assert_false(pacer_may_ask(&pacer));
}

static void numbers_go_round_and_leave_out_zero(void **state)
{
    (void)state;
    struct pacer pacer = { .last_seq = UINT32_MAX };
    assert_int_equal(send_one(&pacer, 1, 0), 1);
    assert_int_equal(pacer_acked(&pacer, 1, 0), PACER_ACK_NEW);
}

/* Whatever a client acknowledges, the window is never exceeded, and a good acknowledgement always opens it. */
static void random_clients(void **state)
{
    (void)state;
    unsigned seed = (unsigned)time(NULL);
    print_message("# seed %u\n", seed);
    struct pacer pacer = { .last_seq = 100 };
    for (int i = 0; i < 100000; i++) {
        if (pacer_may_ask(&pacer) && rand_r(&seed) % 2)
            send_one(&pacer, 1, i);
        else
            pacer_acked(&pacer, pacer.last_seq + (uint32_t)(rand_r(&seed) % 9) - 4, i);
        assert_true(pacer.flight_count >= 0 && pacer.flight_count <= PACER_WINDOW && pacer.asked == 0);
    }
    pacer_acked(&pacer, pacer.last_seq, 0);
    assert_int_equal(pacer.flight_count, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(window_closes_until_acknowledged),    cmocka_unit_test(what_is_asked_for_counts),
        cmocka_unit_test(a_newer_ack_stands_for_older_frames), cmocka_unit_test(an_ack_for_nothing_opens_nothing),
        cmocka_unit_test(numbers_go_round_and_leave_out_zero), cmocka_unit_test(random_clients),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
