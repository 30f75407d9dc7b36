/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Alarm messages: what sessions receive, which alarm commands they may send, and what other programs receive. */
#include "tests/support/test.h"
#include <jansson.h>
#include <sqlite3.h>

#include "base/clock.h"
#include "alarm/journal.h"
#include "message/message_parse.h"
#include "access/access.h"
#include "message/alarm_message.h"
#include "message/alarm_text.h"
#include "history/series_text.h"
#include "session/reply/reply.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/sleep.h"
#include "value/quality.h"

struct alarm_message_setup { /* fixture: a plant of two tags with alarm limits H 80 and HH 90, its store and its alarm service */
    struct plant *plant;
    struct store *store;
    struct alarm_service *alarm_service;
    struct log *log;
    char *folder;
};

static void begin(struct alarm_message_setup *s)
{
    s->plant = plant_by_hand_create(2);
    s->plant->alarms = ALARMS_LOCAL;
    plant_by_hand_source(s->plant, "plc", 502);
    for (int i = 0; i < 2; i++) {
        struct plant_tag *tag = plant_by_hand_tag(s->plant, i ? "TT-2" : "TT-1", TABLE_HOLDING, i, DATA_INT16);
        tag->alarms.limits[LIMIT_H] = 80;
        tag->alarms.limits[LIMIT_HH] = 90;
    }
    s->store = test_store(s->plant);
    s->log = test_log();
    s->folder = temp_folder();
    s->alarm_service = alarm_service_start(&(struct alarm_service_params){
        .log = s->log, .counters = test_counters(), .plant = s->plant, .store = s->store, .folder = s->folder, .keep_days = 400 });
}

static void end(struct alarm_message_setup *s)
{
    alarm_service_stop(&s->alarm_service);
}

TEST_FIXTURE(struct alarm_message_setup, begin, end)

#define CASE(name) TEST_ON(struct alarm_message_setup *s, name, set_up, tear_down)

/* Sets a tag's reading and waits until the alarm service has processed it. */
static void give(struct alarm_message_setup *s, int tag, double value, uint32_t quality)
{
    uint64_t before = alarm_service_number(s->alarm_service);
    int64_t end_ns = clock_mono_ns() + 5 * NS_PER_S;
    store_write(s->store, &(struct sample){ tag, value, quality }, 1, clock_mono_ns(), clock_utc_ns());
    while (alarm_service_number(s->alarm_service) == before && clock_mono_ns() < end_ns)
        sleep_ns(5 * NS_PER_MS);
}

static json_t *parse(char *text)
{
    json_t *o = test_json(json_loads(text, 0, NULL));
    assert_non_null(o);
    mem_free(text);
    return o;
}

static const char *state_of(const json_t *message, const char *kind)
{
    size_t i;
    json_t *row;
    json_array_foreach(json_object_get(message, "alarms"), i,
                       row) if (!strcmp(json_string_value(json_array_get(row, 1)), kind)) return json_string_value(json_array_get(row, 2));
    return NULL;
}

static bool ask(struct alarm_message_setup *s, const char *text, struct message *message, struct message_error *error)
{
    return message_parse(s->plant, text, strlen(text), message, error);
}

CASE(sessions_hear_what_changed)
{
    struct alarm_text_cache said = { 0 };
    uint64_t number = 0, other = 0;
    give(s, 0, 95, QUALITY_GOOD);
    json_t *all = parse(alarms_text(&said, s->alarm_service, s->plant, 5000, &number));
    assert_string_equal(json_string_value(json_object_get(all, "mode")), "local");
    assert_true(json_is_true(json_object_get(all, "all")));
    assert_int_equal(json_array_size(json_object_get(all, "alarms")), 2);
    assert_string_equal(state_of(all, "HH"), "unacknowledged");
    /* a second session requests the same alarms and must get the text that was written for the first one */
    parse(alarms_text(&said, s->alarm_service, s->plant, 5000, &other));
    assert_int_equal(number, other);
    other = 0;
    json_t *later = parse(alarms_text(&said, s->alarm_service, s->plant, NS_PER_S, &other));
    assert_int_equal(json_integer_value(json_object_get(later, "time_us")), 1000000);
    give(s, 0, 85, QUALITY_GOOD);
    json_t *changed = parse(alarms_text(&said, s->alarm_service, s->plant, 6000, &number));
    assert_true(json_is_false(json_object_get(changed, "all")));
    assert_int_equal(json_array_size(json_object_get(changed, "alarms")), 1);
    assert_string_equal(state_of(changed, "HH"), "returned");
    alarm_text_cache_finish(&said);
}

CASE(what_is_asked_is_done_or_refused)
{
    struct message message;
    struct message_error error;
    give(s, 0, 95, QUALITY_GOOD);
    assert_true(ask(s,
                    "{\"type\":\"alarm\",\"seq\":4,\"action\":\"acknowledge\",\"name\":\"Kim\","
                    "\"alarms\":[[\"TT-1\",\"H\"],[\"TT-2\",\"H\"],"
                    "[\"TT-2\",\"L\"]]}",
                    &message, &error));
    json_t *answer = parse(alarm_do(s->alarm_service, s->plant, &message, "panel")), *refused = json_object_get(answer, "refused");
    assert_int_equal(json_integer_value(json_object_get(answer, "done")), 1);
    assert_int_equal(json_array_size(refused), 2);
    assert_string_equal(json_string_value(json_array_get(json_array_get(refused, 0), 2)), "there is nothing to acknowledge");
    assert_string_equal(json_string_value(json_array_get(json_array_get(refused, 1), 2)), "its state has changed meanwhile");
    const json_t *refusal = json_array_get(json_array_get(refused, 0), 3);
    assert_string_equal(json_string_value(json_object_get(refusal, "code")), "quiet");
    uint64_t number = 0;
    char *text = test_memory(alarms_text(NULL, s->alarm_service, s->plant, 0, &number));
    assert_non_null(strstr(text, "null,\"Kim (panel)\",\"\"]"));
}

/* The device of both tags is lost. The alarm must appear once, under the device's name, and not for each tag. */
CASE(a_device_has_its_own)
{
    struct message message;
    struct message_error error;
    uint64_t number = 0;
    int64_t end_ns = clock_mono_ns() + 30 * NS_PER_S;
    static const struct sample samples[] = { { 0, 20, QUALITY_GOOD }, { 1, 20, QUALITY_GOOD } };
    static const int tags[] = { 0, 1 };
    store_write(s->store, samples, 2, clock_mono_ns(), clock_utc_ns());
    store_tags_dead(s->store, tags, 2, clock_mono_ns());
    while (alarm_service_number(s->alarm_service) < 3 && clock_mono_ns() < end_ns)
        sleep_ns(5 * NS_PER_MS);
    json_t *all = parse(alarms_text(NULL, s->alarm_service, s->plant, 5000, &number)), *link = NULL, *row;
    json_t *rows = json_object_get(all, "alarms");
    size_t i;
    json_array_foreach(rows, i, row) if (!strcmp(json_string_value(json_array_get(row, 1)), "LINK")) link = row;
    assert_int_equal(json_array_size(rows), 3);
    assert_string_equal(json_string_value(json_array_get(link, 0)), "plc");
    assert_string_equal(state_of(all, "BAD"), "suppressed");
    assert_true(ask(s, "{\"type\":\"alarm\",\"seq\":1,\"action\":\"acknowledge\",\"alarms\":[[\"plc\",\"LINK\"],[\"TT-1\",\"BAD\"]]}",
                    &message, &error));
    json_t *answer = parse(alarm_do(s->alarm_service, s->plant, &message, "local"));
    /* one of the two requested acknowledgements takes effect: the device's; the tag's alarm is part of the device's alarm and
       cannot be acknowledged */
    assert_int_equal(json_integer_value(json_object_get(answer, "done")), 1);
    assert_false(ask(s, "{\"type\":\"alarm\",\"seq\":2,\"action\":\"acknowledge\",\"alarms\":[[\"TT-1\",\"LINK\"]]}", &message, &error));
    assert_non_null(strstr(error.text, "this plant has no device “TT-1”"));
    json_t *api = parse(alarms_api_text(s->alarm_service, s->plant, &(struct alarm_query){ .limit = 10 }, 5000));
    assert_int_equal(json_integer_value(json_object_get(json_object_get(api, "counts"), "active")), 1);
}

CASE(roles_are_kept)
{
    static const struct {
        const char *action;
        enum role least;
    } actions[] = { { "acknowledge", ROLE_OPERATOR }, { "reset", ROLE_OPERATOR },          { "shelve", ROLE_OPERATOR },
                    { "unshelve", ROLE_OPERATOR },    { "out_of_service", ROLE_ENGINEER }, { "in_service", ROLE_ENGINEER } };
    for (size_t i = 0; i < sizeof(actions) / sizeof(actions[0]); i++) {
        struct message message;
        struct message_error error;
        char *text = test_printf("{\"type\":\"alarm\",\"seq\":1,\"action\":\"%s\",\"alarms\":[[\"TT-1\",\"H\"]],\"for_s\":60,"
                                "\"reason\":\"r\"}",
                                actions[i].action);
        assert_true(ask(s, text, &message, &error));
        for (int role = ROLE_OPEN; role <= ROLE_ENGINEER; role++)
            assert_int_equal(role_may_send((enum role)role, &message, &error), role >= (int)actions[i].least);
    }
}

static bool query(struct alarm_message_setup *s, bool journal, const char *arg, struct alarm_query *out)
{
    struct message_error error = { 0 };
    return alarm_query_parse(s->plant, journal, &arg, 1, 1000000, out, &error);
}

CASE(programs_get_pages)
{
    struct alarm_query q;
    give(s, 0, 95, QUALITY_GOOD);
    give(s, 1, 95, QUALITY_GOOD);
    assert_true(query(s, false, "limit=3", &q));
    json_t *page = parse(alarms_api_text(s->alarm_service, s->plant, &q, 0));
    assert_int_equal(json_array_size(json_object_get(page, "alarms")), 3);
    assert_int_equal(json_integer_value(json_object_get(page, "next_offset")), 3);
    assert_int_equal(json_integer_value(json_object_get(json_object_get(page, "counts"), "active")), 4);
    assert_true(query(s, false, "offset=3", &q));
    page = parse(alarms_api_text(s->alarm_service, s->plant, &q, 0));
    assert_int_equal(json_array_size(json_object_get(page, "alarms")), 1);
    assert_true(json_is_null(json_object_get(page, "next_offset")));
    assert_true(query(s, false, "format=csv", &q));
    char *csv = test_memory(alarms_api_text(s->alarm_service, s->plant, &q, 0));
    assert_non_null(strstr(csv, "\nTT-1,HH,unacknowledged,2,"));
    assert_non_null(strstr(csv, "Z,95,90,0,,,\n"));
    static const char *const wrong[] = { "limit=0", "limit=x", "limit=10001", "tag=TT-9", "before=3", "format=xml", "what" };
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
        assert_false(query(s, false, wrong[i], &q));
    assert_false(query(s, true, "offset=3", &q));
    assert_false(query(s, true, "from=yesterday", &q));
}

CASE(the_journal_is_read_by_pages)
{
    struct alarm_query q;
    struct text out = { 0 };
    give(s, 0, 95, QUALITY_GOOD);
    const struct alarm_act shelve = { ALARM_SHELVE, NS_PER_S * 60, "Kim", "says \"now\", and means it" };
    assert_null(alarm_service_act(s->alarm_service, "TT-1", ALARM_H, &shelve));
    alarm_service_halt(s->alarm_service);
    alarm_service_stop(&s->alarm_service);
    assert_true(query(s, true, "limit=2", &q));
    assert_true(alarms_journal_text(s->log, s->folder, s->plant, &q, &out));
    json_t *page = test_json(json_loads(out.at, 0, NULL)), *rows = json_object_get(page, "rows");
    assert_int_equal(json_array_size(rows), 2);
    assert_string_equal(json_string_value(json_object_get(json_array_get(rows, 0), "event")), "shelve");
    assert_string_equal(json_string_value(json_object_get(json_array_get(rows, 0), "who")), "Kim");
    char *more = test_printf("before=%lld", (long long)json_integer_value(json_object_get(page, "next_before")));
    text_finish(&out);
    assert_true(query(s, true, more, &q));
    q.csv = true;
    assert_true(alarms_journal_text(s->log, s->folder, s->plant, &q, &out));
    assert_non_null(strstr(out.at, ",TT-1,H,raise,normal,unacknowledged,3,80,95,,,\n"));
    text_finish(&out);
    assert_true(query(s, true, "format=csv", &q));
    assert_true(alarms_journal_text(s->log, s->folder, s->plant, &q, &out));
    assert_non_null(strstr(out.at, ",Kim,\"says \"\"now\"\", and means it\",\n"));
    text_finish(&out);
}

/* Restarts the alarm service after a change of the plant: the first tag gets this unit and limit H. unit NULL: the plant is
   unchanged. */
static void restart_in(struct alarm_message_setup *s, const char *unit, double limit)
{
    alarm_service_stop(&s->alarm_service);
    if (unit) {
        mem_free(s->plant->tags[0].unit);
        s->plant->tags[0].unit = mem_strdup(unit);
        s->plant->tags[0].alarms.limits[LIMIT_H] = limit;
    }
    s->alarm_service = alarm_service_start(&(struct alarm_service_params){
        .log = s->log, .counters = test_counters(), .plant = s->plant, .store = s->store, .folder = s->folder, .keep_days = 400 });
}

/* Asserts that the oldest row of the journal has this limit and unit, and that the current alarm H was raised at this value. */
static void expect_row(struct alarm_message_setup *s, double limit, const char *unit, double value)
{
    struct alarm_query q;
    struct text *out = test_text();
    assert_true(query(s, true, "limit=100", &q));
    assert_true(alarms_journal_text(s->log, s->folder, s->plant, &q, out));
    json_t *rows = json_object_get(test_json(json_loads(out->at, 0, NULL)), "rows"), *row = json_array_get(rows, json_array_size(rows) - 1);
    assert_string_equal(json_string_value(json_object_get(row, "kind")), "H");
    assert_float_equal(json_number_value(json_object_get(row, "limit")), limit, 1e-3);
    if (unit)
        assert_string_equal(json_string_value(json_object_get(row, "unit")), unit);
    else
        assert_true(json_is_null(json_object_get(row, "unit")));
    assert_true(query(s, false, "limit=100", &q));
    json_t *alarm = json_array_get(json_object_get(parse(alarms_api_text(s->alarm_service, s->plant, &q, 0)), "alarms"), 0);
    assert_string_equal(json_string_value(json_object_get(alarm, "kind")), "H");
    json_t *raised = json_object_get(alarm, "value");
    assert_true(isnan(value) ? json_is_null(raised) : fabs(json_number_value(raised) - value) < 1e-3);
}

/* Changes the journal's file to that of version 1, which does not store units. */
static void make_older(struct alarm_message_setup *s)
{
    sqlite3 *db;
    char *path = temp_path(s->folder, JOURNAL_FILE);
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_exec(db,
                                  "DROP VIEW journal; ALTER TABLE event DROP COLUMN unit; ALTER TABLE state DROP COLUMN unit;"
                                  "CREATE VIEW journal AS SELECT tag FROM event; PRAGMA user_version = 1",
                                  NULL, NULL, NULL),
                     SQLITE_OK);
    sqlite3_close(db);
}

/* After a tag's unit has changed, old rows of the journal must be converted to the new unit or keep their own. A value must
   never appear with the wrong unit. */
CASE(the_journal_keeps_the_unit_of_the_time)
{
    s->plant->tags[0].alarms.limits[LIMIT_HH] = NAN;
    restart_in(s, "bar", 80);
    give(s, 0, 95, QUALITY_GOOD);
    restart_in(s, "psi", 80 * 14.5037738);
    expect_row(s, 80 * 14.5037738, "psi", 95 * 14.5037738);
    restart_in(s, "°C", 90);
    expect_row(s, 80, "bar", NAN);
    restart_in(s, "bar", 80);
    expect_row(s, 80, "bar", 95);
    alarm_service_stop(&s->alarm_service);
    make_older(s);
    restart_in(s, NULL, 0);
    expect_row(s, 80, NULL, NAN);
    give(s, 0, 70, QUALITY_GOOD); /* the first change of an alarm after that: the service must add the column for units to the old file */
    give(s, 0, 96, QUALITY_GOOD);
    restart_in(s, NULL, 0);
    expect_row(s, 80, NULL, 96);
}

/* Readings of counters and totalizers have many digits, which pages, the API and files must not round. */
CASE(large_readings_keep_their_digits)
{
    static const struct {
        double value;
        const char *text;
    } cases[] = { { 4294967295, "4294967295" }, { 12345678, "12345678" },    { 12345678.53, "12345678.53" },
                  { 101325.372, "101325.372" }, { -20000001, "-20000001" },  { 21.530000686, "21.53" },
                  { 1.5e-7, "1.5e-7" },         { 123456789012, "123456789012" } };
    uint32_t sent[2] = { 0 };
    struct snapshot *snapshot = test_snapshot(2);
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        char *row = test_printf("[0,%s,", cases[i].text);
        store_write(s->store, &(struct sample){ 0, cases[i].value, QUALITY_UNCERTAIN }, 1, clock_mono_ns(), clock_utc_ns());
        store_snapshot(s->store, clock_mono_ns(), clock_utc_ns(), snapshot);
        char *text = reply_tags_text(s->plant, snapshot, sent, true);
        if (!strstr(text, row))
            fail_msg("expected %s in %s", row, text);
        mem_free(text);
        const struct session_context context = { .plant = s->plant, .readings.snapshot = snapshot };
        text = reply_api_tags_text(&context, 0, 1);
        if (!strstr(text, row = test_printf("\"value\":%s,", cases[i].text)))
            fail_msg("expected %s in %s", row, text);
        mem_free(text);
    }
    give(s, 1, 12345678, QUALITY_GOOD);
    char *alarms = test_memory(alarms_text(NULL, s->alarm_service, s->plant, clock_utc_ns(), &(uint64_t){ 0 }));
    assert_non_null(strstr(alarms, ",12345678,80"));
    struct text *out = test_text();
    struct history_series series = { .points = { .at = &(struct history_point){ 0, 123456789012, QUALITY_GOOD }, .count = 1 } };
    series_text_json(out, "TT-1", "Wh", &series);
    assert_non_null(strstr(out->at, "[0,123456789012,0]"));
}
