/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implements the heat method on a point cloud: samples points, finds their neighbours, solves the two linear systems, and
 * interpolates between points. */
#include "preprocess/influence/cloud_heat.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/geodesic/laplacian.h"
#include "surface/mesh/point_cloud.h"
#include "surface/mesh/trimesh.h"

#define PACKING 0.7    /* expected number of Poisson-disc sample points in a square whose side is the point spacing */
#define HEAT_TIME 2.25 /* diffusion time t of the heat method, in squared spacings of the sample points */
/* maximum length of a connected component of the point cloud, in multiples of sqrt(t) (t: diffusion time); for a longer
 * component, t is increased. Heat falls by a factor of e per sqrt(t) and would underflow (DBL_MIN) at 708. */
#define LONGEST 400.0
/* added to the Laplacian's diagonal, relative to the diagonal element, so that rounding does not make the matrix singular */
#define REGULARISATION 1e-9
/* PITCHES: candidate points per spacing, in each direction of a triangle's lattice; PLACES: number of sample points from which
 * a value is interpolated */
enum { PITCHES = 3, PLACES = 4 };

struct heat_link {
    uint32_t from, to; /* indices of two neighbouring sample points, from < to */
    double weight;
};

struct cloud_heat {
    struct log *log;
    double spacing_m, time_m2;
    size_t count, capacity;
    /* points: positions of the sample points; across: two unit vectors that span the tangent plane at each point */
    double (*points)[3], (*across)[2][3];
    uint32_t *piece;                      /* by sample point: number of its connected component */
    struct heat_link *links;
    size_t link_count, link_capacity;
    uint32_t *first, *order; /* indices of the links between neighbouring points, grouped by point */
    int k;
    cholmod_factor *diffusion, *poisson;
    cholmod_common common;
    /* Hash grid of the sample points, with cells one spacing wide; finds the points near a position. */
    uint32_t *cells, *next;
    size_t cell_count, next_capacity;
};

/* --- sampling --------------------------------------------------------------------------------------------------------------- */

static size_t cell_of(const struct cloud_heat *cloud, const double p[3], int dx, int dy, int dz)
{
    uint64_t x = (uint64_t)((int64_t)floor(p[0] / cloud->spacing_m) + dx), y = (uint64_t)((int64_t)floor(p[1] / cloud->spacing_m) + dy),
             z = (uint64_t)((int64_t)floor(p[2] / cloud->spacing_m) + dz);
    uint64_t hash = x * 0x9e3779b97f4a7c15u ^ (y * 0xc2b2ae3d27d4eb4fu + 0x165667b19e3779f9u) ^ (z * 0xd6e8feb86659fd93u);
    return (size_t)((hash ^ hash >> 29) * 0xbf58476d1ce4e5b9u >> 20) & (cloud->cell_count - 1);
}

static bool is_crowded(const struct cloud_heat *cloud, const double p[3])
{
    for (int i = 0; i < 27; i++)
        for (uint32_t at = cloud->cells[cell_of(cloud, p, i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)]; at != TRIMESH_NONE; at = cloud->next[at])
            if (vec_distance(cloud->points[at], p) < cloud->spacing_m)
                return true;
    return false;
}

static void add_point(struct cloud_heat *cloud, const double p[3])
{
    if (is_crowded(cloud, p))
        return;
    mem_grow(&cloud->points, &cloud->capacity, cloud->count + 1, sizeof(*cloud->points));
    mem_grow(&cloud->next, &cloud->next_capacity, cloud->count + 1, sizeof(*cloud->next));
    size_t cell = cell_of(cloud, p, 0, 0, 0);
    memcpy(cloud->points[cloud->count], p, sizeof(*cloud->points));
    cloud->next[cloud->count] = cloud->cells[cell];
    cloud->cells[cell] = (uint32_t)cloud->count++;
}

static double area_of(const struct surface_debug_mesh *mesh, size_t t)
{
    double u[3], v[3], n[3];
    vec_sub(mesh->points_m[mesh->tris[t][1]], mesh->points_m[mesh->tris[t][0]], u);
    vec_sub(mesh->points_m[mesh->tris[t][2]], mesh->points_m[mesh->tris[t][0]], v);
    vec_cross(u, v, n);
    return vec_length(n) / 2;
}

/* Generates candidates for sample points on a surface's triangles: first the triangle corners, so that narrow parts keep their
 * ends; then a lattice in each triangle. */
static void sample(struct cloud_heat *cloud, const struct surface_debug_mesh *mesh)
{
    for (size_t t = 0; t < mesh->visible_count; t++)
        for (int k = 0; k < 3; k++)
            add_point(cloud, mesh->points_m[mesh->tris[t][k]]);
    for (size_t t = 0; t < mesh->visible_count; t++) {
        const double *a = mesh->points_m[mesh->tris[t][0]], *b = mesh->points_m[mesh->tris[t][1]], *c = mesh->points_m[mesh->tris[t][2]];
        double longest_m = fmax(vec_distance(a, b), fmax(vec_distance(b, c), vec_distance(c, a))), p[3];
        int steps = (int)fmin(ceil(longest_m * PITCHES / cloud->spacing_m), 4096);
        for (int i = 0; i <= steps; i++)
            for (int j = 0; i + j <= steps && steps > 1; j++) {
                for (int k = 0; k < 3; k++)
                    p[k] = a[k] + ((b[k] - a[k]) * i + (c[k] - a[k]) * j) / steps;
                add_point(cloud, p);
            }
    }
}

/* --- neighbours ------------------------------------------------------------------------------------------------------------- */

static void take_pair(void *arg, size_t point, size_t other, double distance_m)
{
    struct cloud_heat *cloud = arg;
    if (point > other)
        return;
    mem_grow(&cloud->links, &cloud->link_capacity, cloud->link_count + 1, sizeof(*cloud->links));
    double tau = cloud->spacing_m * cloud->spacing_m / 2;
    cloud->links[cloud->link_count++] =
        (struct heat_link){ (uint32_t)point, (uint32_t)other, exp(-distance_m * distance_m / (4 * tau)) / (4 * M_PI * tau * tau) };
}

static void sort_links(struct cloud_heat *cloud)
{
    cloud->first = mem_array(cloud->count + 2, sizeof(*cloud->first));
    cloud->order = mem_array(2 * cloud->link_count + 1, sizeof(*cloud->order));
    uint32_t *begin = cloud->first + 1;
    for (size_t i = 0; i < cloud->link_count; i++) {
        begin[cloud->links[i].from + 1 < cloud->count ? cloud->links[i].from + 1 : cloud->count]++;
        begin[cloud->links[i].to + 1 < cloud->count ? cloud->links[i].to + 1 : cloud->count]++;
    }
    for (size_t i = 1; i <= cloud->count; i++)
        begin[i] += begin[i - 1];
    for (size_t i = 0; i < cloud->link_count; i++) {
        cloud->order[begin[cloud->links[i].from]++] = (uint32_t)i;
        cloud->order[begin[cloud->links[i].to]++] = (uint32_t)i;
    }
}

static uint32_t other_end(const struct heat_link *link, size_t point)
{
    return link->from == point ? link->to : link->from;
}

/* Visits all points of the cloud that are connected to point `from`, breadth first. Returns their number; queue[] lists them,
 * the farthest last, and hops[] receives the number of steps to each. */
static size_t spread(const struct cloud_heat *cloud, uint32_t from, uint32_t *queue, uint32_t *hops)
{
    size_t count = 1;
    queue[0] = from;
    hops[from] = 0;
    for (size_t i = 0; i < count; i++)
        for (uint32_t k = cloud->first[queue[i]]; k < cloud->first[queue[i] + 1]; k++) {
            uint32_t to = other_end(&cloud->links[cloud->order[k]], queue[i]);
            if (hops[to] == TRIMESH_NONE) {
                hops[to] = hops[queue[i]] + 1;
                queue[count++] = to;
            }
        }
    return count;
}

/* Numbers the connected components of the point cloud. Returns the approximate length of the longest component: finds the point farthest
 * from an arbitrary one, then the largest distance from that point. */
static double find_pieces(struct cloud_heat *cloud)
{
    uint32_t *queue = mem_array(cloud->count + 1, sizeof(*queue)), *hops = mem_array(cloud->count + 1, sizeof(*hops)), pieces = 0, most = 0;
    cloud->piece = mem_array(cloud->count + 1, sizeof(*cloud->piece));
    memset(hops, 0xff, cloud->count * sizeof(*hops));
    for (uint32_t begin = 0; begin < cloud->count; begin++) {
        if (hops[begin] != TRIMESH_NONE)
            continue;
        size_t count = spread(cloud, begin, queue, hops);
        for (size_t i = 0; i < count; i++) {
            cloud->piece[queue[i]] = pieces;
            hops[queue[i]] = TRIMESH_NONE;
        }
        spread(cloud, queue[count - 1], queue, hops);
        uint32_t longest = hops[queue[count - 1]];
        most = longest > most ? longest : most;
        pieces++;
    }
    mem_free(queue);
    mem_free(hops);
    return most * CLOUD_REACH * cloud->spacing_m;
}

/* Computes two axes of the tangent plane at a sample point. The plane's normal is the direction in which the neighbouring
   points spread least: the eigenvector of their covariance matrix with the smallest eigenvalue. It is found by inverse
   iteration, with the matrix of cofactors in place of the inverse. The iteration starts at the longest cofactor vector. If the
   smallest eigenvalue is near 0, this vector is already almost the normal. */
static void find_plane(struct cloud_heat *cloud, size_t point)
{
    double c[3][3] = { { 0 } }, normal[3] = { 0, 0, 1 }, trace = 0;
    for (uint32_t i = cloud->first[point]; i < cloud->first[point + 1]; i++) {
        const struct heat_link *link = &cloud->links[cloud->order[i]];
        double e[3];
        vec_sub(cloud->points[other_end(link, point)], cloud->points[point], e);
        for (int j = 0; j < 9; j++)
            c[j / 3][j % 3] += link->weight * e[j / 3] * e[j % 3];
    }
    trace = c[0][0] + c[1][1] + c[2][2];
    for (int j = 0; trace > 0 && j < 3; j++)
        c[j][j] += 1e-6 * trace;
    double inverse[3][3], best = 0;
    for (int j = 0; j < 3; j++) {
        vec_cross(c[(j + 1) % 3], c[(j + 2) % 3], inverse[j]);
        if (vec_length(inverse[j]) > best) {
            best = vec_length(inverse[j]);
            memcpy(normal, inverse[j], sizeof(normal));
        }
    }
    for (int step = 0; step < 20 && best > 0; step++) {
        double to[3] = { 0 };
        for (int j = 0; j < 9; j++)
            to[j / 3] += inverse[j % 3][j / 3] * normal[j % 3];
        double length = vec_length(to);
        for (int j = 0; j < 3 && length > 0; j++)
            normal[j] = to[j] / length;
    }
    int least = fabs(normal[0]) < fabs(normal[1]) ? 0 : 1;
    least = fabs(normal[2]) < fabs(normal[least]) ? 2 : least;
    double axis[3] = { 0 };
    axis[least] = 1;
    vec_cross(normal, axis, cloud->across[point][0]);
    vec_normalize(cloud->across[point][0]);
    vec_cross(normal, cloud->across[point][0], cloud->across[point][1]);
    vec_normalize(cloud->across[point][1]);
}

/* --- systems ---------------------------------------------------------------------------------------------------------------- */

/* Assembles the lower triangle of the sparse matrix diagonal + scale * L (L: Laplacian). */
static cholmod_sparse *assemble(struct cloud_heat *cloud, const double *diagonal, double scale)
{
    cholmod_triplet *t =
        cholmod_allocate_triplet(cloud->count, cloud->count, cloud->count + cloud->link_count, -1, CHOLMOD_REAL, &cloud->common);
    if (!t)
        return NULL;
    int *row = t->i, *column = t->j;
    double *x = t->x;
    for (size_t i = 0; i < cloud->count; i++) {
        row[i] = column[i] = (int)i;
        x[i] = diagonal[i];
    }
    t->nnz = cloud->count;
    for (size_t i = 0; i < cloud->link_count; i++) {
        const struct heat_link *link = &cloud->links[i];
        x[link->from] += scale * link->weight;
        x[link->to] += scale * link->weight;
        row[t->nnz] = (int)link->to;
        column[t->nnz] = (int)link->from;
        x[t->nnz++] = -scale * link->weight;
    }
    cholmod_sparse *sparse = cholmod_triplet_to_sparse(t, t->nnz, &cloud->common);
    cholmod_free_triplet(&t, &cloud->common);
    return sparse;
}

static bool factor(struct cloud_heat *cloud)
{
    double *area_m2 = mem_array(cloud->count, sizeof(*area_m2)), *little = mem_array(cloud->count, sizeof(*little));
    double reach_m = CLOUD_REACH * cloud->spacing_m;
    for (size_t i = 0; i < cloud->count; i++)
        area_m2[i] = M_PI * reach_m * reach_m / (cloud->first[i + 1] - cloud->first[i] + 1);
    for (size_t i = 0; i < cloud->link_count; i++) {
        struct heat_link *link = &cloud->links[i];
        link->weight *= area_m2[link->from] * area_m2[link->to];
        little[link->from] += REGULARISATION * link->weight;
        little[link->to] += REGULARISATION * link->weight;
    }
    for (size_t i = 0; i < cloud->count; i++)
        little[i] = little[i] > 0 ? little[i] : 1;
    cholmod_sparse *diffusion = assemble(cloud, area_m2, cloud->time_m2), *poisson = diffusion ? assemble(cloud, little, 1) : NULL;
    if (poisson) {
        cloud->diffusion = cholmod_analyze(diffusion, &cloud->common);
        cloud->poisson = cloud->diffusion ? cholmod_copy_factor(cloud->diffusion, &cloud->common) : NULL;
    }
    bool good = cloud->poisson && cholmod_factorize(diffusion, cloud->diffusion, &cloud->common) && cloud->common.status == CHOLMOD_OK &&
                cholmod_factorize(poisson, cloud->poisson, &cloud->common) && cloud->common.status == CHOLMOD_OK;
    cholmod_free_sparse(&diffusion, &cloud->common);
    cholmod_free_sparse(&poisson, &cloud->common);
    mem_free(area_m2);
    mem_free(little);
    return good;
}

struct cloud_heat *cloud_heat_create(struct log *log, const struct surface *surface)
{
    struct cloud_heat *cloud = mem_new(sizeof(*cloud));
    struct surface_debug_mesh mesh;
    double area_m2 = 0;
    cloud->log = log;
    laplacian_start(&cloud->common);
    surface_debug_mesh(surface, &mesh);
    for (size_t t = 0; t < mesh.visible_count; t++)
        area_m2 += area_of(&mesh, t);
    cloud->spacing_m = sqrt(PACKING * area_m2 / CLOUD_POINTS);
    for (cloud->cell_count = 1; (double)cloud->cell_count < 4 * CLOUD_POINTS;)
        cloud->cell_count *= 2;
    cloud->cells = mem_array(cloud->cell_count, sizeof(*cloud->cells));
    memset(cloud->cells, 0xff, cloud->cell_count * sizeof(*cloud->cells));
    sample(cloud, &mesh);
    cloud->k = point_cloud_neighbours((const double(*)[3])cloud->points, cloud->count, CLOUD_REACH * cloud->spacing_m, take_pair, cloud);
    if (cloud->k < 0)
        goto error;
    sort_links(cloud);
    cloud->across = mem_array(cloud->count + 1, sizeof(*cloud->across));
    for (size_t i = 0; i < cloud->count; i++)
        find_plane(cloud, i);
    double root = fmax(sqrt(HEAT_TIME) * cloud->spacing_m, find_pieces(cloud) / LONGEST);
    cloud->time_m2 = root * root;
    if (factor(cloud))
        return cloud;
error:
    log_err(log, "cannot compute distances by the heat method on %zu points: %s", cloud->count,
            cloud->common.status == CHOLMOD_NOT_POSDEF ? "the equations for the asset's surface cannot be solved: check its model for "
                                                         "extremely thin triangles (matrix not positive definite)"
                                                       : "out of memory");
    cloud_heat_destroy(&cloud);
    return NULL;
}

void cloud_heat_destroy(struct cloud_heat **cloud_ptr)
{
    struct cloud_heat *cloud = *cloud_ptr;
    if (!cloud)
        return;
    cholmod_free_factor(&cloud->diffusion, &cloud->common);
    cholmod_free_factor(&cloud->poisson, &cloud->common);
    cholmod_finish(&cloud->common);
    mem_free(cloud->points);
    mem_free(cloud->across);
    mem_free(cloud->piece);
    mem_free(cloud->links);
    mem_free(cloud->first);
    mem_free(cloud->order);
    mem_free(cloud->cells);
    mem_free(cloud->next);
    mem_free(cloud);
    *cloud_ptr = NULL;
}

size_t cloud_heat_count(const struct cloud_heat *cloud)
{
    return cloud->count;
}

int cloud_heat_k(const struct cloud_heat *cloud)
{
    return cloud->k;
}

double cloud_heat_spacing_m(const struct cloud_heat *cloud)
{
    return cloud->spacing_m;
}

/* --- distances -------------------------------------------------------------------------------------------------------------- */

/* Computes the gradient of a function at a sample point, in the point's tangent plane, by weighted least squares. values: the
 * function's values at the sample points. */
static void slope_at(const struct cloud_heat *cloud, size_t point, const double *values, double slope[3])
{
    double xx = 0, xy = 0, yy = 0, bx = 0, by = 0;
    for (uint32_t i = cloud->first[point]; i < cloud->first[point + 1]; i++) {
        const struct heat_link *link = &cloud->links[cloud->order[i]];
        uint32_t to = other_end(link, point);
        double e[3], rise = values[to] - values[point];
        vec_sub(cloud->points[to], cloud->points[point], e);
        double x = vec_dot(e, cloud->across[point][0]), y = vec_dot(e, cloud->across[point][1]);
        xx += link->weight * x * x;
        xy += link->weight * x * y;
        yy += link->weight * y * y;
        bx += link->weight * x * rise;
        by += link->weight * y * rise;
    }
    double det = xx * yy - xy * xy, part[2] = { 0, 0 };
    if (det > 1e-9 * (xx + yy) * (xx + yy)) {
        part[0] = (yy * bx - xy * by) / det;
        part[1] = (xx * by - xy * bx) / det;
    }
    for (int k = 0; k < 3; k++)
        slope[k] = part[0] * cloud->across[point][0][k] + part[1] * cloud->across[point][1][k];
}

struct nearby {
    uint32_t at[PLACES];
    double away_m[PLACES];
    int count;
};

/* Finds the PLACES sample points nearest to position p, nearest first. At least one is within two spacings, because the
 * candidates for sample points cover the surface. */
static void find_nearby(const struct cloud_heat *cloud, const double p[3], struct nearby *near)
{
    near->count = 0;
    for (int i = 0; i < 125; i++) {
        size_t cell = cell_of(cloud, p, i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2);
        for (uint32_t at = cloud->cells[cell]; at != TRIMESH_NONE; at = cloud->next[at]) {
            double away_m = vec_distance(cloud->points[at], p);
            bool known = false;
            for (int k = 0; k < near->count; k++)
                known |= near->at[k] == at;
            if (known || (near->count == PLACES && away_m >= near->away_m[PLACES - 1]))
                continue;
            int to = near->count < PLACES ? near->count++ : PLACES - 1;
            for (; to > 0 && away_m < near->away_m[to - 1]; to--) {
                near->at[to] = near->at[to - 1];
                near->away_m[to] = near->away_m[to - 1];
            }
            near->at[to] = at;
            near->away_m[to] = away_m;
        }
    }
}

/* Interpolates at position p: each of the nearest sample points extrapolates its value along its gradient, weighted by proximity. */
static double value_at(const struct cloud_heat *cloud, const double *values, const double (*slopes)[3], const double p[3], uint32_t piece,
                       const struct nearby *near)
{
    double sum = 0, total = 0;
    for (int k = 0; k < near->count; k++) {
        uint32_t at = near->at[k];
        double e[3], weight = 1 / (near->away_m[k] * near->away_m[k] + 1e-6 * cloud->spacing_m * cloud->spacing_m);
        if (cloud->piece[at] != piece)
            continue;
        vec_sub(p, cloud->points[at], e);
        sum += weight * (values[at] + vec_dot(slopes[at], e));
        total += weight;
    }
    return total > 0 ? sum / total : (double)INFINITY;
}

static cholmod_dense *solve(const struct cloud_heat *cloud, cholmod_factor *factor, cholmod_dense *b, cholmod_common *common)
{
    cholmod_dense *x = cholmod_solve(CHOLMOD_A, factor, b, common);
    if (!x)
        log_err(cloud->log, "cannot compute distances by the heat method on %zu points: out of memory", cloud->count);
    return x;
}

/* Converts the heat u at the sample points into the unit vectors X (cloud_heat.h): tangent vectors that point away from the
 * source. Writes the right-hand side of the linear system for the distances to b. */
static void flow(const struct cloud_heat *cloud, double *u, double (*slopes)[3], double *b)
{
    for (size_t i = 0; i < cloud->count; i++)
        u[i] = -log(fmax(u[i], DBL_MIN)); /* Varadhan's formula: distance / sqrt(t), which is smoother than the heat itself */
    for (size_t i = 0; i < cloud->count; i++) {
        slope_at(cloud, i, u, slopes[i]);
        double length = vec_length(slopes[i]);
        for (int k = 0; k < 3; k++)
            slopes[i][k] = length > 0 ? slopes[i][k] / length : 0;
    }
    memset(b, 0, cloud->count * sizeof(*b));
    for (size_t i = 0; i < cloud->link_count; i++) {
        const struct heat_link *link = &cloud->links[i];
        double e[3];
        vec_sub(cloud->points[link->to], cloud->points[link->from], e);
        double rise = link->weight * (vec_dot(slopes[link->from], e) + vec_dot(slopes[link->to], e)) / 2;
        b[link->from] -= rise;
        b[link->to] += rise;
    }
}

bool cloud_heat_distances(const struct cloud_heat *cloud, const double source_m[3], const float (*positions_m)[3], size_t count, float *out)
{
    cholmod_common common;
    struct nearby near;
    cholmod_start(&common);
    common.print = 0;
    find_nearby(cloud, source_m, &near);
    cholmod_dense *b = cholmod_zeros(cloud->count, 1, CHOLMOD_REAL, &common), *u = NULL, *d = NULL;
    double(*slopes)[3] = mem_try_array(cloud->count, sizeof(*slopes));
    if (b && slopes && near.count > 0) {
        ((double *)b->x)[near.at[0]] = 1;
        u = solve(cloud, cloud->diffusion, b, &common);
    }
    if (u) {
        flow(cloud, u->x, slopes, b->x);
        d = solve(cloud, cloud->poisson, b, &common);
    }
    if (d) {
        const double *values = d->x;
        uint32_t piece = cloud->piece[near.at[0]];
        double start = values[near.at[0]];
        for (size_t i = 0; i < cloud->count; i++)
            slope_at(cloud, i, values, slopes[i]);
        double zero = near.away_m[0]; /* distance in metres between the source and the nearest sample point */
        for (size_t v = 0; v < count; v++) {
            const double p[3] = { (double)positions_m[v][0], (double)positions_m[v][1], (double)positions_m[v][2] };
            find_nearby(cloud, p, &near);
            double away_m = value_at(cloud, values, (const double(*)[3])slopes, p, piece, &near) - start;
            double straight_m = vec_distance(p, source_m);
            out[v] = (float)(isfinite(away_m) ? fmax(away_m, fmin(straight_m, zero)) : away_m);
        }
    }
    bool good = d != NULL;
    cholmod_free_dense(&b, &common);
    cholmod_free_dense(&u, &common);
    cholmod_free_dense(&d, &common);
    cholmod_finish(&common);
    mem_free(slopes);
    return good;
}
