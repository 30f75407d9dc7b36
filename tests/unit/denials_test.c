/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The nodes that a core refused last: which is shown, with which reason, and when a log line is due. */
#include "net/denials.h"

#include "tests/support/test.h"

#include <stdio.h>

#include "base/clock.h"

static const int64_t S = NS_PER_S, T = 1000 * NS_PER_S;

static int set_up(void **state)
{
    static struct denials denials;
    denials = (struct denials){ .last = NULL };
    *state = &denials;
    return 0;
}

#define CASE(name) TEST_ON(struct denials *denials, name, set_up, NULL)

static bool logs(struct denials *denials, const char *who, int64_t now_ns)
{
    char more[LOG_PACE_BYTES];
    return denials_log(denials_note(denials, who, "why", false, now_ns), now_ns, more);
}

CASE(an_unchecked_token_keeps_the_reason)
{
    denials_note(denials, "10.0.0.20", "the token is unknown\n", false, T);
    denials_note(denials, "10.0.0.20", "too many wrong tokens", true, T + 10 * S);
    assert_string_equal(denials_recent(denials, T + 24 * S)->why, "the token is unknown");
    denials_note(denials, "10.0.0.20", "the token has the wrong role", false, T + 24 * S);
    assert_string_equal(denials_recent(denials, T + 24 * S)->why, "the token has the wrong role");
}

CASE(an_unchecked_token_is_the_reason_if_there_is_no_other)
{
    denials_note(denials, "10.0.0.20", "the token is unknown", false, T);
    denials_note(denials, "10.0.0.21", "too many wrong tokens", true, T);
    assert_string_equal(denials_recent(denials, T)->who, "10.0.0.21");
    assert_string_equal(denials_recent(denials, T)->why, "too many wrong tokens");
    denials_note(denials, "10.0.0.20", "too many wrong tokens", true, T + 15 * S);
    assert_string_equal(denials_recent(denials, T + 15 * S)->why, "too many wrong tokens");
}

CASE(a_refusal_is_shown_until_it_is_old_or_a_standby_is_accepted)
{
    assert_null(denials_recent(denials, T));
    denials_note(denials, "c2", "why", false, T);
    assert_non_null(denials_recent(denials, T + 14 * S));
    assert_null(denials_recent(denials, T + 15 * S));
    denials_note(denials, "c2", "why", false, T + 20 * S);
    denials_forget(denials);
    assert_null(denials_recent(denials, T + 20 * S));
}

CASE(each_node_is_logged_at_once_and_then_once_a_minute)
{
    assert_true(logs(denials, "10.0.0.20", T));
    assert_true(logs(denials, "10.0.0.21", T + 1 * S));
    assert_false(logs(denials, "10.0.0.20", T + 2 * S));
    assert_false(logs(denials, "10.0.0.21", T + 60 * S));
    assert_true(logs(denials, "10.0.0.20", T + 60 * S));
    assert_true(logs(denials, "10.0.0.21", T + 61 * S));
}

CASE(many_nodes_do_not_flood_the_log)
{
    int lines = 0;
    for (int i = 0; i < 1000; i++) {
        char who[32];
        snprintf(who, sizeof(who), "2001:db8::%d", i);
        lines += logs(denials, who, T + i);
    }
    assert_int_equal(lines, DENIED_NODES);
}
