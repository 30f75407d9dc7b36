/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Transports tangent vectors from sensors by solving a system with the connection Laplacian (transport.h): one sparse Cholesky
 * factorisation with two unknowns per mesh point, and one solve per sensor. */
#include "preprocess/influence/transport.h"

#include <math.h>
#include <stdatomic.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/geodesic/laplacian.h"
#include "surface/geodesic/solver.h"

/* minimum diffusion length sqrt(t), as the surface's size divided by this number; heat underflows at e^-709 */
#define LENGTHS 150.0
/* minimum diffusion length sqrt(t), as the longest path along the surface divided by this number, because heat underflows; on
 * folded parts, paths are much longer than the surface's size */
#define LONGEST 400.0
#define LEAST 1e-280 /* minimum length of a solved vector; a shorter one has lost its direction to rounding */

struct vector_heat {
    struct influence *influence;
    const struct influence_mesh *mesh;
    const struct influence_anchor *anchors;
    const float (*vertex_normals)[3];
    double (*normals)[3]; /* by point of the mesh: unit normal */
    struct laplacian laplacian;
    cholmod_factor *factor;
    atomic_bool failed;
};

/* --- normals and path lengths on the surface
 * ------------------------------------------------------------------------------------------------------------ */

/* Computes a normal at each mesh point: the area-weighted mean of the triangles around it, or the largest triangle's normal where the
 * normals cancel out, as on a two-sided sheet. */
static void find_normals(struct vector_heat *transport)
{
    const struct trimesh *mesh = &transport->mesh->mesh;
    double *largest = mem_array(mesh->point_count, sizeof(*largest)), (*spare)[3] = mem_array(mesh->point_count, sizeof(*spare));
    for (size_t t = 0; t < mesh->tri_count; t++) {
        double normal[3], size;
        trimesh_normal(mesh, t, normal);
        size = vec_length(normal);
        for (int i = 0; i < 3; i++) {
            uint32_t p = mesh->tris[t][i];
            for (int c = 0; c < 3; c++) {
                transport->normals[p][c] += normal[c];
                spare[p][c] = size > largest[p] ? normal[c] : spare[p][c];
            }
            largest[p] = max_of(largest[p], size);
        }
    }
    for (size_t p = 0; p < mesh->point_count; p++) {
        bool cancels = !(vec_length(transport->normals[p]) > 1e-3 * largest[p]);
        for (int c = 0; cancels && c < 3; c++)
            transport->normals[p][c] = largest[p] > 0 ? spare[p][c] : c == 2;
        vec_normalize(transport->normals[p]);
    }
    mem_free(largest);
    mem_free(spare);
}

/* Adjacency lists: by point, the mesh edges that end there. */
struct ways {
    size_t *first; /* by point: index in `at` of its first edge; plus one element at the end */
    struct transport_edge {
        uint32_t to;
        double length_m;
    } * at;
    uint32_t *queue;
    double *gone_m; /* by point: length of the path from the start, metres; < 0: not reached yet */
};

static void find_ways(const struct intrinsic *in, size_t point_count, struct ways *ways)
{
    size_t *next = mem_array(point_count + 1, sizeof(*next));
    ways->first = mem_array(point_count + 1, sizeof(*ways->first));
    ways->at = mem_array(6 * in->tri_count + 1, sizeof(*ways->at));
    ways->queue = mem_array(point_count + 1, sizeof(*ways->queue));
    ways->gone_m = mem_array(point_count + 1, sizeof(*ways->gone_m));
    for (size_t t = 0; t < in->tri_count; t++)
        for (int i = 0; i < 3; i++)
            ways->first[in->points[t][i] + 1] += 2;
    for (size_t p = 0; p < point_count; p++)
        next[p + 1] = ways->first[p + 1] += ways->first[p];
    for (size_t t = 0; t < in->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t a = in->points[t][i], b = in->points[t][(i + 1) % 3];
            ways->at[next[a]++] = (struct transport_edge){ b, in->lengths[t][i] };
            ways->at[next[b]++] = (struct transport_edge){ a, in->lengths[t][i] };
        }
    for (size_t p = 0; p < point_count; p++)
        ways->gone_m[p] = -1;
    mem_free(next);
}

/* Breadth-first search along mesh edges from point `from`. Returns the number of points reached, which queue[] lists.
 * *farthest: the point with the longest path. */
static size_t spread(struct ways *ways, uint32_t from, uint32_t *farthest)
{
    size_t count = 1;
    ways->queue[0] = *farthest = from;
    ways->gone_m[from] = 0;
    for (size_t i = 0; i < count; i++)
        for (size_t k = ways->first[ways->queue[i]]; k < ways->first[ways->queue[i] + 1]; k++) {
            uint32_t to = ways->at[k].to;
            if (ways->gone_m[to] >= 0)
                continue;
            ways->gone_m[to] = ways->gone_m[ways->queue[i]] + ways->at[k].length_m;
            ways->queue[count++] = to;
            if (ways->gone_m[to] > ways->gone_m[*farthest])
                *farthest = to;
        }
    return count;
}

/* Returns the approximate length, in metres, of the longest path within any connected component: finds the point farthest from
   an arbitrary one, then the longest path from there. */
static double longest_way_m(const struct intrinsic *in, size_t point_count)
{
    struct ways ways;
    double longest_m = 0;
    find_ways(in, point_count, &ways);
    for (uint32_t p = 0; p < point_count; p++) {
        if (ways.gone_m[p] >= 0)
            continue;
        uint32_t end, other;
        size_t count = spread(&ways, p, &end);
        for (size_t i = 0; i < count; i++)
            ways.gone_m[ways.queue[i]] = -1;
        spread(&ways, end, &other);
        longest_m = max_of(longest_m, ways.gone_m[other]);
    }
    mem_free(ways.first);
    mem_free(ways.at);
    mem_free(ways.queue);
    mem_free(ways.gone_m);
    return longest_m;
}

static double diffusion_time_m2(const struct vector_heat *transport)
{
    const struct intrinsic *in = &transport->mesh->intrinsic;
    const struct trimesh *mesh = &transport->mesh->mesh;
    double sum_m = 0;
    for (size_t t = 0; t < in->tri_count; t++)
        for (int i = 0; i < 3; i++)
            sum_m += in->lengths[t][i];
    double length_m = max_of(sum_m / (3 * (double)in->tri_count), transport->mesh->size_m / LENGTHS);
    length_m = max_of(length_m, longest_way_m(in, mesh->point_count) / LONGEST);
    return length_m * length_m;
}

/* --- the system ------------------------------------------------------------------------------------------------------------- */

struct triplets {
    cholmod_triplet *list;
    size_t count;
};

static void put(struct triplets *triplets, uint32_t row, uint32_t column, double value)
{
    ((int *)triplets->list->i)[triplets->count] = (int)row;
    ((int *)triplets->list->j)[triplets->count] = (int)column;
    ((double *)triplets->list->x)[triplets->count++] = value;
}

/* Adds the matrix block for the points a and b: weight times the rotation from b's tangent plane to a's. Swaps a and b if a's row
 * number is the smaller one. */
static void put_pair(const struct vector_heat *transport, struct triplets *triplets, uint32_t a, uint32_t b, double weight)
{
    const uint32_t *row_of = transport->laplacian.row_of;
    if (row_of[a] < row_of[b]) {
        put_pair(transport, triplets, b, a, weight);
        return;
    }
    double of_a[2][3], of_b[2][3];
    vec_frame(transport->normals[a], of_a[0], of_a[1]);
    vec_frame(transport->normals[b], of_b[0], of_b[1]);
    for (int q = 0; q < 2; q++) {
        vec_turn(of_b[q], transport->normals[b], transport->normals[a]);
        for (uint32_t p = 0; p < 2; p++)
            put(triplets, 2 * row_of[a] + p, 2 * row_of[b] + (uint32_t)q, weight * vec_dot(of_a[p], of_b[q]));
    }
}

static void put_edges(const struct vector_heat *transport, const cholmod_sparse *scalar, uint32_t *points, double *diagonal,
                      struct triplets *triplets)
{
    const struct laplacian *laplacian = &transport->laplacian;
    const int *first = scalar->p, *rows = scalar->i;
    const double *values = scalar->x;
    for (uint32_t p = 0; p < laplacian->in->point_count; p++)
        if (laplacian->row_of[p] != TRIMESH_NONE)
            points[laplacian->row_of[p]] = p;
    for (size_t column = 0; column < laplacian->row_count; column++)
        for (int k = first[column]; k < first[column + 1]; k++) {
            if ((size_t)rows[k] == column || !(values[k] < 0))
                continue;
            put_pair(transport, triplets, points[rows[k]], points[column], values[k]);
            diagonal[rows[k]] -= values[k];
            diagonal[column] -= values[k];
        }
    for (uint32_t i = 0; i < 2 * laplacian->row_count; i++)
        put(triplets, i, i, laplacian->mass_m2[i / 2] + diagonal[i / 2]);
}

/* Assembles the connection Laplacian: the scalar Laplacian with a rotation at each edge. Drops edges of negative weight, which
 * are possible at a rim opposite an obtuse angle: if rotations around a triangle do not cancel out, the matrix is only positive
 * definite if all weights are positive. */
static cholmod_sparse *assemble(const struct vector_heat *transport, double time_m2, cholmod_common *common)
{
    const struct laplacian *laplacian = &transport->laplacian;
    cholmod_sparse *scalar = laplacian_assemble(laplacian, laplacian->mass_m2, time_m2, common);
    const size_t rows = 2 * laplacian->row_count;
    struct triplets triplets = { 0 };
    if (scalar)
        triplets.list = cholmod_allocate_triplet(rows, rows, rows + 4 * cholmod_nnz(scalar, common), -1, CHOLMOD_REAL, common);
    uint32_t *points = triplets.list ? mem_try_array(laplacian->row_count, sizeof(*points)) : NULL;
    double *diagonal = points ? mem_try_array(laplacian->row_count, sizeof(*diagonal)) : NULL;
    cholmod_sparse *matrix = NULL;
    if (diagonal) {
        put_edges(transport, scalar, points, diagonal, &triplets);
        triplets.list->nnz = triplets.count;
        matrix = cholmod_triplet_to_sparse(triplets.list, triplets.count, common);
    }
    mem_free(points);
    mem_free(diagonal);
    cholmod_free_sparse(&scalar, common);
    cholmod_free_triplet(&triplets.list, common);
    return matrix;
}

static bool factorize(struct vector_heat *transport, cholmod_common *common)
{
    cholmod_sparse *matrix = assemble(transport, diffusion_time_m2(transport), common);
    transport->factor = matrix ? cholmod_analyze(matrix, common) : NULL;
    bool good = transport->factor && cholmod_factorize(matrix, transport->factor, common) && common->status == CHOLMOD_OK;
    cholmod_free_sparse(&matrix, common);
    return good;
}

/* --- one sensor ------------------------------------------------------------------------------------------------------------- */

/* Sets the right-hand side for a sensor: a tangent vector at the mesh point nearest to it, and copies rotated into the tangent
 * planes of all other points in the sensor's disc. */
static void start_from(const struct vector_heat *transport, size_t sensor, double *b)
{
    const struct influence_disc *disc = &transport->mesh->discs[sensor];
    const double *normal = transport->normals[disc->points[0]];
    double x[3], y[3];
    vec_frame(normal, x, y);
    for (size_t i = 0; i < disc->count; i++) {
        const double *there = transport->normals[disc->points[i]];
        double v[3] = { x[0], x[1], x[2] }, frame[2][3];
        vec_turn(v, normal, there);
        vec_frame(there, frame[0], frame[1]);
        for (uint32_t p = 0; p < 2; p++)
            b[2 * transport->laplacian.row_of[disc->points[i]] + p] += disc->shares[i] * vec_dot(frame[p], v);
    }
}

static float angle_at(const struct vector_heat *transport, size_t vertex, const double *u)
{
    const struct influence_anchor *anchor = &transport->anchors[vertex];
    double normal[3], frame[2][3], x = 0, y = 0;
    for (int c = 0; c < 3; c++)
        normal[c] = (double)transport->vertex_normals[vertex][c];
    vec_normalize(normal);
    vec_frame(normal, frame[0], frame[1]);
    for (int i = 0; i < 3; i++) {
        const double *from = transport->normals[anchor->points[i]], *at = &u[2 * transport->laplacian.row_of[anchor->points[i]]];
        double length = hypot(at[0], at[1]), of[2][3], v[3];
        if (!(length > LEAST))
            continue;
        vec_frame(from, of[0], of[1]);
        for (int c = 0; c < 3; c++)
            v[c] = (double)anchor->weights[i] / length * (at[0] * of[0][c] + at[1] * of[1][c]);
        vec_turn(v, from, normal);
        x += vec_dot(v, frame[0]);
        y += vec_dot(v, frame[1]);
    }
    return x == 0 && y == 0 ? INFINITY : (float)atan2(y, x);
}

static void solve_some(void *arg, size_t begin, size_t end)
{
    struct vector_heat *transport = arg;
    struct solver solver;
    solver_init(&solver);
    for (size_t sensor = begin; sensor < end && !transport->failed; sensor++) {
        double *b = solver_begin(&solver, 2 * transport->laplacian.row_count, 1);
        if (b)
            start_from(transport, sensor, b);
        const double *u = b ? solver_solve(&solver, transport->factor) : NULL;
        for (size_t v = 0; u && v < transport->influence->vertex_count; v++)
            transport->influence->shares[sensor * transport->influence->vertex_count + v] = angle_at(transport, v, u);
        if (!u)
            transport->failed = true;
    }
    solver_finish(&solver);
}

bool transport_angles(struct influence *influence, struct log *log, struct workers *workers, const struct influence_mesh *mesh,
                      const struct influence_anchor *anchors, const float (*normals)[3], size_t vertex_count)
{
    struct vector_heat transport = { .influence = influence, .mesh = mesh, .anchors = anchors, .vertex_normals = normals };
    cholmod_common common;
    laplacian_start(&common);
    *influence = (struct influence){ .count = mesh->source_count, .vertex_count = vertex_count };
    influence->shares = mem_try_array(influence->count * vertex_count, sizeof(*influence->shares));
    influence->precision = mem_try_array(influence->count * influence->count, sizeof(*influence->precision));
    transport.normals = mem_try_array(mesh->mesh.point_count, sizeof(*transport.normals));
    bool good = influence->shares && influence->precision && transport.normals && laplacian_init(&transport.laplacian, &mesh->intrinsic);
    if (good)
        find_normals(&transport);
    good = good && factorize(&transport, &common);
    if (good)
        workers_for(workers, influence->count, 1, solve_some, &transport);
    good = good && !transport.failed;
    if (!good)
        log_err(log, "cannot compute how the directions measured by %zu sensors continue over %zu surface points: %s", influence->count,
                mesh->mesh.point_count,
                common.status == CHOLMOD_NOT_POSDEF ? "the equations for the asset's surface cannot be solved: check its model for "
                                                      "extremely thin triangles (matrix not positive definite)"
                                                    : "out of memory");
    cholmod_free_factor(&transport.factor, &common);
    cholmod_finish(&common);
    laplacian_finish(&transport.laplacian);
    mem_free(transport.normals);
    return good;
}
