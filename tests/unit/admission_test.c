/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resource limits of clients: limits by name, limits per address, and whether the render thread has room for one more session. */
#include "session/pacing/admission.h"

#include "tests/support/test.h"

#include "base/clock.h"
#include "net/address_limits.h"

static struct quotas quotas;

static int set_up(void **state)
{
    (void)state;
    quotas = quotas_default();
    return 0;
}

TEST_WITH(limits_are_set_by_name_and_within_range, set_up, NULL)
{
    assert_true(quotas_parse(&quotas, "sessions=7"));
    assert_int_equal(quotas.at[QUOTA_SESSIONS], 7);
    assert_true(quotas.given[QUOTA_SESSIONS] && !quotas.given[QUOTA_PIXELS]);
    static const char *const bad[] = { "sessions",           "sessions=",  "sessions=x",
                                       "sessions=7x",        "sessions=0", "sessions=-1",
                                       "session=7",          "=7",         "sessions=99999999999999999999",
                                       "message-bytes=65537" };
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
        if (quotas_parse(&quotas, bad[i]))
            fail_msg("%s is taken", bad[i]);
    assert_int_equal(quotas.at[QUOTA_SESSIONS], 7);
}

/* --- addresses ------------------------------------------------------------------------------------------------------------------- */

TEST_WITH(an_address_is_one_however_it_is_written, set_up, NULL)
{
    struct address_limits *limits = address_limits_create(&quotas, true);
    struct address_usage *four = address_limits_ref(limits, "203.0.113.7"), *mapped = address_limits_ref(limits, "::ffff:203.0.113.7");
    struct address_usage *six = address_limits_ref(limits, "2001:db8:1:2::1"),
                         *near_it = address_limits_ref(limits, "2001:db8:1:2:ffff::9");
    struct address_usage *far_from_it = address_limits_ref(limits, "2001:db8:1:3::1");
    assert_true(four == mapped && six == near_it && six != far_from_it && six != four && far_from_it != four);
    four->sessions = 5;
    struct address_usage *local = address_limits_ref(limits, "127.0.0.1"), *local6 = address_limits_ref(limits, "::1"),
                         *none = address_limits_ref(limits, "nonsense");
    assert_true(local->local && local6->local && !four->local && !none->local);
    struct address_usage *all[] = { four, mapped, six, near_it, far_from_it, local, local6, none };
    for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); i++)
        address_limits_unref(limits, &all[i]);
    /* after its last reference an address is forgotten: a new reference finds no sessions */
    four = address_limits_ref(limits, "203.0.113.7");
    assert_int_equal(four->sessions, 0);
    address_limits_unref(limits, &four);
    address_limits_destroy(&limits);
}

TEST_WITH(an_address_has_its_limits_and_this_machine_only_those_set, set_up, NULL)
{
    struct address_limits *limits = address_limits_create(&quotas, true);
    struct address_usage *usage = address_limits_ref(limits, "203.0.113.7"), *local = address_limits_ref(limits, "127.0.0.1");
    usage->connections = local->connections = (int)quotas.at[QUOTA_ADDRESS_CONNECTIONS];
    usage->sessions = local->sessions = (int)quotas.at[QUOTA_ADDRESS_SESSIONS];
    assert_false(address_limits_may_connect(limits, usage) || address_limits_may_stream(limits, usage));
    assert_true(address_limits_may_connect(limits, local) && address_limits_may_stream(limits, local));
    usage->connections--;
    assert_true(address_limits_may_connect(limits, usage));
    assert_true(quotas_parse(&quotas, "address-sessions=2"));
    assert_false(address_limits_may_stream(limits, local));
    address_limits_unref(limits, &usage);
    address_limits_unref(limits, &local);
    address_limits_destroy(&limits);
}

TEST_WITH(messages_of_an_address_are_counted_together, set_up, NULL)
{
    int64_t now_ns = 1000 * NS_PER_S;
    quotas_parse(&quotas, "address-messages=10");
    struct address_limits *limits = address_limits_create(&quotas, true);
    struct address_usage *usage = address_limits_ref(limits, "203.0.113.7");
    for (int i = 0; i < 10; i++)
        assert_true(address_limits_count_message(limits, usage, now_ns));
    assert_false(address_limits_count_message(limits, usage, now_ns + NS_PER_S / 2));
    assert_true(address_limits_count_message(limits, usage, now_ns + NS_PER_S));
    address_limits_unref(limits, &usage);
    address_limits_destroy(&limits);
}

/* --- room ------------------------------------------------------------------------------------------------------------------------ */

/* Simulates one second of the render thread: each of `moving` sessions gets `fps` frames that take cost_ms each to draw.
   data_wait_ms: how long one more frame, for changed readings, had to wait; 0: there is none. */
static void a_second(struct admission *admission, struct address_share *share, int moving, int fps, int cost_ms, int data_wait_ms)
{
    static uint64_t content;
    for (int i = 0; i < moving * fps + (data_wait_ms > 0); i++) {
        struct frame *frame = frame_create(NULL, 16, 16);
        frame->view.tier = TIER_PREVIEW;
        frame->turn_ns = cost_ms * NS_PER_MS;
        frame->content = ++content;
        struct encoded_frame encoded = { .packet = packet_create(frame, WIRE_CODEC_JPEG, true, "jpeg", 4),
                                         .request.urgency = URGENCY_INPUT };
        if (i == moving * fps) {
            encoded.request.urgency = URGENCY_DATA;
            encoded.wait_ns = data_wait_ms * NS_PER_MS;
        }
        admission_on_frame(admission, share, &encoded);
        /* the frame also goes to a second session: its drawing time must count only once */
        admission_on_frame(admission, share, &encoded);
        packet_unref(&encoded.packet);
        frame_unref(&frame);
    }
    admission->now.moving /= 2;
    admission_on_tick(admission, admission->begin_ns + NS_PER_S);
}

static void seconds(struct admission *admission, struct address_share *share, int moving, int fps, int cost_ms, int data_wait_ms)
{
    for (int i = 0; i < ADMISSION_WINDOWS; i++)
        a_second(admission, share, moving, fps, cost_ms, data_wait_ms);
}

/* Asks whether one more session may join from an address that already has `moving` sessions with moving cameras. Returns the
   reason for refusal, or REFUSAL_NONE. */
static enum refusal_code refuses(const struct admission *admission, struct address_share *share, int64_t pixels, int moving)
{
    share->moving = moving;
    return admission_refuses(admission, share, pixels);
}

TEST_WITH(who_would_slow_the_others_down_too_far_is_refused, set_up, NULL)
{
    struct admission admission = { .quotas = &quotas };
    struct address_share share = { 0 };
    admission_join(&admission, &share);
    assert_int_equal(0, refuses(&admission, &share, 1000, 0));
    /* 4 sessions at 6 frames/s use all of the render thread: with a fifth, each would get 4.8, fewer than least-fps allows */
    seconds(&admission, &share, 4, 6, 40, 0);
    assert_int_equal(admission_busy_percent(&admission), 96);
    assert_true(refuses(&admission, &share, 1000, 4));
    seconds(&admission, &share, 4, 7, 34, 0); /* 5.6 */
    assert_int_equal(0, refuses(&admission, &share, 1000, 4));
    a_second(&admission, &share, 4, 1, 40, 0); /* a quiet second */
    assert_int_equal(0, refuses(&admission, &share, 1000, 4));
}

TEST_WITH(a_busy_second_is_no_reason, set_up, NULL)
{
    struct admission admission = { .quotas = &quotas };
    struct address_share share = { 0 };
    admission_join(&admission, &share);
    for (int i = 0; i < ADMISSION_WINDOWS - 1; i++)
        a_second(&admission, &share, 2, 1, 490, 2000);
    assert_int_equal(0, refuses(&admission, &share, 1000, 2));
    a_second(&admission, &share, 2, 1, 490, 2000);
    assert_true(refuses(&admission, &share, 1000, 2));
}

/* Simulates one second of the render thread: for each address, draws `of_each` frames per moving session; each frame takes
   cost_ms. */
static void a_second_of(struct admission *admission, struct address_share *shares, int count, int of_each, int cost_ms)
{
    static uint64_t content = 1 << 20;
    for (int i = 0; i < count; i++)
        for (int n = 0; n < shares[i].moving * of_each; n++) {
            struct frame *frame = frame_create(NULL, 16, 16);
            frame->turn_ns = cost_ms * NS_PER_MS;
            frame->content = ++content;
            struct encoded_frame encoded = { .packet = packet_create(frame, WIRE_CODEC_JPEG, true, "jpeg", 4),
                                             .request.urgency = URGENCY_INPUT };
            admission_on_frame(admission, &shares[i], &encoded);
            packet_unref(&encoded.packet);
            frame_unref(&frame);
        }
    admission_on_tick(admission, admission->begin_ns + NS_PER_S);
}

TEST_WITH(one_address_keeps_no_other_out, set_up, NULL)
{
    struct admission admission = { .quotas = &quotas };
    struct address_share shares[2] = { { .moving = 30 }, { .moving = 0 } };
    admission_join(&admission, &shares[0]);
    for (int i = 0; i < ADMISSION_WINDOWS; i++)
        /* one address has 30 sessions that each get one frame per second, which keeps the render thread busy */
        a_second_of(&admission, shares, 1, 1, 30);
    assert_true(admission_refuses(&admission, &shares[0], 1000));
    assert_int_equal(0, admission_refuses(&admission, &shares[1], 1000));
    admission_join(&admission, &shares[1]);
    shares[1].moving = 1;
    for (int i = 0; i < ADMISSION_WINDOWS; i++)
        a_second_of(&admission, shares, 2, 1, 30);
    assert_int_equal(0, admission_refuses(&admission, &shares[1],
                                          /* admitted: with two addresses, each one's share is half of the render thread's 31
                                             frames per second */
                                          1000));
    shares[1].moving = 3;
    /* refused: the second address's share, divided by its three sessions and the new one, is less than least-fps */
    assert_true(admission_refuses(&admission, &shares[1], 1000));
    struct address_share third = { 0 };
    /* admitted: with a third address, each address's share is still 10 frames per second */
    assert_int_equal(0, admission_refuses(&admission, &third, 1000));
    quotas_parse(&quotas, "least-fps=11");
    assert_true(admission_refuses(&admission, &third, 1000));
}

TEST_WITH(many_addresses_of_one_session_each_are_as_many_sessions, set_up, NULL)
{
    struct admission admission = { .quotas = &quotas };
    struct address_share shares[5] = { { .moving = 1 }, { .moving = 1 }, { .moving = 1 }, { .moving = 1 }, { .moving = 0 } };
    for (int i = 0; i < 4; i++)
        admission_join(&admission, &shares[i]);
    for (int i = 0; i < ADMISSION_WINDOWS; i++)
        a_second_of(&admission, shares, 4, 6, 40);
    assert_true(admission_refuses(&admission, &shares[4], 1000)); /* a fifth address would leave 4.8 frames per second for each */
    for (int i = 0; i < ADMISSION_WINDOWS; i++)
        a_second_of(&admission, shares, 4, 7, 34);
    assert_int_equal(0, admission_refuses(&admission, &shares[4], 1000));
}

TEST_WITH(readings_that_are_drawn_too_late_are_a_reason, set_up, NULL)
{
    struct admission admission = { .quotas = &quotas };
    struct address_share share = { 0 };
    admission_join(&admission, &share);
    seconds(&admission, &share, 1, 30, 30, 900);
    assert_int_equal(0, refuses(&admission, &share, 1000, 1));
    seconds(&admission, &share, 1, 30, 30, 1100);
    assert_true(refuses(&admission, &share, 1000, 1));
}

TEST_WITH(pixels_of_all_views_have_a_limit, set_up, NULL)
{
    struct admission admission = { .quotas = &quotas };
    struct address_share share = { 0 };
    admission_join(&admission, &share);
    quotas_parse(&quotas, "pixels=1000000");
    admission.pixels = 900000;
    assert_int_equal(0, refuses(&admission, &share, 100000, 0));
    assert_true(refuses(&admission, &share, 100001, 0));
}
