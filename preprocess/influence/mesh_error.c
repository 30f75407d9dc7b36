/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the flux imbalance at each mesh edge from the values at mesh points, between which the field is linear, and sums it
 * over sensors. */
#include "preprocess/influence/mesh_error.h"

#include <math.h>
#include <stdatomic.h>

#include "base/math/simd.h"
#include "base/math/vec.h"
#include "base/mem.h"

/* safety factor on the estimated error; 2 because the values at mesh points have an error about as large as the error between points */
#define SAFETY 2.0
#define FIXED 0x1p40 /* fixed-point scale of a flux imbalance; unlike floating point, integer sums do not depend on the order of addition */

/* Linear form whose value is an edge's flux imbalance times the height of its lowest triangle: how far the field at that
 * triangle's tip (the corner opposite the edge) differs from a linear continuation of the edge's other triangles. */
struct edge_form {
    uint32_t first, count; /* index of the form's first term; number of terms */
    float low_m, sum_m;    /* heights of the edge's adjacent triangles above the edge: the smallest, and the sum of all */
};
struct edge_term {
    uint32_t point;
    float factor;
};

struct mesh_error {
    const struct influence_mesh *mesh;
    struct edge_form *edges;
    struct edge_term *terms;
    size_t edge_count;
    uint32_t (*edges_of)[3];       /* by triangle: index of the edge from each corner to the next */
    float (*heights_m)[3];         /* by triangle: its height above each of its edges; 0: the triangle is degenerate */
    _Atomic int64_t *plus, *minus; /* by edge: sums of the sensors' positive and negative flux imbalances, in fixed point */
};

/* --- the mesh ----------------------------------------------------------------------------------------------------------------- */

/* Returns the height of a triangle's tip above the edge a-b. *foot: position of the tip's projection on the edge, 0 at a, 1 at b. */
static double height_m(const double a[3], const double b[3], const double tip[3], double *foot)
{
    double along[3], to[3];
    vec_sub(b, a, along);
    vec_sub(tip, a, to);
    double square = vec_dot(along, along);
    *foot = square > 0 ? vec_dot(to, along) / square : 0;
    for (int c = 0; c < 3; c++)
        to[c] -= *foot * along[c];
    return square > 0 ? vec_length(to) : 0;
}

static void measure_heights(struct mesh_error *error)
{
    const struct trimesh *mesh = &error->mesh->mesh;
    struct edge_table table;
    double foot;
    edge_table_init(&table, 3 * mesh->tri_count / 2);
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            const uint32_t a = mesh->tris[t][i], b = mesh->tris[t][(i + 1) % 3], tip = mesh->tris[t][(i + 2) % 3];
            error->edges_of[t][i] = edge_table_add(&table, a, b);
            error->heights_m[t][i] = (float)height_m(mesh->points[a], mesh->points[b], mesh->points[tip], &foot);
        }
    error->edge_count = table.count;
    edge_table_finish(&table);
}

/* Returns an array by edge: 1 if its ends are in the same sensor's disc, else 0. The caller frees the array (mem_free). */
static char *find_discs(const struct mesh_error *error)
{
    const struct trimesh *mesh = &error->mesh->mesh;
    char *within = mem_array(error->edge_count, 1), *in_disc = mem_array(mesh->point_count, 1);
    for (size_t s = 0; s < error->mesh->source_count; s++) {
        const struct influence_disc *disc = &error->mesh->discs[s];
        for (size_t i = 0; i < disc->count; i++)
            in_disc[disc->points[i]] = 1;
        for (size_t i = 0; i < disc->count; i++)
            for (uint32_t f = error->mesh->fan_first[disc->points[i]]; f < error->mesh->fan_first[disc->points[i] + 1]; f++)
                for (int k = 0; k < 3; k++) {
                    const uint32_t t = error->mesh->fans[f];
                    if (in_disc[mesh->tris[t][k]] && in_disc[mesh->tris[t][(k + 1) % 3]])
                        within[error->edges_of[t][k]] = 1;
                }
        for (size_t i = 0; i < disc->count; i++)
            in_disc[disc->points[i]] = 0;
    }
    mem_free(in_disc);
    return within;
}

static void add_term(struct mesh_error *error, struct edge_form *edge, uint32_t point, double factor)
{
    for (uint32_t i = edge->first; i < edge->first + edge->count; i++)
        if (error->terms[i].point == point) {
            error->terms[i].factor += (float)factor;
            return;
        }
    error->terms[edge->first + edge->count++] = (struct edge_term){ point, (float)factor };
}

/* Reserves space for the terms of each edge's linear form: one for each end of the edge, and one for the opposite corner of
 * each adjacent triangle. */
static bool reserve_terms(struct mesh_error *error)
{
    uint32_t *faces = mem_array(error->edge_count, sizeof(*faces)), next = 0;
    for (size_t t = 0; t < error->mesh->mesh.tri_count; t++)
        for (int i = 0; i < 3; i++)
            faces[error->edges_of[t][i]]++;
    for (size_t e = 0; e < error->edge_count; e++) {
        error->edges[e].first = next;
        next += 2 + faces[e];
    }
    mem_free(faces);
    error->terms = mem_try_array(next, sizeof(*error->terms));
    return error->terms;
}

static bool make_forms(struct mesh_error *error)
{
    const struct trimesh *mesh = &error->mesh->mesh;
    if (!reserve_terms(error))
        return false;
    char *within = find_discs(error);
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            struct edge_form *edge = &error->edges[error->edges_of[t][i]];
            const float high_m = error->heights_m[t][i];
            edge->sum_m += high_m;
            edge->low_m = high_m > 0 && (edge->low_m == 0 || high_m < edge->low_m) ? high_m : edge->low_m;
        }
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            const uint32_t a = mesh->tris[t][i], b = mesh->tris[t][(i + 1) % 3], tip = mesh->tris[t][(i + 2) % 3];
            struct edge_form *edge = &error->edges[error->edges_of[t][i]];
            double foot, high_m = height_m(mesh->points[a], mesh->points[b], mesh->points[tip], &foot);
            if (within[error->edges_of[t][i]] || !((float)high_m > 0))
                continue;
            double factor = (double)edge->low_m / high_m;
            add_term(error, edge, tip, factor);
            add_term(error, edge, a, -factor * (1 - foot));
            add_term(error, edge, b, -factor * foot);
        }
    mem_free(within);
    return true;
}

struct mesh_error *mesh_error_create(const struct influence_mesh *mesh)
{
    struct mesh_error *error = mem_new(sizeof(*error));
    error->mesh = mesh;
    error->edges_of = mem_try_array(mesh->mesh.tri_count, sizeof(*error->edges_of));
    error->heights_m = mem_try_array(mesh->mesh.tri_count, sizeof(*error->heights_m));
    if (!error->edges_of || !error->heights_m)
        goto error;
    measure_heights(error);
    error->edges = mem_try_array(error->edge_count, sizeof(*error->edges));
    error->plus = mem_try_array(error->edge_count, sizeof(*error->plus));
    error->minus = mem_try_array(error->edge_count, sizeof(*error->minus));
    if (!error->edges || !error->plus || !error->minus || !make_forms(error))
        goto error;
    return error;
error:
    mesh_error_destroy(&error);
    return NULL;
}

void mesh_error_destroy(struct mesh_error **error_ptr)
{
    struct mesh_error *error = *error_ptr;
    if (!error)
        return;
    mem_free(error->edges);
    mem_free(error->terms);
    mem_free(error->edges_of);
    mem_free(error->heights_m);
    mem_free((void *)error->plus);
    mem_free((void *)error->minus);
    mem_free(error);
    *error_ptr = NULL;
}

/* --- sums --------------------------------------------------------------------------------------------------------------------- */

SIMD_CLONES("avx512f", "avx2")
void mesh_error_add(struct mesh_error *error, const float *at_points, size_t stride, size_t width)
{
    for (size_t e = 0; e < error->edge_count; e++) {
        const struct edge_form *edge = &error->edges[e];
        float sums[BEND_WIDTH] = { 0 }, plus = 0, minus = 0;
        for (uint32_t i = edge->first; i < edge->first + edge->count; i++) {
            const float *at = at_points + error->terms[i].point * stride, factor = error->terms[i].factor;
            for (size_t s = 0; s < width; s++)
                sums[s] += factor * at[s];
        }
        for (size_t s = 0; s < BEND_WIDTH; s++) {
            plus += sums[s] > 0 ? sums[s] : 0;
            minus -= sums[s] < 0 ? sums[s] : 0;
        }
        atomic_fetch_add_explicit(&error->plus[e], (int64_t)(FIXED * (double)plus), memory_order_relaxed);
        atomic_fetch_add_explicit(&error->minus[e], (int64_t)(FIXED * (double)minus), memory_order_relaxed);
    }
}

/* Returns the discretisation error in triangle `tri` due to its edge i: at most the deviation at the tip of the edge's lowest
 * triangle (struct edge_form). */
static double across(const struct mesh_error *error, size_t tri, int i)
{
    const struct edge_form *edge = &error->edges[error->edges_of[tri][i]];
    double high_m = (double)error->heights_m[tri][i], low_m = (double)edge->low_m;
    double off = max_of((double)error->plus[error->edges_of[tri][i]], (double)error->minus[error->edges_of[tri][i]]) / FIXED;
    return high_m > 0 ? off * fmin(high_m * high_m / (4 * (double)edge->sum_m * low_m), 1) : 0;
}

void mesh_error_take(struct mesh_error *error, float *by_point)
{
    const struct trimesh *mesh = &error->mesh->mesh;
    for (size_t p = 0; p < mesh->point_count; p++)
        by_point[p] = 0;
    for (size_t t = 0; t < mesh->tri_count; t++) {
        double whole = 0;
        for (int i = 0; i < 3; i++)
            whole += SAFETY * across(error, t, i);
        for (int i = 0; i < 3; i++)
            by_point[mesh->tris[t][i]] = fmaxf(by_point[mesh->tris[t][i]], (float)whole);
    }
    for (size_t e = 0; e < error->edge_count; e++)
        error->plus[e] = error->minus[e] = 0;
}
