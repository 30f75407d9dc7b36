/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measuring a field along edges and inside triangles, and cutting these. */
#include "tests/bench/cut_mesh.h"

#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"

#define STEPS_OF_EDGE 16
#define NO_GAIN 0.5   /* of the error, left by the best cut: as in the product */
#define FLAT 1e-3     /* a flat triangle's longest side is no shorter than the way round by more: likewise */
#define ASIDE 0.1
#define JUMPS 1.5     /* a distance that differs by more than so many lengths of an edge jumps along it */

/* True: sample and geodesic_m are filled. */
static bool evaluate(struct truth *truth, const double at[3], const struct facing *facing, float *sample, float *geodesic_m)
{
    struct surface_point hit;
    struct interp_norm norms[8];
    const float place[3] = { (float)at[0], (float)at[1], (float)at[2] };
    const uint32_t origins[2] = { facing->origin, facing->origin };
    if (facing->origin == NO_ORIGIN ? !surface_find_point_within(truth->surface, at, facing->normal, truth->limit_m, &hit)
                                    : !surface_find_point_on(truth->surface, at, truth->limit_m, origins, &hit))
        return false;
    truth->evaluations++;
    surface_field_at_point(truth->field, truth->surface, &hit, geodesic_m);
    if (!isfinite(geodesic_m[0]))
        return false;
    linear_error_weights(&truth->linear, place, geodesic_m, false, sample, norms);
    return true;
}

uint32_t cut_mesh_add_vertex(struct cut_mesh *mesh, const double at[3], const struct facing *facing)
{
    struct truth *truth = mesh->truth;
    mem_grow(&mesh->vertices, &mesh->vertex_capacity, mesh->vertex_count + 1, sizeof(*mesh->vertices));
    struct vertex *vertex = &mesh->vertices[mesh->vertex_count];
    *vertex = (struct vertex){ .sample = mem_array(truth->numbers, sizeof(float)), .geodesic_m = mem_array(truth->sensors, sizeof(float)) };
    memcpy(vertex->at, at, sizeof(vertex->at));
    if (!evaluate(truth, at, facing, vertex->sample, vertex->geodesic_m)) {
        mem_free(vertex->sample);
        mem_free(vertex->geodesic_m);
        vertex->sample = vertex->geodesic_m = NULL;
    }
    return (uint32_t)mesh->vertex_count++;
}

void cut_mesh_add_tri(struct cut_mesh *mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t origin)
{
    const uint32_t v[3] = { a, b, c };
    mem_grow(&mesh->tris, &mesh->tri_capacity, mesh->tri_count + 1, sizeof(*mesh->tris));
    struct tri *tri = &mesh->tris[mesh->tri_count++];
    mesh->live++;
    *tri = (struct tri){ .origin = origin };
    for (int i = 0; i < 3; i++) {
        uint32_t e = edge_table_add(&mesh->table, v[i], v[(i + 1) % 3]);
        tri->v[i] = v[i];
        tri->e[i] = e;
        mem_grow(&mesh->edges, &mesh->edge_capacity, e + 1, sizeof(*mesh->edges));
        if (e == mesh->edge_count) {
            mesh->edges[e] = (struct edge){ .a = v[i], .b = v[(i + 1) % 3], .middle = NO_VERTEX };
            mesh->edge_count++;
        }
    }
}

/* The longest side of a flat triangle runs beside the corner across: where it is cut, it is cut there, or its pieces would be as long and
   as flat. The side; -1: the triangle is not flat. */
static int aim(struct cut_mesh *mesh, const struct tri *tri)
{
    double m[3];
    int i = 0;
    for (int c = 0; c < 3; c++)
        m[c] = vec_distance(mesh->vertices[tri->v[c]].at, mesh->vertices[tri->v[(c + 1) % 3]].at);
    for (int c = 1; c < 3; c++)
        i = m[c] > m[i] ? c : i;
    double ab = m[i], bc = m[(i + 1) % 3], ca = m[(i + 2) % 3];
    struct edge *edge = &mesh->edges[tri->e[i]];
    if (min_of(ca, bc) < max_of(mesh->shortest_m, ASIDE * ab) || ca + bc > ab * (1 + FLAT))
        return -1;
    if (edge->aim == 0)
        edge->aim = edge->a == tri->v[i] ? ca / (ca + bc) : bc / (ca + bc);
    return i;
}

struct facing cut_mesh_facing(const struct cut_mesh *mesh, const struct tri *tri)
{
    struct facing facing = { .origin = tri->origin };
    vec_normal(mesh->vertices[tri->v[0]].at, mesh->vertices[tri->v[1]].at, mesh->vertices[tri->v[2]].at, facing.normal);
    vec_normalize(facing.normal);
    return facing;
}

static double length_of(const struct cut_mesh *mesh, uint32_t e)
{
    return vec_distance(mesh->vertices[mesh->edges[e].a].at, mesh->vertices[mesh->edges[e].b].at);
}

/* The error of one of a client's choices, or, if that is CUT_CHOICES, the largest of all. */
static double error_of(const struct truth *truth, const float *const *samples, const float *weights, size_t count, const float *sample,
                       int combo)
{
    const struct linear_error_group *group = &truth->linear.groups[0];
    size_t first = 0;
    double worst = 0;
    for (int c = 0; c < CUT_CHOICES; c++) {
        const float *at[6];
        if (c % 2 && !group->papers)
            continue;
        for (size_t i = 0; i < count; i++)
            at[i] = samples[i] + first;
        if (combo == CUT_CHOICES || combo == c)
            worst = max_of(worst, (double)interp_error(at, weights, count, sample + first, group->of.count));
        first += group->of.count;
    }
    return worst;
}

/* --- measuring ------------------------------------------------------------------------------------------------------------------ */

static bool jumps(const struct cut_mesh *mesh, const struct edge *edge, double length_m)
{
    const float *a = mesh->vertices[edge->a].geodesic_m, *b = mesh->vertices[edge->b].geodesic_m;
    for (size_t s = 0; s < mesh->truth->sensors; s++)
        if (fabs((double)a[s] - (double)b[s]) > JUMPS * length_m)
            return true;
    return false;
}

/* What is left of an edge's error if it is cut at `at`, of points[0..STEPS_OF_EDGE] along it. */
static double left_after(const struct truth *truth, const float *const *points, const double *t, int at)
{
    double worst = 0;
    for (int i = 1; i < STEPS_OF_EDGE; i++) {
        int from = i < at ? 0 : at, to = i < at ? at : STEPS_OF_EDGE;
        double share = (t[i] - t[from]) / (t[to] - t[from]);
        const float *const ends[2] = { points[from], points[to] };
        const float weights[2] = { (float)(1 - share), (float)share };
        if (i != at)
            worst = max_of(worst, error_of(truth, ends, weights, 2, points[i], CUT_CHOICES));
    }
    return worst;
}

/* Where a kink is, an edge is cut there and not in its middle, as the product does it. The share of its length; found by looking at
   fifteen places, and between the best one and its neighbours. */
static double best_cut(struct cut_mesh *mesh, const struct edge *edge, const struct facing *facing)
{
    struct truth *truth = mesh->truth;
    const struct vertex a = mesh->vertices[edge->a], b = mesh->vertices[edge->b];
    float *rooms[STEPS_OF_EDGE + 1], *geodesic_m = mem_array(truth->sensors, sizeof(*geodesic_m));
    const float *points[STEPS_OF_EDGE + 1] = { [0] = a.sample, [STEPS_OF_EDGE] = b.sample };
    double t[STEPS_OF_EDGE + 1], at[3], middle_left, best_left, share = 0.5, step = 1.0 / STEPS_OF_EDGE;
    bool known = true;
    int best = STEPS_OF_EDGE / 2;
    for (int i = 0; i <= STEPS_OF_EDGE; i++) {
        t[i] = (double)i / STEPS_OF_EDGE;
        rooms[i] = mem_array(truth->numbers, sizeof(**rooms));
        vec_mix(a.at, b.at, t[i], at);
        if (i == 0 || i == STEPS_OF_EDGE)
            continue;
        points[i] = rooms[i];
        known = known && evaluate(truth, at, facing, rooms[i], geodesic_m);
    }
    if (known) {
        best_left = middle_left = left_after(truth, points, t, best);
        for (int i = 1; i < STEPS_OF_EDGE; i++) {
            double left = left_after(truth, points, t, i);
            if (left < best_left) {
                best_left = left;
                best = i;
            }
        }
        share = t[best];
        for (int n = 0; n < 3 && best_left > mesh->limit / 4 && best_left < NO_GAIN * middle_left; n++) {
            step /= 2;
            double from = share;
            for (int side = -1; side < 2; side += 2) {
                t[best] = from + side * step;
                vec_mix(a.at, b.at, t[best], at);
                points[best] = rooms[0];
                if (!evaluate(truth, at, facing, rooms[0], geodesic_m))
                    continue;
                double left = left_after(truth, points, t, best);
                if (left < best_left) {
                    best_left = left;
                    share = t[best];
                }
            }
        }
        share = best_left < NO_GAIN * middle_left ? share : 0.5;
    }
    for (int i = 0; i <= STEPS_OF_EDGE; i++)
        mem_free(rooms[i]);
    mem_free(geodesic_m);
    return share;
}

static void cut_edge(struct cut_mesh *mesh, uint32_t e, double share, const struct facing *facing)
{
    double at[3], length_m = length_of(mesh, e);
    mesh->edges[e].cut = true;
    if (share == 0.5 || min_of(share, 1 - share) * length_m < mesh->shortest_m / 2)
        return;
    vec_mix(mesh->vertices[mesh->edges[e].a].at, mesh->vertices[mesh->edges[e].b].at, share, at);
    uint32_t vertex = cut_mesh_add_vertex(mesh, at, facing);
    mesh->edges[e].middle = vertex;
}

/* At its middle, and at quarters of its length. */
static void measure_edge(struct cut_mesh *mesh, uint32_t e, const struct facing *facing, float *room)
{
    struct edge *edge = &mesh->edges[e];
    double at[3], length_m = length_of(mesh, e), linear = 0, quadratic = 0;
    edge->measured = true;
    if (length_m < mesh->shortest_m || !mesh->vertices[edge->a].sample || !mesh->vertices[edge->b].sample)
        return;
    vec_mix(mesh->vertices[edge->a].at, mesh->vertices[edge->b].at, 0.5, at);
    uint32_t middle = cut_mesh_add_vertex(mesh, at, facing);
    edge->middle = middle;
    if (!mesh->vertices[middle].sample)
        return;
    const float *const samples[3] = { mesh->vertices[edge->a].sample, mesh->vertices[edge->b].sample, mesh->vertices[middle].sample };
    linear = error_of(mesh->truth, samples, (const float[2]){ 0.5f, 0.5f }, 2, samples[2], CUT_CHOICES);
    for (int quarter = 1; quarter < 4; quarter += 2) {
        const float t = (float)quarter / 4, straight[2] = { 1 - t, t };
        const float curved[3] = { (1 - t) * (1 - 2 * t), t * (2 * t - 1), 4 * t * (1 - t) };
        vec_mix(mesh->vertices[edge->a].at, mesh->vertices[edge->b].at, (double)t, at);
        if (!evaluate(mesh->truth, at, facing, room, room + mesh->truth->numbers))
            continue;
        linear = max_of(linear, error_of(mesh->truth, samples, straight, 2, room, CUT_CHOICES));
        quadratic = max_of(quadratic, error_of(mesh->truth, samples, curved, 3, room, CUT_CHOICES));
    }
    edge->linear = linear;
    edge->quadratic = mesh->quadratic ? quadratic : linear;
    edge->barred = edge->quadratic > mesh->limit && length_m < mesh->jump_m && jumps(mesh, edge, length_m);
}

/* Weights of a triangle's six values, of which the middles of straight edges are the means of their ends. Returns how many there are. */
static size_t shape(const struct cut_mesh *mesh, const struct tri *tri, const double w[3], const float *samples[6], float weights[6])
{
    size_t count = 3;
    double corner[3];
    for (int i = 0; i < 3; i++) {
        corner[i] = w[i] * (2 * w[i] - 1);
        samples[i] = mesh->vertices[tri->v[i]].sample;
    }
    for (int i = 0; i < 3; i++) {
        const struct edge *edge = &mesh->edges[tri->e[i]];
        double along = 4 * w[i] * w[(i + 1) % 3];
        if (edge->curved && mesh->vertices[edge->middle].sample) {
            samples[count] = mesh->vertices[edge->middle].sample;
            weights[count++] = (float)along;
        } else {
            corner[i] += along / 2;
            corner[(i + 1) % 3] += along / 2;
        }
    }
    for (int i = 0; i < 3; i++)
        weights[i] = (float)corner[i];
    return count;
}

/* CUT_CHOICES: of all. Less than 0: nothing is known there. */
double cut_mesh_error(struct cut_mesh *mesh, const struct tri *tri, const double w[3], float *room, int combo, bool evaluated)
{
    const float *samples[6];
    float weights[6];
    double at[3] = { 0 };
    for (int i = 0; i < 3; i++)
        if (!mesh->vertices[tri->v[i]].sample)
            return -1;
    const struct facing facing = cut_mesh_facing(mesh, tri);
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < 3; i++)
            at[axis] += w[i] * mesh->vertices[tri->v[i]].at[axis];
    if (!evaluated && !evaluate(mesh->truth, at, &facing, room, room + mesh->truth->numbers))
        return -1;
    size_t count = shape(mesh, tri, w, samples, weights);
    return error_of(mesh->truth, samples, weights, count, room, combo);
}

static void bend(struct cut_mesh *mesh, const struct tri *tri, bool on)
{
    for (int i = 0; i < 3; i++) {
        struct edge *edge = &mesh->edges[tri->e[i]];
        edge->curved = edge->curved || (on && edge->middle != NO_VERTEX && mesh->vertices[edge->middle].sample);
    }
}

/* In the middle, and, what is curved, towards each corner too. */
static bool errs_inside(struct cut_mesh *mesh, const struct tri *tri, float *room)
{
    static const double places[4][3] = { { 1 / 3.0, 1 / 3.0, 1 / 3.0 }, { 0.6, 0.2, 0.2 }, { 0.2, 0.6, 0.2 }, { 0.2, 0.2, 0.6 } };
    bool curved = mesh->edges[tri->e[0]].curved || mesh->edges[tri->e[1]].curved || mesh->edges[tri->e[2]].curved, errs = false;
    for (int i = 0; i < (curved ? 4 : 1) && !errs; i++)
        errs = cut_mesh_error(mesh, tri, places[i], room, CUT_CHOICES, false) > mesh->limit;
    return errs;
}

static void measure_inside(struct cut_mesh *mesh, struct tri *tri, float *room)
{
    int longest = 0;
    for (int i = 1; i < 3; i++)
        if (length_of(mesh, tri->e[i]) > length_of(mesh, tri->e[longest]))
            longest = i;
    struct edge *edge = &mesh->edges[tri->e[longest]];
    double length_m = length_of(mesh, tri->e[longest]);
    if (length_m < mesh->shortest_m || edge->middle == NO_VERTEX || !errs_inside(mesh, tri, room))
        return;
    if (mesh->quadratic) {
        bend(mesh, tri, true);
        if (!errs_inside(mesh, tri, room))
            return;
    }
    if (length_m < mesh->jump_m && jumps(mesh, edge, length_m))
        return;
    const struct facing facing = cut_mesh_facing(mesh, tri);
    cut_edge(mesh, tri->e[longest], edge->aim > 0 ? edge->aim : 0.5, &facing);
}

/* --- cutting -------------------------------------------------------------------------------------------------------------------- */

/* Into two, three or four. */
static void cut_tri(struct cut_mesh *mesh, size_t t)
{
    const struct tri tri = mesh->tris[t];
    uint32_t m[3];
    int cuts = 0, first = 0;
    for (int i = 0; i < 3; i++) {
        const struct edge *edge = &mesh->edges[tri.e[i]];
        m[i] = edge->cut ? edge->middle : NO_VERTEX;
        cuts += edge->cut;
    }
    if (cuts == 0)
        return;
    mesh->tris[t].gone = true;
    mesh->live--;
    for (int i = 0; i < 3; i++) /* one: the edge that is cut; two: the one after the edge that is not */
        if ((cuts == 1 && m[i] != NO_VERTEX) || (cuts == 2 && m[(i + 2) % 3] == NO_VERTEX))
            first = i;
    uint32_t a = tri.v[first], b = tri.v[(first + 1) % 3], c = tri.v[(first + 2) % 3], ab = m[first], bc = m[(first + 1) % 3],
             ca = m[(first + 2) % 3];
    if (cuts == 1) {
        cut_mesh_add_tri(mesh, a, ab, c, tri.origin);
        cut_mesh_add_tri(mesh, ab, b, c, tri.origin);
        return;
    }
    cut_mesh_add_tri(mesh, ab, b, bc, tri.origin);
    if (cuts == 2) {
        bool from_a = vec_distance(mesh->vertices[a].at, mesh->vertices[bc].at) < vec_distance(mesh->vertices[ab].at, mesh->vertices[c].at);
        cut_mesh_add_tri(mesh, a, ab, from_a ? bc : c, tri.origin);
        cut_mesh_add_tri(mesh, from_a ? a : ab, bc, c, tri.origin);
        return;
    }
    cut_mesh_add_tri(mesh, a, ab, ca, tri.origin);
    cut_mesh_add_tri(mesh, ca, bc, c, tri.origin);
    cut_mesh_add_tri(mesh, ab, bc, ca, tri.origin);
}

bool cut_mesh_round(struct cut_mesh *mesh, float *room)
{
    size_t before = mesh->tri_count;
    for (size_t t = 0; t < before; t++) {
        struct tri *tri = &mesh->tris[t];
        if (tri->gone)
            continue;
        const struct facing facing = cut_mesh_facing(mesh, tri);
        aim(mesh, tri);
        for (int i = 0; i < 3; i++) {
            struct edge *edge = &mesh->edges[tri->e[i]];
            if (!edge->measured)
                measure_edge(mesh, tri->e[i], &facing, room);
            edge = &mesh->edges[tri->e[i]];
            edge->curved = edge->curved || (mesh->quadratic && edge->linear > mesh->stage);
            if (!edge->cut && !edge->barred && edge->linear > mesh->stage && edge->quadratic > mesh->stage)
                cut_edge(mesh, tri->e[i], edge->aim > 0 ? edge->aim : best_cut(mesh, edge, &facing), &facing);
        }
    }
    for (size_t t = 0; t < before && mesh->stage < 1.01 * mesh->limit; t++) {
        struct tri *tri = &mesh->tris[t];
        if (tri->gone || tri->done)
            continue;
        tri->done = true;
        if (!mesh->edges[tri->e[0]].cut && !mesh->edges[tri->e[1]].cut && !mesh->edges[tri->e[2]].cut)
            measure_inside(mesh, tri, room);
    }
    for (size_t t = 0; t < before; t++) {
        struct tri *tri = &mesh->tris[t];
        bool any = mesh->edges[tri->e[0]].cut || mesh->edges[tri->e[1]].cut || mesh->edges[tri->e[2]].cut;
        int beside = !tri->gone && any ? aim(mesh, tri) : -1;
        if (beside < 0 || mesh->edges[tri->e[beside]].cut || mesh->edges[tri->e[beside]].middle == NO_VERTEX)
            continue;
        const struct facing facing = cut_mesh_facing(mesh, tri);
        cut_edge(mesh, tri->e[beside], mesh->edges[tri->e[beside]].aim, &facing);
    }
    for (size_t t = 0; t < before; t++)
        if (!mesh->tris[t].gone)
            cut_tri(mesh, t);
    return mesh->tri_count > before;
}

void cut_mesh_finish(struct cut_mesh *mesh)
{
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        mem_free(mesh->vertices[v].sample);
        mem_free(mesh->vertices[v].geodesic_m);
    }
    mem_free(mesh->vertices);
    mem_free(mesh->edges);
    mem_free(mesh->tris);
    edge_table_finish(&mesh->table);
}
