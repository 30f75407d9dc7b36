/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures how far the values interpolated between sensors deviate from linear interpolation between vertices, and finds the
   best split point of an edge. */
#include <math.h>
#include <string.h>
#include <xxhash.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "preprocess/subdivision/subdivide_impl.h"
#include "protocol/asset_distance.h"
#include "surface/mesh/bvh.h"

/* interpolation error at an edge's midpoint, as a share of SUBDIV_AIM, below which the whole edge is assumed to be good */
#define PROBABLE 0.4
/* edge length, as a share of the distance to the nearest sensor, above which an edge is measured at all its sample points. A
   good midpoint (PROBABLE) does not show that such a long edge is good. */
#define CLOSE 0.5
/* edge length, as a share of the distance to the nearest sensor, above which an edge is split in the middle, so that the split
   points of neighbouring edges line up */
#define WIDE 0.3
#define GRAIN 256  /* minimum number of edges, triangles or positions handed to a thread at once: half a millisecond of work */
#define POINTS 16  /* maximum number of points at which the error of an edge is measured */
#define CORNERS 61 /* number of triangle corners whose samples (sensors' weights at a point) each thread caches */
#define STEPS 2    /* number of refinement steps in the search for an edge's best split point */
/* if more than this share of an edge's error remains after the best split, the edge is checked for a jump of the distance along
   the surface; a smooth bend leaves a quarter of the error, a kink nothing */
#define NO_GAIN 0.5
#define ROUNDING 1e-9 /* relative margin for comparing distances, larger than their rounding error */
/* a distance that grows along a path by more than this many times the path's length has a jump: the surface is not connected there */
#define JUMP 1.5

static uint32_t place_of(const struct subdiv *subdiv, uint32_t vertex)
{
    return subdiv->mesh.welded.of_vertex[vertex];
}

/* --- connected components --------------------------------------------------------------------------------------------------- */

static bool list_faces(struct subdiv *subdiv)
{
    const struct geometry *g = subdiv->mesh.geometry;
    subdiv->faces = mem_try_array(g->index_count / 3, sizeof(*subdiv->faces));
    for (uint32_t t = 0; subdiv->faces && t < g->index_count / 3; t++) {
        const uint32_t *v = subdiv->model + 3 * (size_t)t;
        const float *a = subdiv_position(subdiv, v[0]), *b = subdiv_position(subdiv, v[1]), *c = subdiv_position(subdiv, v[2]);
        vecf_normal(a, b, c, subdiv->faces[t].normal);
        subdiv->faces[t].part = subdiv->part[place_of(subdiv, v[0])];
    }
    return subdiv->faces != NULL;
}

bool subdiv_find_parts(struct subdiv *subdiv)
{
    const struct geometry *g = subdiv->mesh.geometry;
    size_t count = subdiv->mesh.welded.count;
    subdiv->part = mem_try_array(count, sizeof(*subdiv->part));
    subdiv->part_capacity = count;
    if (!subdiv->part)
        return false;
    for (uint32_t p = 0; p < count; p++)
        subdiv->part[p] = p;
    for (uint32_t i = 0; i < g->index_count; i += 3)
        for (uint32_t c = 1; c < 3; c++)
            trimesh_join(subdiv->part, place_of(subdiv, subdiv->model[i]), place_of(subdiv, subdiv->model[i + c]));
    for (uint32_t p = 0; p < count; p++)
        subdiv->part[p] = trimesh_root(subdiv->part, p);
    return list_faces(subdiv);
}

struct origin_sight { /* the triangles of the original model that a sample point may be projected onto */
    const struct subdiv *subdiv;
    /* finest level of detail: indices of the two triangles of the original model onto which the point may be projected */
    uint32_t origin[2];
    /* coarser levels of detail: the point is projected onto a triangle of this connected component that faces the same way as `normal` */
    uint32_t part;
    double normal[3];
    struct sample_cache_notes *notes; /* notes for the sample cache, one set per thread */
};

static bool is_in_sight(const void *arg, uint32_t triangle)
{
    const struct origin_sight *sight = arg;
    const struct subdiv_face *face = &sight->subdiv->faces[triangle];
    return face->part == sight->part && vec_dot(face->normal, sight->normal) > 0;
}

static struct origin_sight sight_of_edge(const struct subdiv *subdiv, const struct subdiv_edge *edge, struct sample_cache_notes *notes)
{
    struct origin_sight sight = {
        subdiv, { edge->origin[0], edge->origin[edge->origin[1] != TRIMESH_NONE] }, subdiv->part[place_of(subdiv, edge->a)], { 0 }, notes
    };
    subdiv_mesh_normal(&subdiv->mesh, edge, sight.normal);
    return sight;
}

static struct origin_sight sight_of_tri(const struct subdiv *subdiv, const struct subdiv_tri *tri, struct sample_cache_notes *notes)
{
    struct origin_sight sight = { subdiv, { tri->origin, tri->origin }, subdiv->part[place_of(subdiv, tri->v[0])], { 0 }, notes };
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < 3; i++)
            sight.normal[i] += (double)subdiv->mesh.geometry->normals[tri->v[c]][i];
    return sight;
}

static void to_doubles(const float point[3], double at[3])
{
    for (int i = 0; i < 3; i++)
        at[i] = (double)point[i];
}

/* Finds the surface point that a sample point projects onto. In a coarser level of detail, first searches only the connected
   component that the sample point is on, then all others: if the finest surface there is hidden by another component, the
   sample point may protrude from that one and shows its values. */
static bool search(const struct origin_sight *sight, const double at[3], struct surface_point *hit)
{
    const struct subdiv *subdiv = sight->subdiv;
    if (subdiv->finest)
        return surface_find_point_on(subdiv->in->surface, at, subdiv->on_surface_m, sight->origin, hit);
    if (surface_find_point_among(subdiv->in->surface, at, subdiv->on_surface_m, is_in_sight, sight, hit))
        return true;
    return surface_find_point_within(subdiv->in->surface, at, sight->normal, subdiv->on_surface_m, hit);
}

/* Returns a hash of everything that the projection of a point depends on, except the surface. */
static uint64_t key_of(const struct origin_sight *sight, const float point[3])
{
    struct {
        float point[3];
        uint32_t level, of[2];
        double normal[3];
    } all = { .level = sight->subdiv->level };
    memcpy(all.point, point, sizeof(all.point));
    if (sight->subdiv->finest)
        memcpy(all.of, sight->origin, sizeof(all.of));
    else
        memcpy(all.normal, sight->normal, sizeof(all.normal));
    all.of[0] = sight->subdiv->finest ? all.of[0] : sight->part;
    return XXH3_64bits(&all, sizeof(all));
}

/* Projects a sample point onto the surface, using the cached triangle if any. */
static bool project(const struct origin_sight *sight, const float point[3], const double at[3], struct surface_point *hit)
{
    const struct subdiv *subdiv = sight->subdiv;
    struct sample_cache *sample_cache = subdiv->in->sample_cache;
    uint64_t key = sample_cache ? key_of(sight, point) : 0;
    uint32_t tri;
    bool known = sample_cache && sample_cache_find(sample_cache, key, &tri), seen = false;
    if (known && tri != TRIMESH_NONE)
        known = seen = surface_point_on(subdiv->in->surface, at, subdiv->on_surface_m, tri, hit);
    if (!known)
        seen = search(sight, at, hit);
    if (sample_cache)
        sample_cache_note(sample_cache, sight->notes, key, seen ? hit->tri : TRIMESH_NONE, known);
    return seen;
}

/* Finds the visible point nearest to the position `from` inside a partly hidden triangle: a large triangle may protrude from
 * other connected components only in part. hit->tri on entry: result of the search for another position, or TRIMESH_NONE. On
 * return: result for `from`, even if it is too far away to count; TRIMESH_NONE if the whole triangle is hidden. Returns whether
 * the result is near enough to count. */
static bool find_seen(const struct origin_sight *sight, const double corners[3][3], const double from[3], double weights[3],
                      struct surface_point *hit)
{
    const struct subdiv *subdiv = sight->subdiv;
    double at[3], reach_m = 0;
    for (int c = 0; c < 3; c++)
        reach_m = max_of(reach_m, vec_distance(from, corners[c]));
    double limit_m = reach_m + subdiv->on_surface_m;
    if (hit->tri != TRIMESH_NONE)
        limit_m = min_of(limit_m, vec_distance(from, hit->point_m) * (1 + ROUNDING));
    if (subdiv->finest ? !surface_find_point_on(subdiv->in->surface, from, limit_m, sight->origin, hit)
                       : !surface_find_point_among(subdiv->in->surface, from, limit_m, is_in_sight, sight, hit)) {
        hit->tri = TRIMESH_NONE;
        return false;
    }
    if (vec_distance2(from, hit->point_m) > reach_m * reach_m)
        return false;
    triangle_nearest(hit->point_m, corners[0], corners[1], corners[2], weights);
    for (int i = 0; i < 3; i++)
        at[i] = weights[0] * corners[0][i] + weights[1] * corners[1][i] + weights[2] * corners[2][i];
    return vec_distance(at, hit->point_m) <= subdiv->on_surface_m;
}

/* Computes the distances along the surface from all sensors to a point's projection. Returns false if the point is hidden deep
 * inside another part, where no error is visible. */
static bool measure(const struct origin_sight *sight, const float point[3], float *geodesic_m)
{
    const struct subdiv *subdiv = sight->subdiv;
    struct surface_point hit;
    double at[3];
    to_doubles(point, at);
    if (!project(sight, point, at, &hit))
        return false;
    surface_field_at_point(subdiv->in->field, subdiv->in->surface, &hit, geodesic_m);
    return true;
}

/* Computes the distances along the surface from all sensors to a point, or, if it is hidden, to the nearest visible point. */
static void measure_always(const struct origin_sight *sight, const float point[3], float *geodesic_m)
{
    struct surface_point hit;
    double at[3];
    if (measure(sight, point, geodesic_m))
        return;
    to_doubles(point, at);
    surface_find_point(sight->subdiv->in->surface, at, sight->normal, &hit);
    surface_field_at_point(sight->subdiv->in->field, sight->subdiv->in->surface, &hit, geodesic_m);
}

/* --- edges ------------------------------------------------------------------------------------------------------------------ */

struct line { /* sample points along a mesh edge, in order from its end a to its end b */
    const struct subdiv *subdiv;
    const float *a, *b; /* positions of the edge's ends */
    double length_m;
    struct origin_sight sight;
    double t[POINTS];
    const float *interp[POINTS], *geodesic_m[POINTS];
    int count;
    float *room; /* buffer for the distances and samples (sensors' weights) of sample points that are still to be added */
    struct interp_norm *norms;
};

/* Returns the error at sample point `point` of an edge if the field is interpolated linearly between sample points `from` and
 * `to`. modes: kinds of distance to include. */
static double error_at(const struct line *line, enum linear_error_modes modes, int from, int to, int point)
{
    double t = (line->t[point] - line->t[from]) / (line->t[to] - line->t[from]);
    const float *const ends[2] = { line->interp[from], line->interp[to] };
    return linear_error_on_edge(line->subdiv->in->linear, modes, ends, t, line->interp[point], line->length_m, line->subdiv->slack_m);
}

/* Adds a sample point at fraction t of an edge, if it is visible. Returns its error against linear interpolation between the edge's ends,
 * or 0 if it is hidden. */
static double add_point(struct line *line, double t)
{
    const struct linear_error *linear = line->subdiv->in->linear;
    float *geodesic_m = line->room, *interp = geodesic_m + line->subdiv->sensors, point[3];
    int i = line->count;
    subdiv_mix(line->a, line->b, t, point);
    if (line->count == POINTS || !measure(&line->sight, point, geodesic_m))
        return 0;
    linear_error_weights(linear, point, geodesic_m, line->subdiv->slack_m > 0, interp, line->norms);
    for (; line->t[i - 1] > t; i--) {
        line->t[i] = line->t[i - 1];
        line->interp[i] = line->interp[i - 1];
        line->geodesic_m[i] = line->geodesic_m[i - 1];
    }
    line->t[i] = t;
    line->interp[i] = interp;
    line->geodesic_m[i] = geodesic_m;
    line->count++;
    line->room = interp + line->subdiv->samples;
    return error_at(line, LINEAR_ERROR_BOTH, 0, line->count - 1, i);
}

static bool jumps(const struct line *line, double length_m)
{
    for (int i = 1; i < line->count; i++)
        for (size_t s = 0; s < line->subdiv->sensors; s++) {
            double step_m = fabs((double)line->geodesic_m[i][s] - (double)line->geodesic_m[i - 1][s]);
            if (step_m > JUMP * (line->t[i] - line->t[i - 1]) * length_m)
                return true;
        }
    return false;
}

/* Returns the largest interpolation error that remains on the edge after splitting it at its sample point `cut`. Stops as soon
 * as the error exceeds `enough`. */
static double left_after(const struct line *line, int cut, double enough)
{
    double most = 0;
    for (int i = 1; i < line->count - 1 && most <= enough; i++) {
        int from = i < cut ? 0 : cut, to = i < cut ? cut : line->count - 1;
        if (i != cut)
            most = max_of(most, error_at(line, LINEAR_ERROR_BOTH, from, to, i));
    }
    return most;
}

/* Returns the index of the sample point at which splitting the edge leaves the smallest error, *left. Prefers the middle if it
 * is about as good. */
static int best_cut(const struct line *line, double *left)
{
    int best = 0;
    *left = INFINITY;
    for (int i = 1; i < line->count - 1; i++) {
        double aside = 1 + 0.2 * fabs(line->t[i] - 0.5), error = left_after(line, i, *left) * aside;
        if (error < *left) {
            *left = error;
            best = i;
        }
    }
    return best;
}

static void add_eighths(struct line *line, struct subdiv_finding *finding)
{
    for (int i = 1; i < 8; i += 2)
        finding->error = fmaxf(finding->error, (float)add_point(line, i / 8.0));
}

/* Finds the point at which to split an edge: the middle where the field bends evenly; the kink where two paths are equally
 * long. If the distance jumps, no split helps; halving the edge repeatedly narrows the jump down to a short edge. */
static void find_cut(struct line *line, double length_m, double enough, struct subdiv_finding *finding)
{
    double left;
    int best = best_cut(line, &left);
    if (left > NO_GAIN * (double)finding->error && jumps(line, length_m))
        return;
    for (double step = 1 / 16.0; step > 1 / 16.0 / (1 << STEPS) && left > enough; step /= 2) {
        double t = line->t[best];
        add_point(line, t - step);
        add_point(line, t + step);
        best = best_cut(line, &left);
    }
    finding->share = (float)line->t[best];
}

/* --- work items ------------------------------------------------------------------------------------------------------------- */

struct measure_job {
    struct subdiv *subdiv;
    struct subdiv_finding *findings;
    const uint32_t *edges;
    uint32_t first;
    double enough;
};

/* Buffers of one thread: points of the current edge, and a cache of the samples (linear_error.h) at recently used corners. The
 * next edge probably has one of these corners. */
struct measure_room {
    float *points, *corners;
    struct interp_norm *norms; /* normalisations of the sensors' weights at the last sample point */
    /* by cache slot: the position whose sample is stored; the last three slots are for corners whose regular slot is occupied
     * by another corner of the same edge or triangle */
    uint32_t of[CORNERS + 3];
    uint32_t taken[3]; /* by corner of the current edge or triangle: index of its slot in the cache of samples */
    struct sample_cache_notes notes;
};

static void room_init(struct measure_room *room, const struct subdiv *subdiv, size_t points)
{
    room->notes.count = room->notes.missed = 0;
    room->points = mem_array(points * (subdiv->samples + subdiv->sensors), sizeof(float));
    room->corners = subdiv->interp ? NULL : mem_array((CORNERS + 3) * subdiv->samples, sizeof(float));
    room->norms = mem_array(subdiv->norm_count, sizeof(*room->norms));
    memset(room->of, 0xff, sizeof(room->of));
}

static void room_finish(struct measure_room *room, const struct subdiv *subdiv)
{
    if (subdiv->in->sample_cache)
        sample_cache_hand_over(subdiv->in->sample_cache, &room->notes);
    mem_free(room->points);
    mem_free(room->corners);
    mem_free(room->norms);
}

/* Returns the sample (linear_error.h) at a corner of the current edge or triangle, from the thread's cache if possible. */
static const float *shares_at(const struct subdiv *subdiv, uint32_t vertex, uint32_t corner, struct measure_room *room)
{
    uint32_t place = place_of(subdiv, vertex), number = place % CORNERS;
    if (subdiv->interp)
        return subdiv->interp + place * subdiv->samples;
    for (uint32_t c = 0; c < corner; c++)
        if (room->taken[c] == number && room->of[number] != place)
            number = CORNERS + corner;
    room->taken[corner] = number;
    float *interp = room->corners + number * subdiv->samples;
    if (room->of[number] != place)
        linear_error_weights_again(subdiv->in->linear, subdiv->mesh.welded.positions_m[place], subdiv->geodesic_m + place * subdiv->sensors,
                                   subdiv->norms + place * subdiv->norm_count, interp);
    room->of[number] = place;
    return interp;
}

static void bar_short(struct subdiv_finding *finding)
{
    finding->barred = finding->error;
    finding->error = 0;
}

/* If the geodesic distance jumps across the edge, moves the edge's error from finding->error to finding->barred, because no
 * split fixes a jump. Errors of straight-line distances, which do not jump, stay in finding->error. */
static void bar_jump(struct subdiv_finding *finding, const struct line *line)
{
    finding->jumps = true;
    finding->error = 0;
    for (int i = 1; i < line->count - 1; i++) {
        finding->error = fmaxf(finding->error, (float)error_at(line, LINEAR_ERROR_EUCLIDEAN, 0, line->count - 1, i));
        finding->barred = fmaxf(finding->barred, (float)error_at(line, LINEAR_ERROR_GEODESIC, 0, line->count - 1, i));
    }
}

/* Returns the distance from the edge's midpoint to the nearest sensor, or to the nearest point where a group's data ends.
 * Reuses the midpoint's normalisations if it was the last point measured. */
static double nearest_to_middle(const struct line *line, uint32_t end)
{
    const struct linear_error *linear = line->subdiv->in->linear;
    float middle[3];
    if (line->count == 3)
        return linear_error_nearest_of(linear, line->norms);
    subdiv_mix(line->a, line->b, 0.5, middle);
    return min_of(linear_error_nearest(linear, middle),
                  linear_error_rim_of(linear, line->subdiv->norms + place_of(line->subdiv, end) * line->subdiv->norm_count));
}

static void try_edge(const struct measure_job *job, struct subdiv_finding *finding, struct measure_room *room)
{
    const struct subdiv *subdiv = job->subdiv;
    const struct subdiv_edge *edge = &subdiv->mesh.cuts[finding->number];
    const float *pa = subdiv_position(subdiv, edge->a), *pb = subdiv_position(subdiv, edge->b);
    double length_m = subdiv_length(pa, pb);
    *finding = (struct subdiv_finding){ .number = finding->number, .share = 0.5f };
    struct line line = { .subdiv = subdiv,
                         .a = pa,
                         .b = pb,
                         .length_m = length_m,
                         .sight = sight_of_edge(subdiv, edge, &room->notes),
                         .t = { 0, 1 },
                         .count = 2,
                         .interp = { shares_at(subdiv, edge->a, 0, room) },
                         .geodesic_m = { subdiv->geodesic_m + place_of(subdiv, edge->a) * subdiv->sensors,
                                         subdiv->geodesic_m + place_of(subdiv, edge->b) * subdiv->sensors },
                         .room = room->points,
                         .norms = room->norms };
    line.interp[1] = shares_at(subdiv, edge->b, 1, room);
    finding->error = (float)add_point(&line, 0.5);
    double nearest_m = nearest_to_middle(&line, edge->a);
    if (subdiv_is_short(subdiv, length_m)) {
        bar_short(finding);
        return;
    }
    if ((double)finding->error < PROBABLE * job->enough && length_m < CLOSE * nearest_m && line.count == 3)
        return;
    if ((double)finding->error <= job->enough || length_m < WIDE * nearest_m)
        finding->error = fmaxf(finding->error, (float)max_of(add_point(&line, 0.25), add_point(&line, 0.75)));
    bool partly_seen = line.count < 5 && (double)finding->error <= job->enough;
    if (partly_seen)
        add_eighths(&line, finding);
    if ((double)finding->error > job->enough && length_m < WIDE * nearest_m) {
        if (!partly_seen)
            add_eighths(&line, finding);
        find_cut(&line, length_m, job->enough, finding);
    }
    if (length_m < subdiv->jump_m && jumps(&line, length_m))
        bar_jump(finding, &line);
    double margin = min_of(0.5, subdiv->shortest_m / length_m);
    finding->share = (float)min_of(1 - margin, max_of(margin, (double)finding->share));
}

static void try_edges(void *arg, size_t begin, size_t end)
{
    const struct measure_job *job = arg;
    const struct subdiv *subdiv = job->subdiv;
    struct measure_room room;
    uint32_t next = 0;
    room_init(&room, subdiv, POINTS);
    for (size_t i = begin; i < end; i++) {
        const struct subdiv_edge *edge = &subdiv->mesh.cuts[job->findings[i].number];
        const uint32_t corners[2] = { edge->a, edge->b };
        uint64_t key = subdiv_cache_key(subdiv, corners, 2);
        if (!subdiv_cache_find(subdiv, key, corners, 2, &next, &job->findings[i]))
            try_edge(job, &job->findings[i], &room);
        job->findings[i].key = key;
    }
    room_finish(&room, subdiv);
}

/* Returns whether splitting would not help: the geodesic distance jumps between a point inside a triangle and one of its
 * corners, and the triangle's edges are short. */
static bool jumps_inside(const struct subdiv *subdiv, const struct subdiv_tri *tri, const float middle[3], const float *geodesic_m)
{
    for (int c = 0; c < 3; c++) {
        const float *corner_m = subdiv->geodesic_m + place_of(subdiv, tri->v[c]) * subdiv->sensors;
        double most_m = JUMP * subdiv_length(middle, subdiv_position(subdiv, tri->v[c]));
        if (subdiv_length(subdiv_position(subdiv, tri->v[c]), subdiv_position(subdiv, tri->v[(c + 1) % 3])) > subdiv->jump_m)
            return false;
        for (size_t s = 0; s < subdiv->sensors; s++)
            if (fabs((double)geodesic_m[s] - (double)corner_m[s]) > most_m)
                return true;
    }
    return false;
}

struct inside { /* state for measuring the interpolation error at points inside a triangle */
    struct origin_sight sight;
    const struct subdiv_tri *tri;
    const float *interp[3]; /* samples (weights of the sensors) at the triangle's corners */
    double corners[3][3];
    float *points; /* buffer for the samples of one inner point */
    struct interp_norm *norms;
};

static void place_in(const struct inside *inside, const double weights[3], double at[3])
{
    for (int i = 0; i < 3; i++)
        at[i] = weights[0] * inside->corners[0][i] + weights[1] * inside->corners[1][i] + weights[2] * inside->corners[2][i];
}

/* Returns the interpolation error at a triangle's point with these barycentric weights. hit: the point's projection onto the surface. */
static double error_inside(const struct inside *inside, const double weights[3], const struct surface_point *hit)
{
    const struct subdiv *subdiv = inside->sight.subdiv;
    const struct linear_error *linear = subdiv->in->linear;
    float *geodesic_m = inside->points, *interp = geodesic_m + subdiv->sensors;
    double at[3];
    place_in(inside, weights, at);
    const float point[3] = { (float)at[0], (float)at[1], (float)at[2] };
    surface_field_at_point(subdiv->in->field, subdiv->in->surface, hit, geodesic_m);
    linear_error_weights(linear, point, geodesic_m, subdiv->slack_m > 0, interp, inside->norms);
    enum linear_error_modes modes = jumps_inside(subdiv, inside->tri, point, geodesic_m) ? LINEAR_ERROR_EUCLIDEAN : LINEAR_ERROR_BOTH;
    double wide_m = 0;
    for (int c = 0; c < 3; c++)
        wide_m = max_of(wide_m, vec_distance(at, inside->corners[c]));
    return linear_error_in_triangle(linear, modes, inside->interp, weights, interp, wide_m, subdiv->slack_m);
}

/* Measures a triangle's interpolation error at its centre. If the centre is hidden inside another part, measures at the visible
 * points nearest to it and to three points near the corners. */
static void try_inside(const struct subdiv *subdiv, struct subdiv_finding *finding, struct measure_room *room)
{
    static const double places[4][3] = {
        { 1 / 3.0, 1 / 3.0, 1 / 3.0 }, { 2 / 3.0, 1 / 6.0, 1 / 6.0 }, { 1 / 6.0, 2 / 3.0, 1 / 6.0 }, { 1 / 6.0, 1 / 6.0, 2 / 3.0 }
    };
    const struct subdiv_tri *tri = &subdiv->mesh.tris[finding->number];
    struct inside inside = { .sight = sight_of_tri(subdiv, tri, &room->notes), .tri = tri, .points = room->points, .norms = room->norms };
    struct surface_point hit;
    double at[3], weights[3];
    for (uint32_t c = 0; c < 3; c++) {
        inside.interp[c] = shares_at(subdiv, tri->v[c], c, room);
        to_doubles(subdiv_position(subdiv, tri->v[c]), inside.corners[c]);
    }
    *finding = (struct subdiv_finding){ .number = finding->number };
    place_in(&inside, places[0], at);
    bool middle_seen = project(&inside.sight, (const float[3]){ (float)at[0], (float)at[1], (float)at[2] }, at, &hit);
    if (middle_seen)
        finding->error = (float)error_inside(&inside, places[0], &hit);
    hit.tri = TRIMESH_NONE;
    for (int p = 0; p < 4 && !middle_seen && (p == 0 || hit.tri != TRIMESH_NONE); p++) {
        place_in(&inside, places[p], at);
        if (find_seen(&inside.sight, (const double(*)[3])inside.corners, at, weights, &hit))
            finding->error = fmaxf(finding->error, (float)error_inside(&inside, weights, &hit));
    }
}

static void try_insides(void *arg, size_t begin, size_t end)
{
    const struct measure_job *job = arg;
    const struct subdiv *subdiv = job->subdiv;
    struct measure_room room;
    uint32_t next = 0;
    room_init(&room, subdiv, 1);
    for (size_t i = begin; i < end; i++) {
        const uint32_t *corners = subdiv->mesh.tris[job->findings[i].number].v;
        uint64_t key = subdiv_cache_key(subdiv, corners, 3);
        if (!subdiv_cache_find(subdiv, key, corners, 3, &next, &job->findings[i]))
            try_inside(subdiv, &job->findings[i], &room);
        job->findings[i].key = key;
    }
    room_finish(&room, subdiv);
}

/* Rounds distances beyond a group's reach (maximum distance of influence) to the asset file's precision. There the nearest
   sensor has all the weight, and where two sensors are about equally near, rounding must choose the same one as in the file. */
static void round_beyond_reach(const struct linear_error *linear, float *geodesic_m)
{
    for (size_t g = 0; g < linear->group_count; g++) {
        const struct linear_error_group *group = &linear->groups[g];
        for (size_t i = 0; i < group->count && group->of.reach_m < INFINITY; i++) {
            float *far_m = &geodesic_m[group->columns[i]];
            if (*far_m >= group->of.reach_m)
                *far_m = asset_distance_of(asset_distance_code(*far_m));
        }
    }
}

static void measure_places(void *arg, size_t begin, size_t end)
{
    const struct measure_job *job = arg;
    const struct subdiv *subdiv = job->subdiv;
    struct sample_cache_notes notes;
    notes.count = notes.missed = 0;
    for (size_t i = begin; i < end; i++) {
        uint32_t place = job->first + (uint32_t)i;
        const float *point = subdiv->mesh.welded.positions_m[place];
        float *geodesic_m = subdiv->geodesic_m + place * subdiv->sensors;
        if (job->edges) {
            struct origin_sight sight = sight_of_edge(subdiv, &subdiv->mesh.cuts[job->edges[i]], &notes);
            measure_always(&sight, point, geodesic_m);
        }
        round_beyond_reach(subdiv->in->linear, geodesic_m);
        struct interp_norm *norms = subdiv->norms + place * subdiv->norm_count;
        if (subdiv->interp)
            linear_error_weights(subdiv->in->linear, point, geodesic_m, false, subdiv->interp + place * subdiv->samples, norms);
        else
            linear_error_norms(subdiv->in->linear, point, geodesic_m, norms);
    }
    if (subdiv->in->sample_cache)
        sample_cache_hand_over(subdiv->in->sample_cache, &notes);
}

/* Measures the interpolation error along `count` edges. Errors below `enough` need not be exact, and edges with such errors get
 * no split point. */
static void measure_edges(struct subdiv *subdiv, struct subdiv_finding *findings, size_t count, double enough)
{
    struct measure_job job = { .subdiv = subdiv, .findings = findings, .enough = enough };
    workers_for(subdiv->in->workers, count, GRAIN, try_edges, &job);
    for (size_t i = 0; i < count; i++)
        subdiv_cache_add(subdiv, &findings[i]);
}

void subdiv_measure_new_edges(struct subdiv *subdiv, struct subdiv_finding *findings, size_t count)
{
    measure_edges(subdiv, findings, count, SUBDIV_AIM);
    for (size_t i = 0; i < count; i++) {
        struct subdiv_edge *edge = &subdiv->mesh.cuts[findings[i].number];
        edge->error = findings[i].error;
        edge->barred = findings[i].barred;
        edge->jumps = findings[i].jumps;
        edge->unasked = false;
        edge->proven = findings[i].error <= (float)SUBDIV_AIM && findings[i].barred <= (float)SUBDIV_AIM;
        if (edge->middle == TRIMESH_NONE)
            edge->share = findings[i].share;
    }
}

void subdiv_measure_insides(struct subdiv *subdiv, struct subdiv_finding *findings, size_t count)
{
    workers_for(subdiv->in->workers, count, GRAIN, try_insides, &(struct measure_job){ .subdiv = subdiv, .findings = findings });
    for (size_t i = 0; i < count; i++)
        subdiv_cache_add(subdiv, &findings[i]);
}

void subdiv_measure_places(struct subdiv *subdiv, uint32_t first, const uint32_t *edges, size_t count)
{
    struct measure_job job = { .subdiv = subdiv, .edges = edges, .first = first };
    workers_for(subdiv->in->workers, count, GRAIN, measure_places, &job);
}

void subdiv_add_place(struct subdiv *subdiv, uint32_t place, uint32_t part)
{
    mem_grow(&subdiv->geodesic_m, &subdiv->geodesic_capacity, (place + 1) * subdiv->sensors, sizeof(*subdiv->geodesic_m));
    if (subdiv->interp)
        mem_grow(&subdiv->interp, &subdiv->share_capacity, (place + 1) * subdiv->samples, sizeof(*subdiv->interp));
    mem_grow(&subdiv->norms, &subdiv->norm_capacity, (place + 1) * subdiv->norm_count, sizeof(*subdiv->norms));
    mem_grow(&subdiv->part, &subdiv->part_capacity, place + 1, sizeof(*subdiv->part));
    subdiv->part[place] = part;
}
