/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fits the parameters of a Gaussian process. Searches a grid of ranges with a subset of the sensors, then refines the best
 * range with all sensors by fitting parabolas. For each range, searches a grid of noise shares (noise / deviation), then a
 * finer grid around the best one. The deviation follows from range and noise. */
#include "preprocess/influence/gaussian_fit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "plant/influence.h"
#include "plant/parse/csv.h"
#include "plant/parse/number.h"
#include "preprocess/influence/gaussian_contrast.h"
#include "preprocess/influence/gaussian_covariance.h"

#define RANGES 9  /* number of correlation ranges in the search grid, evenly spaced in logarithms */
#define FEW 96    /* maximum number of sensors used in the grid search for the correlation range */
#define CLOSER 3  /* number of parabola steps that refine the grid's best correlation range */
#define SHARES 13 /* number of noise shares (noise / deviation) in the search grid, from GAUSSIAN_LEAST_NOISE to MAX_SHARE */
#define MAX_SHARE 3.0
/* ranges whose logarithms differ by less than this count as equal: readings cannot distinguish them */
#define SAME 0.02
#define MIN_INSTANTS 8 /* minimum number of instants (lines of readings); fewer do not determine three parameters */

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
        if (csv->diag->errors == 0 && table->instants < MIN_INSTANTS)
            diag_error(csv->diag, csv->path, 0, 0,
                       "only %zu lines of this `fit` file have a value for each of the %zu sensors, %zu lines do not; the fit of `gp` "
                       "needs at least %d such lines",
                       table->instants, table->count, table->left_out, MIN_INSTANTS);
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

struct gaussian_fit {
    const struct gaussian_params *stated;
    const struct readings_table *table;
    struct log *log;
    struct workers *workers;
    struct gaussian_covariance covariance;
    double *scatter; /* [sensor][sensor]: sum over instants of the product of two sensors' readings, each minus the overall mean */
    double *room[2], *means;
    struct gaussian_params best;
    double best_likelihood;
};

static void find_scatter(struct gaussian_fit *fit)
{
    const struct readings_table *table = fit->table;
    const size_t n = table->count;
    double *less = mem_array(n, sizeof(*less)), level = 0;
    /* subtracts the mean of all readings, to avoid cancellation; the result does not change, because the precision matrix
       removes any constant */
    for (size_t i = 0; i < n; i++)
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

/* Evaluates the likelihood of the readings for the covariance s^2 (K + share^2 I), and keeps the best parameters. K: covariance
 * for deviation 1 without noise; s: the deviation given in the plant file, or else the most likely one; I: identity matrix. */
static void try_share(struct gaussian_fit *fit, double range_m, double share, double deviation)
{
    const size_t n = fit->table->count;
    const uint32_t *body = fit->covariance.bodies.of_sensor;
    const double instants = (double)fit->table->instants, freedom = instants * (double)(n - count_bodies(body, n));
    double log_det, misfit = 0;
    memcpy(fit->room[0], fit->covariance.values, n * n * sizeof(double));
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

/* Finds the best noise share (noise / deviation) for a range. Parameters given in the plant file stay fixed. If the noise is
 * given, the search varies the deviation instead, and the share is noise / deviation. Without noise, the share is the smallest one. */
static void try_range(struct gaussian_fit *fit, double range_m)
{
    const struct gaussian_params *stated = fit->stated;
    double step = log(MAX_SHARE / GAUSSIAN_LEAST_NOISE) / (SHARES - 1), centre = NAN;
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < SHARES; i++) {
            double share = pass ? centre * exp(step * (2.0 * i / (SHARES - 1) - 1)) : GAUSSIAN_LEAST_NOISE * exp(step * i);
            share = max_of(share, GAUSSIAN_LEAST_NOISE);
            if (!isnan(stated->noise) && !isnan(stated->deviation))
                share = max_of(stated->noise / stated->deviation, GAUSSIAN_LEAST_NOISE);
            if (stated->noise == 0)
                share = GAUSSIAN_LEAST_NOISE;
            double deviation = !(stated->noise > 0) || !isnan(stated->deviation) ? stated->deviation : stated->noise / share;
            try_share(fit, range_m, share, deviation);
        }
        centre = fit->best.deviation > 0 ? fit->best.noise / fit->best.deviation : GAUSSIAN_LEAST_NOISE;
    }
}

static double logarithm(double x) /* log(), callable where a parameter named `log` hides it */
{
    return log(x);
}

/* one point of the search for the best correlation range: the range's logarithm and the largest likelihood found with it */
struct range_trial {
    double log_range, likelihood;
};

/* Finds the best noise and deviation for a range, and keeps them if they are the best so far. Returns false after logging if
 * out of memory. */
static bool try_one(struct gaussian_fit *fit, double log_range, struct range_trial *trial)
{
    const struct gaussian_params best = fit->best;
    const double best_likelihood = fit->best_likelihood;
    if (!gaussian_covariance_find(&fit->covariance, fit->log, fit->workers, exp(log_range)))
        return false;
    fit->best_likelihood = -INFINITY;
    try_range(fit, exp(log_range));
    *trial = (struct range_trial){ log_range, fit->best_likelihood };
    if (!(fit->best_likelihood > best_likelihood)) {
        fit->best = best;
        fit->best_likelihood = best_likelihood;
    }
    return true;
}

/* Prepares a fit of the Gaussian process to readings. Returns false after logging if out of memory. In either case, call finish_fit(). */
static bool begin_fit(struct gaussian_fit *fit, const struct gaussian_params *stated, const struct gaussian_data *data)
{
    const size_t n = data->table->count;
    *fit = (struct gaussian_fit){
        .stated = stated, .table = data->table, .log = data->log, .workers = data->workers, .best_likelihood = -INFINITY
    };
    fit->scatter = mem_array(n * n, sizeof(*fit->scatter));
    fit->room[0] = mem_array(n * n, sizeof(double));
    fit->room[1] = mem_array(n * n, sizeof(double));
    fit->means = mem_array(n, sizeof(*fit->means));
    find_scatter(fit);
    return gaussian_covariance_init(&fit->covariance, data->log, data->mesh);
}

static void finish_fit(struct gaussian_fit *fit)
{
    gaussian_covariance_finish(&fit->covariance);
    mem_free(fit->scatter);
    mem_free(fit->room[0]);
    mem_free(fit->room[1]);
    mem_free(fit->means);
}

/* Chooses the sensors for the grid search: at most FEW sensors, evenly spaced by index. */
static void pick_few(const struct influence_mesh *mesh, const struct readings_table *table, struct influence_mesh *few_of_mesh,
                     struct readings_table *few_of_table)
{
    const size_t n = table->count, count = n < FEW ? n : FEW;
    *few_of_mesh = *mesh;
    few_of_mesh->source_count = count;
    few_of_mesh->discs = mem_array(count, sizeof(*few_of_mesh->discs));
    *few_of_table = (struct readings_table){ .count = count, .instants = table->instants };
    few_of_table->values = mem_array(table->instants * count, sizeof(*few_of_table->values));
    for (size_t i = 0; i < count; i++) {
        const size_t from = i * n / count;
        few_of_mesh->discs[i] = mesh->discs[from];
        for (size_t t = 0; t < table->instants; t++)
            few_of_table->values[t * count + i] = table->values[t * n + from];
    }
}

/* Finds the best range in the grid with a subset of the sensors (pick_few()). */
static bool look_around(const struct gaussian_params *stated, const struct gaussian_data *data, double first, double step,
                        double *log_range)
{
    struct influence_mesh few_of_mesh;
    struct readings_table few_of_table;
    struct gaussian_fit fit;
    struct range_trial trial;
    pick_few(data->mesh, data->table, &few_of_mesh, &few_of_table);
    const struct gaussian_data few = { data->log, data->workers, &few_of_mesh, &few_of_table };
    bool good = begin_fit(&fit, stated, &few);
    for (int i = 0; good && i < RANGES; i++)
        good = try_one(&fit, first + step * i, &trial);
    *log_range = fit.best.range_m > 0 ? logarithm(fit.best.range_m) : first;
    finish_fit(&fit);
    mem_free(few_of_table.values);
    mem_free(few_of_mesh.discs);
    return good;
}

/* Returns the x coordinate of the maximum of the parabola through three points, or NAN if it is outside them. */
static double summit(const struct range_trial at[3])
{
    double a = at[1].log_range - at[0].log_range, b = at[1].log_range - at[2].log_range;
    double fa = at[1].likelihood - at[0].likelihood, fb = at[1].likelihood - at[2].likelihood;
    double over = a * fb - b * fa, up = a * a * fb - b * b * fa;
    return over != 0 && isfinite(up / over) ? at[1].log_range - up / over / 2 : NAN;
}

/* Refines the best range: evaluates three ranges one step apart, then three closer ones around the maximum of their parabola, and so on. */
static bool close_in(struct gaussian_fit *fit, double start, double step, double first, double last)
{
    struct range_trial at[3];
    start = min_of(max_of(start, first + step), last - step);
    for (int i = 0; i < 3; i++)
        if (!try_one(fit, start + step * (i - 1), &at[i]))
            return false;
    while (at[0].likelihood > at[1].likelihood && at[0].log_range > first) {
        at[2] = at[1], at[1] = at[0];
        if (!try_one(fit, at[1].log_range - step, &at[0]))
            return false;
    }
    while (at[2].likelihood > at[1].likelihood && at[2].log_range < last) {
        at[0] = at[1], at[1] = at[2];
        if (!try_one(fit, at[1].log_range + step, &at[2]))
            return false;
    }
    for (int i = 0; i < CLOSER; i++) {
        double log_range = summit(at);
        struct range_trial found;
        if (!(log_range > at[0].log_range && log_range < at[2].log_range) || fabs(log_range - at[1].log_range) < SAME)
            break;
        if (!try_one(fit, log_range, &found))
            return false;
        if (found.likelihood <= at[1].likelihood)
            at[found.log_range < at[1].log_range ? 0 : 2] = found;
        else {
            at[found.log_range < at[1].log_range ? 2 : 0] = at[1];
            at[1] = found;
        }
    }
    return true;
}

bool gaussian_fit(struct gaussian_params *params, const struct gaussian_data *data, double least_m, double most_m, char why[300])
{
    const size_t n = data->table->count;
    struct gaussian_fit fit;
    if (n < PLANT_GP_FITTED) {
        snprintf(why, 300,
                 "the asset has %zu sensors, but the fit of `gp` needs at least %d: set `range_m`, `noise` and `deviation` instead", n,
                 PLANT_GP_FITTED);
        return false;
    }
    bool good = begin_fit(&fit, params, data);
    if (good && isnan(params->range_m)) {
        double first = logarithm(least_m), last = logarithm(most_m), step = (last - first) / (RANGES - 1), start;
        good = look_around(params, data, first, step, &start) && close_in(&fit, start, step / 2, first, last);
    } else if (good) {
        struct range_trial trial;
        good = try_one(&fit, logarithm(params->range_m), &trial);
    }
    if (!good)
        snprintf(why, 300, "the fit of the Gaussian process (gp) to the readings failed: see the messages above");
    else if (!(fit.best.deviation > 0)) {
        snprintf(why, 300,
                 "the Gaussian process (gp) cannot be fitted, because the sensors on each connected part always have equal "
                 "readings: set `range_m`, `noise` and `deviation` instead");
        good = false;
    } else {
        /* keeps stated parameters to the last bit, which the search may round: the daemon compares them with the plant file */
        params->range_m = isnan(params->range_m) ? fit.best.range_m : params->range_m;
        params->noise = isnan(params->noise) ? fit.best.noise : params->noise;
        params->deviation = isnan(params->deviation) ? fit.best.deviation : params->deviation;
    }
    finish_fit(&fit);
    return good;
}
