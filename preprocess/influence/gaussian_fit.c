/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A grid of ranges and of shares of noise, then a finer one around the best; the deviation follows from both. */
#include "preprocess/influence/gaussian_fit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/vec.h"
#include "plant/csv.h"
#include "plant/number.h"
#include "preprocess/influence/gaussian_contrast.h"

#define RANGES 9  /* of the coarse grid, evenly in logarithms; as many of the fine one */
#define SHARES 13 /* noise by deviation, from GAUSSIAN_LEAST_NOISE to MOST_SHARE */
#define MOST_SHARE 3.0
#define LEAST_INSTANTS 8 /* fewer say nothing about three numbers */
#define LEAST_SENSORS 3

/* --- the table --------------------------------------------------------------------------------------------------------------- */

static bool find_columns(const struct csv *csv, const char *const *names, size_t count, int *columns)
{
    for (size_t i = 0; i < count; i++) {
        columns[i] = csv_find(csv, names[i]);
        if (columns[i] < 0) {
            diag_error(csv->diag, csv->path, 1, 0, "no column '%.60s'", names[i]);
            return false;
        }
    }
    return true;
}

static bool read_row(const struct csv *csv, const int *columns, size_t count, double *values)
{
    for (size_t i = 0; i < count; i++)
        if (number_parse(csv_text(csv, columns[i]), &values[i]) != NUMBER_GOOD)
            return false;
    return true;
}

static void read_rows(struct readings_table *table, struct csv *csv, const char *const *names)
{
    int *columns = mem_array(table->count + 1, sizeof(*columns));
    size_t capacity = 0;
    if (find_columns(csv, names, table->count, columns)) {
        while (csv->diag->errors == 0 && csv_next(csv)) {
            mem_grow(&table->values, &capacity, (table->instants + 1) * table->count, sizeof(*table->values));
            if (read_row(csv, columns, table->count, table->values + table->instants * table->count))
                table->instants++;
            else
                table->left_out++;
        }
        if (csv->diag->errors == 0 && table->instants < LEAST_INSTANTS)
            diag_error(csv->diag, csv->path, 0, 0, "%zu lines have a number of all %zu sensors, %zu do not; at least %d are needed",
                       table->instants, table->count, table->left_out, LEAST_INSTANTS);
    }
    mem_free(columns);
}

bool readings_table_read(struct readings_table *table, const char *path, const char *const *names, size_t count, char why[300])
{
    struct diag diag = { 0 };
    struct csv csv;
    *table = (struct readings_table){ .count = count };
    if (csv_open(&csv, path, &diag)) {
        read_rows(table, &csv, names);
        csv_close(&csv);
    }
    for (size_t i = 0; i < diag.count; i++)
        if (diag.items[i].severity == DIAG_ERROR) {
            const struct diag_item *item = &diag.items[i];
            if (item->line > 0)
                snprintf(why, 300, "%.120s: line %d: %.150s", item->file, item->line, item->text);
            else
                snprintf(why, 300, "%.120s: %.160s", item->file, item->text);
            break;
        }
    const bool good = diag.errors == 0;
    diag_finish(&diag);
    return good;
}

void readings_table_finish(struct readings_table *table)
{
    mem_free(table->values);
    *table = (struct readings_table){ 0 };
}

/* --- the likelihood ---------------------------------------------------------------------------------------------------------- */

struct fit {
    const struct gaussian_params *stated;
    const struct readings_table *table;
    double *scatter; /* [sensor][sensor]: sum over instants of products of two readings less the mean over all of both */
    double *room[2], *means;
    struct gaussian_params best;
    double best_likelihood;
};

static void find_scatter(struct fit *fit)
{
    const struct readings_table *table = fit->table;
    const size_t n = table->count;
    double *less = mem_array(n, sizeof(*less)), level = 0;
    for (size_t i = 0; i < n; i++) /* precision takes any constant out; so do we, for the digits */
        level += table->values[i] / (double)n;
    for (size_t t = 0; t < table->instants; t++) {
        for (size_t i = 0; i < n; i++)
            less[i] = table->values[t * n + i] - level;
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j < n; j++)
                fit->scatter[i * n + j] += less[i] * less[j];
    }
    mem_free(less);
}

static size_t count_bodies(const uint32_t *body, size_t count)
{
    size_t bodies = 0;
    for (size_t i = 0; i < count; i++) {
        bool first = true;
        for (size_t j = 0; j < i; j++)
            first &= body[j] != body[i];
        bodies += first;
    }
    return bodies;
}

/* With covariance s^2 (K + share^2 1); s: as stated, or the best. */
static void try_share(struct fit *fit, double range_m, const double *kernel, const uint32_t *body, double share, double deviation)
{
    const size_t n = fit->table->count;
    const double instants = (double)fit->table->instants, freedom = instants * (double)(n - count_bodies(body, n));
    double log_det, misfit = 0;
    memcpy(fit->room[0], kernel, n * n * sizeof(*kernel));
    for (size_t i = 0; i < n; i++)
        fit->room[0][i * (n + 1)] += share * share;
    if (freedom <= 0 || !gaussian_contrast(n, body, fit->room[0], fit->room[1], fit->means, &log_det))
        return;
    for (size_t i = 0; i < n * n; i++)
        misfit += fit->room[1][i] * fit->scatter[i];
    double variance = isnan(deviation) ? misfit / freedom : deviation * deviation;
    double likelihood = -(instants * log_det + freedom * log(variance) + misfit / variance) / 2;
    if (!(variance > 0) || !(likelihood > fit->best_likelihood))
        return;
    fit->best_likelihood = likelihood;
    fit->best = (struct gaussian_params){ range_m, share * sqrt(variance), sqrt(variance) };
}

/* What is stated is kept: with a stated noise its share follows from the deviation, which is then sought in its place. */
static void try_range(struct fit *fit, double range_m, const double *kernel, const uint32_t *body)
{
    const struct gaussian_params *stated = fit->stated;
    double step = log(MOST_SHARE / GAUSSIAN_LEAST_NOISE) / (SHARES - 1), centre = NAN;
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < SHARES; i++) {
            double share = pass ? centre * exp(step * (2.0 * i / (SHARES - 1) - 1)) : GAUSSIAN_LEAST_NOISE * exp(step * i);
            share = max_of(share, GAUSSIAN_LEAST_NOISE);
            if (!isnan(stated->noise) && !isnan(stated->deviation))
                share = max_of(stated->noise / stated->deviation, GAUSSIAN_LEAST_NOISE);
            double deviation = isnan(stated->noise) || !isnan(stated->deviation) ? stated->deviation : stated->noise / share;
            try_share(fit, range_m, kernel, body, share, deviation);
        }
        centre = fit->best.deviation > 0 ? fit->best.noise / fit->best.deviation : GAUSSIAN_LEAST_NOISE;
    }
}

static bool try_ranges(struct fit *fit, struct log *log, struct workers *workers, const struct influence_mesh *mesh, double first_m,
                       double last_m, int count)
{
    for (int i = 0; i < count; i++) {
        double *kernel = NULL, range_m = count == 1 ? first_m : first_m * pow(last_m / first_m, (double)i / (count - 1));
        uint32_t *body = NULL;
        if (!gaussian_covariance(log, workers, mesh, range_m, &kernel, &body))
            return false;
        try_range(fit, range_m, kernel, body);
        mem_free(kernel);
        mem_free(body);
    }
    return true;
}

bool gaussian_fit(struct gaussian_params *params, struct log *log, struct workers *workers, const struct influence_mesh *mesh,
                  const struct readings_table *table, double least_m, double most_m, char why[300])
{
    const size_t n = table->count;
    struct fit fit = { .stated = params, .table = table, .best_likelihood = -INFINITY };
    if (n < LEAST_SENSORS) {
        snprintf(why, 300, "%zu sensors on one asset: nothing can be fitted to fewer than %d; state range_m, noise and deviation", n,
                 LEAST_SENSORS);
        return false;
    }
    fit.scatter = mem_array(n * n, sizeof(*fit.scatter));
    fit.room[0] = mem_array(n * n, sizeof(double));
    fit.room[1] = mem_array(n * n, sizeof(double));
    fit.means = mem_array(n, sizeof(*fit.means));
    find_scatter(&fit);
    bool good;
    if (isnan(params->range_m)) {
        double step = pow(most_m / least_m, 1.0 / (RANGES - 1));
        good = try_ranges(&fit, log, workers, mesh, least_m, most_m, RANGES);
        double around_m = fit.best.range_m;
        good = good && try_ranges(&fit, log, workers, mesh, max_of(around_m / step, least_m), min_of(around_m * step, most_m), RANGES);
    } else
        good = try_ranges(&fit, log, workers, mesh, params->range_m, params->range_m, 1);
    if (!good)
        snprintf(why, 300, "nothing could be fitted: see above");
    else if (!(fit.best.deviation > 0)) {
        snprintf(why, 300, "nothing can be fitted: no two sensors on one body differ");
        good = false;
    } else
        *params = fit.best;
    mem_free(fit.scatter);
    mem_free(fit.room[0]);
    mem_free(fit.room[1]);
    mem_free(fit.means);
    return good;
}
