/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parsing of timestamps in common formats, and which texts are refused. */
#include "tests/support/test.h"
#include <time.h>

#include "base/text/timestamp.h"

#define S INT64_C(1000000)
static const int64_t NOW = INT64_C(1793491200) * S; /* 2026-11-01T00:00:00Z */

TEST(instants_are_read)
{
    static const struct {
        const char *text;
        int64_t t_us;
    } cases[] = {
        { "2026-11-01T00:00:00Z", INT64_C(1793491200) * S },
        { "2026-11-01T00:00Z", INT64_C(1793491200) * S },
        { "2026-11-01 00:00:00.25z", INT64_C(1793491200) * S + S / 4 },
        { "2026-11-01T01:00:00+01:00", INT64_C(1793491200) * S },
        { "2026-10-31T18:30:00-0530", INT64_C(1793491200) * S },
        { "2028-02-29T00:00:00Z", INT64_C(1835395200) * S },
        { "1793491200", INT64_C(1793491200) * S },
        { "1793491200.5", INT64_C(1793491200) * S + S / 2 },
        { "0", 0 },
        { "now", INT64_C(1793491200) * S },
        { "-90s", INT64_C(1793491110) * S },
        { "-8h", INT64_C(1793462400) * S },
        { "-7d", INT64_C(1792886400) * S },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        int64_t t_us = -1;
        if (!timestamp_parse(cases[i].text, NOW, &t_us) || t_us != cases[i].t_us)
            fail_msg("'%s' was read as %lld", cases[i].text, (long long)t_us);
    }
}

TEST(what_is_not_one_instant_is_refused)
{
    static const char *const bad[] = {
        "",
        "yesterday",
        "2026-10-25T02:30:00" /* there twice in Berlin */,
        "2026-11-31T00:00:00Z",
        "2026-02-29T00:00:00Z",
        "2026-13-01T00:00:00Z",
        "2026-11-01T24:00:00Z",
        "2026-11-01T00:60:00Z",
        "2026-11-01Z",
        "2026-11-01T00:00:00Zx",
        "2026-11-01T00:00:00+15:00",
        "99999999999999999999",
        "12x",
        "-",
        "-8",
        "-8y",
        "-8hh",
        "-99999999d",
        "1e9",
        "nan",
        "2026-1-1T00:00:00Z",
        "9999-01-01T00:00:00Z",
    };
    int64_t t_us;
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
        if (timestamp_parse(bad[i], NOW, &t_us))
            fail_msg("'%s' was taken", bad[i]);
}

/* When clocks go back, the two equal hours of that night are different instants, whatever this computer's time zone. */
TEST(summer_time_does_not_matter)
{
    int64_t first, second;
    setenv("TZ", "Europe/Berlin", 1);
    tzset();
    assert_true(timestamp_parse("2026-10-25T02:30:00+02:00", NOW, &first));
    assert_true(timestamp_parse("2026-10-25T02:30:00+01:00", NOW, &second));
    assert_int_equal(second - first, 3600 * S);
    char text[TIMESTAMP_BYTES];
    timestamp_print(first, text);
    assert_string_equal(text, "2026-10-25T00:30:00.000Z");
    /* 02:30 in the night when clocks skip that hour: with a UTC offset, this is a valid instant all the same */
    assert_true(timestamp_parse("2026-03-29T02:30:00+01:00", NOW, &first));
    unsetenv("TZ");
    tzset();
}

TEST(what_is_written_is_read_again)
{
    srand(3);
    for (int i = 0; i < 10000; i++) {
        int64_t t_us = ((int64_t)rand() * 3) * S + (i % 2 ? rand() % 1000000 : rand() % 1000 * 1000), again;
        char text[TIMESTAMP_BYTES];
        timestamp_print(t_us, text);
        assert_true(timestamp_parse(text, NOW, &again));
        assert_int_equal(again, t_us);
    }
}
