/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the covariance D' A^-1 C A^-1 D (letters: gaussian_covariance.h) as the derivative of -D' A^-1 D with respect to
   k^2. Computes D' A^-1 D for k^2 exp(-STEP) and for k^2 exp(STEP), and divides their difference by that of the two squares
   (central difference). */
#include "preprocess/influence/gaussian_covariance.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"

/* step of log k^2; the relative error of the central difference is STEP^2 / 6; a smaller step would lose digits to cancellation */
#define STEP 0.02

/* --- preparation that does not depend on the correlation range, done only once -------------------------------------------------- */

/* Lists, for each row of the Laplacian (a mesh point), the sensors whose discs contain the point, ordered by index. A sensor's
 * disc is the set of mesh points that its reading averages. The list of row r is sensors[first[r]] .. sensors[first[r + 1] -
 * 1]. */
static void list_sensors(const struct influence_mesh *mesh, const struct laplacian *laplacian, size_t *first, uint32_t *sensors,
                         double *shares)
{
    const size_t rows = laplacian->row_count;
    for (size_t s = 0; s < mesh->source_count; s++)
        for (size_t i = 0; i < mesh->discs[s].count; i++)
            first[laplacian->row_of[mesh->discs[s].points[i]] + 1]++;
    for (size_t r = 0; r < rows; r++)
        first[r + 1] += first[r];
    size_t *at = mem_array(rows + 1, sizeof(*at));
    memcpy(at, first, rows * sizeof(*at));
    for (size_t s = 0; s < mesh->source_count; s++)
        for (size_t i = 0; i < mesh->discs[s].count; i++) {
            size_t slot = at[laplacian->row_of[mesh->discs[s].points[i]]]++;
            sensors[slot] = (uint32_t)s;
            shares[slot] = mesh->discs[s].shares[i];
        }
    mem_free(at);
}

/* Returns an upper bound of the norm k^2 |D' A^-1 D| (D: sensor weights, A = k^2 C + G, C: areas, G: stiffness). The bound is
 * |D' C^-1 D|, estimated from the weights of sensors that share a mesh point. */
static double find_bound(size_t rows, const size_t *first, const uint32_t *sensors, const double *shares, const double *mass_m2,
                         size_t count)
{
    double *sums = mem_array(count + 1, sizeof(*sums)), bound = 0;
    for (size_t r = 0; r < rows; r++) {
        double weight = 0;
        for (size_t at = first[r]; at < first[r + 1]; at++)
            weight += shares[at];
        for (size_t at = first[r]; at < first[r + 1]; at++)
            sums[sensors[at]] += shares[at] * weight / mass_m2[r];
    }
    for (size_t s = 0; s < count; s++)
        bound = max_of(bound, sums[s]);
    mem_free(sums);
    return bound;
}

/* Builds the bordered matrix: G, one row of D' per sensor below it, and one column per sensor, of which only the diagonal
 * element is stored (letters: gaussian_covariance.h). */
static cholmod_sparse *add_border(const cholmod_sparse *inner, size_t count, const size_t *first, const uint32_t *sensors,
                                  const double *shares, cholmod_common *common)
{
    const size_t rows = inner->nrow;
    const int *from = inner->p, *from_rows = inner->i;
    const double *from_values = inner->x;
    cholmod_sparse *matrix =
        cholmod_allocate_sparse(rows + count, rows + count, (size_t)from[rows] + first[rows] + count, true, true, -1, CHOLMOD_REAL, common);
    if (!matrix)
        return NULL;
    int *columns = matrix->p, *row = matrix->i, n = 0;
    double *values = matrix->x;
    for (size_t c = 0; c < rows; c++) {
        columns[c] = n;
        for (int at = from[c]; at < from[c + 1]; at++, n++) {
            row[n] = from_rows[at];
            values[n] = from_values[at];
        }
        for (size_t at = first[c]; at < first[c + 1]; at++, n++) {
            row[n] = (int)(rows + sensors[at]);
            values[n] = shares[at];
        }
    }
    for (size_t c = rows; c <= rows + count; c++) {
        columns[c] = n;
        if (c < rows + count)
            row[n++] = (int)c;
    }
    return matrix;
}

/* Computes an elimination order for the rows of the bordered matrix that keeps the factor sparse: mesh points first, sensors last. */
static cholmod_factor *analyze(cholmod_sparse *inner, cholmod_sparse *bordered, cholmod_common *common)
{
    cholmod_factor *points = cholmod_analyze(inner, common);
    int *order = points ? mem_array(bordered->nrow, sizeof(*order)) : NULL;
    if (!order)
        return NULL;
    for (size_t i = 0; i < bordered->nrow; i++)
        order[i] = i < inner->nrow ? ((int *)points->Perm)[i] : (int)i;
    cholmod_free_factor(&points, common);
    common->method[0].ordering = CHOLMOD_GIVEN;
    common->supernodal = CHOLMOD_SUPERNODAL;
    cholmod_factor *symbolic = cholmod_analyze_p(bordered, order, NULL, 0, common);
    mem_free(order);
    return symbolic;
}

static bool set_up(struct gaussian_covariance *covariance, const struct influence_mesh *mesh, struct laplacian *laplacian)
{
    const size_t count = covariance->count, rows = laplacian->row_count;
    size_t touched = 0;
    for (size_t s = 0; s < count; s++)
        touched += mesh->discs[s].count;
    size_t *first = mem_array(rows + 1, sizeof(*first));
    uint32_t *sensors = mem_array(touched + 1, sizeof(*sensors));
    double *shares = mem_array(touched + 1, sizeof(*shares)), *nothing = mem_array(rows, sizeof(*nothing));
    for (size_t r = 0; r < rows; r++)
        laplacian->mass_m2[r] = max_of(laplacian->mass_m2[r], 1e-30);
    list_sensors(mesh, laplacian, first, sensors, shares);
    covariance->bound = find_bound(rows, first, sensors, shares, laplacian->mass_m2, count);
    cholmod_sparse *stiffness = laplacian_assemble(laplacian, nothing, 1, &covariance->common);
    if (stiffness)
        covariance->bordered = add_border(stiffness, count, first, sensors, shares, &covariance->common);
    if (covariance->bordered)
        covariance->symbolic = analyze(stiffness, covariance->bordered, &covariance->common);
    cholmod_free_sparse(&stiffness, &covariance->common);
    mem_free(first);
    mem_free(sensors);
    mem_free(shares);
    mem_free(nothing);
    return covariance->symbolic != NULL;
}

bool gaussian_covariance_init(struct gaussian_covariance *covariance, struct log *log, const struct influence_mesh *mesh)
{
    const size_t count = mesh->source_count;
    struct laplacian laplacian;
    *covariance = (struct gaussian_covariance){ .count = count };
    laplacian_start(&covariance->common);
    covariance->values = mem_try_array(count * count, sizeof(*covariance->values));
    bool good = laplacian_init(&laplacian, &mesh->intrinsic) && covariance->values && set_up(covariance, mesh, &laplacian);
    if (good) {
        gaussian_bodies_init(&covariance->bodies, mesh, &laplacian);
        covariance->row_count = laplacian.row_count;
        covariance->mass_m2 = laplacian.mass_m2;
        laplacian.mass_m2 = NULL;
        covariance->scale = mem_array(mesh->mesh.point_count, sizeof(*covariance->scale));
    } else
        log_err(log, "cannot compute the covariance of %zu sensors on %zu surface points: out of memory", count, mesh->mesh.point_count);
    laplacian_finish(&laplacian);
    return good;
}

void gaussian_covariance_finish(struct gaussian_covariance *covariance)
{
    cholmod_free_sparse(&covariance->bordered, &covariance->common);
    cholmod_free_factor(&covariance->symbolic, &covariance->common);
    gaussian_bodies_finish(&covariance->bodies);
    mem_free(covariance->values);
    mem_free(covariance->mass_m2);
    mem_free(covariance->scale);
    cholmod_finish(&covariance->common);
}

/* --- a range ----------------------------------------------------------------------------------------------------------------- */

struct slope {
    const struct gaussian_covariance *covariance;
    double k2[2];
    /* [sensor][sensor], lower triangle: D' A^-1 D (letters: gaussian_covariance.h) minus its constant part, for the lower and the upper k^2
     * of the central difference */
    double *between[2];
    atomic_int status; /* the first CHOLMOD status other than CHOLMOD_OK in any thread */
};

static size_t sensor_of(const struct gaussian_covariance *covariance, const cholmod_factor *factor, int row)
{
    return (size_t)((int *)factor->Perm)[row] - covariance->row_count;
}

/* Subtracts l l' from the matrix `from` for each column l in the sensors' block of the factor. */
static void take_columns(const struct gaussian_covariance *covariance, const cholmod_factor *factor, double *from)
{
    const size_t count = covariance->count;
    const int *super = factor->super, *first_row = factor->pi, *first_value = factor->px, *rows = factor->s;
    for (size_t node = 0; node < factor->nsuper; node++) {
        const int height = first_row[node + 1] - first_row[node], *row = rows + first_row[node];
        const double *l = (double *)factor->x + first_value[node];
        for (int column = 0; column < super[node + 1] - super[node]; column++, l += height) {
            if (((int *)factor->Perm)[row[column]] < (int)covariance->row_count)
                continue;
            for (int i = column; i < height; i++)
                for (int j = column; j <= i; j++) {
                    size_t a = sensor_of(covariance, factor, row[i]), b = sensor_of(covariance, factor, row[j]);
                    from[a > b ? a * count + b : b * count + a] -= l[i] * l[j];
                }
        }
    }
}

static void fill_diagonal(const struct gaussian_covariance *covariance, double k2, double border, cholmod_sparse *matrix)
{
    const int *first = matrix->p;
    double *values = matrix->x;
    for (size_t c = 0; c < matrix->ncol; c++)
        if (c < covariance->row_count)
            values[first[c]] += k2 * covariance->mass_m2[c];
        else
            values[first[c]] = border;
}

/* Computes D' A^-1 D (letters: gaussian_covariance.h) as border - F F', where `border` is the border's diagonal and F the sensors' block of
 * the factor. */
static void find_side(const struct gaussian_covariance *covariance, double k2, double *between, cholmod_common *common)
{
    const size_t count = covariance->count;
    const double border = 2 * covariance->bound / k2;
    cholmod_sparse *matrix = cholmod_copy_sparse(covariance->bordered, common);
    cholmod_factor *factor = cholmod_copy_factor(covariance->symbolic, common);
    if (matrix && factor)
        fill_diagonal(covariance, k2, border, matrix);
    if (matrix && factor && cholmod_factorize(matrix, factor, common) && common->status == CHOLMOD_OK) {
        for (size_t i = 0; i < count; i++)
            between[i * (count + 1)] = border;
        take_columns(covariance, factor, between);
        for (size_t i = 0; i < count; i++)
            for (size_t j = 0; j <= i; j++)
                if (covariance->bodies.of_sensor[i] == covariance->bodies.of_sensor[j])
                    between[i * count + j] -= gaussian_bodies_constant(&covariance->bodies, covariance->bodies.of_sensor[i]) / k2;
    }
    cholmod_free_sparse(&matrix, common);
    cholmod_free_factor(&factor, common);
}

static void find_sides(void *arg, size_t begin, size_t end)
{
    struct slope *slope = arg;
    cholmod_common common;
    laplacian_start(&common);
    for (size_t side = begin; side < end && common.status == CHOLMOD_OK; side++)
        find_side(slope->covariance, slope->k2[side], slope->between[side], &common);
    if (common.status != CHOLMOD_OK)
        slope->status = common.status;
    cholmod_finish(&common);
}

bool gaussian_covariance_find(struct gaussian_covariance *covariance, struct log *log, struct workers *workers, double range_m)
{
    const size_t count = covariance->count;
    const double k2 = 8 / (range_m * range_m);
    struct slope slope = { .covariance = covariance, .k2 = { k2 * exp(-STEP), k2 * exp(STEP) }, .status = CHOLMOD_OK };
    for (int side = 0; side < 2; side++)
        slope.between[side] = mem_array(count * count, sizeof(**slope.between));
    workers_for(workers, 2, 1, find_sides, &slope);
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j <= i; j++)
            covariance->values[i * count + j] = covariance->values[j * count + i] =
                (slope.between[0][i * count + j] - slope.between[1][i * count + j]) / (slope.k2[1] - slope.k2[0]);
    for (int side = 0; side < 2; side++)
        mem_free(slope.between[side]);
    gaussian_bodies_scale(&covariance->bodies, count, covariance->values, covariance->scale);
    if (slope.status != CHOLMOD_OK)
        log_err(log, "cannot compute the covariance of %zu sensors on %zu surface points with range %g m: %s", count, covariance->row_count,
                range_m,
                slope.status == CHOLMOD_NOT_POSDEF ? "the equations for the asset's surface cannot be solved: check its model for "
                                                     "extremely thin triangles, and `range_m` (matrix not positive definite)"
                                                   : "out of memory");
    return slope.status == CHOLMOD_OK;
}
