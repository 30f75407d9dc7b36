/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replay sources: every recorded sample reaches the store in order and at its time, once or in a loop. */
#include "tests/support/test.h"

#include "base/clock.h"
#include "base/text/timestamp.h"
#include "tests/support/plant_case.h"
#include "tests/support/sleep.h"
#include "value/quality.h"
#include "value/series.h"
#include "value/source.h"

enum { MOST = 4000 };

struct event_log {
    struct sample_event at[MOST];
    _Atomic size_t count;
};

struct replay_setup {
    struct plant_case *c;
    struct log *log;
    struct counters *counters;
    struct store *store;
    struct source *source;
    struct event_log events;
};

static int set_up(void **state)
{
    struct replay_setup *s = mem_new(sizeof(*s));
    void *c;
    plant_case_set_up(&c);
    s->c = c;
    s->log = test_log();
    s->counters = test_counters();
    *state = s;
    return 0;
}

static int tear_down(void **state)
{
    struct replay_setup *s = *state;
    void *c = s->c;
    source_stop(&s->source);
    mem_free(s);
    return plant_case_tear_down(&c);
}

#define CASE(name) TEST_ON(struct replay_setup *s, name, set_up, tear_down)

static void on_sample_event(void *arg, const struct sample_event *event)
{
    struct event_log *all = arg;
    if (all->count == MOST)
        return;
    all->at[all->count] = *event;
    all->count++; /* increased after the entry is complete, because another thread reads entries up to this number */
}

static void play(struct replay_setup *s, const char *keys, const char *csv, const char *tags)
{
    char *yaml = test_printf("plant: { name: P }\nassets: [{ id: A, model: m.glb }]\ngroups: [{ id: g, unit: K, min: 0, max: 9 }]\n"
                            "sources: [{ id: r, type: replay, file: series.csv, %s }]\ntags: tags.csv\n",
                            keys);
    temp_write_text(s->c->folder, "series.csv", csv);
    plant_case_load(s->c, yaml, tags);
    plant_case_assert_loaded(s->c, 0);
    s->store = test_store(s->c->plant);
    store_listen(s->store, on_sample_event, &s->events);
    s->source = source_start(s->log, s->c->plant, 0, s->store, s->counters);
    assert_non_null(s->source);
}

static void wait_for_heard(struct replay_setup *s, size_t count)
{
    for (int64_t end_ns = clock_mono_ns() + 10 * NS_PER_S; s->events.count < count && clock_mono_ns() < end_ns;)
        sleep_ns(5 * NS_PER_MS);
    assert_true(s->events.count >= count);
}

static void wait_for_link(struct replay_setup *s, bool up)
{
    for (int64_t end_ns = clock_mono_ns() + 10 * NS_PER_S; store_link_is_up(s->store, 0) != up && clock_mono_ns() < end_ns;)
        sleep_ns(5 * NS_PER_MS);
    assert_true(store_link_is_up(s->store, 0) == up);
}

/* Copies the events of one tag to `out` in the order of their arrival, and returns their number. */
static size_t of_tag(const struct replay_setup *s, int tag, struct sample_event *out, size_t most)
{
    size_t count = 0;
    for (size_t i = 0; i < s->events.count && count < most; i++)
        if (s->events.at[i].tag == tag && !quality_is_bad(s->events.at[i].quality))
            out[count++] = s->events.at[i];
    return count;
}

CASE(every_sample_comes_at_its_time)
{
    struct sample_event got[20];
    const double values[] = { 1, 2.5, -3, 0, 4 }, at_s[] = { 0, 10, 20, 50, 60 };
    play(s, "speed: 100", "time_s,shell,TT 2\n0,1,5\n10,2.5,\n20,-3,\n50,0,6\n60,4,7\n", "Tag Name,Address\nTT-1,shell\nTT 2,\n");
    wait_for_heard(s, 8);
    size_t count = of_tag(s, 0, got, 20);
    assert_int_equal(count, 6); /* five samples, and one event because the link was lost at the end of the recording */
    for (size_t i = 0; i < 5; i++) {
        assert_true(got[i].value == values[i] && got[i].quality == QUALITY_GOOD);
        assert_true(llabs(got[i].mono_ns - got[0].mono_ns - (int64_t)(at_s[i] * 1e7)) < 1000);
        assert_true(llabs(got[i].utc_ns - got[0].utc_ns - (int64_t)(at_s[i] * 1e7)) < NS_PER_MS);
    }
    assert_int_equal(of_tag(s, 1, got, 20), 4); /* blank cells are no samples */
    wait_for_link(s, false);                    /* after the end of the replay the link must be down, so that no value appears live */
}

CASE(values_beyond_the_range_are_uncertain)
{
    struct sample_event got[20];
    play(s, "speed: 100", "t_s,a\n0,0\n1,9\n2,9.1\n3,-0.1\n4,5\n", "Tag Name,Address,Scaled Low,Scaled High\nA,a,0,9\n");
    wait_for_heard(s, 5);
    assert_true(of_tag(s, 0, got, 20) >= 5);
    for (size_t i = 0; i < 5; i++)
        assert_string_equal(quality_name(got[i].quality),
                            quality_name(i == 2 || i == 3 ? QUALITY_UNCERTAIN_UNITS_EXCEEDED : QUALITY_GOOD));
}

CASE(a_loop_goes_on)
{
    struct sample_event got[MOST];
    play(s, "speed: 1000, loop: yes", "t_s,a\n0,0\n10,1\n20,2\n", "Tag Name,Address\nA,a\n");
    wait_for_heard(s, 30);
    assert_true(store_link_is_up(s->store, 0));
    size_t count = of_tag(s, 0, got, MOST);
    for (size_t i = 0; i < count; i++) {
        assert_true(got[i].value == (double)(i % 3));
        assert_true(llabs(got[i].mono_ns - got[0].mono_ns - (int64_t)i * 10 * NS_PER_MS) < 1000);
    }
}

CASE(a_long_file_is_read)
{
    struct sample_event got[5];
    play(s, "speed: 10", "1000,x,pump,flow,7,,\n1000,x,pump,temp,70,,\n1500,x,pump,flow,8,,\n2000,x,tank,flow,9,,\n",
         "Tag Name,Address\nF,pump/flow\nT,pump/temp\n");
    wait_for_heard(s, 3);
    assert_int_equal(of_tag(s, 0, got, 2), 2);
    assert_true(got[0].value == 7 && got[1].value == 8 && llabs(got[1].mono_ns - got[0].mono_ns - 50 * NS_PER_MS) < 1000);
    assert_int_equal(of_tag(s, 1, got, 1), 1);
    assert_true(got[0].value == 70);
}

CASE(what_is_not_in_the_file_is_bad)
{
    play(s, "speed: 1", "t_s,a\n0,0\n10,1\n", "Tag Name,Address\nA,a\nB,b\n");
    wait_for_heard(s, 2);
    assert_true(s->events.at[0].tag == 1 && s->events.at[0].quality == QUALITY_BAD_CONFIGURATION);
    assert_true(s->events.at[1].tag == 0 && s->events.at[1].value == 0);
    wait_for_link(s, true);
    int64_t begin_ns = clock_mono_ns();
    source_stop(&s->source); /* stops the source long before the end of the recording; that must take at most 2 s */
    assert_true(clock_mono_ns() - begin_ns < 2 * NS_PER_S);
}

CASE(nothing_in_the_file_is_ours)
{
    play(s, "speed: 1", "t_s,a\n0,0\n", "Tag Name,Address\nB,b\n");
    wait_for_heard(s, 1);
    sleep_ns(50 * NS_PER_MS);
    assert_false(store_link_is_up(s->store, 0));
}

static void check_series(const char *path, const char *name, size_t count, double last_s, double last)
{
    struct series series;
    char why[200] = "";
    bool found;
    if (!series_read(&series, path, name, &found, why) || !found)
        fail_msg("%s: %s", name, why);
    assert_int_equal(series.count, count);
    assert_true(fabs(series.time_s[count - 1] - last_s) < 1e-6);
    assert_true(series.value[count - 1] == last || (isnan(last) && isnan(series.value[count - 1])));
    series_finish(&series);
}

/* In files separated by commas, a comma within a number (decimal or thousands) would shift all following columns. Such files
   must be refused. */
CASE(commas_in_numbers_are_refused)
{
    static const char *const files[] = { "t_s;a;b\n0;21,5;3\n", "t_s\ta\tb\n0\t21,5\t3\n", "t_s,a,b\n0,1,234,3\n",
                                         "Tag;Time;Value\na;2026-10-25T00:00:00Z;21,5\n", "0;temp;x;a;21,5\n" };
    static const char *const errors[] = { "2: a: expected a number", "2: a: expected a number",
                                          "2: this line has more cells than the first line", "2: a: expected a number",
                                          "1: x/a: expected a number" };
    struct series series;
    char why[200];
    bool found;
    for (size_t i = 0; i < sizeof(files) / sizeof(*files); i++) {
        char *path = temp_write_text(s->c->folder, "series.csv", files[i]);
        assert_false(series_read(&series, path, i == 4 ? "x/a" : "a", &found, why));
        assert_non_null(strstr(why, errors[i]));
    }
    check_series(temp_write_text(s->c->folder, "series.csv", "t_s;a;\n0;21.5;;\n"), "a", 1, 0, 21.5); /* empty cells do no harm */
}

CASE(exported_qualities_are_replayed)
{
    play(s, "speed: 1000",
         "Tag,Time,Value,Quality,Unit\nA,2026-10-25T00:00:00Z,1,0x00000000,K\nA,2026-10-25T00:00:01Z,2,0x40900000,K\n"
         "A,2026-10-25T00:00:02Z,3,Bad,K\nA,2026-10-25T00:00:03Z,4,good,K\n",
         "Tag Name,Address,Group,Asset,X,Y,Z\nA,,g,A,0,0,0\n");
    wait_for_heard(s, 4);
    const uint32_t wanted[] = { QUALITY_GOOD, QUALITY_UNCERTAIN_LAST_USABLE, QUALITY_BAD, QUALITY_GOOD };
    for (int i = 0; i < 4; i++)
        assert_int_equal(s->events.at[i].quality, wanted[i]);
    assert_true(s->events.at[1].value == 2 && s->events.at[3].value == 4);
}

/* Timestamps in the forms that historians write: with Z, with an offset, or in local time, where one hour of an autumn night
   occurs twice. */
CASE(times_may_be_instants)
{
    static const char *const wide[] = {
        "t_start,Time,a\n9,2026-10-25T00:00:00Z,1\n9,2026-10-25T01:00:00.5Z,2\n",
        "delay_s;Timestamp;a\n5;2026-10-25T00:00:00Z;1\n0;\"2026-10-25T02:00:00.5+01:00\";2\n",
        "\xEF\xBB\xBFwhen,a\r\n2026-10-25 02:00,1\r\n\r\n2026-10-25 02:00:00.5,2\r\n",
    };
    timestamp_use_zone("Europe/Berlin");
    for (size_t i = 0; i < 3; i++) {
        char *path = temp_write_text(s->c->folder, "series.csv", wide[i]);
        check_series(path, "a", 2, i < 2 ? 3600.5 : 0.5, 2);
    }
    char *path = temp_write_text(s->c->folder, "series.csv", "time,a\n2026-10-25 02:30,1\n2026-10-25 02:10,2\n");
    check_series(path, "a", 2, 2400, 2);
    temp_write_text(s->c->folder, "series.csv",
                             "Tag,Time,Value,Quality,Unit\nb,2026-10-25T00:00:10Z,3,0,K\n"
                             "b,2026-10-25T00:00:20Z,4,0,K\na,2026-10-25T00:00:00Z,1,0,\na,2026-10-25T00:00:07Z,,0x80050000,\n");
    check_series(path, "b", 2, 20, 4);
    check_series(path, "a", 2, 7, NAN);
    temp_write_text(s->c->folder, "series.csv", "Time,a\n25.10.2026 02:30,1\n");
    struct series series;
    char why[200];
    bool found;
    assert_false(series_read(&series, path, "a", &found, why));
    assert_non_null(strstr(why, "series.csv:1: no time column: expected a name that ends in _ms, _s, _min or _h, or times such as"));
    timestamp_use_zone("UTC");
}

CASE(a_file_with_units_is_converted)
{
    struct sample_event got[2] = { 0 };
    play(s, "speed: 1", "Tag,Time,Value,Unit\nA,2026-10-25T00:00:00Z,20,degC\nB,2026-10-25T00:00:00Z,3,bar\n",
         "Tag Name,Address,Group,Asset,X,Y,Z\nA,,g,A,0,0,0\nB,,g,A,0,0,0\n");
    wait_for_heard(s, 2);
    assert_int_equal(of_tag(s, 0, got, 1), 1);
    assert_true(fabs(got[0].value - 293.15) < 1e-9);
    assert_true(s->events.at[0].tag == 1 && s->events.at[0].quality == QUALITY_BAD_CONFIGURATION);
}
