/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds drift (drift.h) by weighted least squares with orthogonalised columns; drops linearly dependent columns. Looks for
   jumps in the residuals of the fit without the straight line in time, because a drift changes little within hours. */
#include "field/drift.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/math/search.h"
#include "base/mem.h"

enum { JUMPS = 2, COLUMNS = 3 + DRIFT_NEAREST + JUMPS, MIN_SENSORS = 3, ROUNDS = 20 };
/* The plant's rate of change at an hour is the mean change of the prediction per hour, from CHANGE_BEFORE hours before to
   CHANGE_AFTER hours after that hour. */
enum { CHANGE_BEFORE = 3, CHANGE_AFTER = 1 };
/* an hour in which the plant changes this many times as fast as usual gets half the normal weight in the fit */
static const double FAST_FACTOR = 2;
static const double STILL_PART = 0.1; /* the plant counts as unchanged if it changes per hour by less than this multiple of the noise */
static const double MEAN_PART = 0.25; /* noise of an hourly mean, relative to that of a single reading: 1/4 if the mean has at least
                                         16 independent readings */
/* A jump at a row shows as the difference between two averages of residuals, one before and one after the row. First constant:
   number of hours in each average. Second constant: number of hours between the two averages, which neither includes. */
enum { BESIDE = 3, WITHIN = 2 };
/* a jump of the residuals is found only if the difference between the two averages is at least this multiple of the difference
   that is usual between such averages */
static const double MIN_JUMP_FACTOR = 6;
static const double LAG_HOURS = 12;          /* time constant of the low-pass filter that models the time that heat takes from the
                                                other sensors to this one */
static const double DEPENDENT_PART = 1. / 6; /* residuals farther apart than this fraction of the recorded time count as independent */
static const double MIN_NEW_PART = 1e-3;     /* smallest part of a column's length (a column is one term of the model over all
                                                hours) that must be independent of the other columns */

struct week { /* hourly data of one sensor */
    /* hourly means. values: of the sensor's own readings; predicted: of the predictions from the other sensors; nearest: of the
       nearest sensors' readings, [nearest_count][hours] */
    const double *values, *predicted, *nearest;
    int nearest_count, hours;
    /* noise: error of a single reading, which includes the rounding of recorded values; root: square root of each hour's weight
       in the fit */
    double noise, root[DRIFT_HOURS];
};

/* The equations (rows) of the least-squares fit, one per hour in which all required values exist. Each is multiplied by the
   square root of the hour's weight. */
struct drift_rows {
    double at[COLUMNS][DRIFT_HOURS], time[DRIFT_HOURS], value[DRIFT_HOURS];
    double counted; /* sum of the weights in the fit of all hours in these rows */
    int hour[DRIFT_HOURS], count, columns;
};

static double dot(const double *a, const double *b, int count)
{
    double sum = 0;
    for (int i = 0; i < count; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Subtracts from the vector `of` its component along the unit vector `unit`, so that the two become orthogonal. */
static void take_out(double *of, const double *unit, int count)
{
    double part = dot(of, unit, count);
    for (int i = 0; i < count; i++)
        of[i] -= part * unit[i];
}

static bool is_whole(const struct week *week, int hour)
{
    bool whole = isfinite(week->values[hour]) && isfinite(week->predicted[hour]);
    for (int k = 0; k < week->nearest_count; k++)
        whole &= isfinite(week->nearest[k * week->hours + hour]);
    return whole;
}

static void collect(const struct week *week, struct drift_rows *rows)
{
    double lagging = NAN;
    rows->count = 0;
    rows->counted = 0;
    for (int h = 0; h < week->hours; h++) {
        const double predicted = week->predicted[h], root = week->root[h];
        if (isfinite(predicted))
            lagging = isnan(lagging) ? predicted : lagging + (predicted - lagging) / LAG_HOURS;
        if (!is_whole(week, h))
            continue;
        int i = rows->count++;
        rows->hour[i] = h;
        rows->counted += root * root;
        rows->time[i] = root * ((h + 0.5) / week->hours - 0.5);
        rows->value[i] = root * week->values[h];
        rows->at[0][i] = root;
        rows->at[1][i] = root * predicted;
        rows->at[2][i] = root * lagging;
        for (int k = 0; k < week->nearest_count; k++)
            rows->at[3 + k][i] = root * week->nearest[k * week->hours + h];
    }
    rows->columns = 3 + week->nearest_count;
}

/* Makes the model's columns orthonormal, and subtracts their components from the columns of time and of the values. largest:
   largest magnitude of the values. Drops columns that depend on others. Returns the number of columns kept. */
static int reduce(struct drift_rows *rows, double largest)
{
    int kept = 0, n = rows->count;
    for (int c = 0; c < rows->columns; c++) {
        double *column = rows->at[c];
        for (int k = 0; k < kept; k++)
            take_out(column, rows->at[k], n);
        double length = sqrt(dot(column, column, n));
        /* Drops a column of which only rounding errors are left, for example because readings are nearly constant. The first
           column, which is all 1, always stays. */
        if (c > 0 && !(length > 1e-9 * sqrt(n) * (1 + largest)))
            continue;
        for (int i = 0; i < n; i++)
            rows->at[kept][i] = column[i] / length;
        for (int k = 0; k < kept; k++) /* orthogonalises a second time, because rounding errors of the first may be large */
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

/* Returns the median of n non-negative numbers, which stay unchanged. */
static double median(const double *of, int n)
{
    double sorted[DRIFT_HOURS];
    memcpy(sorted, of, (size_t)n * sizeof(*sorted));
    qsort(sorted, (size_t)n, sizeof(*sorted), compare_doubles);
    return (sorted[(n - 1) / 2] + sorted[n / 2]) / 2;
}

/* Finds the row (hour) before which the residuals jump most. Returns its index; 0: there is no jump. */
static int find_jump(const struct drift_rows *rows, double noise)
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
    /* 0.6745: ratio of median absolute deviation to standard deviation in a normal distribution */
    if (change[largest] < MIN_JUMP_FACTOR * fmax(median(change, count) / 0.6745, noise * sqrt(2. / BESIDE)))
        return 0;
    int at = largest + BESIDE;
    for (int i = at; i <= largest + first; i++)
        at = fabs(rows->value[i] - rows->value[i - 1]) > fabs(rows->value[at] - rows->value[at - 1]) ? i : at;
    return at;
}

/* Computes each hour's weight in the fit: 1 if the sensor's prediction is constant, 1/2 if it changes FAST_FACTOR times as fast
   as usual. */
static void weigh(struct week *week)
{
    double change[DRIFT_HOURS], sorted[DRIFT_HOURS];
    int known = 0;
    for (int h = 0; h < week->hours; h++) {
        double sum = 0;
        int count = 0;
        for (int k = h - CHANGE_BEFORE; k <= h + CHANGE_AFTER; k++) {
            if (k < 1 || k >= week->hours || !isfinite(week->predicted[k]) || !isfinite(week->predicted[k - 1]))
                continue;
            sum += fabs(week->predicted[k] - week->predicted[k - 1]);
            count++;
        }
        change[h] = count ? sum / count : 0;
        if (is_whole(week, h))
            sorted[known++] = change[h];
    }
    double usual = fmax(known ? median(sorted, known) : 0, STILL_PART * week->noise);
    for (int h = 0; h < week->hours; h++)
        week->root[h] = 1 / hypot(1, change[h] / (FAST_FACTOR * usual));
}

/* Collects the rows (hours) of the fit and makes their columns (terms of the model) orthonormal. Adds a column for each jump
   found: 0 before the jump, 1 after it. Returns the number of columns that remain after linearly dependent ones are dropped. */
static int reduce_with_jumps(const struct week *week, struct drift_rows *rows)
{
    double largest = 0;
    for (int h = 0; h < week->hours; h++)
        largest = isfinite(week->values[h]) ? fmax(largest, fabs(week->values[h])) : largest;
    int jumps[JUMPS], columns = reduce(rows, largest);
    for (int count = 0; count < JUMPS && (jumps[count] = find_jump(rows, week->noise)) > 0;) {
        count++;
        collect(week, rows);
        for (int k = 0; k < count; k++, rows->columns++)
            for (int i = 0; i < rows->count; i++)
                rows->at[rows->columns][i] = i >= jumps[k] ? week->root[rows->hour[i]] : 0;
        columns = reduce(rows, largest);
    }
    return columns;
}

/* Returns the variance of the slope as estimated by Newey & West, from each residual's contribution to the slope. Contributions
   up to DEPENDENT_PART of the hours apart count as correlated. */
static double slope_variance(const struct drift_rows *rows, double time_square, int hours)
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

void drift_fit(const double *values, const double *predicted, const double *nearest, int nearest_count, int hours, double noise,
               struct drift *out)
{
    struct week week = { values, predicted, nearest, nearest_count, hours, noise, { 0 } };
    struct drift_rows rows;
    *out = (struct drift){ DRIFT_UNKNOWN, NAN, NAN, NAN, 0 };
    weigh(&week);
    collect(&week, &rows);
    out->hours = rows.count;
    if (rows.count < DRIFT_HOURS_LEAST)
        return;
    double span = dot(rows.time, rows.time, rows.count);
    int columns = reduce_with_jumps(&week, &rows);
    double left = dot(rows.time, rows.time, rows.count);
    if (!(left > MIN_NEW_PART * MIN_NEW_PART * span))
        return;
    double slope = dot(rows.time, rows.value, rows.count) / left;
    for (int i = 0; i < rows.count; i++)
        rows.value[i] -= slope * rows.time[i];
    double residual = sqrt(dot(rows.value, rows.value, rows.count) / fmax(rows.counted - columns - 1, 1));
    out->change = slope;
    out->scatter = hypot(residual, noise);
    out->error = sqrt(slope_variance(&rows, left, hours) + MEAN_PART * noise * (MEAN_PART * noise) / left);
    if (fabs(slope) >= DRIFT_SIGMAS_LEAST * out->scatter && fabs(slope) >= DRIFT_ERRORS * out->error)
        out->verdict = DRIFT_FOUND;
    else if (DRIFT_SIGMAS * out->scatter >= DRIFT_ERRORS * out->error)
        out->verdict = DRIFT_NONE;
}

const char *drift_unknown_cause(const struct drift *drift, size_t sensors)
{
    if (drift->verdict != DRIFT_UNKNOWN)
        return "";
    if (sensors < MIN_SENSORS)
        return "fewer than 3 sensors of the group on the asset";
    if (sensors > NEIGHBOURS_MOST)
        return "more than 512 sensors of the group on the asset";
    if (drift->hours < DRIFT_HOURS_LEAST)
        return "fewer than 84 hours with readings of the sensor and its neighbours";
    if (drift->error * DRIFT_ERRORS <= drift->scatter * DRIFT_SIGMAS)
        return "fewer than 3 sensors that do not drift";
    return "changes in plant operation could hide a drift";
}

/* Computes each sensor's own offset by least squares of value[hour][sensor] = own[sensor] + common[hour], over all values that are not
   NaN. */
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

struct drift_search {
    const struct neighbours *neighbours;
    const double *values; /* values by [hour][sensor] */
    int hours;
    size_t count;
    double *own;  /* own offset of each sensor */
    double *said; /* predictions by [sensor][hour] */
};

/* Predicts the readings of every sensor, including drifting ones, from the sensors that have not been found to drift. */
static void predict(const struct drift_search *search, const struct drift *drifts)
{
    const double level = neighbours_level(search->neighbours);
    double *used = mem_array(search->count, sizeof(*used));
    struct neighbour *said = mem_array(search->count, sizeof(*said));
    for (int h = 0; h < search->hours; h++) {
        for (size_t i = 0; i < search->count; i++)
            used[i] =
                drifts[i].verdict == DRIFT_FOUND ? (double)NAN : search->values[(size_t)h * search->count + i] - search->own[i] + level;
        neighbours_predict(search->neighbours, used, said);
        for (size_t i = 0; i < search->count; i++)
            search->said[i * (size_t)search->hours + (size_t)h] = said[i].predicted - level + search->own[i];
    }
    mem_free(used);
    mem_free(said);
}

/* Copies a sensor's hourly readings to `out`. Fills gaps with predictions plus the sensor's mean difference from its predictions. */
static void read_filled(const struct drift_search *search, size_t sensor, double *out)
{
    const double *said = search->said + sensor * (size_t)search->hours;
    double off = 0;
    int known = 0;
    for (int h = 0; h < search->hours; h++) {
        out[h] = search->values[(size_t)h * search->count + sensor];
        if (isfinite(out[h]) && isfinite(said[h])) {
            off += out[h] - said[h];
            known++;
        }
    }
    for (int h = 0; h < search->hours && known; h++)
        out[h] = isfinite(out[h]) ? out[h] : said[h] + off / known;
}

/* Returns true if a sensor may be compared with others: not found to drift, and has values for at least half of the hours. */
static bool is_of_use(const struct drift_search *search, size_t sensor, const struct drift *drift)
{
    int known = 0;
    for (int h = 0; h < search->hours; h++)
        known += isfinite(search->values[(size_t)h * search->count + sensor]);
    return drift->verdict != DRIFT_FOUND && 2 * known >= search->hours;
}

/* Fits the model to all sensors not yet found to drift. Returns the index of the sensor that drifts most clearly, or `count` if
   none does. */
static size_t judge(const struct drift_search *search, const double *noise, struct drift *out)
{
    double own[DRIFT_HOURS], nearest[DRIFT_NEAREST * DRIFT_HOURS];
    bool *apart = mem_array(search->count, sizeof(*apart));
    size_t clearest = search->count;
    for (size_t i = 0; i < search->count; i++)
        apart[i] = !is_of_use(search, i, &out[i]);
    for (size_t i = 0; i < search->count; i++) {
        size_t near[DRIFT_NEAREST];
        if (out[i].verdict == DRIFT_FOUND)
            continue;
        for (int h = 0; h < search->hours; h++)
            own[h] = search->values[(size_t)h * search->count + i];
        size_t count = neighbours_nearest(search->neighbours, i, apart, DRIFT_NEAREST, near);
        for (size_t k = 0; k < count; k++)
            read_filled(search, near[k], nearest + k * (size_t)search->hours);
        drift_fit(own, search->said + i * (size_t)search->hours, nearest, (int)count, search->hours, noise[i], &out[i]);
        if (out[i].verdict != DRIFT_FOUND)
            continue;
        out[i].verdict = DRIFT_NONE; /* DRIFT_FOUND is set later, and only for the sensor with the clearest drift */
        if (clearest == search->count || fabs(out[i].change) / out[i].error > fabs(out[clearest].change) / out[clearest].error)
            clearest = i;
    }
    mem_free(apart);
    return clearest;
}

void drift_find(const struct neighbours *neighbours, const double *values, int hours, const double *noise, struct drift *out,
                double *predicted)
{
    const size_t count = neighbours_count(neighbours);
    struct drift_search search = {
        neighbours, values, hours, count, mem_array(count, sizeof(double)), mem_array(count * (size_t)hours, sizeof(double))
    };
    size_t clearest = 0;
    find_own(values, hours, count, search.own);
    for (size_t i = 0; i < count; i++)
        out[i] = (struct drift){ DRIFT_UNKNOWN, NAN, NAN, NAN, 0 };
    for (size_t found = 0; found + MIN_SENSORS <= count; found++) {
        predict(&search, out);
        clearest = judge(&search, noise, out);
        if (clearest == count)
            break;
        out[clearest].verdict = DRIFT_FOUND;
    }
    /* The search stopped because too few sensors without drift remain. Verdicts on these would depend on drifting sensors, so
       they become DRIFT_UNKNOWN. */
    for (size_t i = 0; i < count && clearest < count; i++)
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
