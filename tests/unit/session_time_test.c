/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A session that shows the past: its snapshot requests, frames and messages, playback, and that other sessions stay in the present. */
#include "tests/support/test.h"
#include <jansson.h>

#include "base/clock.h"
#include "service/history_loader.h"
#include "session/session.h"
#include "tests/support/session_case.h"

#define HELLO "{\"type\":\"hello\",\"width\":640,\"height\":360,\"codecs\":[\"jpeg\"]%s}"
static const int64_t NOW_US = INT64_C(1793500000000000), MS = NS_PER_MS;

static int set_up(void **state)
{
    session_case_set_up(state);
    struct session_case *f = *state;
    f->context.readings.live = false;
    f->services.snapshot_cache = snapshot_cache_create();
    f->context.readings.history_first_us = NOW_US - INT64_C(3600000000);
    return 0;
}

static int tear_down(void **state)
{
    struct session_case *f = *state;
    struct snapshot_cache *snapshot_cache = f->services.snapshot_cache;
    session_case_tear_down(state);
    snapshot_cache_destroy(&snapshot_cache);
    return 0;
}

#define CASE(name) TEST_ON(struct session_case *f, name, set_up, tear_down)

static int64_t utc_ns(const struct session_case *f)
{
    return NOW_US * 1000 + f->now_ns - 1000 * NS_PER_S;
}

static void say(struct session_case *f, const char *text)
{
    session_on_message(f->session, text, strlen(text), f->now_ns, utc_ns(f));
}

/* Reads all messages to the client that are due. Returns the last one of this type. */
static json_t *hear(struct session_case *f, const char *type)
{
    struct text *text = test_text();
    json_t *found = NULL;
    while (session_next_text(f->session, f->now_ns, utc_ns(f), text)) {
        json_t *message = test_json(json_loads(text->at, 0, NULL));
        assert_non_null(message);
        if (!strcmp(json_string_value(json_object_get(message, "type")), type))
            found = message;
        text->length = 0;
    }
    return found;
}

static int64_t number(const json_t *message, const char *name)
{
    return json_integer_value(json_object_get(message, name));
}

static void expect_error(struct session_case *f, const char *code)
{
    json_t *message = hear(f, "error");
    assert_non_null(message);
    assert_string_equal(json_string_value(json_object_get(message, "code")), code);
}

static void greet(struct session_case *f, const char *more)
{
    say(f, test_printf(HELLO, more));
    json_t *welcome = hear(f, "welcome");
    assert_non_null(welcome);
    snprintf(f->resume, sizeof(f->resume), "%s", json_string_value(json_object_get(welcome, "resume")));
}

static void go(struct session_case *f, int64_t ago_s, double speed)
{
    say(f, test_printf("{\"type\":\"time\",\"at_us\":%lld,\"speed\":%g}", (long long)(NOW_US - ago_s * 1000000), speed));
}

/* Returns the instant of which the session wants a snapshot, in seconds before NOW, or NAN if it wants none. */
static double wanted(struct session_case *f)
{
    int64_t at_us;
    return session_wants_historical_snapshot(f->session, f->now_ns, utc_ns(f), &at_us) ? (double)(NOW_US - at_us) / 1e6 : (double)NAN;
}

static void bring(struct session_case *f, double ago_s, double value)
{
    struct snapshot *snapshot = test_snapshot(f->snapshot->count);
    int64_t at_us = NOW_US - (int64_t)llround(ago_s * 1e6);
    snapshot->taken_utc_ns = at_us * 1000;
    snapshot->readings[0] = (struct reading){ .value = value };
    snapshot_cache_add(f->services.snapshot_cache, at_us, snapshot);
    session_on_historical_snapshot(f->session, at_us, true, f->now_ns);
}

CASE(test_an_instant_is_shown_once_it_was_read)
{
    struct frame_request request;
    greet(f, "");
    go(f, 60, 0);
    assert_true(f->session->view.at_us == 0);
    assert_true(wanted(f) == 60);
    assert_true(isnan(wanted(f))); /* the same instant is not requested again while the snapshot is being loaded */
    bring(f, 60, 5);
    assert_true(session_next_request(f->session, f->now_ns, &request));
    assert_true(request.view.at_us == NOW_US - 60000000 && request.view.field.slot == 1 && request.urgency == URGENCY_INPUT);
    assert_true(session_snapshot(f->session)->readings[0].value == 5);
    json_t *tags = hear(f, "tags");
    assert_int_equal(number(tags, "time_us"), NOW_US - 60000000);
    /* the past reading must be in this session's own snapshot only, not in the live one that others use */
    assert_true(f->snapshot->readings[0].value == 0);
}

CASE(test_the_client_is_told_where_it_is)
{
    greet(f, "");
    go(f, 60, 0);
    wanted(f);
    bring(f, 60, 5);
    json_t *time = hear(f, "time");
    assert_non_null(time);
    assert_int_equal(json_integer_value(json_object_get(time, "from_us")), f->context.readings.history_first_us);
    assert_int_equal(number(time, "at_us"), NOW_US - 60000000);
    say(f, "{\"type\":\"time\",\"at_us\":null}");
    time = hear(f, "time");
    assert_true(json_is_null(json_object_get(time, "at_us")));
    assert_true(f->session->view.at_us == 0 && f->session->view.field.slot == 0);
    assert_ptr_equal(session_snapshot(f->session), f->snapshot);
}

CASE(test_play_goes_on_by_the_clock_and_ends_in_the_present)
{
    greet(f, "");
    go(f, 60, 20);
    assert_true(wanted(f) == 60);
    bring(f, 60, 1);
    assert_true(isnan(wanted(f)));
    f->now_ns += 100 * MS;
    assert_true(wanted(f) == 58);
    bring(f, 58, 2);
    f->now_ns += 1900 * MS; /* late: time does not wait */
    assert_true(wanted(f) == 20);
    say(f, "{\"type\":\"time\",\"speed\":0}");
    bring(f, 20, 3);
    f->now_ns += 5000 * MS;
    assert_true(isnan(wanted(f)));
    assert_true(f->session->view.at_us == NOW_US - 20000000);
    say(f, "{\"type\":\"time\",\"speed\":100}");
    f->now_ns += 1000 * MS;
    assert_true(isnan(wanted(f)));
    assert_true(f->session->view.at_us == 0 && f->session->travel.speed == 0 && !f->session->travel.historical);
}

CASE(test_backwards_it_stops_where_history_begins)
{
    greet(f, "");
    go(f, 3590, -100);
    wanted(f);
    bring(f, 3590, 1);
    f->now_ns += 1000 * MS;
    assert_true(wanted(f) == 3600);
    bring(f, 3600, 1);
    f->now_ns += 1000 * MS;
    assert_true(isnan(wanted(f)));
    assert_true(f->session->travel.speed == 0);
}

CASE(test_who_drags_sees_what_was_read_on_the_way)
{
    greet(f, "");
    go(f, 60, 0);
    wanted(f);
    go(f, 50, 0);
    bring(f, 60, 1);
    assert_true(f->session->view.at_us == NOW_US - 60000000);
    assert_true(wanted(f) == 50);
    bring(f, 50, 1);
    assert_true(f->session->view.at_us == NOW_US - 50000000);
    assert_true(isnan(wanted(f)));
}

CASE(test_what_cannot_be_read_is_said_and_changes_nothing)
{
    greet(f, "");
    go(f, 60, 60);
    wanted(f);
    session_on_historical_snapshot(f->session, NOW_US - 60000000, false, f->now_ns);
    expect_error(f, "no_history");
    assert_true(f->session->view.at_us == 0 && f->session->travel.speed == 0 && isnan(wanted(f)));
    say(f, "{\"type\":\"time\",\"speed\":2}");
    expect_error(f, "bad_field");
    struct snapshot_cache *snapshot_cache = f->services.snapshot_cache;
    f->services.snapshot_cache = NULL;
    go(f, 60, 0);
    expect_error(f, "no_history");
    f->services.snapshot_cache = snapshot_cache;
}

CASE(test_without_a_history_a_past_time_in_hello_is_refused)
{
    struct snapshot_cache *snapshot_cache = f->services.snapshot_cache;
    f->services.snapshot_cache = NULL;
    say(f, test_printf(HELLO, ",\"at_us\":1793499940000000"));
    expect_error(f, "no_history");
    assert_true(f->session->hello && f->session->view.at_us == 0 && isnan(wanted(f)));
    f->services.snapshot_cache = snapshot_cache;
}

CASE(test_hello_with_a_time_in_the_future_begins_in_the_present)
{
    say(f, test_printf(HELLO, ",\"at_us\":1893500000000000"));
    json_t *time = hear(f, "time");
    assert_non_null(time);
    assert_true(json_is_null(json_object_get(time, "at_us")) && isnan(wanted(f)));
}

CASE(test_without_a_history_a_time_in_the_future_is_no_error)
{
    struct snapshot_cache *snapshot_cache = f->services.snapshot_cache;
    f->services.snapshot_cache = NULL;
    say(f, test_printf(HELLO, ",\"at_us\":1893500000000000"));
    assert_null(hear(f, "error"));
    assert_true(f->session->hello && f->session->view.at_us == 0);
    f->services.snapshot_cache = snapshot_cache;
}

CASE(test_the_newest_seconds_are_the_present)
{
    greet(f, "");
    go(f, 2, 0);
    assert_true(isnan(wanted(f)) && f->session->view.at_us == 0);
}

CASE(test_new_parameters_stay_in_the_past)
{
    greet(f, "");
    go(f, 60, 0);
    wanted(f);
    bring(f, 60, 5);
    say(f, "{\"type\":\"params\",\"seq\":1,\"group\":\"temperature\",\"split\":{\"interpolation\":\"paper\"}}");
    assert_true(f->session->view.at_us == NOW_US - 60000000 && f->session->view.field.slot == 1 && f->session->view.right.field.slot == 1);
    say(f, "{\"type\":\"params\",\"seq\":2,\"baseline\":{\"set\":\"then\"}}");
    struct baseline list[BASELINES_NAMED];
    assert_int_equal(baselines_list(f->services.baselines, list), 1);
    assert_true(list[0].taken_utc_ns == (NOW_US - 60000000) * 1000);
}

CASE(test_whoever_begins_in_the_past_never_sees_the_present)
{
    char more[64];
    struct frame_request request;
    snprintf(more, sizeof(more), ",\"at_us\":%lld,\"speed\":60", (long long)(NOW_US - 600000000));
    greet(f, more);
    assert_false(session_next_request(f->session, f->now_ns, &request));
    assert_true(wanted(f) == 600);
    bring(f, 600, 5);
    assert_true(session_next_request(f->session, f->now_ns, &request));
    assert_true(request.view.at_us == NOW_US - 600000000);
    f->now_ns += 1000 * MS;
    assert_true(wanted(f) == 540);
}

CASE(test_who_comes_back_is_where_he_was)
{
    struct frame_request request;
    char more[128];
    greet(f, "");
    go(f, 60, 0);
    wanted(f);
    bring(f, 60, 5);
    session_leave(f->session, true, f->now_ns);
    session_destroy(&f->session);
    f->session = session_create(&f->context, 8, f->now_ns);
    snprintf(more, sizeof(more), ",\"resume\":\"%s\"", f->resume);
    greet(f, more);
    assert_false(session_next_request(f->session, f->now_ns, &request));
    assert_true(wanted(f) == 60);
    bring(f, 60, 5);
    assert_true(session_next_request(f->session, f->now_ns, &request));
    assert_true(request.view.at_us == NOW_US - 60000000);
}

CASE(test_who_follows_comes_along)
{
    greet(f, "");
    struct session *other = session_create(&f->context, 8, f->now_ns);
    session_follow(other, f->session, f->now_ns);
    go(f, 60, 0);
    wanted(f);
    bring(f, 60, 5);
    session_on_leader(other, f->now_ns);
    assert_true(session_view(other)->at_us == NOW_US - 60000000);
    assert_true(session_snapshot(other)->readings[0].value == 5);
    assert_true(other->owed.time && other->owed.tags_all);
    session_destroy(&other);
}

CASE(test_who_is_given_the_lead_stays_there)
{
    greet(f, "");
    struct session *heir = session_create(&f->context, 8, f->now_ns);
    session_follow(heir, f->session, f->now_ns);
    go(f, 60, 0);
    wanted(f);
    bring(f, 60, 5);
    session_inherit(heir, f->session);
    session_follow(heir, NULL, f->now_ns);
    session_destroy(&f->session);
    assert_true(session_view(heir)->at_us == NOW_US - 60000000);
    assert_true(session_snapshot(heir)->readings[0].value == 5);
    f->session = heir;
}
