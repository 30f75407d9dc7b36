/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the points and buckets of history series as text directly, not through a JSON tree, because they are large. */
#include "history/series_text.h"

#include "history/month.h"
#include "base/text/timestamp.h"

/* Appends a value with ten significant digits, more than any transmitter has; values from 1e10 on, such as counters, get
   fifteen. none: text for NaN. */
static void add_number(struct text *out, double value, const char *none)
{
    if (isnan(value))
        text_add(out, "%s", none);
    else
        /* adding 0.0 turns -0.0 into 0.0, so that no minus sign is printed */
        text_add(out, fabs(value) < 1e10 ? "%.10g" : "%.15g", value + 0.0);
}

/* Appends a JSON string in quotes. */
static void add_string(struct text *out, const char *string)
{
    text_add(out, "\"");
    for (; *string; string++) {
        if (*string == '"' || *string == '\\')
            text_add(out, "\\%c", *string);
        else if ((unsigned char)*string < 0x20)
            text_add(out, "\\u%04x", *string);
        else
            text_add_bytes(out, string, 1);
    }
    text_add(out, "\"");
}

static void add_point(struct text *out, const struct history_point *point)
{
    text_add(out, "[%lld,", (long long)point->t_us);
    add_number(out, history_point_usable(point) ? point->value : NAN, "null");
    text_add(out, ",%u]", point->quality);
}

static void add_bucket(struct text *out, const struct history_bucket *bucket)
{
    const double values[] = { bucket->low, bucket->high, bucket->mean, bucket->first, bucket->last };
    text_add(out, "[%lld", (long long)bucket->t_us);
    for (size_t i = 0; i < sizeof(values) / sizeof(values[0]); i++) {
        text_add(out, ",");
        add_number(out, values[i], "null");
    }
    text_add(out, ",%lld,%u]", (long long)bucket->bad_us, bucket->quality);
}

void series_text_json(struct text *out, const char *tag, const char *unit, const struct history_series *series)
{
    text_add(out, "{\"tag\":");
    add_string(out, tag);
    text_add(out, ",\"unit\":");
    add_string(out, unit);
    text_add(out, ",\"step\":%s,\"bucket_us\":%lld,\"points\":[", series->step ? "true" : "false", (long long)series->bucket_us);
    for (size_t i = 0; i < series->points.count; i++) {
        text_add(out, i ? "," : "");
        add_point(out, &series->points.at[i]);
    }
    for (size_t i = 0; i < series->buckets.count; i++) {
        text_add(out, i ? "," : "");
        add_bucket(out, &series->buckets.at[i]);
    }
    text_add(out, "]}");
}

static const char SPECIAL[] = ",;\t\"\r\n "; /* characters that require quotes around a CSV cell */

static void begin_row(struct text *out, const char *tag, int64_t t_us)
{
    char when[TIMESTAMP_BYTES];
    timestamp_print(t_us, when);
    text_add_cell(out, tag, SPECIAL);
    text_add(out, ",%s,", when);
}

static void end_row(struct text *out, const char *unit)
{
    text_add_cell(out, unit, SPECIAL);
    text_add(out, "\r\n");
}

void series_text_csv_head(struct text *out, bool buckets)
{
    text_add(out, buckets ? "Tag,Time,Low,High,Mean,First,Last,Bad s,Quality,Unit\r\n" : "Tag,Time,Value,Quality,Unit\r\n");
}

void series_text_csv(struct text *out, const char *tag, const char *unit, const struct history_series *series)
{
    for (size_t i = 0; i < series->points.count; i++) {
        const struct history_point *point = &series->points.at[i];
        begin_row(out, tag, point->t_us);
        add_number(out, history_point_usable(point) ? point->value : NAN, "");
        text_add(out, ",0x%08X,", point->quality);
        end_row(out, unit);
    }
    for (size_t i = 0; i < series->buckets.count; i++) {
        const struct history_bucket *bucket = &series->buckets.at[i];
        const double values[] = { bucket->low, bucket->high, bucket->mean, bucket->first, bucket->last };
        begin_row(out, tag, bucket->t_us);
        for (size_t k = 0; k < sizeof(values) / sizeof(values[0]); k++) {
            add_number(out, values[k], "");
            text_add(out, ",");
        }
        text_add(out, "%.6g,0x%08X,", (double)bucket->bad_us / US_PER_S, bucket->quality);
        end_row(out, unit);
    }
}
