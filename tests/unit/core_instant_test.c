/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Historical readings sent from a core to a renderer: bit-exact; invalid messages are refused. */
#include "tests/support/test.h"

#include "corelink/core_instant.h"
#include "value/alarm.h"
#include "value/quality.h"

enum { TAGS = 3, ROUNDS = 200000 };
static const int64_t FIRST_US = INT64_C(1790000000000001);

static struct text make_message(struct snapshot *snapshot)
{
    struct text text = { 0 };
    snapshot->readings[0] = (struct reading){ .value = 0.1 + 0.2,
                                              .quality = QUALITY_GOOD,
                                              .alarm = ALARM_HH,
                                              .alarm_status = ALARM_ACKNOWLEDGED,
                                              .received_utc_ns = INT64_C(1790000000000000007),
                                              .age_ns = 12345678901 };
    snapshot->readings[1] = (struct reading){ .value = NAN, .quality = QUALITY_BAD_SENSOR_FAILURE, .age_ns = INT64_MAX };
    core_instant_write(&text, FIRST_US, snapshot);
    return text;
}

TEST(each_comes_to_the_bit)
{
    struct snapshot *sent = test_snapshot(TAGS), *got = test_snapshot(TAGS);
    struct text text = make_message(sent);
    int64_t first_us = 0;
    assert_null(core_instant_read(text.at, text.length, &first_us, got));
    assert_int_equal(first_us, FIRST_US);
    for (int i = 0; i < TAGS; i++) {
        const struct reading *a = &sent->readings[i], *b = &got->readings[i];
        assert_memory_equal(&a->value, &b->value, sizeof(a->value));
        assert_int_equal(a->quality, b->quality);
        assert_int_equal(a->alarm, b->alarm);
        assert_int_equal(a->alarm_status, b->alarm_status);
        assert_int_equal(a->received_utc_ns, b->received_utc_ns);
        assert_int_equal(a->age_ns, b->age_ns);
    }
    text_finish(&text);
    core_instant_write(&text, 0, NULL);
    assert_null(core_instant_read(text.at, text.length, &first_us, NULL));
    assert_int_equal(first_us, 0);
    assert_string_equal(core_instant_read(text.at, text.length, &first_us, got),
                        "the core's answer has readings of more or fewer tags than this plant has: copy the core's plant file and tag "
                        "list to this machine, then reload");
    text_finish(&text);
}

TEST(any_bytes_are_read_or_refused)
{
    struct snapshot *snapshot = test_snapshot(TAGS), *got = test_snapshot(TAGS);
    struct text text = make_message(snapshot);
    unsigned seed = (unsigned)sweep_seed();
    int refused = 0;
    srand(seed);
    for (int round = 0; round < ROUNDS; round++) {
        size_t length = rand() % 4 ? text.length : (size_t)rand() % (text.length + 1);
        uint8_t *bytes = mem_array(length + 1, 1); /* allocated at the exact size, so that the sanitizer finds a read beyond the end */
        int64_t first_us;
        memcpy(bytes, text.at, length);
        for (int i = rand() % 4; i > 0 && length > 0; i--)
            bytes[(size_t)rand() % length] = (uint8_t)rand();
        if (core_instant_read(bytes, length, &first_us, got)) {
            refused++;
        } else {
            assert_true(first_us >= 0);
            for (int i = 0; i < TAGS; i++) {
                const struct reading *one = &got->readings[i];
                assert_true(one->age_ns >= 0 && one->alarm < ALARM_KINDS && one->alarm_status < ALARM_STATUSES);
                assert_true(quality_is_bad(one->quality) || isfinite(one->value));
            }
        }
        mem_free(bytes);
    }
    assert_true(refused > ROUNDS / 10 && refused < ROUNDS);
    text_finish(&text);
}
