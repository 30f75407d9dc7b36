/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the edges along which the field is not straight, and cuts them in half until it is: those that err most first. */
#include "preprocess/split.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/cutmesh.h"
#include "surface/bvh.h"
#include "surface/vec.h"

#define EDGE_ERROR (0.7 * SPLIT_ERROR) /* three edges that err alike make the inside err by a third more */
#define LONG 0.25                      /* of the way to the nearest sensor: longer edges are tried at three points */
#define LONGER                                                                                                                             \
    1.6                       /* than the edge that is cut, an edge of a triangle may be
                                          without being cut itself */
#define SHORTEST_OF_SIZE 5e-4 /* of the asset: pieces are no shorter */
#define ON_OF_SIZE 1e-5       /* a sensor as near to a vertex or an edge stands on it */
#define SHORTEST_OF_ERROR 2.0 /* of the level: there, about so many pixels */
#define MOST_ROUNDS 40

/* How many triangles a level may get more: so much of its own, or so many, whichever is more. The finest is only drawn from near by. */
#define FINEST_GROWTH 0.6
#define FINEST_GROWTH_TRIS 9000.0
#define GROWTH 0.3
#define GROWTH_TRIS 800.0

struct split {
    const struct split_input *in;
    struct cutmesh mesh;
    size_t sensors;
    float *geodesic_m; /* [place][sensor] */
    size_t geodesic_capacity;
    double size_m;
    /* of the level in hand: */
    double on_surface_m; /* what is farther from the surface is hidden inside another part */
    double shortest_m;
    size_t most_tris;
};

struct finding { /* about one edge or one triangle */
    uint32_t number;
    float error;
};

struct job {
    const struct split *split;
    struct finding *findings;
};

static void mix3(const float a[3], const float b[3], double t, float out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (float)((double)a[i] + t * ((double)b[i] - (double)a[i]));
}

static double length(const float a[3], const float b[3])
{
    double x = (double)b[0] - (double)a[0], y = (double)b[1] - (double)a[1], z = (double)b[2] - (double)a[2];
    return sqrt(x * x + y * y + z * z);
}

static const float *position(const struct split *split, uint32_t vertex)
{
    return split->mesh.geometry->positions_m[vertex];
}

static const float *geodesic(const struct split *split, uint32_t vertex)
{
    return split->geodesic_m + split->mesh.places.of_vertex[vertex] * split->sensors;
}

/* Distances along the surface at a point that is no vertex. False: it is hidden, and nobody will see an error. */
static bool measure(const struct split *split, const float point[3], const double normal[3], float *out)
{
    const struct split_input *in = split->in;
    struct surface_spot spot;
    surface_find_spot(in->surface, (const double[3]){ (double)point[0], (double)point[1], (double)point[2] }, normal, &spot);
    surface_field_at_spot(in->field, in->surface, &spot, out);
    return spot.distance_m <= split->on_surface_m;
}

static void add_distances(struct split *split, uint32_t place, const float point[3], const double normal[3])
{
    mem_grow(&split->geodesic_m, &split->geodesic_capacity, (place + 1) * split->sensors, sizeof(*split->geodesic_m));
    measure(split, point, normal, split->geodesic_m + place * split->sensors);
}

/* --- trying --------------------------------------------------------------------------------------------------------------- */

struct room { /* for one thread */
    float *a, *b, *c, *between, *geodesic_m;
};

static void room_init(struct room *room, const struct split *split)
{
    size_t shares = straight_sample_count(split->in->straight);
    room->a = mem_array(4 * shares + split->sensors, sizeof(*room->a));
    room->b = room->a + shares;
    room->c = room->b + shares;
    room->between = room->c + shares;
    room->geodesic_m = room->between + shares;
}

static double edge_error(const struct split *split, const struct cut_edge *edge, struct room *room)
{
    const struct straight *straight = split->in->straight;
    const float *pa = position(split, edge->a), *pb = position(split, edge->b);
    double length_m = length(pa, pb), normal[3], most = 0;
    float point[3];
    if (length_m < 2 * SHORTEST_OF_SIZE * split->size_m)
        return 0;
    mix3(pa, pb, 0.5, point);
    double nearest_m = straight_nearest(straight, point);
    int tries = length_m > LONG * nearest_m ? 3 : 1;
    if (length_m <= straight_finest(straight, nearest_m))
        return 0;
    straight_shares(straight, pa, geodesic(split, edge->a), room->a);
    straight_shares(straight, pb, geodesic(split, edge->b), room->b);
    cutmesh_normal(&split->mesh, edge, normal);
    for (int i = 0; i < tries; i++) {
        double t = i == 0 ? 0.5 : i == 1 ? 0.25 : 0.75;
        mix3(pa, pb, t, point);
        if (!measure(split, point, normal, room->geodesic_m))
            continue;
        straight_shares(straight, point, room->geodesic_m, room->between);
        most = fmax(most, straight_error(straight, room->a, room->b, t, length_m, room->between));
    }
    return most;
}

static void try_edges(void *arg, size_t begin, size_t end)
{
    struct job *job = arg;
    struct room room;
    room_init(&room, job->split);
    for (size_t i = begin; i < end; i++)
        job->findings[i].error = (float)edge_error(job->split, &job->split->mesh.cuts[job->findings[i].number], &room);
    mem_free(room.a);
}

static int longest_edge(const struct split *split, const struct cut_tri *tri, double *length_m)
{
    int longest = 0;
    *length_m = 0;
    for (int i = 0; i < 3; i++) {
        double l = length(position(split, tri->v[i]), position(split, tri->v[(i + 1) % 3]));
        if (l > *length_m) {
            *length_m = l;
            longest = i;
        }
    }
    return longest;
}

/* Straight edges may enclose a field that is not: by chance, where the triangle is large. */
static double inside_error(const struct split *split, const struct cut_tri *tri, struct room *room)
{
    const struct straight *straight = split->in->straight;
    float middle[3];
    double normal[3], longest_m;
    for (int i = 0; i < 3; i++) {
        middle[i] = (position(split, tri->v[0])[i] + position(split, tri->v[1])[i] + position(split, tri->v[2])[i]) / 3;
        normal[i] = (double)(split->mesh.geometry->normals[tri->v[0]][i] + split->mesh.geometry->normals[tri->v[1]][i] +
                             split->mesh.geometry->normals[tri->v[2]][i]);
    }
    longest_edge(split, tri, &longest_m);
    if (longest_m < LONG * straight_nearest(straight, middle) || longest_m < 2 * SHORTEST_OF_SIZE * split->size_m)
        return 0;
    straight_shares(straight, position(split, tri->v[0]), geodesic(split, tri->v[0]), room->a);
    straight_shares(straight, position(split, tri->v[1]), geodesic(split, tri->v[1]), room->b);
    straight_shares(straight, position(split, tri->v[2]), geodesic(split, tri->v[2]), room->c);
    if (!measure(split, middle, normal, room->geodesic_m))
        return 0;
    straight_shares(straight, middle, room->geodesic_m, room->between);
    return straight_error_inside(straight, (const float *const[3]){ room->a, room->b, room->c }, longest_m, room->between);
}

static void try_insides(void *arg, size_t begin, size_t end)
{
    struct job *job = arg;
    struct room room;
    room_init(&room, job->split);
    for (size_t i = begin; i < end; i++)
        job->findings[i].error = (float)inside_error(job->split, &job->split->mesh.tris[job->findings[i].number], &room);
    mem_free(room.a);
}

static void try_all(const struct split *split, struct finding *findings, size_t count, void (*body)(void *arg, size_t begin, size_t end))
{
    struct job job = { .split = split, .findings = findings };
    if (split->in->workers)
        workers_for(split->in->workers, count, 512, body, &job);
    else
        body(&job, 0, count);
}

/* --- cutting -------------------------------------------------------------------------------------------------------------- */

static void cut(struct split *split, uint32_t edge, double t, const float point[3])
{
    double normal[3];
    cutmesh_normal(&split->mesh, &split->mesh.cuts[edge], normal);
    if (cutmesh_cut(&split->mesh, edge, t, point))
        add_distances(split, split->mesh.cuts[edge].middle, point, normal);
}

static void cut_in_half(struct split *split, uint32_t edge)
{
    const struct cut_edge *at = &split->mesh.cuts[edge];
    float point[3];
    mix3(position(split, at->a), position(split, at->b), 0.5, point);
    cut(split, edge, 0.5, point);
}

/* A triangle is cut at its longest edge first, or pieces would get thinner and thinner. */
static void cut_longest_edges(struct split *split)
{
    struct cutmesh *mesh = &split->mesh;
    for (bool more = true; more;) {
        more = false;
        for (size_t t = 0; t < mesh->tri_count; t++) {
            const struct cut_tri *tri = &mesh->tris[t];
            double longest_m, cut_m = 0;
            for (int i = 0; i < 3; i++)
                if (cutmesh_is_cut(mesh, tri->e[i]))
                    cut_m = fmax(cut_m, length(position(split, tri->v[i]), position(split, tri->v[(i + 1) % 3])));
            if (cut_m == 0)
                continue;
            uint32_t e = tri->e[longest_edge(split, tri, &longest_m)];
            if (longest_m <= LONGER * cut_m || cutmesh_is_cut(mesh, e))
                continue;
            cut_in_half(split, e);
            more = true;
        }
    }
}

static int worst_first(const void *a, const void *b)
{
    const struct finding *p = a, *q = b;
    return p->error > q->error ? -1 : p->error < q->error ? 1 : p->number < q->number ? -1 : p->number > q->number;
}

/* Measures edges that are new. */
static void measure_edges(struct split *split)
{
    struct cutmesh *mesh = &split->mesh;
    struct finding *findings = mem_array(3 * mesh->tri_count, sizeof(*findings));
    size_t count = 0;
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            struct cut_edge *edge = &mesh->cuts[mesh->tris[t].e[i]];
            if (edge->error < 0)
                findings[count++].number = mesh->tris[t].e[i];
            edge->error = fmaxf(edge->error, 0);
        }
    try_all(split, findings, count, try_edges);
    for (size_t i = 0; i < count; i++)
        mesh->cuts[findings[i].number].error = findings[i].error;
    mem_free(findings);
}

/* Measures new triangles whose edges are good: cuts at the longest edge those that err inside. */
static void measure_insides(struct split *split, double limit)
{
    struct cutmesh *mesh = &split->mesh;
    struct finding *findings = mem_array(mesh->tri_count, sizeof(*findings));
    size_t count = 0;
    for (size_t t = 0; t < mesh->tri_count; t++) {
        struct cut_tri *tri = &mesh->tris[t];
        bool good = tri->error < 0;
        for (int i = 0; i < 3; i++)
            good &= (double)mesh->cuts[tri->e[i]].error <= limit;
        if (good)
            findings[count++].number = (uint32_t)t;
    }
    try_all(split, findings, count, try_insides);
    for (size_t i = 0; i < count; i++) {
        struct cut_tri *tri = &mesh->tris[findings[i].number];
        double longest_m;
        struct cut_edge *edge = &mesh->cuts[tri->e[longest_edge(split, tri, &longest_m)]];
        tri->error = findings[i].error;
        edge->error = fmaxf(edge->error, findings[i].error * (float)(EDGE_ERROR / SPLIT_ERROR));
    }
    mem_free(findings);
}

/* Cuts the edges that err by more than the limit, the worst ones first, as long as the level may grow. Returns how many it should cut. */
static size_t cut_worst(struct split *split, double limit)
{
    struct cutmesh *mesh = &split->mesh;
    struct finding *findings = mem_array(3 * mesh->tri_count, sizeof(*findings));
    size_t count = 0, room = split->most_tris > mesh->tri_count ? (split->most_tris - mesh->tri_count) / 2 : 0;
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            const struct cut_edge *edge = &mesh->cuts[mesh->tris[t].e[i]];
            if ((double)edge->error > limit && length(position(split, edge->a), position(split, edge->b)) > 2 * split->shortest_m)
                findings[count++] = (struct finding){ .number = mesh->tris[t].e[i], .error = edge->error };
        }
    qsort(findings, count, sizeof(*findings), worst_first);
    for (size_t i = 0; i < count && room; i++)
        if (!cutmesh_is_cut(mesh, findings[i].number)) {
            cut_in_half(split, findings[i].number);
            room--;
        }
    mem_free(findings);
    return count;
}

/* --- sensors -------------------------------------------------------------------------------------------------------------- */

struct hit { /* where a sensor meets a level */
    size_t tri;
    double weights[3], point[3];
};

static void corners_of(const struct split *split, const struct cut_tri *tri, double corners[3][3])
{
    for (int c = 0; c < 3; c++)
        for (int axis = 0; axis < 3; axis++)
            corners[c][axis] = (double)position(split, tri->v[c])[axis];
}

static double try_piece(const struct split *split, size_t t, const double point[3], double best_m, struct hit *hit)
{
    double corners[3][3], weights[3], at[3];
    corners_of(split, &split->mesh.tris[t], corners);
    triangle_nearest(point, corners[0], corners[1], corners[2], weights);
    for (int axis = 0; axis < 3; axis++)
        at[axis] = weights[0] * corners[0][axis] + weights[1] * corners[1][axis] + weights[2] * corners[2][axis];
    double distance_m = vec_distance(at, point);
    if (!(distance_m < best_m))
        return best_m;
    hit->tri = t;
    memcpy(hit->weights, weights, sizeof(weights));
    memcpy(hit->point, at, sizeof(at));
    return distance_m;
}

/* Among the pieces of a triangle that the level had at first: in its own place, and behind the first ones. */
static double find_piece(const struct split *split, uint32_t origin, size_t first_count, const double point[3], struct hit *hit)
{
    double best_m = try_piece(split, origin, point, INFINITY, hit);
    for (size_t t = first_count; t < split->mesh.tri_count; t++)
        if (split->mesh.tris[t].origin == origin)
            best_m = try_piece(split, t, point, best_m, hit);
    return best_m;
}

/* The vertex where the sensor stands: one that is there, or a new one in an edge or in the triangle. */
static uint32_t set_vertex(struct split *split, const struct hit *hit, const float point[3])
{
    struct cutmesh *mesh = &split->mesh;
    struct cut_tri tri = mesh->tris[hit->tri];
    double on_m = ON_OF_SIZE * split->size_m;
    for (int i = 0; i < 3; i++)
        if (length(position(split, tri.v[i]), point) <= on_m)
            return tri.v[i];
    for (int i = 0; i < 3; i++) {
        const float *a = position(split, tri.v[i]), *b = position(split, tri.v[(i + 1) % 3]);
        double t = hit->weights[(i + 1) % 3] / fmax(hit->weights[i] + hit->weights[(i + 1) % 3], 1e-30);
        float foot[3];
        mix3(a, b, t, foot);
        if (length(foot, point) > on_m)
            continue;
        bool forward = mesh->places.of_vertex[tri.v[i]] == mesh->places.of_vertex[mesh->cuts[tri.e[i]].a];
        cut(split, tri.e[i], forward ? t : 1 - t, point);
        uint32_t middle = mesh->cuts[tri.e[i]].middle;
        cutmesh_apply(mesh);
        for (uint32_t v = mesh->geometry->vertex_count; v-- > mesh->own_vertices;)
            if (mesh->places.of_vertex[v] == middle)
                return v;
    }
    double normal[3];
    uint32_t vertex = cutmesh_insert(mesh, hit->tri, hit->weights, point);
    for (int axis = 0; axis < 3; axis++)
        normal[axis] = (double)mesh->geometry->normals[vertex][axis];
    add_distances(split, mesh->places.of_vertex[vertex], point, normal);
    return vertex;
}

static void stand(struct split *split, const struct bvh *bvh, size_t first_count, size_t sensor, bool finest, double error_m)
{
    struct asset_sensor *at = &split->in->sensors[sensor];
    const double point[3] = { (double)at->surface_m[0], (double)at->surface_m[1], (double)at->surface_m[2] };
    struct bvh_place place;
    struct hit hit = { 0 };
    float on_level[3];
    bvh_nearest(bvh, point, INFINITY, NULL, NULL, &place);
    if (find_piece(split, place.tri, first_count, point, &hit) > 2 * error_m + ON_OF_SIZE * split->size_m)
        return; /* the part it stands on is not in this level */
    for (int axis = 0; axis < 3; axis++)
        on_level[axis] = finest ? at->surface_m[axis] : (float)hit.point[axis];
    uint32_t vertex = set_vertex(split, &hit, on_level);
    if (!finest)
        return;
    at->nearest_vertex = vertex;
    memcpy(at->surface_m, position(split, vertex), sizeof(at->surface_m));
    split->geodesic_m[split->mesh.places.of_vertex[vertex] * split->sensors + sensor] = 0;
}

static void place_sensors(struct split *split, bool finest, double error_m)
{
    struct cutmesh *mesh = &split->mesh;
    struct trimesh trimesh = { 0 };
    size_t first_count = mesh->tri_count;
    for (size_t t = 0; t < first_count; t++)
        mesh->tris[t].origin = (uint32_t)t;
    for (size_t p = 0; p < mesh->places.count; p++) {
        const float *at = mesh->places.positions_m[p];
        trimesh_add_point(&trimesh, (const double[3]){ (double)at[0], (double)at[1], (double)at[2] });
    }
    for (size_t t = 0; t < first_count; t++)
        trimesh_add_tri(&trimesh, mesh->places.of_vertex[mesh->tris[t].v[0]], mesh->places.of_vertex[mesh->tris[t].v[1]],
                        mesh->places.of_vertex[mesh->tris[t].v[2]], (uint32_t)t);
    struct bvh *bvh = bvh_create(&trimesh);
    for (size_t s = 0; s < split->sensors; s++)
        stand(split, bvh, first_count, s, finest, error_m);
    bvh_destroy(&bvh);
    trimesh_finish(&trimesh);
}

/* --- all ------------------------------------------------------------------------------------------------------------------ */

static float largest_error(const struct cutmesh *mesh)
{
    float most = 0;
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            most = fmaxf(most, mesh->cuts[mesh->tris[t].e[i]].error);
    return most;
}

/* Large errors go first: should the level come to its bound, the smaller ones are what is left. */
static void split_level(struct split *split, struct level *level, bool finest)
{
    static const double limits[] = { 16 * EDGE_ERROR, 4 * EDGE_ERROR, EDGE_ERROR };
    split->on_surface_m = 1.5 * (double)level->error_m + 1e-4 * split->size_m;
    split->shortest_m = fmax(SHORTEST_OF_SIZE * split->size_m, SHORTEST_OF_ERROR * (double)level->error_m);
    cutmesh_load(&split->mesh, level);
    split->most_tris = split->mesh.tri_count + (size_t)(finest ? fmax(FINEST_GROWTH * (double)split->mesh.tri_count, FINEST_GROWTH_TRIS)
                                                               : fmax(GROWTH * (double)split->mesh.tri_count, GROWTH_TRIS));
    place_sensors(split, finest, (double)level->error_m);
    for (size_t l = 0; l < sizeof(limits) / sizeof(*limits); l++)
        for (int round = 0; round < MOST_ROUNDS; round++) {
            measure_edges(split);
            measure_insides(split, limits[l]);
            if (!cut_worst(split, limits[l]))
                break;
            cut_longest_edges(split);
            if (!cutmesh_apply(&split->mesh))
                break;
        }
    measure_edges(split);
    level->field_error = largest_error(&split->mesh);
    cutmesh_store(&split->mesh, level);
}

static void set_radii(struct split *split)
{
    const struct geometry *g = split->mesh.geometry;
    float *largest_m[2] = { mem_array(split->sensors, sizeof(float)), mem_array(split->sensors, sizeof(float)) };
    for (size_t s = 0; s < split->sensors; s++)
        for (uint32_t v = 0; v < g->vertex_count; v++) {
            float geodesic_m = geodesic(split, v)[s];
            if (isfinite(geodesic_m))
                largest_m[DISTANCE_GEODESIC][s] = fmaxf(largest_m[DISTANCE_GEODESIC][s], geodesic_m);
            largest_m[DISTANCE_EUCLIDEAN][s] =
                fmaxf(largest_m[DISTANCE_EUCLIDEAN][s], (float)length(g->positions_m[v], split->in->sensors[s].surface_m));
        }
    straight_set_radius(split->in->straight, (const float *const *)largest_m);
    mem_free(largest_m[0]);
    mem_free(largest_m[1]);
}

static bool start(struct split *split, struct geometry *geometry)
{
    float low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    if (!cutmesh_init(&split->mesh, geometry))
        return false;
    split->geodesic_capacity = split->mesh.places.count * split->sensors;
    split->geodesic_m = mem_try_array(split->geodesic_capacity, sizeof(*split->geodesic_m));
    for (uint32_t v = 0; split->geodesic_m && v < geometry->vertex_count; v++)
        surface_field_at_vertex(split->in->field, split->in->surface, v,
                                split->geodesic_m + split->mesh.places.of_vertex[v] * split->sensors);
    for (uint32_t v = 0; v < geometry->vertex_count; v++)
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = fminf(low[axis], geometry->positions_m[v][axis]);
            high[axis] = fmaxf(high[axis], geometry->positions_m[v][axis]);
        }
    split->size_m = length(low, high);
    return split->geodesic_m != NULL;
}

static float *columns_of(const struct split *split)
{
    uint32_t count = split->mesh.geometry->vertex_count;
    float *columns = mem_try_array(split->sensors * (size_t)count, sizeof(*columns));
    for (size_t s = 0; columns && s < split->sensors; s++)
        for (uint32_t v = 0; v < count; v++)
            columns[s * count + v] = geodesic(split, v)[s];
    return columns;
}

bool split_levels(struct levels *levels, struct geometry *geometry, const struct split_input *input, float **distances)
{
    struct split split = { .in = input, .sensors = input->straight->sensor_count };
    *distances = NULL;
    if (start(&split, geometry)) {
        set_radii(&split);
        for (size_t l = 0; l < levels->count; l++)
            split_level(&split, &levels->at[l], l == 0);
        *distances = columns_of(&split);
    }
    cutmesh_finish(&split.mesh);
    mem_free(split.geodesic_m);
    return *distances != NULL;
}
