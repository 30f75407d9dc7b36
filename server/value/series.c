/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads one recorded series from a CSV file. */
#include "value/series.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/math/search.h"
#include "base/mem.h"
#include "base/text/text.h"
#include "base/text/timestamp.h"
#include "value/quality.h"
#include "value/state_word.h"

enum { MAX_BYTES = 512 * 1024 * 1024, LONG_CELLS = 5 };
#define NO_TIME "%s:1: no time column: expected a name that ends in _ms, _s, _min or _h, or times such as 2026-11-20T10:00:00Z"

struct series_cell {
    const char *at;
    size_t length;
};

struct series_lines {
    const char *path, *at;
    char separator; /* character that separates the cells of a line: comma, semicolon or tab */
    int number;
    struct series_cell *cells;
    size_t count, capacity;
};

/* Begins to read the text of a CSV file. The separator of its cells is the most frequent of comma, semicolon and tab in the
   first line. So `21,5` in a file with semicolons is one cell. */
static struct series_lines lines_of(const char *path, const char *text)
{
    size_t most = 0;
    struct series_lines lines = { .path = path, .at = strncmp(text, "\xEF\xBB\xBF", 3) ? text : text + 3, .separator = ',' };
    for (const char *one = ",;\t"; *one; one++) {
        size_t count = 0;
        for (const char *at = lines.at; *at && *at != '\n'; at++)
            count += *at == *one;
        if (count > most)
            lines.separator = *one;
        most = count > most ? count : most;
    }
    return lines;
}

static bool next_line(struct series_lines *lines)
{
    if (!*lines->at)
        return false;
    const char *at = lines->at, *end = at + strcspn(at, "\n"), ends[] = { lines->separator, '\r', '\n', 0 };
    lines->number++;
    lines->count = 0;
    for (;;) {
        size_t length = strcspn(at, ends);
        mem_grow(&lines->cells, &lines->capacity, lines->count + 1, sizeof(*lines->cells));
        bool quoted = length > 1 && *at == '"' && at[length - 1] == '"';
        lines->cells[lines->count++] = (struct series_cell){ at + quoted, length - 2 * quoted };
        at += length;
        if (at >= end || *at == '\r')
            break;
        at++;
    }
    lines->at = *end ? end + 1 : end;
    return true;
}

static bool is(const struct series_cell *cell, const char *text, size_t length)
{
    return cell->length == length && !memcmp(cell->at, text, length);
}

/* Returns true if a cell equals a name, ignoring case. */
static bool is_called(const struct series_cell *cell, const char *name)
{
    return cell->length == strlen(name) && !strncasecmp(cell->at, name, cell->length);
}

static size_t column_called(const struct series_lines *lines, const char *name)
{
    size_t i = 0;
    while (i < lines->count && !is_called(&lines->cells[i], name))
        i++;
    return i;
}

static bool number_of(const struct series_cell *cell, double *out)
{
    char *end;
    *out = cell->length ? strtod(cell->at, &end) : NAN;
    return cell->length && end == cell->at + cell->length && isfinite(*out);
}

/* Reads a cell's value; NaN if the cell has a word for "no value" (state_word.h). Returns false if the cell is neither a number nor such
   a word. */
static bool value_of(const struct series_cell *cell, double *out)
{
    char text[64];
    uint32_t quality;
    if (number_of(cell, out))
        return true;
    snprintf(text, sizeof(text), "%.*s", (int)(cell->length < sizeof(text) ? cell->length : sizeof(text) - 1), cell->at);
    *out = NAN;
    return state_word_is_bad(text, &quality);
}

/* Reads a cell's quality: a status code such as 0x40900000, or a word. Uncertain if the cell is neither. */
static uint32_t quality_of(const struct series_cell *cell)
{
    char text[40], *end;
    uint32_t quality;
    snprintf(text, sizeof(text), "%.*s", (int)(cell->length < sizeof(text) ? cell->length : sizeof(text) - 1), cell->at);
    if (!*text || !strncasecmp(text, "good", 4))
        return QUALITY_GOOD;
    quality = (uint32_t)strtoul(text, &end, 0);
    return *text == '0' && !*end ? quality : state_word_is_bad(text, &quality) ? quality : QUALITY_UNCERTAIN;
}

static double unit_of_time(const struct series_cell *name)
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

static void add_value(struct series *series, double time_s, double value, uint32_t quality)
{
    mem_grow(&series->time_s, &series->capacity, series->count + 1, sizeof(double));
    mem_grow(&series->value, &series->value_capacity, series->count + 1, sizeof(double));
    mem_grow(&series->quality, &series->quality_capacity, series->count + 1, sizeof(*series->quality));
    series->quality[series->count] = isnan(value) && !quality_is_bad(quality) ? QUALITY_BAD : quality;
    series->time_s[series->count] = time_s;
    series->value[series->count++] = value;
}

struct clock {     /* state for converting the time column of a file to seconds */
    bool instants; /* true: the column contains dates and times; false: numbers */
    bool begun;    /* first or first_us is set */
    double unit_s, first, last_s;
    int64_t first_us, last_us;
    size_t ticks; /* number of different times that the column contains */
};

static bool instant_of(const struct series_cell *cell, int64_t after_us, int64_t *t_us)
{
    char text[40];
    if (cell->length >= sizeof(text))
        return false;
    memcpy(text, cell->at, cell->length);
    text[cell->length] = 0;
    return timestamp_parse_local(text, after_us, t_us);
}

static bool read_instant(struct clock *clock, const struct series_cell *cell, double *time_s)
{
    int64_t t_us;
    if (!instant_of(cell, clock->ticks ? clock->last_us - 1 : INT64_MIN, &t_us))
        return false;
    if (!clock->begun)
        clock->first_us = t_us;
    clock->begun = true;
    clock->last_us = t_us;
    *time_s = (double)(t_us - clock->first_us) / 1e6;
    return true;
}

static bool read_number(struct clock *clock, const struct series_cell *cell, double *time_s)
{
    double stamp;
    if (!number_of(cell, &stamp))
        return false;
    if (!clock->begun)
        clock->first = stamp;
    clock->begun = true;
    *time_s = (stamp - clock->first) * clock->unit_s;
    return true;
}

/* Reads a line's time in seconds since the first line. Returns false if the cell is not a time, or the time is before the
   previous line's. */
static bool tick(struct clock *clock, const struct series_cell *cell, double *time_s)
{
    if (!(clock->instants ? read_instant : read_number)(clock, cell, time_s) || *time_s < clock->last_s)
        return false;
    clock->ticks += clock->ticks == 0 || *time_s > clock->last_s;
    clock->last_s = *time_s;
    return true;
}

/* Returns true if a line has more non-empty cells than the header has columns, for example because a file with commas contains
   the number `1,234`. */
static bool has_surplus(const struct series_lines *lines, size_t columns)
{
    for (size_t i = columns; i < lines->count; i++)
        if (lines->cells[i].length > 0)
            return true;
    return false;
}

static bool read_wide(struct series *series, struct series_lines *lines, size_t time_column, size_t column, struct clock *clock,
                      char why[200])
{
    double time_s, value;
    size_t columns = lines->count;
    while (next_line(lines)) {
        if (lines->count == 1 && lines->cells[0].length == 0)
            continue;
        if (has_surplus(lines, columns)) {
            snprintf(why, 200, "%s:%d: this line has more cells than the first line", lines->path, lines->number);
            return false;
        }
        bool short_line = lines->count <= column || lines->count <= time_column;
        if (short_line || !tick(clock, &lines->cells[time_column], &time_s)) {
            snprintf(why, 200, "%s:%d: expected a time not before that of the previous line", lines->path, lines->number);
            return false;
        }
        if (lines->cells[column].length == 0) /* no value at this time, because the cell is empty */
            continue;
        if (!value_of(&lines->cells[column], &value)) {
            snprintf(why, 200, "%s:%d: %s: expected a number", lines->path, lines->number, series->name);
            return false;
        }
        add_value(series, time_s, value, QUALITY_GOOD);
    }
    return true;
}

static bool read_long(struct series *series, struct series_lines *lines, struct clock *clock, char why[200])
{
    double time_s, value;
    const char *slash = strrchr(series->name, '/');
    size_t entity = slash ? (size_t)(slash - series->name) : 0;
    do {
        if (lines->count < LONG_CELLS || !tick(clock, &lines->cells[0], &time_s)) {
            snprintf(why, 200, "%s:%d: expected the cells time in ms, type, entity, property and value, with lines in order of time",
                     lines->path, lines->number);
            return false;
        }
        if (!slash || !is(&lines->cells[2], series->name, entity) || !is(&lines->cells[3], slash + 1, strlen(slash + 1)))
            continue;
        if (!value_of(&lines->cells[4], &value)) {
            snprintf(why, 200, "%s:%d: %s: expected a number", lines->path, lines->number, series->name);
            return false;
        }
        add_value(series, time_s, value, QUALITY_GOOD);
    } while (next_line(lines));
    return true;
}

struct header {              /* indices of columns in a CSV file; the index of a missing column is the number of columns */
    /* for the wide form (series.h), which has a column per series: indices of the time column and of the series' column */
    size_t time, column;
    size_t tag, value, unit, quality; /* for the values form (series.h), which has one value in each line: indices of its columns */
    bool of_values;
};

/* Finds the first and the last time of a file, and its number of distinct times. Times need not ascend through the file,
   because the lines of one tag may follow those of another. */
static void scan_values(struct series_lines lines, const struct header *header, struct clock *clock)
{
    int64_t t_us;
    lines.cells = NULL;
    lines.capacity = 0;
    while (next_line(&lines)) {
        if (header->time >= lines.count || !instant_of(&lines.cells[header->time], INT64_MIN, &t_us))
            continue;
        clock->first_us = !clock->begun || t_us < clock->first_us ? t_us : clock->first_us;
        clock->last_us = !clock->begun || t_us > clock->last_us ? t_us : clock->last_us;
        clock->begun = true;
        clock->ticks++;
    }
    mem_free(lines.cells);
}

/* Reads a file in the values form: each line has a tag and a value, as written by `plantcast history export`. A blank value
   means that the quality was Bad. */
static bool read_values(struct series *series, struct series_lines *lines, const struct header *header, struct clock *file, char why[200])
{
    double time_s, value;
    size_t columns = lines->count;
    scan_values(*lines, header, file);
    struct clock own = { .instants = true, .begun = true, .first_us = file->first_us };
    file->last_s = (double)(file->last_us - file->first_us) / 1e6;
    while (next_line(lines)) {
        if (lines->count == 1 && lines->cells[0].length == 0)
            continue;
        if (lines->count <= header->time || lines->count <= header->tag || lines->count <= header->value || has_surplus(lines, columns)) {
            snprintf(why, 200, "%s:%d: expected as many cells in this line as in the first line", lines->path, lines->number);
            return false;
        }
        if (!is(&lines->cells[header->tag], series->name, strlen(series->name)))
            continue;
        if (!tick(&own, &lines->cells[header->time], &time_s)) {
            snprintf(why, 200, "%s:%d: expected a time not before the previous value of %s", lines->path, lines->number, series->name);
            return false;
        }
        if (!value_of(&lines->cells[header->value], &value)) {
            snprintf(why, 200, "%s:%d: %s: expected a number", lines->path, lines->number, series->name);
            return false;
        }
        const struct series_cell *unit = header->unit < lines->count ? &lines->cells[header->unit] : NULL;
        if (unit && series->unit && !is(unit, series->unit, strlen(series->unit))) {
            snprintf(why, 200, "%s:%d: %s: expected the same unit as in the lines before, %s", lines->path, lines->number, series->name,
                     series->unit);
            return false;
        }
        if (unit && !series->unit)
            series->unit = mem_printf("%.*s", (int)unit->length, unit->at);
        add_value(series, time_s, value, header->quality < lines->count ? quality_of(&lines->cells[header->quality]) : QUALITY_GOOD);
    }
    return true;
}

/* Returns true if the first line below the header has a date and time in this column, regardless of the column's name in the header. */
static bool begins_with_instant(const struct series_lines *header, size_t column)
{
    struct series_lines next = { .at = header->at, .separator = header->separator };
    int64_t t_us;
    while (next_line(&next) && next.count == 1 && next.cells[0].length == 0)
        continue;
    bool begins = column < next.count && instant_of(&next.cells[column], INT64_MIN, &t_us);
    mem_free(next.cells);
    return begins;
}

static bool read_header(const struct series_lines *lines, const char *name, struct header *header, struct clock *clock)
{
    static const char *const times[] = { "Time", "Timestamp", "UTC", "DateTime", "Date" };
    *header = (struct header){ .time = lines->count,
                               .column = lines->count,
                               .tag = column_called(lines, "Tag"),
                               .value = column_called(lines, "Value"),
                               .unit = column_called(lines, "Unit"),
                               .quality = column_called(lines, "Quality") };
    for (size_t i = lines->count; i-- > 0;)
        if (is(&lines->cells[i], name, strlen(name)))
            header->column = i;
    for (size_t i = 0; i < sizeof(times) / sizeof(*times) && !clock->instants; i++) {
        header->time = column_called(lines, times[i]);
        clock->instants = header->time < lines->count && begins_with_instant(lines, header->time);
    }
    for (size_t i = lines->count; i-- > 0 && !clock->instants;)
        if (unit_of_time(&lines->cells[i]) > 0) {
            header->time = i;
            clock->unit_s = unit_of_time(&lines->cells[i]);
        }
    if (header->time >= lines->count && begins_with_instant(lines, 0)) {
        header->time = 0;
        clock->instants = true;
    }
    header->of_values = clock->instants && header->tag < lines->count && header->value < lines->count;
    return clock->instants || (header->time < lines->count && unit_of_time(&lines->cells[header->time]) > 0);
}

bool series_read(struct series *series, const char *path, const char *name, bool *found, char why[200])
{
    size_t bytes;
    struct header header;
    double number;
    bool good = false;
    *found = false;
    *series = (struct series){ .name = mem_strdup(name) };
    char *text = text_read_file(path, MAX_BYTES, &bytes);
    struct series_lines lines = lines_of(path, text ? text : "");
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
    } else if (!read_header(&lines, name, &header, &clock)) {
        snprintf(why, 200, NO_TIME, path);
    } else if (header.of_values) {
        good = read_values(series, &lines, &header, &clock, why);
    } else {
        good = header.column == lines.count || read_wide(series, &lines, header.time, header.column, &clock, why);
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
    mem_free(series->unit);
    mem_free(series->time_s);
    mem_free(series->value);
    mem_free(series->quality);
    *series = (struct series){ 0 };
}

double series_at(const struct series *series, double time_s, bool loop)
{
    size_t after;
    if (loop)
        time_s = fmod(time_s, series->length_s);
    search_sorted(after, series->count, series->time_s[after] <= time_s);
    return series->value[after > 0 ? after - 1 : 0];
}

/* --- listing series ------------------------------------------------------------------------------------------------------------- */

enum { HEAD_BYTES = 32 << 20, HEAD_LINES = 200000 };

static char *read_head(const char *path, bool *whole, char why[200])
{
    FILE *file = fopen(path, "rb");
    char *text = file ? mem_array(HEAD_BYTES + 1, 1) : NULL;
    size_t count = file ? fread(text, 1, HEAD_BYTES, file) : 0;
    *whole = count < HEAD_BYTES;
    if (!file || ferror(file)) {
        snprintf(why, 200, "%s: %s", path, strerror(errno));
        mem_free(text);
        text = NULL;
    }
    if (file)
        fclose(file);
    return text;
}

static void add_name(struct series_names *names, char *name)
{
    for (size_t i = names->count; i-- > 0;)
        if (!strcmp(names->at[i], name)) {
            mem_free(name);
            return;
        }
    mem_grow(&names->at, &names->capacity, names->count + 1, sizeof(*names->at));
    names->at[names->count++] = name;
}

/* Lists the series of a file with one value in each line. In the long form they are named entity/property, in the values form like their
   tags. */
static void list_lines(struct series_names *names, struct series_lines *lines, size_t tag)
{
    int first = lines->number;
    do {
        const struct series_cell *cells = lines->cells;
        if (tag < lines->count)
            add_name(names, mem_printf("%.*s", (int)cells[tag].length, cells[tag].at));
        else if (lines->count >= LONG_CELLS)
            add_name(names, mem_printf("%.*s/%.*s", (int)cells[2].length, cells[2].at, (int)cells[3].length, cells[3].at));
        if (lines->number - first >= HEAD_LINES)
            names->whole = false;
    } while (lines->number - first < HEAD_LINES && next_line(lines));
}

bool series_list(struct series_names *names, const char *path, char why[200])
{
    struct header header;
    double number;
    bool good = true;
    *names = (struct series_names){ 0 };
    char *text = read_head(path, &names->whole, why);
    struct series_lines lines = lines_of(path, text ? text : "");
    struct clock clock = { 0 };
    if (!text)
        return false;
    if (!next_line(&lines)) {
        snprintf(why, 200, "%s: is empty", path);
        good = false;
    } else if (number_of(&lines.cells[0], &number)) {
        list_lines(names, &lines, SIZE_MAX);
    } else if (!read_header(&lines, "", &header, &clock)) {
        snprintf(why, 200, NO_TIME, path);
        good = false;
    } else if (header.of_values) {
        if (next_line(&lines))
            list_lines(names, &lines, header.tag);
    } else {
        names->whole = true;
        for (size_t i = 0; i < lines.count; i++)
            if (i != header.time)
                add_name(names, mem_printf("%.*s", (int)lines.cells[i].length, lines.cells[i].at));
    }
    mem_free(text);
    mem_free(lines.cells);
    if (!good)
        series_names_finish(names);
    return good;
}

void series_names_finish(struct series_names *names)
{
    for (size_t i = 0; i < names->count; i++)
        mem_free(names->at[i]);
    mem_free(names->at);
    *names = (struct series_names){ 0 };
}
