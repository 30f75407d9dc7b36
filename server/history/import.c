/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Imports a CSV file of samples. Reads it twice: first to find all errors and the spacing of each tag's samples, then to record
   the samples in the history files of their months. */
#include "history/import.h"

#include <ctype.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/math/search.h"
#include "base/mem.h"
#include "base/text/text.h"
#include "history/history.h"
#include "history/month.h"
#include "history/recorder.h"
#include "history/spacing.h"
#include "base/text/timestamp.h"
#include "plant/parse/csv.h"
#include "plant/parse/number.h"
#include "value/quality.h"
#include "value/state_word.h"

enum {
    FLUSH_ROWS = 500000,
    MAX_ERRORS = 50,
    /* If two samples are farther apart than this multiple of the series' median time between samples, the time between them is
       a gap. */
    MEDIANS = 10
};

/* State of importing one tag's samples from the file. */
struct import_series {
    bool has_row;   /* true: the current pass over the CSV file has already read a row of this tag */
    int64_t row_us; /* time of this tag's last row in the current pass over the CSV file */
    bool seen;      /* true: the first pass found samples of this tag */
    int64_t first_us, last_us;
    struct spacing spacing;
    /* longest time in microseconds between two samples of this tag that is not a gap; after a gap the tag's value is unknown
       until the next sample */
    int64_t longest_us;
    /* true: `pending` holds the newest sample of the tag in the second pass. It is recorded once a later sample was read,
       because another row with the same time would replace it */
    bool has_pending;
    struct history_point pending;
    struct history_points before; /* points of this tag that history already had in the time span of the imported samples */
    size_t next;                  /* index in `before` of the first point that is not older than the current imported sample */
};

struct history_import {
    const struct import_params *params;
    struct csv csv;
    /* column indices in the CSV file; -1: no such column. tag -1: the file has the wide form (one column per tag) */
    int time, tag, value, quality, unit;
    int *tags;                    /* wide form: tag index of each column; -1: not a tag's column, ignored */
    struct import_series *series; /* [tag]: series of the tag's samples in the imported file, and the state of reading it */
    /* wide form (one column per tag): time of the last row read; long form (one value per line): INT64_MIN */
    int64_t row_us;
    struct import_counts *counts;
};

typedef bool take_sample(struct history_import *import, void *arg, int tag, const struct history_point *point, int column);

/* --- columns -------------------------------------------------------------------------------------------------------------------- */

static int find_time(struct history_import *import)
{
    static const char *const names[] = { "Time", "Timestamp", "UTC", "DateTime", "Date" };
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        if (csv_find(&import->csv, names[i]) >= 0)
            return csv_find(&import->csv, names[i]);
    /* if no column has a name for times, the first column contains the times, unless it is named after a tag */
    return plant_find_tag(import->params->plant, import->csv.header.cells[0].text) < 0 ? 0 : -1;
}

static bool find_wide(struct history_import *import)
{
    const struct csv_row *header = &import->csv.header;
    int known = 0;
    import->tags = mem_array(header->count, sizeof(*import->tags));
    for (size_t i = 0; i < header->count; i++) {
        import->tags[i] = (int)i == import->time ? -1 : plant_find_tag(import->params->plant, header->cells[i].text);
        known += import->tags[i] >= 0;
        if (import->tags[i] < 0 && (int)i != import->time)
            diag_warning(import->csv.diag, import->csv.path, header->cells[i].line, header->cells[i].column,
                         "the plant has no tag '%.60s'; its column is ignored", header->cells[i].text);
    }
    if (!known)
        diag_error(import->csv.diag, import->csv.path, 1, 1, "no column has the name of any tag in the plant");
    return known > 0;
}

static bool find_columns(struct history_import *import)
{
    import->tag = csv_find(&import->csv, "Tag");
    import->value = csv_find(&import->csv, "Value");
    import->quality = csv_find(&import->csv, "Quality");
    import->unit = -1;
    import->time = find_time(import);
    if (import->time < 0) {
        diag_error(import->csv.diag, import->csv.path, 1, 1, "expected a column 'Time'");
        return false;
    }
    if (import->tag >= 0 && import->value >= 0) {
        import->unit = csv_find(&import->csv, "Unit");
        /* true: the columns are those of series_text_csv_head(), so `plantcast history export` has written the file */
        import->counts->exported = import->csv.header.count == 5 && import->tag == 0 && import->time == 1 && import->value == 2 &&
                                   import->quality == 3 && import->unit == 4;
        return true;
    }
    import->tag = -1;
    return find_wide(import);
}

/* --- rows ----------------------------------------------------------------------------------------------------------------------- */

/* Reads the time of a row. When clocks are set back in autumn, one hour of local time occurs twice. A row whose time is not
   after that of the previous row (after_us) then belongs to the second occurrence. */
static bool take_time(struct history_import *import, int64_t after_us, int64_t *t_us)
{
    const char *text = csv_text(&import->csv, import->time);
    double count;
    if (import->params->start_us == INT64_MIN) {
        if (*text != '-' && (timestamp_parse(text, 0, t_us) || timestamp_parse_local(text, after_us, t_us)))
            return true;
        csv_error(&import->csv, import->time,
                  "expected a time such as 2026-11-20T10:00:00Z (without Z or offset: local time in %s), found '%.60s'",
                  import->params->plant->time_zone ? import->params->plant->time_zone : "UTC", text);
        return false;
    }
    if (number_parse(text, &count) == NUMBER_GOOD && fabs(count) < 1e12) {
        *t_us = import->params->start_us + (int64_t)llround(count * (double)import->params->unit_us);
        return true;
    }
    csv_error(&import->csv, import->time, "expected a number (time since --start), found '%.60s'", text);
    return false;
}

static bool take_quality(struct history_import *import, uint32_t *quality)
{
    static const struct {
        const char *name;
        uint32_t quality;
    } names[] = { { "Good", QUALITY_GOOD }, { "Uncertain", QUALITY_UNCERTAIN_LAST_USABLE }, { "Bad", QUALITY_BAD_COMMUNICATION_ERROR } };
    const char *text = csv_text(&import->csv, import->quality);
    char *end;
    *quality = QUALITY_GOOD;
    if (import->quality < 0 || !*text)
        return true;
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        if (!strcasecmp(text, names[i].name)) {
            *quality = names[i].quality;
            return true;
        }
    *quality = (uint32_t)strtoul(text, &end, 0);
    if (!*end && (*text == '0'))
        return true;
    if (!strncasecmp(text, "good", 4) || !strncasecmp(text, "uncertain", 9)) {
        *quality = tolower((unsigned char)*text) == 'g' ? QUALITY_GOOD : QUALITY_UNCERTAIN;
        return true;
    }
    if (state_word_is_bad(text, quality))
        return true;
    csv_error(&import->csv, import->quality, "expected Good, Uncertain, Bad or a code such as 0x80050000, found '%.60s'", text);
    return false;
}

/* Converts a value to the tag's unit: from the unit in the row's column Unit or, if that is blank, from the unit in which the
   tag's device sends values. */
static bool take_unit(struct history_import *import, int tag, double *value)
{
    const struct plant_tag *of = &import->params->plant->tags[tag];
    const char *unit = text_cell_read(csv_text(&import->csv, import->unit)), *to = of->unit ? of->unit : "";
    struct unit_change change = of->scale.change;
    if (*unit && units_compare(unit, to, &change) > UNITS_CONVERT) {
        csv_error(&import->csv, import->unit, "unit '%.60s' cannot be converted to '%.60s', the unit in which tag %s is recorded", unit, to,
                  of->name);
        return false;
    }
    *value = unit_change_value(&change, *value);
    return true;
}

/* Reads one cell of a CSV row, either a number or a state word (value/state_word.h), which means no value. Passes the sample to `take`. */
static bool take_cell(struct history_import *import, take_sample *take, void *arg, int tag, int column, int64_t t_us, uint32_t quality)
{
    const char *text = csv_text(&import->csv, column);
    struct history_point point = { t_us, NAN, quality };
    if (!quality_is_bad(quality)) {
        enum number_result result = number_parse(text, &point.value);
        bool word = result != NUMBER_GOOD && state_word_is_bad(text, &point.quality);
        if (result == NUMBER_NOT_FINITE && !word)
            point.quality = QUALITY_BAD;
        if (result == NUMBER_NOT_A_NUMBER && !word) {
            csv_error(&import->csv, column, "expected a number, or a word such as Bad or No Data, found '%.60s'", text);
            return false;
        }
    }
    if (!take_unit(import, tag, &point.value) || !take(import, arg, tag, &point, column))
        return false;
    import->series[tag].has_row = true;
    import->series[tag].row_us = t_us;
    return true;
}

static bool take_long(struct history_import *import, take_sample *take, void *arg)
{
    const char *name = text_cell_read(csv_text(&import->csv, import->tag));
    int tag = plant_find_tag(import->params->plant, name);
    uint32_t quality;
    int64_t t_us;
    if (!take_time(import, tag >= 0 && import->series[tag].has_row ? import->series[tag].row_us : INT64_MIN, &t_us))
        return false;
    if (tag < 0)
        csv_error(&import->csv, import->tag, "the plant has no tag '%.60s'", name);
    return tag >= 0 && take_quality(import, &quality) && take_cell(import, take, arg, tag, import->value, t_us, quality);
}

static bool take_row(struct history_import *import, take_sample *take, void *arg)
{
    int64_t t_us;
    if (import->tag >= 0)
        return take_long(import, take, arg);
    bool good = take_time(import, import->row_us, &t_us);
    if (good)
        import->row_us = t_us;
    for (size_t i = 0; good && i < import->csv.header.count; i++)
        if (import->tags[i] >= 0)
            good = take_cell(import, take, arg, import->tags[i], (int)i, t_us, QUALITY_GOOD);
    return good;
}

/* Makes one pass over the CSV file and passes every sample to `take`. Returns false if the file has errors or `take` failed. */
static bool read_file(const struct import_params *params, struct diag *diag, struct import_counts *counts, struct import_series *series,
                      take_sample *take, void *arg)
{
    struct history_import import = { .params = params, .counts = counts, .series = series, .row_us = INT64_MIN };
    int errors = diag->errors;
    bool going = true;
    if (!csv_open_foreign(&import.csv, params->path, params->encoding, diag, &counts->encoding))
        return false;
    for (size_t i = 0; i < params->plant->tag_count; i++)
        series[i].has_row = false;
    if (find_columns(&import))
        while (going && diag->errors - errors < MAX_ERRORS && csv_next(&import.csv))
            going = take_row(&import, take, arg) || diag->errors > errors;
    csv_close(&import.csv);
    mem_free(import.tags);
    return going && diag->errors == errors;
}

/* --- first pass: errors and spacing ----------------------------------------------------------------------------------------------- */

static bool check_sample(struct history_import *import, void *arg, int tag, const struct history_point *point, int column)
{
    struct import_counts *counts = import->counts;
    struct import_series *series = &import->series[tag];
    (void)arg;
    if (series->seen && point->t_us < series->last_us) {
        char text[TIMESTAMP_BYTES];
        timestamp_print(series->last_us, text);
        csv_error(&import->csv, column, "tag %s: expected a time not before the tag's previous sample, %s",
                  import->params->plant->tags[tag].name, text);
        return false;
    }
    if (!counts->samples || point->t_us < counts->from_us)
        counts->from_us = point->t_us;
    if (!counts->samples || point->t_us > counts->to_us)
        counts->to_us = point->t_us;
    counts->samples++;
    counts->tags += !series->seen;
    counts->duplicates += series->seen && point->t_us == series->last_us;
    spacing_put(&series->spacing, point);
    series->first_us = series->seen ? series->first_us : point->t_us;
    series->last_us = point->t_us;
    series->seen = true;
    return true;
}

/* Returns a typical time between samples: the lower median, over all series with a rhythm (at least three samples), of each
   series' median time between samples. Returns 0 if no series has a rhythm. */
static int64_t typical_spacing(struct import_series *series, size_t count)
{
    int64_t *medians = mem_array(count ? count : 1, sizeof(*medians)), typical_us = 0;
    size_t found = 0;
    for (size_t i = 0; i < count; i++)
        if (series[i].seen && spacing_has_rhythm(&series[i].spacing))
            medians[found++] = spacing_median(&series[i].spacing);
    qsort(medians, found, sizeof(*medians), compare_int64);
    if (found)
        typical_us = medians[(found - 1) / 2];
    mem_free(medians);
    return typical_us;
}

/* Returns the longest time between two samples of a series that does not count as a gap: normally a multiple of the series'
   median time between samples. `Stale s` of the tag list is used instead if it is at least the median; a shorter one is meant
   for live readings, which come faster. A series of two samples has no usable median, since the time between the two may itself
   be the gap. It uses the median of a typical series or, if no series has one, the longest time that the historian leaves
   between two points. */
static int64_t longest_gap(const struct import_params *params, const struct plant_tag *tag, struct spacing *spacing, int64_t typical_us,
                           bool exported)
{
    bool goes_stale = tag->validity.stale_s < PLANT_NEVER_STALE_S;
    bool alone = spacing->passed > 0 && !spacing_has_rhythm(spacing);
    int64_t median_us = alone ? typical_us : spacing_median(spacing);
    int64_t stale_us = goes_stale ? (int64_t)(tag->validity.stale_s * US_PER_S) : INT64_MAX;
    int64_t override_us = (int64_t)(2 * params->plant->history.override_s * US_PER_S);
    if (params->longest_gap_us)
        return params->longest_gap_us;
    if (exported && !goes_stale)
        return INT64_MAX;
    bool by_stale = !median_us || (tag->validity.states_stale && stale_us >= median_us);
    int64_t longest_us = by_stale ? stale_us : median_us < INT64_MAX / MEDIANS ? median_us * MEDIANS : INT64_MAX;
    bool is_least = exported || (alone && by_stale && !tag->validity.states_stale);
    return is_least && longest_us < override_us ? override_us : longest_us;
}

/* Runs between the two passes over the CSV file: sets the longest time without a gap for each series, and resets the state for
   the second pass. */
static void judge_series(const struct import_params *params, struct import_series *series, struct import_counts *counts)
{
    int64_t typical_us = typical_spacing(series, params->plant->tag_count);
    *counts->longest_us = INT64_MAX;
    for (size_t i = 0; i < params->plant->tag_count; i++) {
        if (!series[i].seen)
            continue;
        series[i].longest_us = longest_gap(params, &params->plant->tags[i], &series[i].spacing, typical_us, counts->exported);
        if (series[i].longest_us < counts->longest_us[0])
            counts->longest_us[0] = series[i].longest_us;
        if (series[i].longest_us > counts->longest_us[1])
            counts->longest_us[1] = series[i].longest_us;
    }
}

/* --- second pass: recording -------------------------------------------------------------------------------------------------------- */

struct filling {
    const struct import_params *params;
    struct history_tag *tags;
    struct recorder *recorder;
    struct recorder_rows rows;
    struct import_series *series;
    struct import_counts *counts;
    bool failed;
};

static int by_month_tag_time(const void *a, const void *b)
{
    const struct history_row *x = a, *y = b;
    int mx = month_of(x->point.t_us), my = month_of(y->point.t_us);
    if (mx != my)
        return mx < my ? -1 : 1;
    if (x->tag != y->tag)
        return x->tag < y->tag ? -1 : 1;
    return (x->point.t_us > y->point.t_us) - (x->point.t_us < y->point.t_us);
}

/* Imports the rows of one month into its file, one tag at a time. */
static bool fill_month(struct filling *filling, const struct history_row *rows, size_t count)
{
    struct history_point *points = mem_array(count, sizeof(*points));
    int error = 0;
    struct month_file *file = month_file_open(filling->params->log, filling->params->folder, month_of(rows->point.t_us), filling->tags,
                                              filling->params->plant->tag_count, &error);
    if (file && filling->params->plant->history.postgres.url)
        error = month_file_use_outbox(file);
    for (size_t i = 0; file && i < count && !error;) {
        size_t n = 0;
        int tag = rows[i].tag;
        while (i < count && rows[i].tag == tag)
            points[n++] = rows[i++].point;
        error = month_file_import(file, tag, points, n);
    }
    month_file_close(&file);
    mem_free(points);
    return !error;
}

static bool flush(struct filling *filling)
{
    struct recorder_rows *rows = &filling->rows;
    bool good = true;
    if (rows->count)
        qsort(rows->at, rows->count, sizeof(*rows->at), by_month_tag_time);
    for (size_t begin = 0, end; begin < rows->count && good; begin = end) {
        int month = month_of(rows->at[begin].point.t_us);
        for (end = begin + 1; end < rows->count && month_of(rows->at[end].point.t_us) == month;)
            end++;
        good = fill_month(filling, rows->at + begin, end - begin);
    }
    filling->counts->points += (long long)rows->count;
    rows->count = 0;
    filling->failed |= !good;
    return good;
}

static void add_row(struct filling *filling, int tag, int64_t t_us, double value, uint32_t quality)
{
    struct recorder_rows *rows = &filling->rows;
    mem_grow(&rows->at, &rows->capacity, rows->count + 1, sizeof(*rows->at));
    rows->at[rows->count++] = (struct history_row){ tag, { t_us, value, quality } };
}

/* Returns true if the point is the end of a recording: it has no value and the quality Bad_NoCommunication, so the tag's values
   are unknown until the next point. */
static bool is_end_of_line(const struct history_point *point)
{
    return point->quality == QUALITY_BAD_NO_COMMUNICATION && isnan(point->value);
}

/* Returns true if the existing history has at t_us a point without a value, with which an earlier import or a stopped daemon
   ended its recording. Call it with ascending times. */
static bool was_end_of_line(struct import_series *series, int64_t t_us)
{
    while (series->next < series->before.count && series->before.at[series->next].t_us < t_us)
        series->next++;
    return series->next < series->before.count && series->before.at[series->next].t_us == t_us &&
           is_end_of_line(&series->before.at[series->next]);
}

/* Records the tag's pending sample. If the time from there to the next sample, at next_us, is a gap, also records a point
   without a value just after the sample, so that the sample's value does not seem to last through the gap. next_us INT64_MAX:
   there is no next sample. */
static void record_pending(struct filling *filling, int tag, int64_t next_us)
{
    struct import_series *series = &filling->series[tag];
    const struct history_point *sample = &series->pending;
    bool usable = history_point_usable(sample);
    bool ends = usable && (next_us == INT64_MAX || next_us - sample->t_us > series->longest_us);
    recorder_put(filling->recorder, tag, sample, &filling->rows);
    filling->counts->bad += quality_is_bad(sample->quality);
    if (ends) {
        const struct history_point end = { sample->t_us + 1, NAN, QUALITY_BAD_NO_COMMUNICATION };
        recorder_put(filling->recorder, tag, &end, &filling->rows);
        /* Existing history ends just after this sample with a point without a value, which would interrupt the imported series.
           The sample's value replaces that point. */
    } else if (usable && was_end_of_line(series, sample->t_us + 1)) {
        recorder_end_tag(filling->recorder, tag, &filling->rows);
        add_row(filling, tag, sample->t_us + 1, sample->value, sample->quality);
    }
    filling->counts->gaps += ends && next_us <= series->last_us;
}

static bool fill_sample(struct history_import *import, void *arg, int tag, const struct history_point *point, int column)
{
    struct filling *filling = arg;
    struct import_series *series = &import->series[tag];
    (void)column;
    if (series->has_pending && series->pending.t_us < point->t_us)
        record_pending(filling, tag, point->t_us);
    series->has_pending = true;
    series->pending = *point;
    return filling->rows.count < FLUSH_ROWS || flush(filling);
}

/* --- joining existing history -------------------------------------------------------------------------------------------------------- */

/* Connects the first imported sample of a series to the preceding point in history. If the time between the two is a gap,
   records a point without a value after the preceding point; otherwise removes such a point. */
static void join_before(struct filling *filling, struct history_reader *reader, int tag)
{
    struct import_series *series = &filling->series[tag];
    const struct history_point *last = series->before.count ? series->before.at : NULL;
    struct history_series earlier = { 0 };
    if (!last || last->t_us >= series->first_us)
        return;
    bool gap = series->first_us - last->t_us > series->longest_us;
    if (gap && history_point_usable(last)) {
        add_row(filling, tag, last->t_us + 1, NAN, QUALITY_BAD_NO_COMMUNICATION);
    } else if (!gap && is_end_of_line(last) &&
               history_series(reader, filling->params->plant->tags[tag].name, last->t_us - 1, last->t_us - 1, 2, &earlier) == 0) {
        const struct history_point *point = earlier.points.at;
        if (earlier.points.count && point->t_us == last->t_us - 1 && history_point_usable(point))
            add_row(filling, tag, last->t_us, point->value, point->quality);
    }
    history_series_finish(&earlier);
}

/* Reads the points that history already has in the time span of each imported series into series->before. */
static bool read_before(struct filling *filling)
{
    const struct plant *plant = filling->params->plant;
    struct history_reader *reader = history_reader_create(filling->params->log, filling->params->folder);
    bool good = true;
    history_reader_show_by(reader, plant);
    for (size_t i = 0; i < plant->tag_count && good; i++) {
        struct import_series *series = &filling->series[i];
        struct history_series there = { 0 };
        if (!series->seen)
            continue;
        good = history_series(reader, plant->tags[i].name, series->first_us, series->last_us + 1, INT_MAX, &there) == 0;
        series->before = there.points;
        there.points.at = NULL;
        history_series_finish(&there);
        if (good)
            join_before(filling, reader, (int)i);
    }
    history_reader_destroy(&reader);
    return good;
}

/* Records the last imported sample of each series, and connects it to the following point in history. */
static void record_last(struct filling *filling)
{
    for (size_t i = 0; i < filling->params->plant->tag_count; i++) {
        struct import_series *series = &filling->series[i];
        const struct history_points *before = &series->before;
        if (!series->has_pending)
            continue;
        size_t k = before->count;
        while (k > 0 && before->at[k - 1].t_us > series->last_us)
            k--;
        bool follows = k < before->count && !is_end_of_line(&before->at[k]);
        record_pending(filling, (int)i, follows ? before->at[k].t_us : INT64_MAX);
    }
    recorder_end(filling->recorder, &filling->rows);
}

static bool fill(const struct import_params *params, struct import_series *series, struct import_counts *counts)
{
    struct filling filling = {
        .params = params,
        .tags = history_tags(params->plant),
        .recorder = recorder_create(params->plant, INT64_MIN),
        .series = series,
        .counts = counts,
    };
    /* reports of the second pass go to a struct diag of its own and are discarded, because `diag` already has them from the first pass */
    struct diag again = { 0 };
    mkdir(params->folder, 0777); /* ignores the result: if the folder cannot be created, opening a month's file reports the error */
    bool good = read_before(&filling) && read_file(params, &again, counts, series, fill_sample, &filling);
    diag_finish(&again);
    if (good)
        record_last(&filling);
    good = good && !filling.failed && flush(&filling);
    recorder_destroy(&filling.recorder);
    mem_free(filling.rows.at);
    mem_free(filling.tags);
    return good;
}

bool history_import(const struct import_params *params, struct diag *diag, struct import_counts *counts)
{
    size_t tag_count = params->plant->tag_count;
    struct import_series *series = mem_array(tag_count + 1, sizeof(*series));
    *counts = (struct import_counts){ 0 };
    bool good = read_file(params, diag, counts, series, check_sample, NULL);
    if (good) {
        judge_series(params, series, counts);
        good = fill(params, series, counts);
    }
    for (size_t i = 0; i < tag_count; i++) {
        spacing_finish(&series[i].spacing);
        mem_free(series[i].before.at);
    }
    mem_free(series);
    return good;
}
