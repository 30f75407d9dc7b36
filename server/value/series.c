/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Picks one series out of a CSV file of numbers. */
#include "value/series.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/text.h"

enum { MAX_BYTES = 512 * 1024 * 1024, LONG_CELLS = 5 };

struct cell {
    const char *at;
    size_t length;
};

struct lines {
    const char *path, *at;
    int number;
    struct cell *cells;
    size_t count, capacity;
};

static bool next_line(struct lines *lines)
{
    if (!*lines->at)
        return false;
    const char *at = lines->at, *end = at + strcspn(at, "\n");
    lines->number++;
    lines->count = 0;
    for (;;) {
        size_t length = strcspn(at, ",;\t\r\n");
        mem_grow(&lines->cells, &lines->capacity, lines->count + 1, sizeof(*lines->cells));
        lines->cells[lines->count++] = (struct cell){ at, length };
        at += length;
        if (at >= end || *at == '\r')
            break;
        at++;
    }
    lines->at = *end ? end + 1 : end;
    return true;
}

static bool is(const struct cell *cell, const char *text, size_t length)
{
    return cell->length == length && !memcmp(cell->at, text, length);
}

static bool number_of(const struct cell *cell, double *out)
{
    char *end;
    *out = cell->length ? strtod(cell->at, &end) : NAN;
    return cell->length && end == cell->at + cell->length && isfinite(*out);
}

static double unit_of_time(const struct cell *name)
{
    static const struct {
        const char *ending;
        double seconds;
    } units[] = { { "_ms", 0.001 }, { "_s", 1 }, { "_min", 60 }, { "_h", 3600 } };
    for (size_t i = 0; i < sizeof(units) / sizeof(units[0]); i++) {
        size_t length = strlen(units[i].ending);
        if (name->length > length && !memcmp(name->at + name->length - length, units[i].ending, length))
            return units[i].seconds;
    }
    return 0;
}

static void add(struct series *series, double time_s, double value)
{
    mem_grow(&series->time_s, &series->capacity, series->count + 1, sizeof(double));
    mem_grow(&series->value, &series->value_capacity, series->count + 1, sizeof(double));
    series->time_s[series->count] = time_s;
    series->value[series->count++] = value;
}

struct clock { /* of one file */
    double unit_s, first, last_s;
    size_t ticks; /* different times */
};

/* The line's time since the first line. False: it is no number, or lies before the line above. */
static bool tick(struct clock *clock, const struct cell *cell, double *time_s)
{
    double stamp;
    if (!number_of(cell, &stamp))
        return false;
    if (clock->ticks == 0)
        clock->first = stamp;
    *time_s = (stamp - clock->first) * clock->unit_s;
    if (*time_s < clock->last_s)
        return false;
    clock->ticks += clock->ticks == 0 || *time_s > clock->last_s;
    clock->last_s = *time_s;
    return true;
}

static bool read_wide(struct series *series, struct lines *lines, size_t time_column, size_t column, struct clock *clock, char why[200])
{
    double time_s, value;
    while (next_line(lines)) {
        if (lines->count == 1 && lines->cells[0].length == 0)
            continue;
        bool short_line = lines->count <= column || lines->count <= time_column;
        if (short_line || !tick(clock, &lines->cells[time_column], &time_s)) {
            snprintf(why, 200, "%s:%d: expected a time that is not before the last", lines->path, lines->number);
            return false;
        }
        if (lines->cells[column].length == 0) /* no value at this time */
            continue;
        if (!number_of(&lines->cells[column], &value)) {
            snprintf(why, 200, "%s:%d: %s: expected a number", lines->path, lines->number, series->name);
            return false;
        }
        add(series, time_s, value);
    }
    return true;
}

static bool read_long(struct series *series, struct lines *lines, struct clock *clock, char why[200])
{
    double time_s, value;
    const char *slash = strrchr(series->name, '/');
    size_t entity = slash ? (size_t)(slash - series->name) : 0;
    do {
        if (lines->count < LONG_CELLS || !tick(clock, &lines->cells[0], &time_s)) {
            snprintf(why, 200, "%s:%d: expected time in ms,type,entity,property,value, times not falling", lines->path, lines->number);
            return false;
        }
        if (!slash || !is(&lines->cells[2], series->name, entity) || !is(&lines->cells[3], slash + 1, strlen(slash + 1)))
            continue;
        if (!number_of(&lines->cells[4], &value)) {
            snprintf(why, 200, "%s:%d: %s: expected a number", lines->path, lines->number, series->name);
            return false;
        }
        add(series, time_s, value);
    } while (next_line(lines));
    return true;
}

static bool read_header(const struct lines *lines, const char *name, size_t *time_column, size_t *column, double *unit_s)
{
    *time_column = *column = lines->count;
    for (size_t i = lines->count; i-- > 0;) {
        if (is(&lines->cells[i], name, strlen(name)))
            *column = i;
        if (unit_of_time(&lines->cells[i]) > 0) {
            *time_column = i;
            *unit_s = unit_of_time(&lines->cells[i]);
        }
    }
    return *time_column < lines->count;
}

bool series_read(struct series *series, const char *path, const char *name, bool *found, char why[200])
{
    size_t bytes, time_column = 0, column = 0;
    double number;
    bool good = false;
    *found = false;
    *series = (struct series){ .name = mem_strdup(name) };
    char *text = text_read_file(path, MAX_BYTES, &bytes);
    struct lines lines = { .path = path, .at = text ? text : "" };
    struct clock clock = { .unit_s = 0.001 };
    if (!text) {
        snprintf(why, 200, "%s: %s", path, strerror(errno));
        goto error;
    }
    if (!next_line(&lines)) {
        snprintf(why, 200, "%s: is empty", path);
        goto error;
    }
    if (number_of(&lines.cells[0], &number)) {
        good = read_long(series, &lines, &clock, why);
    } else if (!read_header(&lines, name, &time_column, &column, &clock.unit_s)) {
        snprintf(why, 200, "%s:1: no column is the time: expected a name that ends in _ms, _s, _min or _h", path);
    } else {
        good = column == lines.count || read_wide(series, &lines, time_column, column, &clock, why);
    }
    *found = good && series->count > 0;
    if (good && !*found)
        snprintf(why, 200, "%s: has no series %s", path, name);
    series->length_s = clock.ticks > 1 ? clock.last_s * (double)clock.ticks / (double)(clock.ticks - 1) : 1;
error:
    mem_free(text);
    mem_free(lines.cells);
    if (!*found)
        series_finish(series);
    return good;
}

void series_finish(struct series *series)
{
    mem_free(series->name);
    mem_free(series->time_s);
    mem_free(series->value);
    *series = (struct series){ 0 };
}

double series_at(const struct series *series, double time_s, bool loop)
{
    size_t low = 0, high = series->count;
    if (loop)
        time_s = fmod(time_s, series->length_s);
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (series->time_s[middle] <= time_s)
            low = middle;
        else
            high = middle;
    }
    return series->value[low];
}
