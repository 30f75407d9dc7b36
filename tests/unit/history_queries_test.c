/* SPDX-License-Identifier: GPL-3.0-or-later */
/* History queries: which queries are accepted, and that answers contain the recorded points and arrive in the order of the
   queries. */
#include "tests/support/test.h"
#include <jansson.h>

#include "base/clock.h"
#include "base/text/text.h"
#include "history/history.h"
#include "history/month.h"
#include "service/history_queries.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/sleep.h"

static const int64_t NOW = INT64_C(1793500000) * US_PER_S;

struct history_queries_setup {
    char *folder;
    struct log *log;
    struct plant *plant;
    struct history_queries *queries;
    _Atomic int notified;
};

static void on_answer(void *arg)
{
    struct history_queries_setup *s = arg;
    s->notified++;
}

static void begin(struct history_queries_setup *s)
{
    s->folder = temp_folder();
    s->log = test_log();
    s->plant = plant_by_hand_create(2);
    plant_by_hand_source(s->plant, "plc", 502);
    plant_by_hand_tag(s->plant, "A \"1\"", TABLE_HOLDING, 0, DATA_FLOAT32)->deadband = 0;
    plant_by_hand_tag(s->plant, "B,2", TABLE_HOLDING, 2, DATA_FLOAT32)->deadband = 0;
    struct history_tag *tags = history_tags(s->plant);
    int error;
    struct month_file *file = month_file_open(s->log, s->folder, month_of(NOW), tags, 2, &error);
    for (int i = 0; i < 50; i++)
        assert_int_equal(month_file_import(file, 0, &(struct history_point){ NOW - (50 - i) * US_PER_S, i, 0 }, 1), 0);
    month_file_close(&file);
    mem_free(tags);
    s->queries = history_queries_create(s->log, s->plant, NULL, s->folder, NULL, on_answer, s);
}

static void end(struct history_queries_setup *s)
{
    history_queries_destroy(&s->queries);
}

TEST_FIXTURE(struct history_queries_setup, begin, end)

#define CASE(name) TEST_ON(struct history_queries_setup *s, name, set_up, tear_down)

static bool parse(struct history_queries_setup *s, const char *const *args, size_t count, struct history_query *query,
                  struct message_error *error)
{
    return history_query_parse(s->plant, args, count, NOW, query, error);
}

CASE(queries_are_judged)
{
    static const struct {
        const char *args[3], *says;
    } bad[] = {
        { { "from=-1h" }, "tags: expected names" },
        { { "tags=A \"1\",C" }, "tags: this plant has no tag “C”" },
        { { "tags=A \"1\"", "from=2026-10-25T02:30:00" }, "from: expected a time" },
        { { "tags=A \"1\"", "to=x" }, "to: expected a time" },
        { { "tags=A \"1\"", "from=-1h", "to=-2h" }, "from: the first instant must be before" },
        { { "tags=A \"1\"", "points=1" }, "points: expected a number from 2" },
        { { "tags=A \"1\"", "points=1e9" }, "points: expected a number from 2" },
        { { "tags=A \"1\"", "format=xml" }, "format: expected json or csv" },
        { { "tags=A \"1\",A \"1\"" }, "is listed twice" },
        { { "tag=A \"1\"" }, "unknown argument 'tag'" },
        { { "tags" }, "tags: expected names" },
    };
    struct history_query query;
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        struct message_error error = { 0 };
        size_t count = 0;
        while (count < 3 && bad[i].args[count])
            count++;
        if (parse(s, bad[i].args, count, &query, &error) || !strstr(error.text, bad[i].says))
            fail_msg("'%s': '%s' is not '%s'", bad[i].args[0], error.text, bad[i].says);
    }
    struct message_error error = { 0 };
    const char *const good[] = { "tags=A \"1\"", "from=-30m", "points=7", "format=csv" };
    assert_true(parse(s, good, 4, &query, &error));
    assert_true(query.tag_count == 1 && query.tags[0] == 0 && query.max_points == 7 && query.csv);
    assert_true(query.from_us == NOW - 1800 * US_PER_S && query.to_us == NOW);
}

TEST(gaps_are_asked_by_time_alone)
{
    struct history_query query;
    struct message_error error = { 0 };
    assert_true(history_query_parse_gaps((const char *const[]){ "from=-8h", "to=-1h" }, 2, NOW, &query, &error));
    assert_true(query.gaps && query.from_us == NOW - 8 * 3600 * US_PER_S && query.to_us == NOW - 3600 * US_PER_S);
    assert_false(history_query_parse_gaps((const char *const[]){ "tags=A" }, 1, NOW, &query, &error));
    assert_false(history_query_parse_gaps((const char *const[]){ "to" }, 1, NOW, &query, &error));
    assert_false(history_query_parse_gaps((const char *const[]){ "from=noon" }, 1, NOW, &query, &error));
    assert_false(history_query_parse_gaps((const char *const[]){ "from=-1h", "to=-2h" }, 2, NOW, &query, &error));
}

static struct history_answer *wait_for(struct history_queries_setup *s, int count)
{
    for (int i = 0; i < 1000 && s->notified < count; i++)
        sleep_ns(10 * NS_PER_MS);
    assert_int_equal(s->notified, count);
    return history_queries_collect(s->queries);
}

CASE(answers_hold_what_was_recorded)
{
    struct history_query query = { .client = 7, .tags = { 0, 1 }, .tag_count = 2, .max_points = 100 };
    query.from_us = NOW - 20 * US_PER_S;
    query.to_us = NOW;
    assert_true(history_queries_ask(s->queries, &query));
    struct history_answer *answer = wait_for(s, 1);
    assert_int_equal(answer->client, 7);
    json_t *root = test_json(json_loads(answer->text, 0, NULL));
    assert_non_null(root);
    json_t *series = json_object_get(root, "series"), *first = json_array_get(series, 0);
    assert_int_equal(json_array_size(series), 2);
    assert_string_equal(json_string_value(json_object_get(first, "tag")), "A \"1\"");
    json_t *points = json_object_get(first, "points");
    assert_int_equal(json_array_size(points), 20);
    for (size_t i = 0; i < 20; i++) {
        assert_true(json_integer_value(json_array_get(json_array_get(points, i), 0)) == NOW - (20 - (int64_t)i) * US_PER_S);
        assert_true(json_number_value(json_array_get(json_array_get(points, i), 1)) == 30.0 + (double)i);
    }
    assert_int_equal(json_array_size(json_object_get(json_array_get(series, 1), "points")), 0);
    assert_true(answer->first && answer->last);
    history_answer_free(&answer);
}

CASE(csv_has_quotes_where_it_needs_them)
{
    struct history_query query = { .tags = { 0 }, .tag_count = 1, .max_points = 100, .csv = true };
    query.from_us = NOW - 2 * US_PER_S;
    query.to_us = NOW;
    assert_true(history_queries_ask(s->queries, &query));
    struct history_answer *answer = wait_for(s, 1);
    assert_string_equal(answer->text, "Tag,Time,Value,Quality,Unit\r\n"
                                      "\"A \"\"1\"\"\",2026-11-01T02:26:38.000Z,48,0x00000000,\r\n"
                                      "\"A \"\"1\"\"\",2026-11-01T02:26:39.000Z,49,0x00000000,\r\n");
    history_answer_free(&answer);
}

/* Records 20,000 points for each of two tags, more than one part of an answer can hold. */
static void record_much(struct history_queries_setup *s)
{
    struct history_tag *tags = history_tags(s->plant);
    int error;
    struct month_file *file = month_file_open(s->log, s->folder, month_of(NOW), tags, 2, &error);
    static struct history_point points[20000];
    for (int tag = 0; tag < 2; tag++) {
        for (int i = 0; i < 20000; i++)
            points[i] = (struct history_point){ NOW + i * US_PER_S / 10, i / 7.0, 0 };
        assert_int_equal(month_file_import(file, tag, points, 20000), 0);
    }
    month_file_close(&file);
    mem_free(tags);
}

/* An answer is sent in parts, and each part only when the client asks for it. A client that stops reading thus delays only its
   own answer. The parts together must be one valid answer. */
CASE(long_answers_come_in_pieces)
{
    struct history_query query = { .client = 7, .account = 1, .tags = { 0, 1 }, .tag_count = 2, .max_points = 20000 };
    struct text *all = test_text();
    int pieces = 0;
    record_much(s);
    query.from_us = NOW;
    query.to_us = NOW + 3000 * US_PER_S;
    assert_true(history_queries_ask(s->queries, &query));
    struct history_answer *answer = wait_for(s, ++pieces);
    assert_true(answer->first && !answer->last && answer->length > 256 * 1024);
    sleep_ns(50 * NS_PER_MS);
    assert_null(history_queries_collect(s->queries)); /* there must be no second part before the client asks for it */
    for (;;) {
        bool last = answer->last;
        text_add_bytes(all, answer->text, answer->length);
        history_answer_free(&answer);
        if (last)
            break;
        history_queries_continue(s->queries, 7);
        answer = wait_for(s, ++pieces);
        assert_false(answer->first);
    }
    json_t *root = test_json(json_loads(all->at, 0, NULL));
    assert_int_equal(json_array_size(json_object_get(json_array_get(json_object_get(root, "series"), 1), "points")), 20000);
    assert_int_equal(pieces, 2);
}

CASE(who_is_forgotten_leaves_room)
{
    struct history_query query = { .account = 1, .tags = { 0, 1 }, .tag_count = 2, .max_points = 20000, .from_us = NOW };
    record_much(s);
    query.to_us = NOW + 3000 * US_PER_S;
    for (int i = 0; i < 4 * HISTORY_QUERIES_MOST; i++) {
        query.client = (uint64_t)i + 1;
        assert_true(history_queries_ask(s->queries, &query));
        /* cancels an earlier query, because queries count towards the limit until their answers are collected */
        if (i >= HISTORY_QUERIES_MOST - 2)
            history_queries_forget(s->queries, query.client - HISTORY_QUERIES_MOST + 2);
        for (struct history_answer *answer = history_queries_collect(s->queries), *next; answer; answer = next) {
            next = answer->next;
            history_answer_free(&answer);
        }
        sleep_ns(NS_PER_MS);
    }
}

CASE(too_many_are_refused)
{
    struct history_query query = { .tags = { 0 }, .tag_count = 1, .max_points = 100 };
    query.from_us = NOW - 20 * US_PER_S;
    query.to_us = NOW;
    int taken = 0;
    for (int i = 0; i < 10000; i++) {
        query.client = (uint64_t)i;
        taken += history_queries_ask(s->queries, &query);
        if (i % 2)
            history_queries_forget(s->queries, (uint64_t)i);
    }
    assert_true(taken < 10000);
    for (struct history_answer *answer = history_queries_collect(s->queries), *next; answer; answer = next) {
        next = answer->next;
        history_answer_free(&answer);
    }
}
