/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The history's month files and their reader: recorded points must come back unchanged, across the borders of months, as
   rollups (summaries of time intervals), as readings at one instant, from damaged files and after the disk was full. */
#include "tests/support/test.h"
#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#include <sqlite3.h>

#include "base/files/atomic_file.h"
#include "base/files/database.h"
#include "base/text/text.h"
#include "history/history.h"
#include "history/retention.h"
#include "history/month.h"
#include "history/month_outbox.h"
#include "history/recorder.h"
#include "history/spool.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/sweep.h"
#include "value/quality.h"

#define S US_PER_S
enum { TAGS = 3 };
static const int64_t NOVEMBER = INT64_C(1793491200) * US_PER_S; /* 2026-11-01T00:00:00Z */

struct history_setup {
    char *folder;
    struct log *log;
    struct plant *plant; /* plant with three tags: two analogue ones, recorded with tolerances of 0.4 and 1, and a switch */
    struct history_tag *tags;
    struct history_reader *reader;
};

static void begin(struct history_setup *s)
{
    s->folder = temp_folder();
    s->log = test_log();
    s->plant = plant_by_hand_create(TAGS);
    s->plant->history = (struct plant_history){ .override_s = 600 };
    plant_by_hand_source(s->plant, "plc", 502);
    plant_by_hand_tag(s->plant, "TT-1", TABLE_HOLDING, 0, DATA_FLOAT32)->deadband = 0.4;
    plant_by_hand_tag(s->plant, "TT-2", TABLE_HOLDING, 2, DATA_FLOAT32)->deadband = 1;
    plant_by_hand_tag(s->plant, "XS-1", TABLE_COIL, 0, DATA_BIT);
    s->tags = history_tags(s->plant);
    s->reader = history_reader_create(s->log, s->folder);
}

static void end(struct history_setup *s)
{
    history_reader_destroy(&s->reader);
    mem_free(s->tags);
}

TEST_FIXTURE(struct history_setup, begin, end)

#define CASE(name) TEST_ON(struct history_setup *s, name, set_up, tear_down)

static struct month_file *open_file(struct history_setup *s, int64_t t_us)
{
    int error;
    struct month_file *file = month_file_open(s->log, s->folder, month_of(t_us), s->tags, TAGS, &error);
    assert_non_null(file);
    return file;
}

static double wave(int tag, int64_t second)
{
    double t = (double)second;
    if (tag == 2)
        return second / 700 % 2;
    return 50 + 30 * sin(t / (500 + 300 * tag)) + (second % 5000 == 4321 ? 40 : 0);
}

static uint32_t quality_at(int tag, int64_t second)
{
    return tag == 1 && second % 9000 > 8000 ? QUALITY_BAD_SENSOR_FAILURE : QUALITY_GOOD;
}

/* Records one sample per tag and second into a month file as the historian does: only the points that the swinging-door filter
   keeps, in one transaction per minute, with rollups of ten minutes. */
static void record(struct history_setup *s, int64_t begin_us, int seconds)
{
    struct recorder *recorder = recorder_create(s->plant, INT64_MIN);
    struct recorder_rows rows = { 0 }, held = { 0 };
    struct month_file *file = open_file(s, begin_us);
    for (int i = 0; i < seconds; i++) {
        for (int tag = 0; tag < TAGS; tag++) {
            uint32_t quality = quality_at(tag, i);
            struct history_point point = { begin_us + i * S, quality_is_bad(quality) ? NAN : wave(tag, i), quality };
            recorder_put(recorder, tag, &point, &rows);
        }
        if (i % 60 != 59 && i + 1 < seconds)
            continue;
        recorder_held(recorder, &held);
        assert_int_equal(month_file_write(file, rows.at, rows.count, held.at, held.count), 0);
        rows.count = held.count = 0;
        if (i % 600 == 599)
            assert_int_equal(month_file_tidy(file), 0);
    }
    mem_free(rows.at);
    mem_free(held.at);
    month_file_close(&file);
    recorder_destroy(&recorder);
}

/* --- tests -------------------------------------------------------------------------------------------------------------------- */

CASE(what_was_recorded_comes_back)
{
    const int seconds = 20000;
    struct history_series series;
    record(s, NOVEMBER, seconds);
    for (int tag = 0; tag < TAGS; tag++) {
        assert_int_equal(history_series(s->reader, s->tags[tag].name, NOVEMBER, NOVEMBER + seconds * S, 1000000, &series), 0);
        assert_int_equal(series.bucket_us, 0);
        assert_true(series.points.count > 2 && series.points.count < (size_t)seconds / 4);
        size_t k = 0;
        for (int i = 0; i < seconds; i++) {
            int64_t t_us = NOVEMBER + i * S;
            while (k + 1 < series.points.count && series.points.at[k + 1].t_us <= t_us)
                k++;
            const struct history_point *a = &series.points.at[k], *b = k + 1 < series.points.count ? a + 1 : NULL;
            assert_int_equal(a->quality, quality_at(tag, i));
            if (!history_point_usable(a))
                continue;
            double value = b && history_point_joined(a, b, series.step) ? history_point_between(a, b, t_us) : a->value;
            assert_true(fabs(value - wave(tag, i)) <= s->tags[tag].within + 1e-9);
        }
        history_series_finish(&series);
    }
}

CASE(one_instant_is_as_it_was)
{
    struct snapshot *snapshot = test_snapshot(TAGS);
    record(s, NOVEMBER, 20000);
    for (int i = 7; i < 20000; i += 997) {
        assert_int_equal(history_at(s->reader, s->tags, NOVEMBER + i * S, snapshot), 0);
        for (int tag = 0; tag < TAGS; tag++) {
            assert_int_equal(snapshot->readings[tag].quality, quality_at(tag, i));
            if (!quality_is_bad(quality_at(tag, i)))
                assert_true(fabs(snapshot->readings[tag].value - wave(tag, i)) <= s->tags[tag].within + 1e-9);
        }
    }
    assert_int_equal(history_at(s->reader, s->tags, NOVEMBER - S, snapshot), 0);
    assert_int_equal(snapshot->readings[0].quality, QUALITY_BAD_WAITING);
}

/* A source that sends only changes: nothing for hours, then a value each second, then nothing again. While nothing is sent, the
   last value must hold, and no sloping line may lead to the next one. */
CASE(a_value_that_is_not_sent_again_holds)
{
    const struct history_point sent[] = { { NOVEMBER, 10, 0 },           { NOVEMBER + 7200 * S, 20, 0 }, { NOVEMBER + 7201 * S, 25, 0 },
                                          { NOVEMBER + 7202 * S, 40, 0 }, { NOVEMBER + 9999 * S, 30, 0 }, { NOVEMBER + 20000 * S, 30, 0 } };
    struct snapshot *snapshot = test_snapshot(TAGS);
    struct recorder_rows rows = { 0 };
    s->plant->tags[0].validity.stale_s = PLANT_NEVER_STALE_S;
    mem_free(s->tags);
    s->tags = history_tags(s->plant);
    struct recorder *recorder = recorder_create(s->plant, NOVEMBER);
    for (size_t i = 0; i < 6; i++)
        recorder_put(recorder, 0, &sent[i], &rows);
    recorder_end(recorder, &rows);
    recorder_destroy(&recorder);
    struct month_file *file = open_file(s, NOVEMBER);
    assert_int_equal(month_file_write(file, rows.at, rows.count, NULL, 0), 0);
    month_file_close(&file);
    mem_free(rows.at);
    for (int second = 0; second <= 20000; second += second < 7190 || second > 7210 ? 10 : 1) {
        double value = second < 7200 ? 10 : second < 7201 ? 20 : second < 7202 ? 25 : second < 9999 ? 40 : 30;
        assert_int_equal(history_at(s->reader, s->tags, NOVEMBER + second * S, snapshot), 0);
        assert_true(fabs(snapshot->readings[0].value - value) <= s->tags[0].within + 1e-9);
    }
}

/* Records samples of TT-1, given in `sent`, with the plant's settings for its source and stale time. Returns the reading that
   the history gives for the time `second` seconds after the first sample. */
static struct reading recorded_at(struct history_setup *s, const struct history_point *sent, size_t count, int second)
{
    struct snapshot *snapshot = test_snapshot(TAGS);
    struct recorder_rows rows = { 0 };
    struct recorder *recorder = recorder_create(s->plant, NOVEMBER);
    s->folder = temp_folder();
    history_reader_destroy(&s->reader);
    s->reader = history_reader_create(s->log, s->folder);
    mem_free(s->tags);
    s->tags = history_tags(s->plant);
    for (size_t i = 0; i < count; i++)
        recorder_put(recorder, 0, &sent[i], &rows);
    recorder_end(recorder, &rows);
    recorder_destroy(&recorder);
    struct month_file *file = open_file(s, NOVEMBER);
    assert_int_equal(month_file_write(file, rows.at, rows.count, NULL, 0), 0);
    month_file_close(&file);
    mem_free(rows.at);
    assert_int_equal(history_at(s->reader, s->tags, NOVEMBER + second * S, snapshot), 0);
    return snapshot->readings[0];
}

static void send_by(struct history_setup *s, const char *kind, enum mqtt_payload payload, int scan_ms, double stale_s)
{
    mem_free(s->plant->sources[0].kind);
    s->plant->sources[0].kind = mem_strdup(kind);
    s->plant->sources[0].mqtt.payload = payload;
    s->plant->tags[0].signal.scan_ms = scan_ms;
    s->plant->tags[0].validity.stale_s = stale_s;
}

/* Samples ten minutes apart, where the stale time allows that: live pictures showed the old value until the new one arrived, so
   the history must not draw a sloping line between them. */
CASE(a_line_does_not_slope_over_a_long_silence)
{
    static const struct {
        const char *kind;
        enum mqtt_payload payload;
    } sources[] = { { "opcua", 0 }, { "mqtt", MQTT_SPARKPLUG }, { "mqtt", MQTT_JSON }, { "mqtt", MQTT_NUMBER }, { "modbus", 0 } };
    const struct history_point sent[] = { { NOVEMBER, 10, 0 }, { NOVEMBER + 600 * S, 90, 0 } };
    for (size_t i = 0; i < sizeof(sources) / sizeof(sources[0]); i++) {
        send_by(s, sources[i].kind, sources[i].payload, 1000, 3600);
        struct reading reading = recorded_at(s, sent, 2, 300);
        assert_int_equal(reading.quality, QUALITY_GOOD);
        assert_float_equal(reading.value, 10, 1e-9);
        reading = recorded_at(s, sent, 2, 598);
        assert_float_equal(reading.value, 10, 1e-9);
    }
    /* this publisher sends every five minutes (Scan Rate): with only one message missing within ten minutes, a line connects
       the samples */
    send_by(s, "mqtt", MQTT_JSON, 300000, 3600);
    assert_float_equal(recorded_at(s, sent, 2, 300).value, 50, 1e-9);
}

/* If a gap is so short that the next sample arrives before the historian noticed the stale reading, the time after the stale
   limit must be unknown all the same. */
CASE(a_gap_is_unknown_however_short)
{
    const struct history_point sent[] = { { NOVEMBER, 10, 0 }, { NOVEMBER + 6 * S, 20, 0 }, { NOVEMBER + 9 * S, 30, 0 } };
    send_by(s, "mqtt", MQTT_JSON, 1000, 4);
    assert_float_equal(recorded_at(s, sent, 3, 3).value, 10, 1e-9);
    assert_int_equal(recorded_at(s, sent, 3, 5).quality, QUALITY_BAD_COMMUNICATION_ERROR);
    assert_float_equal(recorded_at(s, sent, 3, 6).value, 20, 1e-9);
    assert_float_equal(recorded_at(s, sent, 3, 7).value, 20 + 10 / 3.0, 1e-9);
}

/* However long the queried time, a spike of one second and the total duration of gaps must show in the result. */
CASE(long_times_keep_spikes_and_gaps)
{
    struct history_series series;
    record(s, NOVEMBER, 40000);
    for (int max = 10; max <= 20000; max *= 2) {
        double high = 0, low = 1000, bad_us = 0;
        for (int tag = 0; tag < 2; tag++) {
            assert_int_equal(history_series(s->reader, s->tags[tag].name, NOVEMBER, NOVEMBER + 39999 * S, max, &series), 0);
            for (size_t i = 0; i < series.buckets.count; i++) {
                const struct history_bucket *bucket = &series.buckets.at[i];
                high = fmax(high, bucket->high);
                low = fmin(low, bucket->low);
                bad_us += tag == 1 ? (double)bucket->bad_us : 0;
                /* a Bad reading lasts until the next bucket that has data, so the time without buckets counts, too */
                if (tag == 1 && quality_is_bad(bucket->quality) && i + 1 < series.buckets.count)
                    bad_us += (double)(bucket[1].t_us - bucket->t_us - series.bucket_us);
                assert_true(i == 0 || bucket->t_us > series.buckets.at[i - 1].t_us);
            }
            for (size_t i = 0; i < series.points.count; i++) {
                high = fmax(high, series.points.at[i].value);
                low = fmin(low, series.points.at[i].value);
                if (tag == 1 && i + 1 < series.points.count && !history_point_usable(&series.points.at[i]))
                    bad_us += (double)(series.points.at[i + 1].t_us - series.points.at[i].t_us);
            }
            assert_true(series.points.count + series.buckets.count <= 2 * (size_t)max + 3);
            history_series_finish(&series);
        }
        double truth_high = 0, truth_low = 1000;
        for (int i = 0; i < 40000; i++)
            for (int tag = 0; tag < 2; tag++)
                if (!quality_is_bad(quality_at(tag, i))) {
                    truth_high = fmax(truth_high, wave(tag, i));
                    truth_low = fmin(truth_low, wave(tag, i));
                }
        assert_true(fabs(high - truth_high) < 0.5);
        assert_true(fabs(low - truth_low) <= 1);
        assert_true(fabs(bad_us / 1e6 - 4 * 999) < 5 * 2);
    }
}

CASE(lines_cross_the_border_of_a_month)
{
    struct history_series series;
    struct snapshot *snapshot = test_snapshot(TAGS);
    struct history_point before = { NOVEMBER - 10 * S, 10, 0 }, after = { NOVEMBER + 10 * S, 30, 0 };
    struct month_file *file = open_file(s, before.t_us);
    assert_int_equal(month_file_import(file, 0, &before, 1), 0);
    month_file_close(&file);
    file = open_file(s, after.t_us);
    assert_int_equal(month_file_import(file, 0, &after, 1), 0);
    month_file_close(&file);
    for (int i = -9; i < 10; i++) {
        assert_int_equal(history_at(s->reader, s->tags, NOVEMBER + i * S, snapshot), 0);
        assert_true(fabs(snapshot->readings[0].value - 20 - i) < 1e-9);
    }
    assert_int_equal(history_series(s->reader, "TT-1", NOVEMBER - 5 * S, NOVEMBER - 1 * S, 100, &series), 0);
    assert_int_equal(series.points.count, 2);
    history_series_finish(&series);
}

/* Writes ascending points of a tag into the files of their months. */
static void import_points(struct history_setup *s, int tag, const struct history_point *points, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        struct month_file *file = open_file(s, points[i].t_us);
        assert_int_equal(month_file_import(file, tag, &points[i], 1), 0);
        month_file_close(&file);
    }
}

/* TT-1 has points in July, November and January, the switch in July and November, TT-2 in all months: queries for the months
   between must find the points before and after. */
CASE(points_that_are_months_apart_are_found)
{
    const int64_t day = 86400 * S, july = NOVEMBER - 120 * day, january = NOVEMBER + 65 * day;
    const struct history_point rises[] = { { july, 10, 0 }, { NOVEMBER + 10 * day, 140, 0 }, { january, 85, 0 } };
    const struct history_point turns[] = { { july, 1, 0 }, { NOVEMBER + 10 * day, 0, 0 } };
    struct snapshot *snapshot = test_snapshot(TAGS);
    struct history_series series;
    import_points(s, 0, rises, 3);
    import_points(s, 2, turns, 2);
    for (int i = -125; i < 70; i++)
        import_points(s, 1, &(struct history_point){ NOVEMBER + i * day, i, 0 }, 1);
    for (int tag = 0; tag < TAGS; tag++)
        s->tags[tag].stale_us = INT64_MAX;
    for (int i = -124; i < 80; i += 3) {
        assert_int_equal(history_at(s->reader, s->tags, NOVEMBER + i * day, snapshot), 0);
        double rise = i < 10 ? 130 + i : i < 65 ? 150 - i : 85;
        assert_int_equal(snapshot->readings[0].quality, i < -120 ? QUALITY_BAD_WAITING : QUALITY_GOOD);
        assert_true(i < -120 || fabs(snapshot->readings[0].value - rise) < 1e-6);
        assert_int_equal(snapshot->readings[2].quality, i < -120 ? QUALITY_BAD_WAITING : QUALITY_GOOD);
        assert_true(i < -120 || snapshot->readings[2].value == (i < 10));
        if (i < -120)
            continue;
        assert_int_equal(history_series(s->reader, "TT-1", NOVEMBER + i * day, NOVEMBER + (i + 1) * day, 1000, &series), 0);
        assert_int_equal(series.points.count, i < 65 ? 2 + (i == -120) : 1);
        assert_true(series.points.at[0].t_us <= NOVEMBER + i * day);
        assert_true(i >= 65 || series.points.at[series.points.count - 1].t_us > NOVEMBER + (i + 1) * day);
        history_series_finish(&series);
        /* as intervals, the query gives the bucket before the range and the one after it, between which the line runs */
        assert_int_equal(history_intervals(s->reader, "TT-1", NOVEMBER + i * day, NOVEMBER + (i + 1) * day, 24, &series), 0);
        assert_int_equal(series.buckets.count, i < 65 ? 2 + (i == -120) : 1);
        history_series_finish(&series);
    }
    /* One month file between two others is cut off and unreadable: readings in that month must be unknown, all others returned.
       */
    char *august = temp_path(s->folder, "history-2026-08.sqlite");
    assert_int_equal(truncate(august, 100), 0);
    history_reader_destroy(&s->reader);
    s->reader = history_reader_create(s->log, s->folder);
    assert_int_equal(history_at(s->reader, s->tags, NOVEMBER + day / 2, snapshot), 0);
    assert_int_equal(snapshot->readings[0].quality, QUALITY_BAD_WAITING);
    assert_float_equal(snapshot->readings[1].value, 0.5, 1e-6);
    assert_int_equal(history_series(s->reader, "TT-1", NOVEMBER, NOVEMBER + day, 1000, &series), 0);
    assert_int_equal(series.points.count, 1);
    history_series_finish(&series);
}

static void set_zone(const char *zone)
{
    assert_int_equal(zone ? setenv("TZ", zone, 1) : unsetenv("TZ"), 0);
    tzset();
}

/* While the historian records, the machine's time zone changes, summer time ends and a new month begins: points must be stored
   and found as if nothing had happened. */
CASE(time_zones_do_not_touch_what_is_recorded)
{
    const char *const zones[] = { "Pacific/Kiritimati", "Europe/Berlin", "America/Adak", "UTC" }, *before = getenv("TZ");
    char *kept = test_memory(before ? mem_strdup(before) : NULL);
    const int64_t autumn = NOVEMBER - (6 * 86400 + 82800) * S; /* 2026-10-25T01:00Z: in Berlin the clock is set back from 3:00 to 2:00 */
    const int64_t begins[] = { autumn - 1800 * S, NOVEMBER - 1800 * S };
    size_t count;
    for (size_t b = 0; b < 2; b++)
        /* the machine's time zone changes each quarter of an hour while recording goes on */
        for (int quarter = 0; quarter < 4; quarter++) {
            set_zone(zones[quarter]);
            int64_t from_us = begins[b] + quarter * 900 * S;
            int error;
            struct month_file *file = month_file_open(s->log, s->folder, month_of(from_us), s->tags, TAGS, &error);
            struct history_row rows[900];
            for (int i = 0; i < 900; i++)
                rows[i] = (struct history_row){ 0, { from_us + i * S, quarter * 900 + i, QUALITY_GOOD } };
            assert_int_equal(month_file_write(file, rows, 900, NULL, 0), 0);
            assert_int_equal(month_file_tidy(file), 0);
            month_file_close(&file);
        }
    int *months = test_memory(month_list(s->folder, &count));
    assert_int_equal(count, 2); /* months are counted in UTC, whatever the time zone */
    assert_int_equal(months[1], month_of(NOVEMBER));
    for (size_t zone = 0; zone < 4; zone++)
        for (size_t b = 0; b < 2; b++) {
            struct history_series series;
            set_zone(zones[zone]);
            assert_int_equal(history_series(s->reader, "TT-1", begins[b], begins[b] + 3599 * S, 1000000, &series), 0);
            /* the series may begin with the last point before the range and end with the first one after it */
            const struct history_point *at = series.points.at;
            at += at->t_us < begins[b];
            assert_true(series.points.at + series.points.count - at >= 3600);
            for (int i = 0; i < 3600; i++) {
                assert_int_equal(at[i].t_us, begins[b] + i * S);
                assert_true(at[i].value == i);
            }
            history_series_finish(&series);
        }
    set_zone(kept);
}

/* --- compressed points ------------------------------------------------------------------------------------------------------- */

enum { ODD_SECONDS = 4000 };

static double odd_value(void)
{
    static const double rare[] = { NAN, INFINITY, -INFINITY, 0, -0.0, 5e-324, 1.7976931348623157e308, -1 };
    int kind = rand() % 16;
    return kind < 8 ? rare[kind] : kind < 12 ? (double)((float)rand() / 7.0F) : (double)rand() / 7;
}

static bool same(double a, double b)
{
    return memcmp(&a, &b, sizeof(a)) == 0 || (isnan(a) && isnan(b));
}

/* Asserts that the history has exactly the tag's points of `truth`, an array with an entry for each second; quality 1 marks a
   second without a point. */
static void assert_points(struct history_setup *s, int tag, const struct history_point *truth)
{
    struct history_series series;
    size_t found = 0;
    assert_int_equal(history_series(s->reader, s->tags[tag].name, NOVEMBER - S, NOVEMBER + ODD_SECONDS * S, 1000000, &series), 0);
    for (int i = 0; i < ODD_SECONDS; i++) {
        if (truth[i].quality == 1)
            continue;
        assert_true(found < series.points.count);
        const struct history_point *point = &series.points.at[found++];
        assert_int_equal(point->t_us, truth[i].t_us);
        assert_int_equal(point->quality, truth[i].quality);
        assert_true(same(point->value, truth[i].value));
    }
    assert_int_equal(found, series.points.count);
    history_series_finish(&series);
}

/* Random values and qualities must come back with the same bits, even if times repeat or go backwards, whether they are stored
   as rows or in compressed blocks, and even if the file is closed and reopened at any moment. A newer point replaces an older
   one with the same time. */
CASE(every_point_comes_back_bit_by_bit)
{
    struct history_point truth[TAGS][ODD_SECONDS];
    struct month_file *file = open_file(s, NOVEMBER);
    srand((unsigned)sweep_seed());
    for (int tag = 0; tag < TAGS; tag++)
        for (int i = 0; i < ODD_SECONDS; i++)
            truth[tag][i].quality = 1;
    for (int second = 0; second < ODD_SECONDS; second++) {
        struct history_row rows[TAGS];
        size_t count = 0;
        for (int tag = 0; tag < TAGS; tag++) {
            /* one sample in 20 has an earlier time, as after the clock was set back */
            int at = rand() % 20 == 0 ? rand() % (second + 1) : second;
            uint32_t quality = rand() % 8 ? QUALITY_GOOD : 0x80000000U + (unsigned)rand();
            struct history_point point = { NOVEMBER + at * S + at % 7, odd_value(), quality };
            if (rand() % 3)
                rows[count++] = (struct history_row){ tag, truth[tag][at] = point };
        }
        assert_int_equal(month_file_write(file, rows, count, NULL, 0), 0);
        if (rand() % 200 == 0)
            assert_int_equal(month_file_tidy(file), 0);
        if (rand() % 300 == 0) {
            month_file_close(&file); /* closes the file without cleaning it up, as a killed daemon does */
            file = open_file(s, NOVEMBER);
        }
        if (second % 700 == 699)
            assert_points(s, second % TAGS, truth[second % TAGS]);
    }
    for (int tag = 0; tag < TAGS; tag++)
        assert_points(s, tag, truth[tag]);
    assert_int_equal(month_file_tidy(file), 0);
    for (int tag = 0; tag < TAGS; tag++)
        assert_points(s, tag, truth[tag]);
    month_file_close(&file);
}

/* Points imported before existing ones change the rollups: these must be as if all points had been recorded in order of time.
   */
CASE(an_import_is_rolled_up_again)
{
    enum { COUNT = 20000 };
    struct history_point *points = test_memory(mem_array(COUNT, sizeof(*points)));
    struct history_series once, twice;
    for (int i = 0; i < COUNT; i++)
        points[i] = (struct history_point){ NOVEMBER + i * S, rand() % 1000, 0 };
    struct month_file *file = open_file(s, NOVEMBER);
    assert_int_equal(month_file_import(file, 0, points, COUNT), 0);
    assert_int_equal(month_file_import(file, 1, points + COUNT / 3, COUNT - COUNT / 3), 0);
    assert_int_equal(month_file_import(file, 1, points, COUNT / 3), 0);
    month_file_close(&file);
    assert_int_equal(history_series(s->reader, "TT-1", NOVEMBER, NOVEMBER + COUNT * S, 500, &once), 0);
    assert_int_equal(history_series(s->reader, "TT-2", NOVEMBER, NOVEMBER + COUNT * S, 500, &twice), 0);
    assert_true(once.buckets.count > 300);
    assert_int_equal(once.buckets.count, twice.buckets.count);
    for (size_t i = 0; i < once.buckets.count; i++) {
        assert_true(once.buckets.at[i].low == twice.buckets.at[i].low && once.buckets.at[i].high == twice.buckets.at[i].high);
        assert_true(fabs(once.buckets.at[i].mean - twice.buckets.at[i].mean) < 1e-9);
    }
    history_series_finish(&once);
    history_series_finish(&twice);
}

/* Another process imports points while the recording handle is open: first a point of another tag, after a spike of TT-1 was
   written, then a spike of TT-1 itself, while no point waits to be moved to blocks. The rollups must contain both spikes. */
CASE(an_import_by_another_handle_keeps_rollups_right)
{
    int error;
    struct month_buckets hours = { 0 };
    struct month_file *file = open_file(s, NOVEMBER), *imports = open_file(s, NOVEMBER);
    for (int minute = 0; minute < 150; minute++) {
        struct history_row row = { 0, { NOVEMBER + minute * 60 * S, minute == 15 ? 99 : minute % 2, QUALITY_GOOD } };
        assert_int_equal(month_file_write(file, &row, 1, NULL, 0), 0);
        if (minute == 15)
            assert_int_equal(month_file_import(imports, 1, &(struct history_point){ NOVEMBER, 1, QUALITY_GOOD }, 1), 0);
        if (minute % 10 == 0)
            assert_int_equal(month_file_tidy(file), 0);
        struct history_point spike = { NOVEMBER + 79 * 60 * S + S, -99, QUALITY_GOOD };
        if (minute == 80)
            assert_int_equal(month_file_import(imports, 0, &spike, 1), 0);
    }
    assert_int_equal(month_file_tidy(file), 0);
    month_file_close(&imports);
    month_file_close(&file);
    file = month_file_read(s->log, s->folder, month_of(NOVEMBER), &error);
    assert_int_equal(month_file_buckets(file, "TT-1", LEVEL_1_H, NOVEMBER, NOVEMBER + 3600 * S, &hours), 0);
    assert_int_equal(hours.buckets.count, 2);
    assert_true(hours.buckets.at[0].high == 99 && hours.buckets.at[0].low == 0);
    assert_true(hours.buckets.at[1].high == 1 && hours.buckets.at[1].low == -99);
    month_file_close(&file);
    mem_free(hours.buckets.at);
}

/* Another process imports points for a plant that lacks TT-1, and so moves points of TT-1 without rolling them up. */
CASE(an_import_for_another_plant_keeps_rollups_right)
{
    int error;
    struct month_buckets hours = { 0 };
    struct month_file *file = open_file(s, NOVEMBER);
    struct month_file *other = month_file_open(s->log, s->folder, month_of(NOVEMBER), s->tags + 1, 1, &error);
    assert_non_null(other);
    for (int minute = 0; minute < 150; minute++) {
        struct history_row row = { 0, { NOVEMBER + minute * 60 * S, minute == 55 ? 99 : minute % 2, QUALITY_GOOD } };
        assert_int_equal(month_file_write(file, &row, 1, NULL, 0), 0);
        if (minute == 65)
            assert_int_equal(month_file_import(other, 0, &(struct history_point){ NOVEMBER, 1, QUALITY_GOOD }, 1), 0);
        if (minute % 20 == 10)
            assert_int_equal(month_file_tidy(file), 0);
    }
    assert_int_equal(month_file_tidy(file), 0);
    month_file_close(&other);
    month_file_close(&file);
    file = month_file_read(s->log, s->folder, month_of(NOVEMBER), &error);
    assert_int_equal(month_file_buckets(file, "TT-1", LEVEL_1_H, NOVEMBER, NOVEMBER + 3600 * S, &hours), 0);
    assert_int_equal(hours.buckets.count, 2);
    assert_true(hours.buckets.at[0].high == 99 && hours.buckets.at[1].high == 1);
    hours.buckets.count = 0;
    assert_int_equal(month_file_buckets(file, "TT-1", LEVEL_1_MIN, NOVEMBER, NOVEMBER + 149 * 60 * S, &hours), 0);
    assert_int_equal(hours.buckets.count, 149);
    month_file_close(&file);
    mem_free(hours.buckets.at);
}

static sqlite3 *open_database(const char *path)
{
    sqlite3 *db;
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    return db;
}

/* Computes what a rollup of begin_us to end_us must contain, by adding up the line through the points minute by minute. */
static void sum_up(const struct history_point *points, int count, bool step, int64_t begin_us, int64_t end_us, struct history_bucket *out)
{
    double sum = 0;
    *out = (struct history_bucket){ .t_us = begin_us };
    for (int64_t t_us = begin_us; t_us < end_us && t_us < points[count - 1].t_us; t_us += 60 * S) {
        const struct history_point *a = points;
        while (a[1].t_us <= t_us)
            a++;
        if (!history_point_usable(a)) {
            out->bad_us += 60 * S;
            continue;
        }
        sum += history_point_joined(a, a + 1, step) ? history_point_between(a, a + 1, t_us + 30 * S) : a->value;
        out->good_us += 60 * S;
    }
    out->mean = sum / (double)(out->good_us / (60 * S));
}

/* Points exactly at boundaries of buckets, as imported tables have them: the value of a switch, and a value before a change of
   quality, hold until the next point. Rollups must agree. */
CASE(values_hold_until_a_point_at_the_border_of_a_bucket)
{
    enum { COUNT = 4 };
    const uint32_t bad = QUALITY_BAD_SENSOR_FAILURE, unsure = QUALITY_UNCERTAIN;
    const struct history_point points[TAGS][COUNT] = {
        { { 0, 5, 0 }, { 10, NAN, bad }, { 20, 7, 0 }, { 30, 9, 0 } },
        { { 0, 1, 0 }, { 10, 3, unsure }, { 20, 8, unsure }, { 30, 2, 0 } },
        { { 0, 0, 0 }, { 10, 1, 0 }, { 20, 0, 0 }, { 30, 1, 0 } },
    };
    struct history_point truth[TAGS][COUNT];
    char *path = temp_path(s->folder, "history-2026-11.sqlite");
    struct month_file *file = open_file(s, NOVEMBER);
    for (int tag = 0; tag < TAGS; tag++) {
        for (int i = 0; i < COUNT; i++) {
            truth[tag][i] = points[tag][i];
            truth[tag][i].t_us = NOVEMBER + points[tag][i].t_us * 3600 * S;
        }
        assert_int_equal(month_file_import(file, tag, truth[tag], COUNT), 0);
    }
    month_file_close(&file);
    for (int earlier = 0; earlier < 2; earlier++) {
        for (int tag = 0; tag < TAGS; tag++) {
            struct history_series series;
            assert_int_equal(history_intervals(s->reader, s->tags[tag].name, NOVEMBER, NOVEMBER + 30 * 3600 * S, 4, &series), 0);
            assert_int_equal(series.bucket_us, 8 * 3600 * S);
            assert_int_equal(series.buckets.count, 4);
            for (size_t i = 0; i < 4; i++) {
                const struct history_bucket *got = &series.buckets.at[i];
                struct history_bucket wanted;
                sum_up(truth[tag], COUNT, series.step, got->t_us, got->t_us + series.bucket_us, &wanted);
                assert_int_equal(got->good_us, wanted.good_us);
                assert_int_equal(got->bad_us, wanted.bad_us);
                /* `earlier`: a file as older versions wrote it, whose rollups lack a change of quality at a boundary */
                assert_true(wanted.good_us == 0 || (earlier && tag == 1) || fabs(got->mean - wanted.mean) < 1e-9);
            }
            history_series_finish(&series);
        }
        sqlite3 *db = open_database(path);
        assert_int_equal(sqlite3_exec(db, "UPDATE rollup SET first = last", NULL, NULL, NULL), SQLITE_OK); /* as earlier versions */
        sqlite3_close(db);
    }
}

/* A tag with few points: the bucket before the requested time span must be in the result, because it gives the value at the
   beginning of the span. */
CASE(a_span_between_sparse_points_begins_with_the_bucket_before)
{
    enum { COUNT = 400, APART_S = 1000 };
    struct history_point *points = test_memory(mem_array(COUNT, sizeof(*points)));
    struct history_series series;
    for (int i = 0; i < COUNT; i++)
        points[i] = (struct history_point){ NOVEMBER + (i - COUNT / 2) * APART_S * S, i, 0 }; /* half of them in October */
    for (int month = 0; month < 2; month++) {
        struct month_file *file = open_file(s, month == 0 ? NOVEMBER - S : NOVEMBER);
        assert_int_equal(month_file_import(file, 0, points + month * COUNT / 2, COUNT / 2), 0);
        month_file_close(&file);
    }
    for (int64_t from_us = NOVEMBER - 2500 * S; from_us < NOVEMBER + 2500 * S; from_us += 500 * S) {
        assert_int_equal(history_intervals(s->reader, "TT-1", from_us, from_us + 1200 * S, 20, &series), 0);
        assert_int_equal(series.bucket_us, 60 * S); /* as many minutes as points */
        assert_true(series.buckets.count >= 2 && series.buckets.at[0].t_us <= from_us);
        assert_true(series.buckets.at[1].t_us + series.bucket_us > from_us);
        history_series_finish(&series);
    }
}

/* Adds the line from point a to point b, as far as it lies between begin_us and end_us, to the rollup *out. b NULL: a is the
   last point, where the line ends. */
static void add_line(const struct history_point *a, const struct history_point *b, bool step, int64_t begin_us, int64_t end_us,
                     struct history_bucket *out)
{
    begin_us = a->t_us > begin_us ? a->t_us : begin_us;
    end_us = b && b->t_us < end_us ? b->t_us : end_us;
    if (a->t_us == begin_us && history_point_usable(a) && begin_us < end_us + !b) {
        out->low = fmin(out->low, a->value);
        out->high = fmax(out->high, a->value);
    }
    if (!b || end_us <= begin_us)
        return;
    if (!history_point_usable(a)) {
        out->bad_us += end_us - begin_us;
        return;
    }
    bool joined = history_point_joined(a, b, step);
    double enters = joined ? history_point_between(a, b, begin_us) : a->value;
    double leaves = joined ? history_point_between(a, b, end_us) : a->value;
    out->low = fmin(out->low, fmin(enters, leaves));
    out->high = fmax(out->high, fmax(enters, leaves));
    out->mean += (enters + leaves) / 2 * (double)(end_us - begin_us);
    out->good_us += end_us - begin_us;
}

/* Returns the line's value at t_us, or NaN if there is no line. At a jump, returns the value after it or, with `before`, the
   value before it. */
static double line_at(const struct history_point *points, int count, bool step, int64_t t_us, bool before)
{
    for (int i = 0; i + 1 < count; i++) {
        const struct history_point *a = &points[i], *b = a + 1;
        if ((before ? a->t_us < t_us && t_us <= b->t_us : a->t_us <= t_us && t_us < b->t_us) && history_point_usable(a))
            return history_point_joined(a, b, step) ? history_point_between(a, b, t_us) : a->value;
    }
    const struct history_point *last = &points[count - 1];
    return !before && last->t_us == t_us && history_point_usable(last) ? last->value : NAN;
}

static void assert_close(double got, double wanted)
{
    if (!(isnan(got) && isnan(wanted)) && !(fabs(got - wanted) < 1e-6))
        fail_msg("%.9g instead of %.9g", got, wanted);
}

/* Compares the intervals that a query returned for from_us to to_us with those computed here from the line through the points.
   */
static void assert_intervals(const struct history_series *series, const struct history_point *points, int count, int64_t from_us,
                             int64_t to_us)
{
    const struct history_buckets *got = &series->buckets;
    int64_t length_us = series->bucket_us;
    size_t k = 0;
    for (int i = 0; i < count; i++) {
        int64_t begin_us = points[i].t_us - points[i].t_us % length_us, end_us = begin_us + length_us;
        if (end_us <= from_us || begin_us > to_us || (i > 0 && points[i - 1].t_us >= begin_us))
            continue;
        while (k < got->count && got->at[k].t_us < begin_us)
            k++;
        assert_true(k < got->count && got->at[k].t_us == begin_us); /* the result must contain every interval with a point in it */
    }
    if (points[0].t_us <= from_us)
        assert_true(got->count && got->at[0].t_us <= from_us);
    if (points[count - 1].t_us > to_us)
        assert_true(got->count && got->at[got->count - 1].t_us + length_us > to_us);
    for (size_t i = 0; i < got->count; i++) {
        struct history_bucket wanted = { .low = NAN, .high = NAN };
        int64_t begin_us = got->at[i].t_us, end_us = begin_us + length_us;
        for (int p = 0; p < count; p++)
            if (points[p].t_us < end_us)
                add_line(&points[p], p + 1 < count ? &points[p + 1] : NULL, series->step, begin_us, end_us, &wanted);
        assert_int_equal(got->at[i].good_us, wanted.good_us);
        assert_int_equal(got->at[i].bad_us, wanted.bad_us);
        assert_close(got->at[i].low, wanted.low);
        assert_close(got->at[i].high, wanted.high);
        if (wanted.good_us)
            assert_close(got->at[i].mean, wanted.mean / (double)wanted.good_us);
        double enters = line_at(points, count, series->step, begin_us, true);
        if (points[0].t_us < begin_us && !got->at[i].bad_us)
            assert_close(got->at[i].first, isnan(enters) ? line_at(points, count, series->step, begin_us, false) : enters);
        if (points[count - 1].t_us >= end_us)
            assert_close(got->at[i].last, line_at(points, count, series->step, end_us, true));
    }
}

/* Makes points at random times, some close together, some days apart, from October to December. */
static int make_points(struct history_point *points, int most, bool step)
{
    static const int64_t apart_s[] = { 1, 20, 300, 4000, 60000 };
    int64_t t_us = NOVEMBER - 10 * 86400 * S;
    int count = 0;
    for (; count < most && t_us < NOVEMBER + 40 * 86400 * S; count++) {
        bool bad = rand() % 12 == 0;
        points[count] = (struct history_point){ t_us, bad ? NAN : step ? rand() % 2 : rand() % 1000,
                                                bad               ? QUALITY_BAD_SENSOR_FAILURE
                                                : rand() % 6 == 0 ? QUALITY_UNCERTAIN
                                                                  : QUALITY_GOOD };
        t_us += (1 + rand() % apart_s[rand() % 5]) * S;
        if (rand() % 4 == 0) /* some points lie on full hours, as in tables from other systems */
            t_us += 3600 * S - t_us % (3600 * S);
    }
    return count;
}

/* Writes the points to the files of their months. In the last month a quarter of them is written as single rows, as the
   historian leaves new points until it packs them into blocks. */
static void write_points(struct history_setup *s, int tag, const struct history_point *points, int count)
{
    for (int i = 0, end; i < count; i = end) {
        int month = month_of(points[i].t_us);
        for (end = i; end < count && month_of(points[end].t_us) == month;)
            end++;
        struct month_file *file = open_file(s, points[i].t_us);
        int imported = end < count ? end - i : (end - i) * 3 / 4;
        assert_int_equal(month_file_import(file, tag, points + i, (size_t)imported), 0);
        for (int k = i + imported; k < end; k++)
            assert_int_equal(month_file_write(file, &(struct history_row){ tag, points[k] }, 1, NULL, 0), 0);
        month_file_close(&file);
    }
}

/* Queries for intervals of random length over random times must equal those computed from the whole line, with few or many
   points, also across the borders of months. */
CASE(intervals_are_those_of_the_line)
{
    enum { MOST = 3000 };
    srand((unsigned)sweep_seed());
    struct history_point *points = test_memory(mem_array(MOST, sizeof(*points)));
    for (int tag = 0; tag < TAGS; tag++) {
        bool step = s->tags[tag].step;
        int count = make_points(points, MOST, step);
        write_points(s, tag, points, count);
        for (int round = 0; round < sweep(2000, 200); round++) {
            struct history_series series;
            int64_t from_us = points[rand() % count].t_us + (rand() % 20000 - 10000) * S;
            if (rand() % 2)
                from_us = NOVEMBER + (rand() % 2 * 30 * 86400 + rand() % 40000 - 30000) * S;
            int64_t to_us = from_us + (1 + rand() % (rand() % 2 ? 20000 : 4000000)) * S;
            int most = 2 + rand() % 300;
            assert_int_equal(history_intervals(s->reader, s->tags[tag].name, from_us, to_us, most, &series), 0);
            int64_t least_us = (to_us - from_us) / most;
            assert_true(series.bucket_us >= least_us && series.bucket_us <= 2 * least_us + 2 * S);
            assert_true(series.buckets.count <= (size_t)most + 3);
            assert_intervals(&series, points, count, from_us, to_us);
            history_series_finish(&series);
        }
    }
}

/* A query of any length returns points if they are few enough, otherwise intervals. */
CASE(few_points_of_a_long_time_come_as_points)
{
    enum { MOST = 3000, DAY = 86400 };
    srand((unsigned)sweep_seed());
    struct history_point *points = test_memory(mem_array(MOST, sizeof(*points)));
    int count = make_points(points, MOST, false);
    write_points(s, 0, points, count);
    for (int round = 0; round < 300; round++) {
        struct history_series series;
        int64_t from_us = NOVEMBER + (rand() % (40 * DAY) - 12 * DAY) * S, to_us = from_us + (1 + rand() % (20 * DAY)) * S;
        int most = 2 + rand() % 1000, first = 0, last = count - 1;
        while (first + 1 < count && points[first + 1].t_us <= from_us)
            first++;
        while (last > first && points[last - 1].t_us > to_us)
            last--;
        int there = last - first + 1;
        assert_int_equal(history_series(s->reader, "TT-1", from_us, to_us, most, &series), 0);
        assert_int_equal(series.bucket_us == 0, there <= most + 2);
        assert_int_equal(series.points.count, there <= most + 2 ? there : 0);
        for (size_t i = 0; i < series.points.count; i++)
            assert_int_equal(series.points.at[i].t_us, points[first + (int)i].t_us);
        history_series_finish(&series);
    }
}

/* After a restart, no line connects the last point of the run before with the first point of the new one. */
CASE(a_restart_leaves_a_gap)
{
    struct snapshot *snapshot = test_snapshot(TAGS);
    int64_t ended_us;
    record(s, NOVEMBER, 100);
    struct month_file *file = open_file(s, NOVEMBER);
    assert_int_equal(month_file_recover(file, QUALITY_BAD_NO_COMMUNICATION, true, &ended_us), 0);
    assert_int_equal(ended_us, NOVEMBER + 99 * S);
    assert_int_equal(month_file_tidy(file), 0);
    assert_int_equal(month_file_import(file, 0, &(struct history_point){ NOVEMBER + 500 * S, 60, 0 }, 1), 0);
    month_file_close(&file);
    assert_int_equal(history_at(s->reader, s->tags, NOVEMBER + 99 * S, snapshot), 0);
    assert_true(fabs(snapshot->readings[0].value - wave(0, 99)) < 0.4);
    assert_int_equal(history_at(s->reader, s->tags, NOVEMBER + 300 * S, snapshot), 0);
    assert_int_equal(snapshot->readings[0].quality, QUALITY_BAD_NO_COMMUNICATION);
    assert_int_equal(history_at(s->reader, s->tags, NOVEMBER + 500 * S, snapshot), 0);
    assert_int_equal(snapshot->readings[0].quality, QUALITY_GOOD);
}

/* Gaps noted in month files must be reported in order of time and, where they overlap, as one: two in October, of which the
   longer extends into November, and one of a clock that was set forward. */
CASE(gaps_are_told_in_order_and_joined)
{
    struct history_gaps gaps;
    int64_t october = NOVEMBER - 2 * 86400 * S;
    struct month_file *file = open_file(s, october);
    assert_int_equal(month_file_note(file, october + 200 * S, "gap", "not recorded for 259200 s"), 0);
    assert_int_equal(month_file_note(file, october, "gap", "not recorded for 10 s"), 0);
    assert_int_equal(month_file_note(file, october, "gap", "not recorded for ever"), 0);
    month_file_close(&file);
    file = open_file(s, NOVEMBER);
    assert_int_equal(month_file_note(file, NOVEMBER + 86500 * S, "clock", "the clock was set forward by 200.0 s"), 0);
    assert_int_equal(month_file_note(file, NOVEMBER + 90000 * S, "clock", "the clock was set back by 200.0 s"), 0);
    month_file_close(&file);
    assert_int_equal(history_gaps(s->reader, october - S, NOVEMBER + 200000 * S, &gaps), 0);
    assert_int_equal(gaps.count, 2);
    assert_true(gaps.at[0].from_us == october && gaps.at[0].to_us == october + 10 * S);
    assert_true(gaps.at[1].from_us == october + 200 * S && gaps.at[1].to_us == NOVEMBER + 86600 * S);
    mem_free(gaps.at);
    /* asks for an hour in November within a gap that began in October and is noted in October's file */
    assert_int_equal(history_gaps(s->reader, NOVEMBER + 3600 * S, NOVEMBER + 7200 * S, &gaps), 0);
    assert_int_equal(gaps.count, 1);
    mem_free(gaps.at);
    assert_int_equal(history_gaps(s->reader, october + 20 * S, october + 30 * S, &gaps), 0);
    assert_int_equal(gaps.count, 0);
    mem_free(gaps.at);
}

static size_t count_damaged(const char *folder)
{
    char *command = test_printf("ls '%s' | grep -c 'damaged-.*sqlite$'", folder);
    FILE *pipe = popen(command, "r");
    int count = -1;
    assert_int_equal(fscanf(pipe, "%d", &count), 1);
    pclose(pipe);
    return (size_t)count;
}

CASE(a_damaged_file_is_set_aside)
{
    char *path = temp_path(s->folder, "history-2026-11.sqlite");
    static const char rubbish[20000] = "this was never a database";
    assert_int_equal(atomic_file_put(path, rubbish, sizeof(rubbish)), 0);
    record(s, NOVEMBER, 100);
    assert_int_equal(count_damaged(s->folder), 1);
    struct snapshot *snapshot = test_snapshot(TAGS);
    assert_int_equal(history_at(s->reader, s->tags, NOVEMBER + 50 * S, snapshot), 0);
    assert_int_equal(snapshot->readings[0].quality, QUALITY_GOOD);
}

/* A damaged page in the middle of a file is noticed when a query reads it. */
CASE(damage_inside_is_noticed)
{
    char *path = temp_path(s->folder, "history-2026-11.sqlite");
    record(s, NOVEMBER, 40000);
    FILE *file = fopen(path, "r+b");
    static const char rubbish[4096] = { 1, 2, 3 };
    fseek(file, 0, SEEK_END);
    long pages = ftell(file) / 4096;
    assert_true(pages > 20);
    /* leaves the first 12 pages intact: they hold the roots of tables, where damage would be noticed when the file is opened */
    for (long page = 12; page < pages; page++) {
        fseek(file, page * 4096, SEEK_SET);
        assert_int_equal(fwrite(rubbish, sizeof(rubbish), 1, file), 1);
    }
    fclose(file);
    int error = 0, row_error = 0;
    struct month_file *again = month_file_open(s->log, s->folder, month_of(NOVEMBER), s->tags, TAGS, &error);
    for (int i = 0; again && !row_error && i < 40; i++)
        row_error = month_file_import(again, i % 2, &(struct history_point){ NOVEMBER + i * 1000 * S, 1, 0 }, 1);
    if (again) {
        assert_int_equal(row_error, -EBADMSG);
        month_file_set_aside(&again);
    }
    assert_int_equal(count_damaged(s->folder), 1);
    record(s, NOVEMBER + 50000 * S, 100);
}

CASE(a_newer_version_is_left_alone)
{
    char *path = temp_path(s->folder, "history-2026-11.sqlite"), *command;
    record(s, NOVEMBER, 10);
    command = test_printf("/usr/bin/python3 -c \"import sqlite3; sqlite3.connect('%s').execute('PRAGMA user_version = 99')\"", path);
    assert_int_equal(system(command), 0);
    int error;
    assert_null(month_file_open(s->log, s->folder, month_of(NOVEMBER), s->tags, TAGS, &error));
    assert_int_equal(error, -DATABASE_NEWER);
    assert_int_equal(count_damaged(s->folder), 0);
}

/* The exact statements with which version 1 created the tables of a month file. */
static const char version_1[] =
    "CREATE TABLE tag(id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE, unit TEXT NOT NULL, step INTEGER NOT NULL, within REAL NOT NULL);"
    "CREATE TABLE sample(tag INTEGER NOT NULL, t INTEGER NOT NULL, v REAL, q INTEGER NOT NULL, PRIMARY KEY(tag, t)) WITHOUT ROWID;"
    "CREATE TABLE recent(tag INTEGER NOT NULL, t INTEGER NOT NULL, v REAL, q INTEGER NOT NULL);"
    "CREATE TABLE held(tag INTEGER PRIMARY KEY, t INTEGER NOT NULL, v REAL, q INTEGER NOT NULL);"
    "CREATE TABLE rollup(level_s INTEGER NOT NULL, tag INTEGER NOT NULL, t INTEGER NOT NULL, low REAL, high REAL, mean REAL,"
    " first REAL, last REAL,"
    " good_us INTEGER NOT NULL, bad_us INTEGER NOT NULL, q INTEGER NOT NULL, PRIMARY KEY(level_s, tag, t)) WITHOUT ROWID;"
    "CREATE TABLE event(t INTEGER NOT NULL, kind TEXT NOT NULL, text TEXT NOT NULL);"
    "CREATE VIEW history AS SELECT name AS tag, strftime('%Y-%m-%dT%H:%M:%fZ', s.t / 1e6, 'unixepoch') AS utc, s.v AS value, unit,"
    " printf('0x%08X', s.q) AS quality FROM (SELECT * FROM sample UNION ALL SELECT * FROM recent UNION ALL SELECT * FROM held) s"
    " JOIN tag ON tag.id = s.tag;"
    "INSERT INTO tag VALUES(7, 'TT-1', 'K', 0, 0.4), (9, 'XS-1', '', 1, 0), (11, 'GONE', 'bar', 0, 1);"
    "INSERT INTO sample VALUES(7, 1793491200000000, 10, 0), (7, 1793491210000000, 30, 0), (7, 1793491220000000, NULL, 2147811328),"
    " (9, 1793491200000000, 1, 0), (11, 1793491201000000, 5, 0);"
    "INSERT INTO recent VALUES(7, 1793491230000000, 12, 0), (7, 1793491240000000, 14, 0);"
    "INSERT INTO held VALUES(7, 1793491240000000, 14, 0), (9, 1793491241000000, 1, 0);"
    "INSERT INTO rollup VALUES(10, 11, 1793491200000000, 5, 5, 5, 5, 5, 1000000, 0, 0);"
    "INSERT INTO event VALUES(1793491200000000, 'gap', 'not recorded for 3 s');"
    "PRAGMA user_version = 1; PRAGMA application_id = 1346586697; PRAGMA journal_mode = WAL;";

/* Runs an SQL query and asserts that its rows, joined into one text, equal `wanted`. */
static void assert_rows(sqlite3 *db, const char *query, const char *wanted)
{
    struct text *found = test_text();
    sqlite3_stmt *s;
    assert_int_equal(sqlite3_prepare_v2(db, query, -1, &s, NULL), SQLITE_OK);
    text_add(found, "%s", "");
    while (sqlite3_step(s) == SQLITE_ROW)
        for (int i = 0, n = sqlite3_column_count(s); i < n; i++)
            text_add(found, "%s%s", sqlite3_column_text(s, i) ? (const char *)sqlite3_column_text(s, i) : "-", i + 1 < n ? " " : "; ");
    sqlite3_finalize(s);
    assert_string_equal(found->at, wanted);
}

static void check_contents(sqlite3 *db)
{
    assert_rows(db, "SELECT * FROM tag WHERE id > 7 ORDER BY id", "9 XS-1  1 0.0; 11 GONE bar 0 1.0; ");
    assert_rows(db, "SELECT t / 1000000 - 1793491200, v, q FROM (SELECT * FROM sample UNION SELECT * FROM recent) WHERE tag = 7 ORDER BY t",
                "0 10.0 0; 10 30.0 0; 20 - 2147811328; 30 12.0 0; 40 14.0 0; ");
    assert_rows(db, "SELECT tag, v, q FROM held", "7 14.0 0; 9 1.0 0; ");
    assert_rows(db, "SELECT level_s, tag, low, bad_us FROM rollup WHERE tag = 11", "10 11 5.0 0; ");
    assert_rows(db, "SELECT kind, text FROM event", "gap not recorded for 3 s; ");
}

/* A file of an older version can be read as it is. A writer upgrades it with all its content, then appends. */
CASE(an_older_version_is_read_and_brought_up)
{
    char *path = temp_path(s->folder, "history-2026-11.sqlite");
    struct snapshot *snapshot = test_snapshot(TAGS);
    sqlite3 *db = open_database(path);
    assert_int_equal(sqlite3_exec(db, version_1, NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(history_at(s->reader, s->tags, NOVEMBER + 5 * S, snapshot), 0);
    assert_true(snapshot->readings[0].value == 20);
    assert_rows(db, "PRAGMA user_version", "1; ");
    /* in files of version 1, the view `history` returns the newest point twice: 6 rows for 5 points */
    assert_rows(db, "SELECT count(*) FROM history WHERE tag = 'TT-1'", "6; ");
    struct month_file *file = open_file(s, NOVEMBER);
    assert_rows(db, "PRAGMA user_version", "3; ");
    assert_rows(db, "SELECT count(*) FROM sqlite_master WHERE name = 'history'", "0; "); /* SQL cannot read compressed points */
    check_contents(db);
    const struct history_row next = { 0, { NOVEMBER + 60 * S, 34, QUALITY_GOOD } };
    assert_int_equal(month_file_write(file, &next, 1, NULL, 0), 0);
    assert_int_equal(month_file_tidy(file), 0);
    month_file_close(&file);
    assert_rows(db, "SELECT id FROM tag WHERE name = 'TT-1'", "7; ");
    for (int i = 0; i < 2; i++) { /* a reader that was opened before the upgrade must read the upgraded file */
        assert_int_equal(history_at(s->reader, s->tags, NOVEMBER + (i ? 50 : 35) * S, snapshot), 0);
        assert_true(snapshot->readings[0].value == (i ? 24 : 13));
    }
    assert_int_equal(count_damaged(s->folder), 0);
    sqlite3_close(db);
}

static int refuse_views(void *arg, int action, const char *a, const char *b, const char *c, const char *d)
{
    (void)arg, (void)a, (void)b, (void)c, (void)d;
    return action == SQLITE_CREATE_VIEW ? SQLITE_DENY : SQLITE_OK;
}

static int on_open(sqlite3 *db, const char **error, const void *api)
{
    (void)error, (void)api;
    return sqlite3_set_authorizer(db, refuse_views, NULL);
}

/* If an upgrade fails midway, the file of the old version stays intact. */
CASE(what_cannot_be_brought_up_stays_as_it_was)
{
    char *path = temp_path(s->folder, "history-2026-11.sqlite");
    int error;
    sqlite3 *db = open_database(path);
    assert_int_equal(sqlite3_exec(db, version_1, NULL, NULL, NULL), SQLITE_OK);
    sqlite3_auto_extension((void (*)(void))on_open);
    assert_null(month_file_open(s->log, s->folder, month_of(NOVEMBER), s->tags, TAGS, &error));
    sqlite3_reset_auto_extension();
    assert_rows(db, "PRAGMA user_version", "1; ");
    assert_rows(db, "SELECT count(*) FROM history WHERE tag = 'TT-1'", "6; ");
    check_contents(db);
    sqlite3_close(db);
}

static void make_month(const struct history_setup *s, const char *name, size_t bytes)
{
    char *content = test_memory(mem_array(bytes, 1));
    temp_write(s->folder, name, content, bytes);
}

CASE(old_and_large_months_go)
{
    size_t count;
    for (int m = 1; m <= 9; m++) {
        char *name = test_printf("history-2026-%02d.sqlite", m);
        make_month(s, name, 1000);
    }
    /* With a limit of 100 days, months that ended before 24 July are deleted on 1 November. */
    int64_t unsent;
    assert_int_equal(retention_apply(s->log, s->folder, &(struct retention_limits){ .days = 100 }, NOVEMBER, &unsent), 3000);
    int *months = month_list(s->folder, &count);
    assert_int_equal(count, 3);
    assert_int_equal(months[0], month_of(NOVEMBER) - 4);
    mem_free(months);
    assert_int_equal(retention_apply(s->log, s->folder, &(struct retention_limits){ .bytes = 2500 }, NOVEMBER, &unsent), 2000);
    /* the newest stays */
    assert_int_equal(retention_apply(s->log, s->folder, &(struct retention_limits){ .bytes = 1 }, NOVEMBER, &unsent), 1000);
    months = month_list(s->folder, &count);
    assert_int_equal(count, 1);
    assert_int_equal(months[0], month_of(NOVEMBER) - 2);
    mem_free(months);
}

/* After a jump of the clock by more than a week, nothing is deleted for its age for a week of running, also if the jump was made
   while the daemon did not run, or if the daemon starts again after it. */
CASE(a_jump_of_the_clock_deletes_nothing_for_a_week)
{
    const int64_t week_us = 7 * 86400 * S, jump_us = month_begin_us(month_of(NOVEMBER) + 25), now_us = NOVEMBER + 100 * S;
    struct retention_clock stopped = { 0 }, again = { 0 }, running = { 0 };
    record(s, NOVEMBER, 100);
    assert_true(retention_by_age(&running, s->log, s->folder, 0, now_us * 1000));
    assert_true(retention_by_age(&running, s->log, s->folder, week_us * 1000, (now_us + 2 * week_us - S) * 1000)); /* a small step */
    assert_false(retention_by_age(&running, s->log, s->folder, week_us * 1000, jump_us * 1000));
    assert_false(retention_by_age(&running, s->log, s->folder, (2 * week_us - S) * 1000, (jump_us + week_us - S) * 1000));
    assert_true(retention_by_age(&running, s->log, s->folder, 2 * week_us * 1000, (jump_us + week_us) * 1000));
    assert_false(retention_by_age(&stopped, s->log, s->folder, 0, jump_us * 1000)); /* before the first point after the jump */
    record(s, jump_us, 100);
    assert_false(retention_by_age(&again, s->log, s->folder, 0, (jump_us + 100 * S) * 1000));
    assert_true(retention_by_age(&(struct retention_clock){ 0 }, s->log, s->folder, 0, now_us * 1000)); /* the clock was set back */
    assert_true(retention_by_age(&again, s->log, s->folder, week_us * 1000, (jump_us + 100 * S + week_us) * 1000));
}

/* The clock jumps at the end of a month, and the daemon starts again at the beginning of the next. */
CASE(a_jump_before_the_end_of_a_month_deletes_nothing_for_a_week)
{
    const int64_t day_us = 86400 * S, border_us = month_begin_us(month_of(NOVEMBER) + 25);
    record(s, NOVEMBER, 100);
    record(s, border_us - day_us, 100);
    record(s, border_us, 100);
    struct retention_clock clock = { 0 };
    assert_false(retention_by_age(&clock, s->log, s->folder, 0, (border_us + 5 * day_us) * 1000));
    assert_int_equal(clock.pause_from_us, NOVEMBER + 99 * S);
    assert_int_equal(clock.pause_to_us, border_us - day_us);
    assert_true(retention_by_age(&(struct retention_clock){ 0 }, s->log, s->folder, 0, (border_us + 6 * day_us + S) * 1000));
}

/* --- deleting the beginning of a month that alone is too large ----------------------------------------------------------------- */

enum { LOT = 60000 };
static const int64_t LIMIT = 700000;

/* Records LOT points of two tags, one per second. No point lies on the line between its neighbours, so none can be left out. */
static void record_a_lot(struct history_setup *s, int64_t from_us)
{
    int error;
    struct month_file *file = month_file_open(s->log, s->folder, month_of(from_us), s->tags, TAGS, &error);
    struct history_row *rows = mem_array(2 * LOT, sizeof(*rows));
    assert_non_null(file);
    for (int i = 0; i < 2 * LOT; i++)
        rows[i] = (struct history_row){ i % 2, { from_us + i / 2 * US_PER_S, (double)rand() / RAND_MAX, QUALITY_GOOD } };
    for (int i = 0; i < 2 * LOT; i += LOT / 6) {
        assert_int_equal(month_file_write(file, rows + i, LOT / 6, NULL, 0), 0);
        assert_int_equal(month_file_tidy(file), 0);
    }
    month_file_close(&file);
    mem_free(rows);
}

static int64_t size_of_month(const struct history_setup *s, int64_t t_us)
{
    struct stat st;
    char name[MONTH_NAME_BYTES];
    month_name(month_of(t_us), name);
    char *path = temp_path(s->folder, name);
    int64_t size = stat(path, &st) == 0 ? st.st_size : 0;
    return size;
}

static void apply_for_some_minutes(struct history_setup *s, int64_t limit, int64_t now_us)
{
    int64_t unsent;
    for (int minute = 0; minute < 10; minute++)
        retention_apply(s->log, s->folder, &(struct retention_limits){ .bytes = (double)limit }, now_us, &unsent);
}

static void check_what_is_left(struct history_setup *s, int64_t last_us)
{
    struct history_reader *reader = history_reader_create(s->log, s->folder);
    struct history_series series;
    int64_t first_us, end_us;
    assert_true(history_span(reader, &first_us, &end_us));
    printf("# %.1f h of history are left\n", (double)(end_us - first_us) / US_PER_S / 3600);
    assert_int_equal(end_us, last_us);
    assert_true(end_us - first_us > 5 * 3600 * US_PER_S);
    assert_int_equal(history_series(reader, s->tags[0].name, last_us - 3600 * US_PER_S, last_us, 1000000, &series), 0);
    assert_true(series.points.count >= 3600);
    history_series_finish(&series);
    history_reader_destroy(&reader);
}

/* A single month grows to three times the allowed size: it must lose its oldest points and keep the newest, and must not exceed
   the limit by much at any time. */
CASE(a_month_that_is_too_large_loses_its_beginning)
{
    int64_t from_us = NOVEMBER;
    for (int day = 0; day < 4; day++, from_us += LOT * US_PER_S) {
        record_a_lot(s, from_us);
        printf("# %.1f MB\n", (double)size_of_month(s, NOVEMBER) / 1e6);
        if (day > 0)
            assert_true(size_of_month(s, NOVEMBER) < LIMIT * 3); /* a simulated day takes twice the allowed size */
        apply_for_some_minutes(s, LIMIT, from_us);
    }
    int64_t large = size_of_month(s, NOVEMBER);
    /* new points use the space within the file that deleting the oldest ones has freed, so the file hardly grows */
    record_a_lot(s, from_us);
    assert_true(size_of_month(s, NOVEMBER) < large + LIMIT);
    apply_for_some_minutes(s, LIMIT, from_us);
    check_what_is_left(s, from_us + (LOT - 1) * US_PER_S);
}

/* In December, November's file is too large: it must not be deleted at once, but lose its oldest points as far as the limit
   requires. */
CASE(a_month_that_is_over_shrinks)
{
    int64_t december_us = month_begin_us(month_of(NOVEMBER) + 1);
    int error;
    record_a_lot(s, NOVEMBER);
    struct month_file *file = month_file_open(s->log, s->folder, month_of(december_us), s->tags, TAGS, &error);
    assert_non_null(file);
    struct history_row row = { 0, { december_us, 1, QUALITY_GOOD } };
    assert_int_equal(month_file_write(file, &row, 1, NULL, 0), 0);
    month_file_close(&file);
    assert_true(size_of_month(s, NOVEMBER) > LIMIT);
    /* halves the limit repeatedly: the file must shrink below each one, first by giving up unused space, then by deleting
       points */
    for (int64_t limit = LIMIT; limit > LIMIT / 4; limit /= 2) {
        apply_for_some_minutes(s, limit, december_us);
        int64_t left = size_of_month(s, NOVEMBER);
        printf("# %.1f MB\n", (double)left / 1e6);
        assert_true(left < limit && left > limit / 2);
    }
}

/* While another process locks November's file, its oldest points cannot be deleted. The month must not be deleted instead. */
CASE(a_locked_month_is_not_deleted)
{
    int64_t december_us = month_begin_us(month_of(NOVEMBER) + 1), unsent;
    record_a_lot(s, NOVEMBER);
    record(s, december_us, 100);
    int64_t bytes = size_of_month(s, NOVEMBER);
    sqlite3 *db = open_database(temp_path(s->folder, "history-2026-11.sqlite"));
    assert_int_equal(sqlite3_exec(db, "BEGIN IMMEDIATE", NULL, NULL, NULL), SQLITE_OK);
    retention_apply(s->log, s->folder, &(struct retention_limits){ .bytes = (double)bytes }, december_us + 100 * S, &unsent);
    assert_int_equal(size_of_month(s, NOVEMBER), bytes);
    sqlite3_close(db);
    apply_for_some_minutes(s, bytes, december_us + 100 * S);
    assert_in_range(size_of_month(s, NOVEMBER), bytes / 2, bytes - 1);
}

/* keep_gb limits the history's size. The estimate of how many days fit is given once there is a day of history; before, it is
   infinite. */
CASE(the_days_that_fit_are_estimated)
{
    record_a_lot(s, NOVEMBER);
    struct retention_limits limits = { .days = 100, .bytes = 1e9 };
    assert_true(isinf(retention_check(s->log, s->folder, &limits)));
    record_a_lot(s, NOVEMBER + LOT * US_PER_S);
    limits.bytes = 10 * (double)size_of_month(s, NOVEMBER);
    double days = retention_check(s->log, s->folder, &limits), recorded_days = 2.0 * LOT / 86400;
    assert_true(days > 9.5 * recorded_days && days < 12 * recorded_days);
}

/* --- samples waiting to be sent to another database ----------------------------------------------------------------------------- */

static int64_t waiting_in(const struct history_setup *s, int month)
{
    int error;
    int64_t count = 0;
    struct month_outbox *outbox = month_outbox_open(s->log, s->folder, month, &error);
    if (outbox)
        assert_int_equal(month_outbox_count(outbox, &count), 0);
    month_outbox_close(&outbox);
    return count;
}

/* Records `count` points in the month of from_us, one per second, all waiting to be sent. */
static void record_to_send(struct history_setup *s, int64_t from_us, size_t count)
{
    int error;
    struct month_file *file = month_file_open(s->log, s->folder, month_of(from_us), s->tags, TAGS, &error);
    struct history_row *rows = mem_array(count, sizeof(*rows));
    assert_non_null(file);
    assert_int_equal(month_file_use_outbox(file), 0);
    for (size_t i = 0; i < count; i++)
        rows[i] = (struct history_row){ 0, { from_us + (int64_t)i * US_PER_S, (double)(i * 7919 % 1009), QUALITY_GOOD } };
    assert_int_equal(month_file_write(file, rows, count, NULL, 0), 0);
    assert_int_equal(month_file_tidy(file), 0);
    month_file_close(&file);
    mem_free(rows);
}

CASE(months_wait_for_what_is_to_be_sent)
{
    int november = month_of(NOVEMBER);
    int64_t march_us = month_begin_us(november + 4), unsent;
    size_t count;
    record_to_send(s, NOVEMBER, 100);
    record_to_send(s, month_begin_us(november + 1), 20000);
    record_to_send(s, march_us, 10);
    struct retention_limits limits = { .days = 30, .bytes = 1e9, .sends = true };
    retention_apply(s->log, s->folder, &limits, march_us, &unsent);
    assert_int_equal(unsent, 0);
    assert_int_equal(waiting_in(s, november), 100); /* too old, and room enough */
    int error;
    struct month_outbox *outbox = month_outbox_open(s->log, s->folder, november, &error);
    assert_int_equal(month_outbox_shorten(outbox, 0), 0);
    month_outbox_close(&outbox);
    retention_apply(s->log, s->folder, &limits, march_us, &unsent);
    assert_int_equal(unsent, 0);
    mem_free(month_list(s->folder, &count));
    assert_int_equal(count, 2); /* two of the three month files are left: the one whose points had all been sent was deleted for its age */
    /* a month file above the size limit loses its oldest points; `unsent` counts those that had not been sent to the database
       */
    int64_t waiting = waiting_in(s, november + 1), lost = 0;
    assert_int_equal(waiting, 20000);
    limits.bytes = (double)size_of_month(s, month_begin_us(november + 1)) * 0.7;
    for (int minute = 0; minute < 10; minute++) {
        retention_apply(s->log, s->folder, &limits, march_us, &unsent);
        lost += unsent;
    }
    printf("# %lld of 20000 points went unsent\n", (long long)lost);
    assert_in_range(lost, 1000, 19000);
    assert_int_equal(waiting_in(s, november + 1), 20000 - lost);
    /* a limit of 1 byte deletes everything up to the present month */
    limits.bytes = 1;
    retention_apply(s->log, s->folder, &limits, march_us, &unsent);
    assert_int_equal(unsent, 20000 - lost);
    mem_free(month_list(s->folder, &count));
    assert_int_equal(count, 1);
    /* the plant file names no database, so points that wait to be sent do not protect a month from deletion */
    record_to_send(s, NOVEMBER, 100);
    retention_apply(s->log, s->folder, &(struct retention_limits){ .days = 30 }, march_us, &unsent);
    assert_int_equal(unsent, 0);
    mem_free(month_list(s->folder, &count));
    assert_int_equal(count, 1);
}

/* A month file that cannot be read may hold unsent points, so it is not deleted for its age. */
CASE(months_that_cannot_be_read_are_not_too_old)
{
    int64_t march_us = month_begin_us(month_of(NOVEMBER) + 4), unsent;
    size_t count;
    char name[MONTH_NAME_BYTES];
    record_to_send(s, march_us, 10);
    month_name(month_of(NOVEMBER), name);
    char *path = temp_path(s->folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("this is no database, but long enough to be taken for one at first sight: its head would have a hundred bytes at least\n", file);
    fclose(file);
    retention_apply(s->log, s->folder, &(struct retention_limits){ .days = 30, .bytes = 1e9, .sends = true }, march_us, &unsent);
    mem_free(month_list(s->folder, &count));
    assert_int_equal(count, 2);
    assert_int_equal(unsent, 0);
    retention_apply(s->log, s->folder, &(struct retention_limits){ .days = 30, .bytes = 1e9 }, march_us, &unsent);
    mem_free(month_list(s->folder, &count));
    assert_int_equal(count, 1);
}

/* When a tag's unit changes, points waiting to be sent are converted, too, also by processes that send nothing: an import, or a
   daemon whose plant file names no database any more. */
CASE(what_waits_is_converted_with_the_rest)
{
    int error;
    struct history_tag kelvin = { "TT-9", "K", false, 0, INT64_MAX }, celsius = { "TT-9", "degC", false, 0, INT64_MAX };
    struct month_file *file = month_file_open(s->log, s->folder, month_of(NOVEMBER), &kelvin, 1, &error);
    struct history_row row = { 0, { NOVEMBER, 373.15, QUALITY_GOOD } };
    assert_int_equal(month_file_use_outbox(file), 0);
    assert_int_equal(month_file_write(file, &row, 1, NULL, 0), 0);
    month_file_close(&file);
    file = month_file_open(s->log, s->folder, month_of(NOVEMBER), &celsius, 1, &error);
    row.point = (struct history_point){ NOVEMBER + US_PER_S, 50, QUALITY_GOOD };
    assert_int_equal(month_file_write(file, &row, 1, NULL, 0), 0);
    month_file_close(&file);
    struct month_outbox_batch batch = { 0 };
    struct month_outbox *outbox = month_outbox_open(s->log, s->folder, month_of(NOVEMBER), &error);
    assert_int_equal(month_outbox_read(outbox, 10, &batch), 0);
    assert_int_equal(batch.row_count, 1);
    assert_string_equal(batch.tags[0].unit, "degC");
    assert_float_equal(batch.rows[0].point.value, 100, 1e-4);
    month_outbox_batch_finish(&batch);
    month_outbox_close(&outbox);
}

/* --- changes of unit that cannot be converted --------------------------------------------------------------------------------- */

/* Writes `count` points, one per second, to the month file, as the historian does while TT-1 has this unit. sends: also to the
   outbox for another database */
static void write_in_unit(struct history_setup *s, const char *unit, int64_t t_us, double value, int count, bool sends)
{
    int error;
    struct history_tag tag = { "TT-1", unit, false, 0, INT64_MAX };
    struct month_file *file = month_file_open(s->log, s->folder, month_of(t_us), &tag, 1, &error);
    assert_non_null(file);
    assert_int_equal(sends ? month_file_use_outbox(file) : 0, 0);
    for (int i = 0; i < count; i++) {
        struct history_row row = { 0, { t_us + i * S, value + i, QUALITY_GOOD } };
        assert_int_equal(month_file_write(file, &row, 1, NULL, 0), 0);
    }
    assert_int_equal(month_file_tidy(file), 0);
    month_file_close(&file);
}

/* Reads TT-1 like a plant in which TT-1 has this unit. Returns the lines of the log. */
static char *read_in_unit(struct history_setup *s, const char *unit, int64_t to_us, int max_points, struct history_series *series)
{
    mem_free(s->plant->tags[0].unit);
    s->plant->tags[0].unit = mem_strdup(unit);
    char *said = temp_path(s->folder, "said");
    size_t bytes;
    int kept = dup(STDERR_FILENO), to = open(said, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    assert_true(kept >= 0 && to >= 0 && dup2(to, STDERR_FILENO) >= 0);
    struct log *log = log_create(LOG_WARN);
    struct history_reader *reader = history_reader_create(log, s->folder);
    history_reader_show_by(reader, s->plant);
    int error = history_series(reader, "TT-1", NOVEMBER, to_us, max_points, series);
    history_series_finish(series);
    error = error ? error : history_series(reader, "TT-1", NOVEMBER, to_us, max_points, series);
    history_reader_destroy(&reader);
    log_destroy(&log);
    dup2(kept, STDERR_FILENO);
    close(kept);
    close(to);
    assert_int_equal(error, 0);
    test_series(series);
    char *text = test_memory(text_read_file(said, 1 << 20, &bytes));
    assert_non_null(text);
    return text;
}

CASE(points_of_another_quantity_are_left_out)
{
    static const char *const changes[][2] = { { "kPa", "°C" }, { "bar", "psig" }, { "pcs", "widgets" } };
    for (size_t c = 0; c < sizeof(changes) / sizeof(*changes); c++) {
        const char *before = changes[c][0], *after = changes[c][1];
        struct history_series series;
        write_in_unit(s, before, NOVEMBER, 100, 3, true);
        /* the plant says the new unit, but all recorded points are in the old one, so none is returned */
        char *said = read_in_unit(s, after, NOVEMBER + 100 * S, 1000, &series);
        assert_int_equal(series.points.count, 0);
        char *line = test_printf("TT-1: 3 points in '%s' are left out, because '%s' cannot be converted to '%s'", before, before, after);
        char *first = strstr(said, line);
        assert_non_null(first);
        assert_null(strstr(first + 1, line)); /* the second query says nothing */
        /* writes a point in the new unit: the file now has points in both */
        write_in_unit(s, after, NOVEMBER + 10 * S, 20, 1, true);
        said = read_in_unit(s, after, NOVEMBER + 100 * S, 1000, &series);
        assert_non_null(strstr(said, line));
        assert_int_equal(series.points.count, 1);
        assert_float_equal(series.points.at[0].value, 20, 0);
        assert_int_equal(history_intervals(s->reader, "TT-1", NOVEMBER, NOVEMBER + 3600 * S, 2, &series), 0);
        assert_int_equal(series.buckets.count, 1);
        assert_float_equal(series.buckets.at[0].high, 20, 0);
        history_series_finish(&series);
        struct history_tag tag = { "TT-1", after, false, 0, INT64_MAX };
        struct snapshot *snapshot = test_snapshot(1);
        assert_int_equal(history_at(s->reader, &tag, NOVEMBER + 5 * S, snapshot), 0);
        assert_int_equal(snapshot->readings[0].quality, QUALITY_BAD_WAITING);
        /* the outbox lists the tag twice, once for each unit */
        struct month_outbox_batch batch = { 0 };
        int error;
        struct month_outbox *outbox = month_outbox_open(s->log, s->folder, month_of(NOVEMBER), &error);
        assert_int_equal(month_outbox_read(outbox, 100, &batch), 0);
        assert_int_equal(batch.tag_count, 2);
        for (size_t i = 0; i < batch.tag_count; i++) {
            assert_string_equal(batch.tags[i].name, "TT-1");
            assert_string_equal(batch.tags[i].unit, changes[c][batch.tags[i].id == batch.rows[4].tag]);
        }
        /* three points in the old unit, a point without a value that ends their line, and one point in the new unit */
        assert_int_equal(batch.row_count, 5);
        month_outbox_batch_finish(&batch);
        month_outbox_close(&outbox);
        /* The plant has the old unit again: its points are returned, and a point without a value separates those before the
           change from the new one. */
        write_in_unit(s, before, NOVEMBER + 20 * S, 110, 1, false);
        read_in_unit(s, before, NOVEMBER + 100 * S, 1000, &series);
        assert_int_equal(series.points.count, 5);
        assert_true(series.points.at[2].value == 102 && isnan(series.points.at[3].value) && series.points.at[4].value == 110);
        char name[MONTH_NAME_BYTES];
        month_name(month_of(NOVEMBER), name);
        assert_int_equal(unlink(temp_path(s->folder, name)), 0);
    }
}

/* Imports a point while another handle records TT-1 in °C. This handle knows another unit of TT-1, and may be of a plant whose tag
   list was changed after the daemon read it. */
static void import_in_unit(struct history_setup *s, const char *unit, int64_t t_us, double value)
{
    int error;
    struct history_tag tag = { "TT-1", unit, false, 0, INT64_MAX };
    struct month_file *file = month_file_open(s->log, s->folder, month_of(t_us), &tag, 1, &error);
    assert_non_null(file);
    assert_int_equal(month_file_use_outbox(file), 0);
    assert_int_equal(month_file_import(file, 0, &(struct history_point){ t_us, value, QUALITY_GOOD }, 1), 0);
    month_file_close(&file);
}

static void assert_values(struct history_setup *s, const char *unit, const double *values, size_t count)
{
    struct history_series series;
    read_in_unit(s, unit, NOVEMBER + 100 * S, 1000, &series);
    assert_int_equal(series.points.count, count);
    for (size_t i = 0; i < count; i++)
        assert_float_equal(series.points.at[i].value, values[i], 1e-9);
}

CASE(an_import_keeps_the_unit_that_is_recorded)
{
    int error;
    struct history_tag tag = { "TT-1", "°C", false, 0, INT64_MAX };
    struct month_file *file = month_file_open(s->log, s->folder, month_of(NOVEMBER), &tag, 1, &error);
    struct history_row row = { 0, { NOVEMBER + 10 * S, 20, QUALITY_GOOD } };
    assert_non_null(file);
    assert_int_equal(month_file_write(file, &row, 1, NULL, 0), 0);
    import_in_unit(s, "°F", NOVEMBER, 212);
    row.point.t_us += S;
    assert_int_equal(month_file_write(file, &row, 1, NULL, 0), 0);
    import_in_unit(s, "bar", NOVEMBER + S, 5);
    import_in_unit(s, "kg", NOVEMBER + 2 * S, 7);
    import_in_unit(s, "kPa", NOVEMBER + 3 * S, 600);
    row.point.t_us += S;
    assert_int_equal(month_file_write(file, &row, 1, NULL, 0), 0);
    assert_int_equal(month_file_tidy(file), 0);
    month_file_close(&file);
    assert_values(s, "°C", (double[]){ 100, 20, 20, 20 }, 4);
    assert_values(s, "bar", (double[]){ 5, 6 }, 2);
    assert_values(s, "kg", (double[]){ 7 }, 1);
    struct month_outbox_batch batch = { 0 };
    struct month_outbox *outbox = month_outbox_open(s->log, s->folder, month_of(NOVEMBER), &error);
    assert_int_equal(month_outbox_read(outbox, 100, &batch), 0);
    assert_int_equal(batch.row_count, 4);
    assert_float_equal(batch.rows[0].point.value, 100, 1e-9);
    assert_float_equal(batch.rows[3].point.value, 6, 1e-9);
    month_outbox_batch_finish(&batch);
    month_outbox_close(&outbox);
    /* the daemon reloads the changed tag list */
    write_in_unit(s, "°F", NOVEMBER + 13 * S, 70, 1, false);
    assert_values(s, "°F", (double[]){ 212, 68, 68, 68, 70 }, 5);
    write_in_unit(s, "bar", NOVEMBER + 14 * S, 8, 1, false);
    assert_values(s, "bar", (double[]){ 5, 6, 8 }, 3);
    /* a unit that looks like the id of a series: "1" is that of fractions */
    import_in_unit(s, "1", NOVEMBER + 4 * S, 0.5);
    write_in_unit(s, "1", NOVEMBER + 15 * S, 0.25, 1, false);
    assert_values(s, "1", (double[]){ 0.5, 0.25 }, 2);
}

CASE(a_unit_stated_later_keeps_the_points)
{
    struct history_series series;
    write_in_unit(s, "", NOVEMBER, 100, 3, false);
    write_in_unit(s, "°C", NOVEMBER + 10 * S, 103, 1, false);
    char *said = read_in_unit(s, "°C", NOVEMBER + 100 * S, 1000, &series);
    assert_string_equal(said, "");
    assert_int_equal(series.points.count, 4);
}

CASE(a_spool_is_read_in_the_present_units)
{
    char *path = temp_path(s->folder, "spool");
    struct history_row row = { 1, { NOVEMBER, 2, QUALITY_GOOD } };
    struct spool_rows rows = { .kept = { &row, 1, 1 } }, back = { 0 };
    size_t foreign = 0;
    s->plant->tags[1].unit = mem_strdup("kgf/cm2");
    assert_int_equal(spool_write(path, s->plant, &rows), 0);
    mem_free(s->plant->tags[1].unit);
    s->plant->tags[1].unit = mem_strdup("kPa");
    assert_int_equal(spool_read(path, s->plant, &back, &foreign), 0);
    assert_true(foreign == 0 && back.kept.count == 1);
    assert_float_equal(back.kept.at[0].point.value, 196.133, 1e-6);
    mem_free(s->plant->tags[1].unit);
    s->plant->tags[1].unit = mem_strdup("°C");
    assert_int_equal(spool_read(path, s->plant, &back, &foreign), 0);
    assert_true(foreign == 1 && back.kept.count == 1);
    mem_free(back.kept.at);
}
