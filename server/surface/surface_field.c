/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes distances from many sources on all cores, a block of sources at a time, and interpolates distances at points inside
 * triangles. */
#include <stdatomic.h>
#include <string.h>

#include "base/math/search.h"
#include "base/math/simd.h"
#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/surface_impl.h"

/* number of sources per block; one thread computes the distances from all sources of a block, then stores them together */
#define BLOCK 16

struct solve {
    const struct surface *surface;
    const struct surface_point *hits;
    size_t count;
    float *out;                            /* NULL, or distances [point][vertex] */
    struct surface_field *field;           /* field that receives the distances; NULL: they are written to `out` instead */
    const struct surface_columns *columns; /* cache of columns; NULL: none */
    atomic_bool failed;
};

static const struct stray *stray_of(const struct surface *surface, uint32_t vertex)
{
    size_t at;
    search_sorted(at, surface->stray_count, surface->strays[at].vertex < vertex);
    return at < surface->stray_count && surface->strays[at].vertex == vertex ? &surface->strays[at] : NULL;
}

/* Writes the distances of a stray vertex, one per source of the field: those of the nearest surface point. */
static void at_stray(const struct surface *surface, const struct surface_field *field, const struct stray *stray, float *out)
{
    struct surface_point hit = { .tri = stray->tri };
    memcpy(hit.point_m, stray->point_m, sizeof(hit.point_m));
    surface_field_at_point(field, surface, &hit, out);
}

/* Writes the distances of all model vertices from one source. distances_m: those of the surface's points. */
static void take_vertices(const struct surface *surface, const struct surface_point *source, float *distances_m, float *out)
{
    struct surface_field field = {
        .source_count = 1, .sources = (struct surface_point *)source, .source_tris = (uint32_t *)&source->tri, .distances_m = distances_m
    };
    for (size_t v = 0; v < surface->vertex_count; v++)
        out[v] = distances_m[surface->vertex_point[v]];
    for (size_t i = 0; i < surface->stray_count; i++)
        at_stray(surface, &field, &surface->strays[i], &out[surface->strays[i].vertex]);
}

/* Copies a block of distances into the field, one cache line at a time. The block has a column per source, sorted by point; the field has a
 * row per point, sorted by source. */
static void take_rows(const struct solve *solve, const float *block, size_t first, size_t count)
{
    size_t points = solve->surface->mesh.point_count;
    for (size_t p = 0; p < points; p++)
        for (size_t s = 0; s < count; s++)
            solve->field->distances_m[p * solve->field->source_count + first + s] = block[s * points + p];
}

struct abreast { /* up to PROPAGATION_ABREAST sources whose distances one thread computes alternately, to hide memory latency */
    struct propagation_front fronts[PROPAGATION_ABREAST];
    struct propagation_source from[PROPAGATION_ABREAST];
    size_t source[PROPAGATION_ABREAST], count;
};

/* Computes the distances from the sources collected in `abreast`. block: receives the distances to all points, a column per source,
 * beginning with source `first`; NULL: the distances to the model's vertices go to solve->out. Returns false if out of memory. */
static bool propagate(const struct solve *solve, struct abreast *abreast, float *block, size_t first)
{
    const struct surface *surface = solve->surface;
    size_t points = surface->mesh.point_count;
    if (!propagation_run(&surface->propagation, abreast->fronts, abreast->from, abreast->count))
        return false;
    for (size_t i = 0; i < abreast->count; i++) {
        float *distance_m = abreast->fronts[i].distance_m;
        size_t s = abreast->source[i];
        if (block)
            memcpy(block + (s - first) * points, distance_m, points * sizeof(*block));
        else
            take_vertices(surface, &solve->hits[s], distance_m, solve->out + s * surface->vertex_count);
        if (block && solve->columns)
            solve->columns->keep(solve->columns->arg, s, block + (s - first) * points);
    }
    abreast->count = 0;
    return true;
}

static void solve_block(void *arg, size_t begin, size_t end)
{
    struct solve *solve = arg;
    size_t points = solve->surface->mesh.point_count;
    struct abreast abreast = { 0 };
    float *block = solve->field ? mem_try_array((end - begin) * points, sizeof(*block)) : NULL;
    solve->failed = solve->failed || (solve->field && !block);
    for (size_t s = begin; s < end && !solve->failed; s++) {
        bool known = solve->columns && solve->columns->fetch(solve->columns->arg, s, block + (s - begin) * points);
        if (!known) {
            abreast.from[abreast.count] = (struct propagation_source){ solve->hits[s].tri, solve->hits[s].weights };
            abreast.source[abreast.count++] = s;
        }
        if (abreast.count > 0 && (abreast.count == PROPAGATION_ABREAST || s + 1 == end) && !propagate(solve, &abreast, block, begin))
            solve->failed = true;
    }
    if (block && !solve->failed)
        take_rows(solve, block, begin, end - begin);
    for (size_t i = 0; i < PROPAGATION_ABREAST; i++)
        propagation_front_finish(&abreast.fronts[i]);
    mem_free(block);
}

static bool solve_all(struct solve *solve)
{
    struct workers *workers = solve->surface->workers;
    size_t share = workers ? 1 + solve->count / (size_t)workers_count(workers) : solve->count;
    if (workers)
        workers_for(workers, solve->count, share < BLOCK ? share : BLOCK, solve_block, solve);
    for (size_t s = 0; s < solve->count && !workers; s += BLOCK)
        solve_block(solve, s, s + BLOCK < solve->count ? s + BLOCK : solve->count);
    if (solve->failed)
        log_err(solve->surface->log, "cannot compute the distances from %zu sensors to an asset's %zu surface points: out of memory",
                solve->count, solve->surface->mesh.point_count);
    return !solve->failed;
}

static struct surface_point *project_all(const struct surface *surface, const double (*points_m)[3], size_t count)
{
    struct surface_point *hits = mem_array(count, sizeof(*hits));
    for (size_t i = 0; i < count; i++)
        surface_find_point(surface, points_m[i], NULL, &hits[i]);
    return hits;
}

bool surface_distances(const struct surface *surface, const double (*points_m)[3], size_t point_count, float *out)
{
    struct surface_point *hits = project_all(surface, points_m, point_count);
    struct solve solve = { .surface = surface, .hits = hits, .count = point_count, .out = out };
    bool good = solve_all(&solve);
    mem_free(hits);
    return good;
}

size_t surface_column_length(const struct surface *surface)
{
    return surface->mesh.point_count;
}

bool surface_field_init(struct surface_field *field, const struct surface *surface, const double (*points_m)[3], size_t point_count,
                        const struct surface_columns *columns)
{
    struct solve solve = { .surface = surface, .count = point_count, .field = field, .columns = columns };
    *field = (struct surface_field){ .source_count = point_count };
    field->distances_m = mem_try_array(surface->mesh.point_count, field->source_count * sizeof(*field->distances_m));
    field->sources = project_all(surface, points_m, point_count);
    field->source_tris = mem_array(point_count, sizeof(*field->source_tris));
    for (size_t s = 0; s < point_count; s++)
        field->source_tris[s] = field->sources[s].tri;
    solve.hits = field->sources;
    if (!field->distances_m)
        log_err(surface->log, "cannot compute the distances from %zu sensors to an asset's %zu surface points: out of memory", point_count,
                surface->mesh.point_count);
    if (field->distances_m && solve_all(&solve))
        return true;
    surface_field_finish(field);
    return false;
}

void surface_field_finish(struct surface_field *field)
{
    mem_free(field->sources);
    mem_free(field->source_tris);
    mem_free(field->distances_m);
    *field = (struct surface_field){ 0 };
}

void surface_field_at_vertex(const struct surface_field *field, const struct surface *surface, uint32_t vertex, float *out)
{
    const struct stray *stray = surface->stray_count ? stray_of(surface, vertex) : NULL;
    if (stray)
        at_stray(surface, field, stray, out);
    else
        memcpy(out, field->distances_m + surface->vertex_point[vertex] * field->source_count, field->source_count * sizeof(*out));
}

/* An edge a-b of the triangle that contains a surface point. side: length of the edge. x, y: position of the point in the
   triangle's plane; a is at (0, 0) and b at (side, 0). */
struct edge_window {
    float side, half, per, x, y;
};

static struct edge_window sight_of(double ab, double to_a, double to_b)
{
    double x, y;
    ab = max_of(ab, 1e-30);
    intrinsic_layout((const double[3]){ ab, to_b, to_a }, &x, &y);
    return (struct edge_window){ (float)ab, (float)ab / 2, 1 / (2 * (float)ab), (float)x, (float)y };
}

/* Returns the smaller of best2 and the squared length of the straight path from the source through the edge to the point. da,
   db: distances of the edge's ends from the source, which is placed beyond the edge to fit both. Ignores a path that does not
   pass through the edge. */
SIMD_BODY float through_edge(const struct edge_window *sight, float da, float db, float best2)
{
    const float x = sight->x, y = sight->y;
    float sx = (da - db) * (da + db) * sight->per + sight->half, sy2 = (da - sx) * (da + sx), sy = sqrtf(sy2 > 0 ? sy2 : 0);
    /* cut / dy: position of the straight path's crossing with the edge, counted from a */
    float dx = x - sx, dy = y + sy, cut = sx * y + x * sy;
    float straight2 = dx * dx + dy * dy;
    /* if da or db is INFINITY, at least one of the two comparisons is false, so straight2 becomes INFINITY */
    straight2 = cut >= 0 ? straight2 : INFINITY;
    straight2 = cut <= sight->side * dy ? straight2 : INFINITY;
    return straight2 < best2 ? straight2 : best2;
}

/* Fills a row of distances (one per source) for a surface point. A path to the point may enter its triangle straight through an
 * edge, if it passes within that edge, or through a corner. The shortest one counts. */
SIMD_BODY void fill_row(const struct edge_window sights[3], const float to_m[3], const float *restrict a, const float *restrict b,
                        const float *restrict c, size_t count, float *restrict out)
{
    const struct edge_window ab = sights[0], bc = sights[1], ca = sights[2];
    const float to_a = to_m[0], to_b = to_m[1], to_c = to_m[2];
    for (size_t s = 0; s < count; s++) {
        float da = a[s], db = b[s], dc = c[s], along_a = da + to_a, along_b = db + to_b, along_c = dc + to_c;
        float straight = sqrtf(through_edge(&ca, dc, da, through_edge(&bc, db, dc, through_edge(&ab, da, db, INFINITY))));
        float along = along_a < along_b ? along_a : along_b;
        along = along_c < along ? along_c : along;
        out[s] = straight < along ? straight : along;
    }
}

static void fill_row_plain(const struct edge_window sights[3], const float to_m[3], const float *const rows[3], size_t count, float *out)
{
    fill_row(sights, to_m, rows[0], rows[1], rows[2], count, out);
}

SIMD_AVX2 static void fill_row_wide(const struct edge_window sights[3], const float to_m[3], const float *const rows[3], size_t count,
                                    float *out)
{
    fill_row(sights, to_m, rows[0], rows[1], rows[2], count, out);
}

void surface_field_at_point(const struct surface_field *field, const struct surface *surface, const struct surface_point *hit, float *out)
{
    const struct trimesh *mesh = &surface->visible;
    const uint32_t *v = mesh->tris[hit->tri];
    const float *rows[3];
    struct edge_window sights[3];
    double to_m[3];
    for (int i = 0; i < 3; i++) {
        to_m[i] = vec_distance(hit->point_m, mesh->points[v[i]]);
        rows[i] = field->distances_m + v[i] * field->source_count;
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        sights[i] = sight_of(vec_distance(mesh->points[v[i]], mesh->points[v[j]]), to_m[i], to_m[j]);
    }
    (simd_has_avx2() ? fill_row_wide : fill_row_plain)(sights, (const float[3]){ (float)to_m[0], (float)to_m[1], (float)to_m[2] }, rows,
                                                       field->source_count, out);
    for (size_t s = 0; s < field->source_count; s++)
        if (field->source_tris[s] == hit->tri)
            out[s] = (float)vec_distance(hit->point_m, field->sources[s].point_m);
}
