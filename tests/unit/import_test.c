/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Import of series from CSV files in both layouts (one row per value, or one column per tag); all errors; and import of an
   exported file. */
#include "tests/support/test.h"

#include "base/text/text.h"
#include "base/text/timestamp.h"
#include "history/history.h"
#include "history/import.h"
#include "history/month.h"
#include "history/series_text.h"
#include "tests/support/plant_by_hand.h"
#include "value/quality.h"

static const int64_t OCTOBER_25 = INT64_C(1792886400) * US_PER_S; /* 2026-10-25T00:00:00Z */

struct import_setup {
    char *folder;
    struct log *log;
    struct plant *plant;
    struct diag diag;
    struct import_counts counts;
    int64_t longest_gap_us;
};

static void begin(struct import_setup *s)
{
    s->folder = temp_folder();
    s->log = test_log();
    s->plant = plant_by_hand_create(2);
    plant_by_hand_source(s->plant, "plc", 502);
    plant_by_hand_tag(s->plant, "FT-1", TABLE_HOLDING, 0, DATA_FLOAT32)->deadband = 0;
    plant_by_hand_tag(s->plant, "TT-1", TABLE_HOLDING, 2, DATA_FLOAT32)->deadband = 0.5;
    s->plant->history.override_s = 600;
}

static void end(struct import_setup *s)
{
    diag_finish(&s->diag);
}

TEST_FIXTURE(struct import_setup, begin, end)

#define CASE(name) TEST_ON(struct import_setup *s, name, set_up, tear_down)

static bool import(struct import_setup *s, const char *folder_name, const char *csv, int64_t start_us, int64_t unit_us)
{
    char *path = temp_write_text(s->folder, "series.csv", csv), *folder = temp_path(s->folder, folder_name);
    const struct import_params params = {
        .log = s->log, .plant = s->plant, .folder = folder, .path = path, .start_us = start_us, .unit_us = unit_us,
        .longest_gap_us = s->longest_gap_us
    };
    bool good = history_import(&params, &s->diag, &s->counts);
    return good;
}

static struct history_series read_series(struct import_setup *s, const char *folder_name, const char *tag)
{
    char *folder = temp_path(s->folder, folder_name);
    struct history_reader *reader = history_reader_create(s->log, folder);
    struct history_series series;
    assert_int_equal(history_series(reader, tag, OCTOBER_25 - 3600 * US_PER_S, OCTOBER_25 + 86400 * US_PER_S, 100000, &series), 0);
    history_reader_destroy(&reader);
    test_series(&series);
    return series;
}

struct wanted_point {
    int64_t t_us; /* time since OCTOBER_25 */
    double value; /* NaN: none */
};

static void assert_points(const struct history_points *points, const struct wanted_point *wanted, size_t count)
{
    assert_true(points->count >= count);
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(points->at[i].t_us - OCTOBER_25, wanted[i].t_us);
        assert_int_equal(history_point_usable(&points->at[i]), !isnan(wanted[i].value));
        if (!isnan(wanted[i].value))
            assert_true(fabs(points->at[i].value - wanted[i].value) < 1e-9);
    }
}

static struct reading read_at(struct import_setup *s, const char *folder_name, int tag, int64_t t_us)
{
    char *folder = temp_path(s->folder, folder_name);
    struct history_reader *reader = history_reader_create(s->log, folder);
    struct history_tag *tags = history_tags(s->plant);
    struct snapshot *snapshot = test_snapshot(s->plant->tag_count);
    assert_int_equal(history_at(reader, tags, OCTOBER_25 + t_us, snapshot), 0);
    struct reading reading = snapshot->readings[tag];
    mem_free(tags);
    history_reader_destroy(&reader);
    return reading;
}

CASE(long_rows_are_taken)
{
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
    assert_int_equal(series.points.count, 5); /* four values, and a point without a value that ends the line before a gap */
    /* both rows have the same local time, which occurs twice in that night, so they are an hour apart */
    assert_true(series.points.at[1].t_us - series.points.at[0].t_us == 3600 * US_PER_S);
    assert_true(series.points.at[1].value == 2.5);
    assert_true(isnan(series.points.at[2].value) && series.points.at[2].quality == QUALITY_BAD_COMMUNICATION_ERROR);
}

CASE(wide_rows_count_from_a_start)
{
    assert_true(import(s, "h", "t_min,TT-1,unknown,FT-1\n0,1,x,2\n1,2,x,\n2,30,x,8\n", OCTOBER_25, 60 * US_PER_S));
    assert_int_equal(s->diag.warnings, 1);
    assert_int_equal(s->counts.samples, 6);
    assert_int_equal(s->counts.bad, 1);
    struct history_series series = read_series(s, "h", "FT-1");
    assert_points(&series.points, (const struct wanted_point[]){ { 0, 2 }, { 1, NAN }, { 60 * US_PER_S, NAN }, { 120 * US_PER_S, 8 } }, 4);
}

CASE(everything_wrong_is_said_and_nothing_is_taken)
{
    assert_false(import(s, "h",
                        "Tag,Time,Value\n"
                        "FT-1,2026-10-25T00:00:00Z,1\n"
                        "FT-1,25.10.2026 02:30,1\n"
                        "FT-2,2026-10-25T00:00:01Z,1\n"
                        "FT-1,2026-10-24T23:59:59Z,1\n"
                        "FT-1,2026-10-25T00:00:05Z,hot\n",
                        INT64_MIN, 0));
    static const struct {
        int line, column;
        const char *text;
    } wanted[] = {
        { 3, 6, "expected a time such as 2026-11-20T10:00:00Z (without Z or offset: local time in UTC)" },
        { 4, 1, "the plant has no tag 'FT-2'" },
        { 5, 27, "tag FT-1: expected a time not before the tag's previous sample, 2026-10-25T00:00:00.000Z" },
        { 6, 27, "expected a number, or a word such as Bad or No Data, found 'hot'" },
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
}

/* Local times: in the night that repeats an hour, rows continue through both hours, and an hour that does not exist is refused. */
CASE(times_without_a_zone_are_the_plant_s)
{
    timestamp_use_zone("Europe/Berlin");
    assert_true(import(s, "wide",
                       "time,FT-1\n2026-10-25 01:30,1\n2026-10-25 02:30,2\n2026-10-25 02:00,3\n2026-10-25 02:30,4\n"
                       "2026-10-25 03:30,5\n",
                       INT64_MIN, 0));
    assert_true(import(s, "long", "Tag,Time,Value\nTT-1,2026-10-25T02:30,7\nTT-1,2026-10-25T02:30,8\nFT-1,2026-10-25T02:30:00.5,9\n",
                       INT64_MIN, 0));
    struct history_series wide = read_series(s, "wide", "FT-1"), fresh = read_series(s, "long", "FT-1");
    static const int minutes[] = { -30, 30, 60, 90, 150 };
    assert_int_equal(wide.points.count, 6); /* six points, including one without a value, after which the line ends */
    for (int i = 0; i < 5; i++)
        assert_true(wide.points.at[i].t_us == OCTOBER_25 + minutes[i] * 60 * US_PER_S);
    assert_true(fresh.points.at[0].t_us == OCTOBER_25 + 30 * 60 * US_PER_S + US_PER_S / 2);
    assert_false(import(s, "gap", "Time,FT-1\n2026-03-29 02:30,1\n", INT64_MIN, 0));
    timestamp_use_zone("UTC");
}

CASE(files_that_are_no_series_are_refused)
{
    assert_false(import(s, "h", "a,b\n1,2\n", INT64_MIN, 0));
    assert_false(import(s, "h", "Time,b\n2026-10-25T00:00:00Z,2\n", INT64_MIN, 0));
    assert_false(import(s, "h", "", INT64_MIN, 0));
    assert_int_equal(s->diag.errors, 3);
}

/* An export contains the imported points, and importing that export gives the same points. */
CASE(out_and_in_again_is_the_same)
{
    struct text *csv = test_text(), *out = test_text();
    text_add(csv, "Time,TT-1\n");
    for (int i = 0; i < 5000; i++)
        text_add(csv, "%d,%.4f\n", i, 20 + 5 * sin(i / 50.0) + (i % 977 == 0 ? 30 : 0));
    assert_true(import(s, "one", csv->at, OCTOBER_25, US_PER_S));
    assert_true(s->counts.points < s->counts.samples / 3);
    struct history_series one = read_series(s, "one", "TT-1");
    series_text_csv_head(out, false);
    series_text_csv(out, "TT-1", "", &one);
    s->plant->tags[1].deadband = 0;
    assert_true(import(s, "two", out->at, INT64_MIN, 0));
    struct history_series two = read_series(s, "two", "TT-1");
    assert_int_equal(one.points.count, two.points.count);
    for (size_t i = 0; i < one.points.count; i++)
        assert_true(one.points.at[i].t_us == two.points.at[i].t_us && one.points.at[i].quality == two.points.at[i].quality &&
                    (isnan(one.points.at[i].value) || fabs(one.points.at[i].value - two.points.at[i].value) < 1e-8));
}

/* --- times without data --------------------------------------------------------------------------------------------------------- */

#define DAY_US (86400 * US_PER_S)
static const char two_days[] = "Time,FT-1\n0,0\n10,0\n172800,100\n172810,100\n";

CASE(a_gap_is_no_data)
{
    assert_true(import(s, "h", two_days, OCTOBER_25 - 3 * DAY_US, US_PER_S));
    assert_int_equal(s->counts.gaps, 1);
    assert_int_equal(s->counts.longest_us[0], 100 * US_PER_S);
    assert_true(quality_is_good(read_at(s, "h", 0, -3 * DAY_US + 9 * US_PER_S).quality));
    static const int64_t inside[] = { -3 * DAY_US + 11 * US_PER_S, -2 * DAY_US, -1 * DAY_US - US_PER_S, /* the end: */ 30 * US_PER_S };
    for (size_t i = 0; i < 4; i++)
        assert_int_equal(read_at(s, "h", 0, inside[i]).quality, QUALITY_BAD_NO_COMMUNICATION);
    assert_true(read_at(s, "h", 0, -1 * DAY_US + 5 * US_PER_S).value == 100);
}

/* A series may have only two samples, far apart: no line connects them. */
CASE(two_samples_alone_are_no_line)
{
    assert_true(import(s, "alone", "Time,FT-1\n0,1\n172800,2\n", OCTOBER_25 - 2 * DAY_US, US_PER_S));
    assert_int_equal(s->counts.gaps, 1);
    assert_int_equal(read_at(s, "alone", 0, -DAY_US).quality, QUALITY_BAD_NO_COMMUNICATION);
    static const char beside[] = "Tag,Time,Value\nTT-1,0,1\nTT-1,60,2\nTT-1,120,3\nFT-1,0,1\nFT-1,172800,2\n";
    assert_true(import(s, "beside", beside, OCTOBER_25 - 2 * DAY_US, US_PER_S));
    assert_int_equal(read_at(s, "beside", 0, -DAY_US).quality, QUALITY_BAD_NO_COMMUNICATION);
    static const char near[] = "Tag,Time,Value\nTT-1,0,1\nTT-1,60,2\nTT-1,120,3\nFT-1,0,1\nFT-1,500,2\n"; /* less than 600 s apart */
    assert_true(import(s, "near", near, OCTOBER_25, US_PER_S));
    assert_int_equal(s->counts.gaps, 0);
    assert_true(fabs(read_at(s, "near", 0, 250 * US_PER_S).value - 1.5) < 1e-9);
    s->longest_gap_us = 3 * DAY_US;
    assert_true(import(s, "stated", "Time,FT-1\n0,1\n172800,2\n", OCTOBER_25 - 2 * DAY_US, US_PER_S));
    assert_true(fabs(read_at(s, "stated", 0, -DAY_US).value - 1.5) < 1e-9);
    s->longest_gap_us = 0;
    assert_true(import(s, "regular", "Time,FT-1\n0,1\n86400,2\n172800,3\n", OCTOBER_25 - 2 * DAY_US, US_PER_S));
    assert_int_equal(s->counts.gaps, 0);
}

/* Within a gap, rollups and hourly means have no data. */
CASE(a_gap_is_no_data_in_rollups)
{
    double means[60];
    assert_true(import(s, "h", two_days, OCTOBER_25 - 2 * DAY_US, US_PER_S));
    char *folder = temp_path(s->folder, "h");
    struct history_reader *reader = history_reader_create(s->log, folder);
    assert_int_equal(history_hourly(reader, "FT-1", OCTOBER_25 + 3600 * US_PER_S, 60, means), 0);
    for (int i = 0; i < 60; i++)
        assert_true(isnan(means[i]));
    static const int counts[] = { 10, 100, 1000 };
    for (size_t i = 0; i < 3; i++) {
        struct history_series series;
        assert_int_equal(history_intervals(reader, "FT-1", OCTOBER_25 - 3 * DAY_US, OCTOBER_25 + DAY_US, counts[i], &series), 0);
        assert_true(series.bucket_us > 0);
        for (size_t k = 0; k < series.buckets.count; k++) {
            const struct history_bucket *bucket = &series.buckets.at[k];
            assert_true(isnan(bucket->mean) || bucket->mean == 0 || bucket->mean == 100);
            assert_true(bucket->good_us <= 11 * US_PER_S && (isnan(bucket->last) || bucket->last == bucket->mean));
        }
        history_series_finish(&series);
    }
    history_reader_destroy(&reader);
}

/* The largest distance of two samples that a line may connect: --longest-gap if given, else the tag's Stale s, else derived
   from the usual spacing of samples. A Stale s shorter than that spacing is ignored. */
CASE(the_longest_gap_can_be_stated)
{
    static const char series[] = "Time,FT-1\n0,1\n10,1\n20,1\n30,1\n90,2\n100,2\n";
    s->longest_gap_us = 50 * US_PER_S;
    assert_true(import(s, "stated", series, OCTOBER_25, US_PER_S));
    assert_int_equal(s->counts.gaps, 1);
    s->longest_gap_us = 60 * US_PER_S;
    assert_true(import(s, "longer", series, OCTOBER_25, US_PER_S));
    assert_int_equal(s->counts.gaps, 0);
    assert_true(fabs(read_at(s, "longer", 0, 60 * US_PER_S).value - 1.5) < 1e-9);
    s->longest_gap_us = 0;
    s->plant->tags[0].validity.states_stale = true;
    s->plant->tags[0].validity.stale_s = 30;
    assert_true(import(s, "stale", series, OCTOBER_25, US_PER_S));
    assert_int_equal(s->counts.gaps, 1);
    s->plant->tags[0].validity.stale_s = 5;
    assert_true(import(s, "slower", series, OCTOBER_25, US_PER_S));
    assert_int_equal(s->counts.gaps, 0);
    assert_int_equal(s->counts.longest_us[1], 100 * US_PER_S);
}

CASE(words_and_blanks_are_bad_samples)
{
    static const struct {
        const char *cell;
        uint32_t quality;
    } cells[] = {
        { "", QUALITY_BAD }, { "NaN", QUALITY_BAD }, { "-nan", QUALITY_BAD }, { "1.#QNAN", QUALITY_BAD }, { "inf", QUALITY_BAD },
        { "null", QUALITY_BAD }, { "NULL", QUALITY_BAD }, { "(null)", QUALITY_BAD }, { "#N/A", QUALITY_BAD }, { "#DIV/0!", QUALITY_BAD },
        { "N/A", QUALITY_BAD }, { "-", QUALITY_BAD }, { "---", QUALITY_BAD }, { "****", QUALITY_BAD }, { "No Data", QUALITY_BAD },
        { "NO_DATA", QUALITY_BAD }, { "No Result", QUALITY_BAD }, { "No Sample", QUALITY_BAD }, { "Pt Created", QUALITY_BAD },
        { "Bad", QUALITY_BAD }, { "BAD", QUALITY_BAD }, { "Bad Input", QUALITY_BAD }, { "Bad Quality", QUALITY_BAD },
        { "Bad_Stale", QUALITY_BAD }, { "BadSensorFailure", QUALITY_BAD }, { "Error_Configuration", QUALITY_BAD },
        { "I/O Timeout", QUALITY_BAD_COMMUNICATION_ERROR }, { "Comm Fail", QUALITY_BAD_COMMUNICATION_ERROR },
        { "Not Connect", QUALITY_BAD_COMMUNICATION_ERROR }, { "Not Connected", QUALITY_BAD_COMMUNICATION_ERROR },
        { "Over Range", QUALITY_BAD_SENSOR_FAILURE }, { "Under Range", QUALITY_BAD_SENSOR_FAILURE },
        { "Configure", QUALITY_BAD_CONFIGURATION }, { "Calc Failed", QUALITY_BAD_CONFIGURATION },
        { "Scan Off", QUALITY_BAD_OUT_OF_SERVICE }, { "Shutdown", QUALITY_BAD_OUT_OF_SERVICE },
        { "Intf Shut", QUALITY_BAD_OUT_OF_SERVICE }, { "Out of Serv", QUALITY_BAD_OUT_OF_SERVICE },
    };
    enum { CELLS = sizeof(cells) / sizeof(cells[0]) };
    struct text *csv = test_text();
    text_add(csv, "Time,FT-1,TT-1\n");
    for (int i = 0; i < CELLS; i++)
        text_add(csv, "%d,5,5\n%d,%s,6\n", 20 * i, 20 * i + 10, cells[i].cell);
    assert_true(import(s, "h", csv->at, OCTOBER_25, US_PER_S));
    assert_int_equal(s->counts.bad, CELLS);
    for (int i = 0; i < CELLS; i++) {
        uint32_t quality = read_at(s, "h", 0, (20 * i + 15) * US_PER_S).quality;
        if (quality != cells[i].quality)
            fail_msg("'%s' became 0x%08X", cells[i].cell, quality);
    }
    static const char *const garbage[] = { "12,5", "1.2.3", "hot", "badge", "0x10", "12 °C", "5%", "1e" };
    for (size_t i = 0; i < sizeof(garbage) / sizeof(garbage[0]); i++) {
        char *rows = test_printf("Time;FT-1\n0;1\n10;%s\n", garbage[i]);
        int errors = s->diag.errors;
        assert_false(import(s, "g", rows, OCTOBER_25, US_PER_S));
        assert_int_equal(s->diag.errors, errors + 1);
        assert_int_equal(s->diag.items[errors].line, 3);
        assert_int_equal(s->diag.items[errors].column, 4);
    }
}

CASE(the_last_of_equal_times_counts)
{
    assert_true(import(s, "h", "Tag,Time,Value\nFT-1,0,1\nFT-1,10,2\nTT-1,10,5\nFT-1,10,3\nFT-1,10,4\nFT-1,20,Bad\nFT-1,20,6\n",
                       OCTOBER_25, US_PER_S));
    assert_int_equal(s->counts.duplicates, 3);
    assert_int_equal(s->counts.bad, 0);
    struct history_series series = read_series(s, "h", "FT-1");
    assert_points(&series.points, (const struct wanted_point[]){ { 0, 1 }, { 10 * US_PER_S, 4 }, { 20 * US_PER_S, 6 } }, 3);
}

/* A series in several files may be imported in any order: gaps remain only where data is missing. Importing again with a larger
   --longest-gap closes gaps of the first import. */
CASE(imports_that_follow_each_other_join)
{
    static const char parts[3][80] = { "Time,FT-1\n0,0\n10,1\n20,2\n", "Time,FT-1\n30,3\n40,4\n50,5\n", "Time,FT-1\n60,6\n70,7\n80,8\n" };
    static const int orders[][3] = { { 0, 1, 2 }, { 2, 1, 0 }, { 0, 2, 1 } };
    for (size_t k = 0; k < 3; k++) {
        char folder[] = { 'h', (char)('0' + k), 0 };
        for (int i = 0; i < 3; i++)
            assert_true(import(s, folder, parts[orders[k][i]], OCTOBER_25, US_PER_S));
        for (int i = 0; i < 80; i += 5) {
            struct reading reading = read_at(s, folder, 0, i * US_PER_S);
            assert_true(quality_is_good(reading.quality) && fabs(reading.value - i / 10.0) < 1e-3);
        }
        assert_int_equal(read_at(s, folder, 0, 100 * US_PER_S).quality, QUALITY_BAD_NO_COMMUNICATION);
    }
    assert_true(import(s, "again", two_days, OCTOBER_25, US_PER_S));
    s->longest_gap_us = 3 * DAY_US;
    assert_true(import(s, "again", two_days, OCTOBER_25, US_PER_S));
    assert_true(fabs(read_at(s, "again", 0, DAY_US).value - 50) < 1);
    s->longest_gap_us = 0;
    assert_true(import(s, "again", "Time,FT-1\n864000,3\n864010,3\n864020,3\n", OCTOBER_25, US_PER_S));
    assert_int_equal(read_at(s, "again", 0, 5 * DAY_US).quality, QUALITY_BAD_NO_COMMUNICATION);
}
