/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a tag's recorded series across the files of several months, and reduces long series to buckets (intervals of equal length). */
#include "history/history.h"

#include <errno.h>
#include <stdlib.h>

#include "base/mem.h"
#include "history/month.h"
#include "value/quality.h"

enum { OPEN_MONTHS = 4 };

struct history_reader {
    struct log *log;
    char *folder;
    /* plant to whose units values are converted; NULL: values keep the units in which they were recorded */
    const struct plant *plant;
    bool *told; /* [tag of `plant`]: true once the log reports that points of the tag are omitted (unit not convertible) */
    struct month_file *files[OPEN_MONTHS];
    int next; /* index in `files` of the next file to close when room for another is needed */
};

struct history_reader *history_reader_create(struct log *log, const char *folder)
{
    struct history_reader *reader = mem_new(sizeof(*reader));
    reader->log = log;
    reader->folder = mem_strdup(folder);
    return reader;
}

void history_reader_show_by(struct history_reader *reader, const struct plant *plant)
{
    reader->plant = plant;
    mem_free(reader->told);
    reader->told = plant ? mem_array(plant->tag_count + 1, sizeof(*reader->told)) : NULL;
}

void history_reader_destroy(struct history_reader **reader)
{
    if (!*reader)
        return;
    for (int i = 0; i < OPEN_MONTHS; i++)
        month_file_close(&(*reader)->files[i]);
    mem_free((*reader)->folder);
    mem_free((*reader)->told);
    mem_free(*reader);
    *reader = NULL;
}

/* Opens the file of a month, or returns it if it is already open; it stays valid until another month is opened. Returns NULL
   with *error 0 if the month has no file, and NULL with *error -errno if the file cannot be read. */
static struct month_file *open_month(struct history_reader *reader, int month, int *error)
{
    struct month_file **place = &reader->files[reader->next];
    *error = 0;
    for (int i = 0; i < OPEN_MONTHS; i++)
        if (reader->files[i] && month_file_month(reader->files[i]) == month) {
            if (month_file_is_there(reader->files[i]))
                return reader->files[i];
            /* closes the month's file if it was deleted or replaced after it was opened, and opens the file that now has the
               name */
            place = &reader->files[i];
        }
    if (place == &reader->files[reader->next])
        reader->next = (reader->next + 1) % OPEN_MONTHS;
    month_file_close(place);
    *place = month_file_read(reader->log, reader->folder, month, error);
    if (*error == -ENOENT)
        *error = 0;
    if (*place)
        month_file_show_by(*place, reader->plant);
    return *place;
}

/* --- series ------------------------------------------------------------------------------------------------------------------- */

/* Returns the rollup level (set of precomputed buckets of one length) with the longest buckets that are at most twice
   stretch_us, the desired length. Returns -1 if the buckets of all levels are longer: the caller must then compute buckets from
   points. */
static int level_for(int64_t stretch_us)
{
    int level = -1;
    for (int i = 0; i < LEVEL_COUNT; i++)
        if (history_level_us[i] <= 2 * stretch_us)
            level = i;
    return level;
}

/* Returns the shortest bucket length in microseconds for which at most max_points buckets cover the time span. */
static int64_t wanted_length(int64_t span_us, int max_points)
{
    int64_t count = max_points > 1 ? max_points : 1, length_us = (span_us + count - 1) / count;
    return length_us > 1 ? length_us : 1;
}

static int64_t bucket_length(int64_t stretch_us, int level)
{
    int64_t unit_us = level < 0 ? 1 : history_level_us[level];
    int64_t count = (stretch_us + unit_us - 1) / unit_us;
    return count > 1 ? count * unit_us : unit_us;
}

/* State of merging a series' short buckets into longer ones, appended to `out`. */
struct gather {
    struct history_series *out;
    int64_t length_us; /* length in microseconds of the short buckets (time intervals) that are merged */
    /* rollup: computes buckets from points that no bucket of a file includes yet, across months. done_us: buckets from `rollup`
       that begin before this time are dropped, because a file has them */
    struct rollup rollup;
    int64_t done_us;
    bool has_last;
    struct history_bucket last;
};

static struct history_bucket *bucket_of(struct history_series *out, int64_t t_us)
{
    struct history_buckets *buckets = &out->buckets;
    if (buckets->count && buckets->at[buckets->count - 1].t_us == t_us)
        return &buckets->at[buckets->count - 1];
    mem_grow(&buckets->at, &buckets->capacity, buckets->count + 1, sizeof(*buckets->at));
    struct history_bucket *bucket = &buckets->at[buckets->count++];
    *bucket = (struct history_bucket){ .t_us = t_us, .low = NAN, .high = NAN, .mean = NAN, .first = NAN, .last = NAN };
    return bucket;
}

/* Merges a short bucket into the long bucket that covers its time. The straight line from the previous short bucket to this one
   counts in every long bucket that it crosses. */
static void put_bucket(struct gather *gather, const struct history_bucket *bucket)
{
    struct history_series *out = gather->out;
    struct history_bucket to = *bucket;
    /* the value of a switch holds until the next point, so the bucket begins with the last value of the previous one. Earlier
       versions of the file stored in `first` the value after a step at the bucket's start */
    if (out->step)
        to.first = gather->last.last;
    int64_t begin_us = bucket->t_us - bucket->t_us % out->bucket_us, end_us = gather->last.t_us + gather->length_us;
    struct history_bucket *before = gather->has_last ? &out->buckets.at[out->buckets.count - 1] : NULL;
    int64_t border_us = before ? before->t_us + out->bucket_us : 0;
    if (before)
        rollup_bridge(before, &gather->last, end_us, &to, end_us, bucket->t_us < border_us ? bucket->t_us : border_us);
    bool same = before && before->t_us == begin_us;
    struct history_bucket *into = bucket_of(out, begin_us);
    if (before && !same)
        rollup_bridge(into, &gather->last, end_us, &to, end_us > begin_us ? end_us : begin_us, bucket->t_us);
    rollup_merge(into, bucket);
    gather->last = *bucket;
    gather->has_last = true;
}

/* Computes buckets from points that no bucket of a file includes yet. Of the points before done_us only the last matters,
   because the straight line from it to the next point crosses done_us. */
static void put_points(struct gather *gather, const struct history_points *points)
{
    struct history_bucket closed;
    gather->rollup.length_us = gather->length_us;
    gather->rollup.step = points->step;
    for (size_t i = 0; i < points->count; i++)
        if (rollup_put(&gather->rollup, &points->at[i], &closed) && closed.t_us >= gather->done_us)
            put_bucket(gather, &closed);
}

/* Adds the last bucket that was computed from points to the output. The bucket may be incomplete, because the series continues
   after the last point. */
static void put_rest(struct gather *gather)
{
    struct history_bucket rest;
    if (rollup_rest(&gather->rollup, &rest) && rest.t_us >= gather->done_us)
        put_bucket(gather, &rest);
}

/* Recomputes the first bucket of a month's file if the straight line from the previous month's last point to this month's first
   point crosses it, because the file's own bucket begins only at its first point. *joined: true if the recomputed bucket was
   merged. */
static int join_month(struct month_file *file, const char *tag, const struct history_bucket *first, struct gather *gather, bool *joined)
{
    struct history_points points = { 0 };
    *joined = false;
    if (!gather->rollup.open)
        return 0;
    int error = month_file_points(file, tag, first->t_us - 1, first->t_us + gather->length_us - 1, &points);
    if (!error && points.count && points.at[0].t_us >= first->t_us) {
        put_points(gather, &points);
        *joined = gather->rollup.bucket.t_us > first->t_us;
    }
    mem_free(points.at);
    return error;
}

static int add_month(struct month_file *file, const char *tag, int level, int64_t from_us, int64_t to_us, struct gather *gather)
{
    struct month_buckets month = { .step = gather->out->step };
    struct history_points points = { 0 };
    bool joined = false;
    int error = month_file_buckets(file, tag, (enum history_level)level, from_us, to_us, &month);
    gather->out->step = month.step;
    if (!error && month.buckets.count) {
        error = join_month(file, tag, month.buckets.at, gather, &joined);
        gather->rollup = (struct rollup){ 0 };
        gather->done_us = month.until_us;
    }
    if (!error && month.until_us <= to_us)
        error = month_file_points(file, tag, month.until_us - 1, to_us, &points);
    for (size_t i = joined; i < month.buckets.count && !error; i++)
        put_bucket(gather, &month.buckets.at[i]);
    gather->out->step |= points.step;
    if (!error)
        put_points(gather, &points);
    mem_free(month.buckets.at);
    mem_free(points.at);
    return error;
}

/* Drops points outside the time range, except the last one before and the first one after it. Every month's file may have
   contributed such points. */
static void drop_edges(struct history_points *points, int64_t from_us, int64_t to_us)
{
    size_t first = 0, last = points->count;
    while (first + 1 < last && points->at[first + 1].t_us <= from_us)
        first++;
    while (last > first + 1 && points->at[last - 2].t_us > to_us)
        last--;
    for (size_t i = first; i < last; i++)
        points->at[i - first] = points->at[i];
    points->count = last - first;
}

/* Drops buckets outside the time range, except the last one that begins at or before from_us and the first one that ends after to_us. */
static void drop_outer_buckets(struct history_series *series, int64_t from_us, int64_t to_us)
{
    struct history_buckets *buckets = &series->buckets;
    size_t first = 0, last = buckets->count;
    while (first + 1 < last && buckets->at[first + 1].t_us <= from_us)
        first++;
    while (last > first + 1 && buckets->at[last - 2].t_us + series->bucket_us > to_us)
        last--;
    for (size_t i = first; i < last; i++)
        buckets->at[i - first] = buckets->at[i];
    buckets->count = last - first;
}

/* Logs, once per tag, that points are omitted because their unit cannot be converted. */
static void report_left_out(struct history_reader *reader, int tag, const struct history_left_out *left_out)
{
    const struct plant_tag *of = &reader->plant->tags[tag];
    if (!left_out->count)
        return;
    log_warn(reader->log, "history: tag %s: %zu points in '%s' are left out, because '%s' cannot be converted to '%s'", of->name,
             left_out->count, left_out->unit, left_out->unit, of->unit);
    reader->told[tag] = true;
}

struct month_request { /* the part of a tag's series to be read from a month's file */
    const char *tag;
    int level; /* rollup level (set of precomputed buckets of one length) whose buckets are to be read; -1: the points are to be read */
    int64_t from_us, to_us;
};

/* Reads the requested part of one month. left_out: counts the points whose unit cannot be converted; NULL: not counted. */
static int read_month(struct history_reader *reader, int month, const struct month_request *of, struct gather *gather,
                      struct history_left_out *left_out)
{
    struct history_series *out = gather->out;
    int error;
    struct month_file *file = open_month(reader, month, &error);
    if (!file || (error = month_file_begin_read(file)))
        return error;
    if (of->level >= 0) {
        error = add_month(file, of->tag, of->level, of->from_us, of->to_us, gather);
    } else if (!history_points_full(&out->points)) {
        error = month_file_points(file, of->tag, of->from_us, of->to_us, &out->points);
        out->step |= out->points.step;
    }
    if (!error && left_out)
        error = month_file_left_out(file, of->tag, of->from_us, of->to_us, left_out);
    month_file_end_read(file);
    return error;
}

/* Returns true if the months read so far contain a point of the tag. Otherwise earlier months must be searched for the point
   from which a straight line leads into the time span. */
static bool has_begun(const struct gather *gather)
{
    return gather->out->points.count > 0 || gather->out->buckets.count > 0 || gather->rollup.open;
}

/* Returns true if the months read so far have no point of the tag after to_us, so that later months must be searched. */
static bool lacks_end(const struct gather *gather, int level, int64_t to_us)
{
    const struct history_points *points = &gather->out->points;
    if (level >= 0)
        return gather->rollup.open && gather->rollup.last.t_us <= to_us;
    return !points->count || points->at[points->count - 1].t_us <= to_us;
}

/* Reads a series from the files of all months in its time span. Also searches earlier months for the newest point before the
   span, where the line that enters the span begins, and later months for the first point after it. Both points may be far away:
   a source that sends only changes may send none for months. */
static int read_months(struct history_reader *reader, const struct month_request *of, struct gather *gather,
                       struct history_left_out *left_out)
{
    size_t count, begin = 0;
    int *months = month_list(reader->folder, &count), error = 0, first = month_of(of->from_us), last = month_of(of->to_us);
    while (begin < count && months[begin] < first)
        begin++;
    /* Searches earlier months, one by one, for the last point before the time span: the recorded line enters the span on the
       straight line from that point. If one of these months cannot be read, the search ends, but the query does not fail. */
    for (size_t i = begin; i > 0 && !error && !has_begun(gather); i--)
        if ((error = read_month(reader, months[i - 1], of, gather, left_out)) && i < begin) {
            error = 0;
            break;
        }
    for (size_t i = begin; i < count && !error && (months[i] <= last || lacks_end(gather, of->level, of->to_us)); i++)
        if (left_out || !history_points_full(&gather->out->points))
            error = read_month(reader, months[i], of, gather, left_out);
    mem_free(months);
    if (!error && of->level < 0)
        drop_edges(&gather->out->points, of->from_us, of->to_us);
    return error;
}

/* Reads the buckets between two times, plus one bucket before and one after. */
static int read_buckets(struct history_reader *reader, const struct month_request *of, struct history_series *out)
{
    struct gather gather = { .out = out, .length_us = of->level < 0 ? out->bucket_us : history_level_us[of->level], .done_us = INT64_MIN };
    out->buckets.count = 0;
    /* if buckets are computed from points, also reads the last point before the range: until a step at the first point in the
       range, that point's value holds */
    struct month_request before = { of->tag, of->level, of->level < 0 ? of->from_us - 1 : of->from_us, of->to_us };
    int error = read_months(reader, &before, &gather, NULL);
    if (!error && of->level < 0)
        put_points(&gather, &out->points);
    if (!error)
        put_rest(&gather);
    mem_free(out->points.at);
    out->points = (struct history_points){ .step = out->step };
    return error;
}

int history_intervals(struct history_reader *reader, const char *tag, int64_t from_us, int64_t to_us, int max_count,
                      struct history_series *out)
{
    int64_t stretch_us = wanted_length(to_us - from_us, max_count);
    int level = level_for(stretch_us), error = 0;
    int64_t length_us = level < 0 ? stretch_us : bucket_length(stretch_us, level);
    struct month_request of = { tag, level, from_us - from_us % length_us, to_us - to_us % length_us + length_us - 1 };
    *out = (struct history_series){ .bucket_us = length_us };
    /* The first pass reads the buckets before and after the range only in part. If the series includes such a bucket, the
       second pass extends the range to read it in full. */
    for (int pass = 0; pass < 2 && !error; pass++) {
        error = read_buckets(reader, &of, out);
        drop_outer_buckets(out, from_us, to_us);
        const struct history_buckets *buckets = &out->buckets;
        int64_t first_us = buckets->count ? buckets->at[0].t_us : of.from_us;
        int64_t last_us = buckets->count ? buckets->at[buckets->count - 1].t_us + length_us - 1 : of.to_us;
        if (first_us >= of.from_us && last_us <= of.to_us)
            break;
        of.from_us = first_us < of.from_us ? first_us : of.from_us;
        of.to_us = last_us > of.to_us ? last_us : of.to_us;
    }
    return error;
}

int history_series(struct history_reader *reader, const char *tag, int64_t from_us, int64_t to_us, int max_points,
                   struct history_series *out)
{
    const struct month_request of = { tag, -1, from_us, to_us };
    /* maximum number of points to return: those in the range, one before and one after it. Reading may find two more, in
       neighbouring months */
    const size_t most = (size_t)max_points + 2;
    struct history_left_out left_out = { 0 };
    int index = reader->plant ? plant_find_tag(reader->plant, tag) : -1;
    bool counts = index >= 0 && !reader->told[index];
    *out = (struct history_series){ .points.max = most + 2 };
    struct gather gather = { .out = out };
    int error = read_months(reader, &of, &gather, counts ? &left_out : NULL);
    if (counts)
        report_left_out(reader, index, &left_out);
    if (error || out->points.count <= most)
        return error;
    history_series_finish(out);
    return history_intervals(reader, tag, from_us, to_us, max_points, out);
}

void history_series_finish(struct history_series *series)
{
    mem_free(series->points.at);
    mem_free(series->buckets.at);
    *series = (struct history_series){ 0 };
}

/* --- one instant -------------------------------------------------------------------------------------------------------------- */

/* Returns true if the tag has no value at t_us: its newest recorded sample is older than the tag's `Stale s` (time in seconds
   for which a value stays usable) allows. If samples had continued to arrive, the historian would have recorded a newer point. */
static bool has_ended(const struct history_pair *pair, int64_t t_us, int64_t stale_us)
{
    return pair->after.t_us == INT64_MIN && history_point_usable(&pair->before) && stale_us < INT64_MAX - HISTORY_SETTLED_US &&
           t_us - pair->before.t_us > stale_us + HISTORY_SETTLED_US;
}

static void read_pair(const struct history_pair *pair, int64_t t_us, int64_t stale_us, struct reading *out)
{
    const struct history_point *before = &pair->before;
    *out = (struct reading){ .quality = QUALITY_BAD_WAITING, .age_ns = INT64_MAX };
    if (before->t_us == INT64_MIN)
        return;
    out->quality = has_ended(pair, t_us, stale_us) ? QUALITY_BAD_NO_COMMUNICATION : before->quality;
    out->value = isnan(before->value) ? 0 : before->value;
    out->received_utc_ns = t_us * 1000;
    out->age_ns = 0;
    /* the quality has not been Good since the point `before`, so the age of the value is counted from that point */
    if (!quality_is_good(out->quality)) {
        out->received_utc_ns = before->t_us * 1000;
        out->age_ns = (t_us - before->t_us) * 1000;
    } else if (pair->after.t_us != INT64_MIN && history_point_joined(before, &pair->after, pair->step)) {
        out->value = history_point_between(before, &pair->after, t_us);
    }
}

static int at_month(struct history_reader *reader, int month, const struct history_tag *tags, int64_t t_us, size_t count,
                    struct history_pair *pairs)
{
    int error;
    struct month_file *file = open_month(reader, month, &error);
    if (!file || (error = month_file_begin_read(file)))
        return error;
    error = month_file_at(file, t_us, tags, count, pairs);
    month_file_end_read(file);
    return error;
}

/* Returns true if the search must go on: for some tag, no point at or before t_us has been found yet. With `after`, also if
   such a point is usable and the next point of the tag has not been found. */
static bool lacks_point(const struct history_pair *pairs, size_t count, bool after)
{
    size_t i = 0;
    while (i < count && (after ? pairs[i].after.t_us != INT64_MIN || pairs[i].before.t_us == INT64_MIN ||
                                     !history_point_usable(&pairs[i].before)
                               : pairs[i].before.t_us != INT64_MIN))
        i++;
    return i < count;
}

int history_at(struct history_reader *reader, const struct history_tag *tags, int64_t t_us, struct snapshot *into)
{
    struct history_pair *pairs = mem_array(into->count ? into->count : 1, sizeof(*pairs));
    size_t months_count, begin = 0;
    int *months = month_list(reader->folder, &months_count), month = month_of(t_us), error = 0;
    for (size_t i = 0; i < into->count; i++)
        pairs[i].before.t_us = pairs[i].after.t_us = INT64_MIN;
    while (begin < months_count && months[begin] <= month)
        begin++;
    /* Searches the month of t_us, then months before and after it, because a tag's points may be months apart. A distant month
       that cannot be read ends the search, but is no failure: the reading is then unknown. */
    for (size_t i = begin; i > 0 && !error && (i == begin || lacks_point(pairs, into->count, false)); i--) {
        error = at_month(reader, months[i - 1], tags, t_us, into->count, pairs);
        if (error && months[i - 1] < month - 1) {
            error = 0;
            break;
        }
    }
    for (size_t i = begin; i < months_count && !error && lacks_point(pairs, into->count, true); i++) {
        error = at_month(reader, months[i], tags, t_us, into->count, pairs);
        if (error && months[i] > month + 1) {
            error = 0;
            break;
        }
    }
    for (size_t i = 0; i < into->count; i++)
        read_pair(&pairs[i], t_us, tags[i].stale_us, &into->readings[i]);
    into->taken_utc_ns = t_us * 1000;
    mem_free(months);
    mem_free(pairs);
    return error;
}

static bool month_span(struct history_reader *reader, int month, int64_t *first_us, int64_t *last_us)
{
    int error;
    struct month_file *file = open_month(reader, month, &error);
    *first_us = INT64_MAX;
    return file && month_file_span(file, first_us, last_us) == 0 && *first_us != INT64_MAX;
}

bool history_span(struct history_reader *reader, int64_t *first_us, int64_t *last_us)
{
    size_t count;
    int *months = month_list(reader->folder, &count);
    int64_t unused;
    bool first = false, last = false;
    for (size_t i = 0; i < count && !first; i++)
        first = month_span(reader, months[i], first_us, &unused);
    for (size_t i = count; i > 0 && !last; i--)
        last = month_span(reader, months[i - 1], &unused, last_us);
    mem_free(months);
    return first && last;
}

/* --- gaps in recording --------------------------------------------------------------------------------------------------------- */

static int by_beginning(const void *a, const void *b)
{
    const struct history_gap *x = a, *y = b;
    return (x->from_us > y->from_us) - (x->from_us < y->from_us);
}

/* Sorts gaps in recording by time, keeps those that overlap from_us..to_us, and merges overlapping ones. */
static void tidy_gaps(struct history_gaps *gaps, int64_t from_us, int64_t to_us)
{
    size_t kept = 0;
    if (gaps->count)
        qsort(gaps->at, gaps->count, sizeof(*gaps->at), by_beginning);
    for (size_t i = 0; i < gaps->count; i++) {
        struct history_gap gap = gaps->at[i], *last = kept ? &gaps->at[kept - 1] : NULL;
        if (gap.to_us <= from_us || gap.from_us >= to_us)
            continue;
        if (last && gap.from_us <= last->to_us)
            last->to_us = gap.to_us > last->to_us ? gap.to_us : last->to_us;
        else
            gaps->at[kept++] = gap;
    }
    gaps->count = kept;
}

/* begins with the last file before from_us, because a gap in recording that is noted there may extend beyond from_us */
int history_gaps(struct history_reader *reader, int64_t from_us, int64_t to_us, struct history_gaps *out)
{
    size_t count;
    int *months = month_list(reader->folder, &count), error = 0, first = month_of(from_us), last = month_of(to_us);
    *out = (struct history_gaps){ 0 };
    for (size_t i = 0; i < count && !error; i++) {
        bool leads = months[i] < first && (i + 1 == count || months[i + 1] >= first);
        struct month_file *file = leads || (months[i] >= first && months[i] <= last) ? open_month(reader, months[i], &error) : NULL;
        if (file)
            error = month_file_gaps(file, out);
    }
    mem_free(months);
    if (error) {
        mem_free(out->at);
        *out = (struct history_gaps){ 0 };
        return error;
    }
    tidy_gaps(out, from_us, to_us);
    return 0;
}
