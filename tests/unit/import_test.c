/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Series out of CSV files: both forms, what is wrong with them, and the way out and in again. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#include "base/mem.h"
#include "base/text.h"
#include "base/timestamp.h"
#include "history/history.h"
#include "history/import.h"
#include "history/month.h"
#include "history/series_text.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/temp.h"
#include "value/quality.h"

static const int64_t OCTOBER_25 = INT64_C(1792886400) * US_PER_S; /* 2026-10-25T00:00:00Z */

struct setup {
    char *folder;
    struct log *log;
    struct plant *plant;
    struct diag diag;
    struct import_counts counts;
};

static int set_up(void **state)
{
    static struct setup s;
    static int order[2] = { 0, 1 };
    s.folder = temp_folder_create();
    s.log = log_create(LOG_ERROR);
    s.plant = plant_by_hand_create(2);
    plant_by_hand_source(s.plant, "plc", 502);
    plant_by_hand_tag(s.plant, "FT-1", TABLE_HOLDING, 0, DATA_FLOAT32)->deadband = 0;
    plant_by_hand_tag(s.plant, "TT-1", TABLE_HOLDING, 2, DATA_FLOAT32)->deadband = 0.5;
    s.plant->tags_by_name = order;
    s.plant->history.override_s = 600;
    s.diag = (struct diag){ 0 };
    *state = &s;
    return 0;
}

static int tear_down(void **state)
{
    struct setup *s = *state;
    diag_finish(&s->diag);
    s->plant->tags_by_name = NULL;
    plant_by_hand_destroy(&s->plant);
    log_destroy(&s->log);
    temp_folder_destroy(&s->folder);
    return 0;
}

static bool import(struct setup *s, const char *folder_name, const char *csv, int64_t start_us, int64_t unit_us)
{
    char *path = temp_write_text(s->folder, "series.csv", csv), *folder = temp_path(s->folder, folder_name);
    const struct import_params params = {
        .log = s->log, .plant = s->plant, .folder = folder, .path = path, .start_us = start_us, .unit_us = unit_us
    };
    bool good = history_import(&params, &s->diag, &s->counts);
    mem_free(path);
    mem_free(folder);
    return good;
}

static struct history_series read_series(struct setup *s, const char *folder_name, const char *tag)
{
    char *folder = temp_path(s->folder, folder_name);
    struct history_reader *reader = history_reader_create(s->log, folder);
    struct history_series series;
    assert_int_equal(history_series(reader, tag, OCTOBER_25 - 3600 * US_PER_S, OCTOBER_25 + 86400 * US_PER_S, 100000, &series), 0);
    history_reader_destroy(&reader);
    mem_free(folder);
    return series;
}

static void long_rows_are_taken(void **state)
{
    struct setup *s = *state;
    assert_true(import(s, "h",
                       "Tag;Time;Value;Quality\n"
                       "FT-1;2026-10-25T02:30:00+02:00;1.5;Good\n"
                       "FT-1;2026-10-25T02:30:00+01:00;2.5;\n"
                       "TT-1;2026-10-25T00:40:00Z;7;Uncertain\n"
                       "FT-1;2026-10-25T02:00:00Z;;Bad\n"
                       "FT-1;2026-10-25T03:00:00Z;9;0x00000000\n",
                       INT64_MIN, 0));
    assert_int_equal(s->counts.samples, 5);
    assert_int_equal(s->counts.tags, 2);
    struct history_series series = read_series(s, "h", "FT-1");
    assert_int_equal(series.points.count, 4);
    assert_true(series.points.at[1].t_us - series.points.at[0].t_us == 3600 * US_PER_S); /* both hours of that night */
    assert_true(series.points.at[1].value == 2.5);
    assert_true(isnan(series.points.at[2].value) && series.points.at[2].quality == QUALITY_BAD_COMMUNICATION_ERROR);
    history_series_finish(&series);
}

static void wide_rows_count_from_a_start(void **state)
{
    struct setup *s = *state;
    assert_true(import(s, "h", "t_min,TT-1,unknown,FT-1\n0,1,x,2\n1,2,x,\n2,30,x,8\n", OCTOBER_25, 60 * US_PER_S));
    assert_int_equal(s->diag.warnings, 1);
    assert_int_equal(s->counts.samples, 5);
    struct history_series series = read_series(s, "h", "FT-1");
    assert_int_equal(series.points.count, 2);
    assert_true(series.points.at[1].t_us == OCTOBER_25 + 120 * US_PER_S && series.points.at[1].value == 8);
    history_series_finish(&series);
}

static void everything_wrong_is_said_and_nothing_is_taken(void **state)
{
    struct setup *s = *state;
    assert_false(import(s, "h",
                        "Tag,Time,Value\n"
                        "FT-1,2026-10-25T00:00:00Z,1\n"
                        "FT-1,25.10.2026 02:30,1\n"
                        "FT-2,2026-10-25T00:00:01Z,1\n"
                        "FT-1,2026-10-25T00:00:00Z,1\n"
                        "FT-1,2026-10-25T00:00:05Z,hot\n",
                        INT64_MIN, 0));
    static const struct {
        int line, column;
        const char *text;
    } wanted[] = {
        { 3, 6, "expected an instant such as 2026-11-20T10:00:00Z (without Z or an offset: one that clocks in UTC showed)" },
        { 4, 1, "the plant has no tag 'FT-2'" },
        { 5, 27, "FT-1: expected a time after its last sample, 2026-10-25T00:00:00.000Z" },
        { 6, 27, "expected a number, found 'hot'" },
    };
    assert_int_equal(s->diag.errors, 4);
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(s->diag.items[i].line, wanted[i].line);
        assert_int_equal(s->diag.items[i].column, wanted[i].column);
        assert_non_null(strstr(s->diag.items[i].text, wanted[i].text));
    }
    size_t months;
    char *folder = temp_path(s->folder, "h");
    mem_free(month_list(folder, &months));
    assert_int_equal(months, 0);
    mem_free(folder);
}

/* Clocks of the plant: in the night that has an hour twice, rows go on; an hour that never was is refused. */
static void times_without_a_zone_are_the_plant_s(void **state)
{
    struct setup *s = *state;
    timestamp_use_zone("Europe/Berlin");
    assert_true(import(s, "wide",
                       "time,FT-1\n2026-10-25 01:30,1\n2026-10-25 02:30,2\n2026-10-25 02:00,3\n2026-10-25 02:30,4\n"
                       "2026-10-25 03:30,5\n",
                       INT64_MIN, 0));
    assert_true(import(s, "long", "Tag,Time,Value\nTT-1,2026-10-25T02:30,7\nTT-1,2026-10-25T02:30,8\nFT-1,2026-10-25T02:30:00.5,9\n",
                       INT64_MIN, 0));
    struct history_series wide = read_series(s, "wide", "FT-1"), fresh = read_series(s, "long", "FT-1");
    static const int minutes[] = { -30, 30, 60, 90, 150 };
    assert_int_equal(wide.points.count, 5);
    for (int i = 0; i < 5; i++)
        assert_true(wide.points.at[i].t_us == OCTOBER_25 + minutes[i] * 60 * US_PER_S);
    assert_true(fresh.points.at[0].t_us == OCTOBER_25 + 30 * 60 * US_PER_S + US_PER_S / 2);
    history_series_finish(&wide);
    history_series_finish(&fresh);
    assert_false(import(s, "gap", "Time,FT-1\n2026-03-29 02:30,1\n", INT64_MIN, 0));
    timestamp_use_zone("UTC");
}

static void files_that_are_no_series_are_refused(void **state)
{
    struct setup *s = *state;
    assert_false(import(s, "h", "a,b\n1,2\n", INT64_MIN, 0));
    assert_false(import(s, "h", "Time,b\n2026-10-25T00:00:00Z,2\n", INT64_MIN, 0));
    assert_false(import(s, "h", "", INT64_MIN, 0));
    assert_int_equal(s->diag.errors, 3);
}

/* What is printed is what was there, and goes in again as it came out. */
static void out_and_in_again_is_the_same(void **state)
{
    struct setup *s = *state;
    struct text csv = { 0 }, out = { 0 };
    text_add(&csv, "Time,TT-1\n");
    for (int i = 0; i < 5000; i++)
        text_add(&csv, "%d,%.4f\n", i, 20 + 5 * sin(i / 50.0) + (i % 977 == 0 ? 30 : 0));
    assert_true(import(s, "one", csv.at, OCTOBER_25, US_PER_S));
    assert_true(s->counts.points < s->counts.samples / 3);
    struct history_series one = read_series(s, "one", "TT-1");
    series_text_csv_head(&out, false);
    series_text_csv(&out, "TT-1", "", &one);
    s->plant->tags[1].deadband = 0;
    assert_true(import(s, "two", out.at, INT64_MIN, 0));
    struct history_series two = read_series(s, "two", "TT-1");
    assert_int_equal(one.points.count, two.points.count);
    for (size_t i = 0; i < one.points.count; i++)
        assert_true(one.points.at[i].t_us == two.points.at[i].t_us && fabs(one.points.at[i].value - two.points.at[i].value) < 1e-8);
    history_series_finish(&one);
    history_series_finish(&two);
    text_finish(&csv);
    text_finish(&out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(long_rows_are_taken, set_up, tear_down),
        cmocka_unit_test_setup_teardown(wide_rows_count_from_a_start, set_up, tear_down),
        cmocka_unit_test_setup_teardown(everything_wrong_is_said_and_nothing_is_taken, set_up, tear_down),
        cmocka_unit_test_setup_teardown(times_without_a_zone_are_the_plant_s, set_up, tear_down),
        cmocka_unit_test_setup_teardown(files_that_are_no_series_are_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(out_and_in_again_is_the_same, set_up, tear_down),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
