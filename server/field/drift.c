/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Least squares by orthogonal columns; a column that says nothing new is left out. Jumps are looked for in what is left of values without
   a line in time: a drift changes little within hours. */
#include "field/drift.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { JUMPS = 2, COLUMNS = 3 + JUMPS, SENSORS_LEAST = 3, ROUNDS = 20 };
enum { BESIDE = 3, WITHIN = 2 };           /* hours: of the means before and after a jump, and between the two */
static const double JUMP = 6;              /* as many times what residuals usually change by in as many hours */
static const double LAG_HOURS = 12;        /* heat takes its time from the others' places to this one */
static const double DEPENDENT_PART = 1. / 6; /* of the time: residuals farther apart count as independent */
static const double NEW_PART = 1e-3;       /* of a column's length that has to be left beside the other columns */

struct rows { /* where there are both, value and prediction; hour by hour */
    double at[COLUMNS][DRIFT_HOURS], time[DRIFT_HOURS], value[DRIFT_HOURS];
    int hour[DRIFT_HOURS], count, columns;
};

static double dot(const double *a, const double *b, int count)
{
    double sum = 0;
    for (int i = 0; i < count; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Takes out of `of` what `unit` explains. */
static void take_out(double *of, const double *unit, int count)
{
    double part = dot(of, unit, count);
    for (int i = 0; i < count; i++)
        of[i] -= part * unit[i];
}

static void collect(const double *values, const double *predicted, int hours, struct rows *rows)
{
    double lagging = NAN;
    rows->count = 0;
    for (int h = 0; h < hours; h++) {
        if (isfinite(predicted[h]))
            lagging = isnan(lagging) ? predicted[h] : lagging + (predicted[h] - lagging) / LAG_HOURS;
        if (!isfinite(values[h]) || !isfinite(predicted[h]))
            continue;
        int i = rows->count++;
        rows->hour[i] = h;
        rows->time[i] = (h + 0.5) / hours - 0.5;
        rows->value[i] = values[h];
        rows->at[0][i] = 1;
        rows->at[1][i] = predicted[h];
        rows->at[2][i] = lagging;
    }
    rows->columns = COLUMNS - JUMPS;
}

/* The columns become orthonormal; what they explain goes out of time and value. Returns how many are left. */
static int reduce(struct rows *rows)
{
    int kept = 0, n = rows->count;
    for (int c = 0; c < rows->columns; c++) {
        double *column = rows->at[c];
        for (int k = 0; k < kept; k++)
            take_out(column, rows->at[k], n);
        double length = sqrt(dot(column, column, n));
        /* of readings that hardly differ only rounding is left; the first column is 1 */
        if (c > 0 && !(length > 1e-9 * sqrt(n) * (1 + fabs(rows->value[0]))))
            continue;
        for (int i = 0; i < n; i++)
            rows->at[kept][i] = column[i] / length;
        for (int k = 0; k < kept; k++) /* once more: exact to rounding */
            take_out(rows->at[kept], rows->at[k], n);
        kept++;
    }
    for (int pass = 0; pass < 2; pass++)
        for (int k = 0; k < kept; k++) {
            take_out(rows->time, rows->at[k], n);
            take_out(rows->value, rows->at[k], n);
        }
    return kept;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Of n numbers, none negative. */
static double median(const double *of, int n)
{
    double sorted[DRIFT_HOURS];
    memcpy(sorted, of, (size_t)n * sizeof(*sorted));
    qsort(sorted, (size_t)n, sizeof(*sorted), by_size);
    return (sorted[(n - 1) / 2] + sorted[n / 2]) / 2;
}

/* Finds the row before which reduced values jump most. Returns 0 if they do not. */
static int find_jump(const struct rows *rows, double noise)
{
    double change[DRIFT_HOURS];
    const int first = BESIDE + WITHIN, count = rows->count - first - BESIDE + 1;
    int largest = 0;
    for (int k = 0; k < count; k++) {
        double sum = 0;
        for (int i = 0; i < BESIDE; i++)
            sum += rows->value[first + k + i] - rows->value[k + i];
        change[k] = fabs(sum) / BESIDE;
        largest = change[k] > change[largest] ? k : largest;
    }
    if (change[largest] < JUMP * fmax(median(change, count) / 0.6745, noise * sqrt(2. / BESIDE))) /* as of a normal distribution */
        return 0;
    int at = largest + BESIDE;
    for (int i = at; i <= largest + first; i++)
        at = fabs(rows->value[i] - rows->value[i - 1]) > fabs(rows->value[at] - rows->value[at - 1]) ? i : at;
    return at;
}

/* Collects and reduces, with a column for each jump: from there on the level is another one. Returns how many columns are left. */
static int reduce_with_jumps(const double *values, const double *predicted, int hours, double noise, struct rows *rows)
{
    int jumps[JUMPS], columns = reduce(rows);
    for (int count = 0; count < JUMPS && (jumps[count] = find_jump(rows, noise)) > 0;) {
        count++;
        collect(values, predicted, hours, rows);
        for (int k = 0; k < count; k++, rows->columns++)
            for (int i = 0; i < rows->count; i++)
                rows->at[rows->columns][i] = i >= jumps[k];
        columns = reduce(rows);
    }
    return columns;
}

/* Of the slope, by Newey & West's estimate: pulls of the residuals on it, and how they hang together over `reach` hours. */
static double slope_variance(const struct rows *rows, double time_square, int hours)
{
    double pull[DRIFT_HOURS] = { 0 };
    int reach = (int)(DEPENDENT_PART * hours);
    for (int i = 0; i < rows->count; i++)
        pull[rows->hour[i]] = rows->time[i] * rows->value[i] / time_square;
    double sum = dot(pull, pull, hours);
    for (int lag = 1; lag <= reach; lag++)
        sum += 2 * (1 - (double)lag / (reach + 1)) * dot(pull, pull + lag, hours - lag);
    return fmax(sum, 0);
}

void drift_fit(const double *values, const double *predicted, int hours, double noise, struct drift *out)
{
    struct rows rows;
    *out = (struct drift){ DRIFT_UNKNOWN, NAN, NAN, NAN, 0 };
    collect(values, predicted, hours, &rows);
    out->hours = rows.count;
    if (rows.count < DRIFT_HOURS_LEAST)
        return;
    double span = dot(rows.time, rows.time, rows.count);
    int columns = reduce_with_jumps(values, predicted, hours, noise, &rows);
    double left = dot(rows.time, rows.time, rows.count);
    if (!(left > NEW_PART * NEW_PART * span))
        return;
    double slope = dot(rows.time, rows.value, rows.count) / left;
    for (int i = 0; i < rows.count; i++)
        rows.value[i] -= slope * rows.time[i];
    double residual = sqrt(dot(rows.value, rows.value, rows.count) / (rows.count - columns - 1));
    out->change = slope;
    out->scatter = hypot(residual, noise);
    out->error = sqrt(slope_variance(&rows, left, hours) + noise * noise / left);
    if (fabs(slope) >= DRIFT_SIGMAS * out->scatter && fabs(slope) >= DRIFT_ERRORS * out->error)
        out->verdict = DRIFT_FOUND;
    else if (DRIFT_SIGMAS * out->scatter >= DRIFT_ERRORS * out->error)
        out->verdict = DRIFT_NONE;
}

/* What is a sensor's own, by least squares of value = own[sensor] + common[hour], where there are values. */
static void find_own(const double *values, int hours, size_t count, double *own)
{
    double *sum = mem_array(count, sizeof(*sum));
    int *known = mem_array(count, sizeof(*known));
    for (int round = 0; round < ROUNDS; round++) {
        memset(sum, 0, count * sizeof(*sum));
        memset(known, 0, count * sizeof(*known));
        for (int h = 0; h < hours; h++) {
            const double *row = values + (size_t)h * count;
            double common = 0;
            int there = 0;
            for (size_t i = 0; i < count; i++)
                if (isfinite(row[i])) {
                    common += row[i] - own[i];
                    there++;
                }
            for (size_t i = 0; i < count; i++)
                if (isfinite(row[i])) {
                    sum[i] += row[i] - common / there;
                    known[i]++;
                }
        }
        for (size_t i = 0; i < count; i++)
            own[i] = known[i] ? sum[i] / known[i] : 0;
    }
    mem_free(sum);
    mem_free(known);
}

struct search {
    const struct neighbours *neighbours;
    const double *values; /* [hour][sensor] */
    int hours;
    size_t count;
    double *own;  /* by sensor */
    double *said; /* [sensor][hour] */
};

/* Without those that were found, but of these too. */
static void predict(const struct search *search, const struct drift *drifts)
{
    const double level = neighbours_level(search->neighbours);
    double *used = mem_array(search->count, sizeof(*used));
    struct neighbour *said = mem_array(search->count, sizeof(*said));
    for (int h = 0; h < search->hours; h++) {
        for (size_t i = 0; i < search->count; i++)
            used[i] = drifts[i].verdict == DRIFT_FOUND ? (double)NAN
                                                       : search->values[(size_t)h * search->count + i] - search->own[i] + level;
        neighbours_predict(search->neighbours, used, said);
        for (size_t i = 0; i < search->count; i++)
            search->said[i * (size_t)search->hours + (size_t)h] = said[i].predicted - level + search->own[i];
    }
    mem_free(used);
    mem_free(said);
}

/* Judges all that were not found yet. Returns the one that drifts most clearly; count: none. */
static size_t judge(const struct search *search, const double *noise, struct drift *out)
{
    double own[DRIFT_HOURS];
    size_t clearest = search->count;
    for (size_t i = 0; i < search->count; i++) {
        if (out[i].verdict == DRIFT_FOUND)
            continue;
        for (int h = 0; h < search->hours; h++)
            own[h] = search->values[(size_t)h * search->count + i];
        drift_fit(own, search->said + i * (size_t)search->hours, search->hours, noise[i], &out[i]);
        if (out[i].verdict != DRIFT_FOUND)
            continue;
        out[i].verdict = DRIFT_NONE; /* not yet */
        if (clearest == search->count || fabs(out[i].change) / out[i].error > fabs(out[clearest].change) / out[clearest].error)
            clearest = i;
    }
    return clearest;
}

void drift_find(const struct neighbours *neighbours, const double *values, int hours, const double *noise, struct drift *out,
                double *predicted)
{
    const size_t count = neighbours_count(neighbours);
    struct search search = { neighbours, values, hours, count, mem_array(count, sizeof(double)),
                             mem_array(count * (size_t)hours, sizeof(double)) };
    size_t clearest = 0;
    find_own(values, hours, count, search.own);
    for (size_t i = 0; i < count; i++)
        out[i] = (struct drift){ DRIFT_UNKNOWN, NAN, NAN, NAN, 0 };
    for (size_t found = 0; found + SENSORS_LEAST <= count; found++) {
        predict(&search, out);
        clearest = judge(&search, noise, out);
        if (clearest == count)
            break;
        out[clearest].verdict = DRIFT_FOUND;
    }
    for (size_t i = 0; i < count && clearest < count; i++) /* too few are left to tell which, and what is said of them is by the found */
        if (out[i].verdict == DRIFT_NONE)
            out[i].verdict = DRIFT_UNKNOWN;
    if (predicted) {
        predict(&search, out);
        for (int h = 0; h < hours; h++)
            for (size_t i = 0; i < count; i++)
                predicted[(size_t)h * count + i] = search.said[i * (size_t)hours + (size_t)h];
    }
    mem_free(search.own);
    mem_free(search.said);
}
