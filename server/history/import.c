/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a CSV twice: once to find everything that is wrong, once through the doors of its tags into the months' files. */
#include "history/import.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/mem.h"
#include "base/text.h"
#include "history/history.h"
#include "history/month.h"
#include "history/recorder.h"
#include "base/timestamp.h"
#include "plant/csv.h"
#include "plant/number.h"
#include "value/quality.h"

enum { FLUSH_ROWS = 500000, MAX_ERRORS = 50 };

struct import {
    const struct import_params *params;
    struct csv csv;
    int time, tag, value, quality, unit; /* columns; tag -1: wide */
    int *tags;                           /* wide: of each column; -1: passed over */
    int64_t *last_us;                    /* by tag */
    bool *seen;
    int64_t row_us; /* wide: of the last row; else INT64_MIN */
    struct import_counts *counts;
};

typedef bool take_sample(struct import *import, void *arg, int tag, const struct history_point *point, int column);

/* --- what the columns are ------------------------------------------------------------------------------------------------------- */

static int find_time(struct import *import)
{
    static const char *const names[] = { "Time", "Timestamp", "UTC", "DateTime", "Date" };
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        if (csv_find(&import->csv, names[i]) >= 0)
            return csv_find(&import->csv, names[i]);
    return plant_find_tag(import->params->plant, import->csv.header.cells[0].text) < 0 ? 0 : -1; /* whatever it is called */
}

static bool find_wide(struct import *import)
{
    const struct csv_row *header = &import->csv.header;
    int known = 0;
    import->tags = mem_array(header->count, sizeof(*import->tags));
    for (size_t i = 0; i < header->count; i++) {
        import->tags[i] = (int)i == import->time ? -1 : plant_find_tag(import->params->plant, header->cells[i].text);
        known += import->tags[i] >= 0;
        if (import->tags[i] < 0 && (int)i != import->time)
            diag_warning(import->csv.diag, import->csv.path, header->cells[i].line, header->cells[i].column,
                         "the plant has no tag '%.60s'; its column is passed over", header->cells[i].text);
    }
    if (!known)
        diag_error(import->csv.diag, import->csv.path, 1, 1, "no column is named as a tag of the plant is");
    return known > 0;
}

static bool find_columns(struct import *import)
{
    import->tag = csv_find(&import->csv, "Tag");
    import->value = csv_find(&import->csv, "Value");
    import->quality = csv_find(&import->csv, "Quality");
    import->unit = -1;
    import->time = find_time(import);
    if (import->time < 0) {
        diag_error(import->csv.diag, import->csv.path, 1, 1, "a column 'Time' is needed");
        return false;
    }
    if (import->tag >= 0 && import->value >= 0) {
        import->unit = csv_find(&import->csv, "Unit");
        return true;
    }
    import->tag = -1;
    return find_wide(import);
}

/* --- rows ----------------------------------------------------------------------------------------------------------------------- */

/* Of rows in the hour that was there twice, those that do not come after the one before are of the second. */
static bool take_time(struct import *import, int64_t after_us, int64_t *t_us)
{
    const char *text = csv_text(&import->csv, import->time);
    double count;
    if (import->params->start_us == INT64_MIN) {
        if (*text != '-' && (timestamp_parse(text, 0, t_us) || timestamp_parse_local(text, after_us, t_us)))
            return true;
        csv_error(&import->csv, import->time,
                  "expected an instant such as 2026-11-20T10:00:00Z (without Z or an offset: one that clocks in %s showed), found '%.60s'",
                  import->params->plant->time_zone ? import->params->plant->time_zone : "UTC", text);
        return false;
    }
    if (number_parse(text, &count) == NUMBER_GOOD && fabs(count) < 1e12) {
        *t_us = import->params->start_us + (int64_t)llround(count * (double)import->params->unit_us);
        return true;
    }
    csv_error(&import->csv, import->time, "expected a number that counts from the start, found '%.60s'", text);
    return false;
}

static bool take_quality(struct import *import, uint32_t *quality)
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
    csv_error(&import->csv, import->quality, "expected Good, Uncertain, Bad or a code such as 0x80050000, found '%.60s'", text);
    return false;
}

/* From the unit that the row says, else the tag's own. */
static bool take_unit(struct import *import, int tag, double *value)
{
    const struct plant_tag *of = &import->params->plant->tags[tag];
    const char *unit = text_cell_read(csv_text(&import->csv, import->unit)), *to = of->unit ? of->unit : "";
    struct unit_change change = of->change;
    if (*unit && units_compare(unit, to, &change) > UNITS_CONVERT) {
        csv_error(&import->csv, import->unit, "'%.60s' cannot be converted to '%.60s', in which %s is recorded", unit, to, of->name);
        return false;
    }
    *value = unit_change_value(&change, *value);
    return true;
}

/* One cell: a number, or nothing while the quality is Bad. */
static bool take_cell(struct import *import, take_sample *take, void *arg, int tag, int column, int64_t t_us, uint32_t quality)
{
    const char *text = csv_text(&import->csv, column);
    struct history_point point = { t_us, NAN, quality };
    if (!quality_is_bad(quality) && number_parse(text, &point.value) != NUMBER_GOOD) {
        csv_error(&import->csv, column, "expected a number, found '%.60s'", text);
        return false;
    }
    if (!take_unit(import, tag, &point.value) || !take(import, arg, tag, &point, column))
        return false;
    import->seen[tag] = true;
    import->last_us[tag] = t_us;
    return true;
}

static bool take_long(struct import *import, take_sample *take, void *arg)
{
    const char *name = text_cell_read(csv_text(&import->csv, import->tag));
    int tag = plant_find_tag(import->params->plant, name);
    uint32_t quality;
    int64_t t_us;
    if (!take_time(import, tag >= 0 && import->seen[tag] ? import->last_us[tag] : INT64_MIN, &t_us))
        return false;
    if (tag < 0)
        csv_error(&import->csv, import->tag, "the plant has no tag '%.60s'", name);
    return tag >= 0 && take_quality(import, &quality) && take_cell(import, take, arg, tag, import->value, t_us, quality);
}

static bool take_row(struct import *import, take_sample *take, void *arg)
{
    int64_t t_us;
    if (import->tag >= 0)
        return take_long(import, take, arg);
    bool good = take_time(import, import->row_us, &t_us);
    if (good)
        import->row_us = t_us;
    for (size_t i = 0; good && i < import->csv.header.count; i++)
        if (import->tags[i] >= 0 && *csv_text(&import->csv, (int)i))
            good = take_cell(import, take, arg, import->tags[i], (int)i, t_us, QUALITY_GOOD);
    return good;
}

/* Every row, to `take`. False: findings, or it said so. */
static bool read_file(const struct import_params *params, struct diag *diag, struct import_counts *counts, take_sample *take, void *arg)
{
    struct import import = { .params = params, .counts = counts, .row_us = INT64_MIN };
    int errors = diag->errors;
    bool going = true;
    if (!csv_open(&import.csv, params->path, diag))
        return false;
    import.last_us = mem_array(params->plant->tag_count + 1, sizeof(*import.last_us));
    import.seen = mem_array(params->plant->tag_count + 1, sizeof(*import.seen));
    if (find_columns(&import))
        while (going && diag->errors - errors < MAX_ERRORS && csv_next(&import.csv))
            going = take_row(&import, take, arg) || diag->errors > errors;
    csv_close(&import.csv);
    mem_free(import.tags);
    mem_free(import.last_us);
    mem_free(import.seen);
    return going && diag->errors == errors;
}

/* --- first: is it good? ----------------------------------------------------------------------------------------------------------- */

static bool check_sample(struct import *import, void *arg, int tag, const struct history_point *point, int column)
{
    struct import_counts *counts = import->counts;
    (void)arg;
    if (import->seen[tag] && point->t_us <= import->last_us[tag]) {
        char text[TIMESTAMP_BYTES];
        timestamp_print(import->last_us[tag], text);
        csv_error(&import->csv, column, "%s: expected a time after its last sample, %s", import->params->plant->tags[tag].name, text);
        return false;
    }
    if (!counts->samples || point->t_us < counts->from_us)
        counts->from_us = point->t_us;
    if (!counts->samples || point->t_us > counts->to_us)
        counts->to_us = point->t_us;
    counts->samples++;
    counts->tags += !import->seen[tag];
    return true;
}

/* --- then: in with it ------------------------------------------------------------------------------------------------------------- */

struct filling {
    const struct import_params *params;
    struct history_tag *tags;
    struct recorder *recorder;
    struct recorder_rows rows;
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

/* Rows of one month: those of one tag at a time. */
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
    rows->count = 0;
    filling->failed |= !good;
    return good;
}

static bool fill_sample(struct import *import, void *arg, int tag, const struct history_point *point, int column)
{
    struct filling *filling = arg;
    size_t before = filling->rows.count;
    (void)column;
    recorder_put(filling->recorder, tag, point, &filling->rows);
    import->counts->points += (long long)(filling->rows.count - before);
    return filling->rows.count < FLUSH_ROWS || flush(filling);
}

bool history_import(const struct import_params *params, struct diag *diag, struct import_counts *counts)
{
    *counts = (struct import_counts){ 0 };
    if (!read_file(params, diag, counts, check_sample, NULL))
        return false;
    struct filling filling = { .params = params, .tags = history_tags(params->plant), .recorder = recorder_create(params->plant) };
    mkdir(params->folder, 0777); /* where it cannot be made, opening says why */
    struct diag again = { 0 };   /* says what diag has said */
    bool good = read_file(params, &again, counts, fill_sample, &filling);
    diag_finish(&again);
    size_t before = filling.rows.count;
    recorder_end(filling.recorder, &filling.rows);
    counts->points += (long long)(filling.rows.count - before);
    good = good && !filling.failed && flush(&filling);
    recorder_destroy(&filling.recorder);
    mem_free(filling.rows.at);
    mem_free(filling.tags);
    return good;
}
