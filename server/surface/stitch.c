/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bridging what is broken: seams along open edges. */
#include "surface/stitch.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "surface/attach.h"
#include "surface/bvh.h"
#include "surface/cloud.h"
#include "surface/stitch_impl.h"
#include "surface/vec.h"

#define GAP_OF_EDGE 0.45 /* two points become one only if they are nearer than this share of the shortest edge at either */
#define EXACT_OF_TOLERANCE 0.01

/* --- open edges ------------------------------------------------------------------------------------------------------------ */

struct borders {
    uint32_t (*edges)[2], *edge_tri; /* open edges and their one triangle */
    size_t edge_count;
    uint32_t *points; /* points on them */
    size_t point_count;
    uint32_t *slot;       /* point -> place in points, or TRIMESH_NONE */
    double *shortest_m;   /* of each point in points: the shortest edge of any triangle at it */
    uint32_t *first, *at; /* open edges at each point in points */
};

static void borders_finish(struct borders *b)
{
    mem_free(b->edges);
    mem_free(b->edge_tri);
    mem_free(b->points);
    mem_free(b->slot);
    mem_free(b->shortest_m);
    mem_free(b->first);
    mem_free(b->at);
}

static void find_open_edges(struct borders *b, const struct trimesh *mesh)
{
    struct edge_table edges;
    edge_table_init(&edges, mesh->tri_count * 3 / 2);
    unsigned char *faces = mem_array(mesh->tri_count * 3, 1);
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t e = edge_table_add(&edges, mesh->tris[t][i], mesh->tris[t][(i + 1) % 3]);
            faces[e] = (unsigned char)(faces[e] < 2 ? faces[e] + 1 : 2);
        }
    for (size_t e = 0; e < edges.count; e++)
        b->edge_count += faces[e] == 1;
    b->edges = mem_array(b->edge_count, sizeof(*b->edges));
    b->edge_tri = mem_array(b->edge_count, sizeof(*b->edge_tri));
    size_t n = 0;
    for (uint32_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t p = mesh->tris[t][i], q = mesh->tris[t][(i + 1) % 3];
            if (faces[edge_table_find(&edges, p, q)] != 1)
                continue;
            b->edges[n][0] = p;
            b->edges[n][1] = q;
            b->edge_tri[n++] = t;
        }
    mem_free(faces);
    edge_table_finish(&edges);
}

static void find_border_points(struct borders *b, const struct trimesh *mesh)
{
    b->slot = mem_array(mesh->point_count, sizeof(*b->slot));
    b->points = mem_array(2 * b->edge_count, sizeof(*b->points));
    memset(b->slot, 0xff, mesh->point_count * sizeof(*b->slot));
    for (size_t e = 0; e < b->edge_count; e++)
        for (int i = 0; i < 2; i++) {
            uint32_t p = b->edges[e][i];
            if (b->slot[p] == TRIMESH_NONE) {
                b->slot[p] = (uint32_t)b->point_count;
                b->points[b->point_count++] = p;
            }
        }
    b->shortest_m = mem_array(b->point_count, sizeof(*b->shortest_m));
    for (size_t i = 0; i < b->point_count; i++)
        b->shortest_m[i] = INFINITY;
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                uint32_t s = b->slot[mesh->tris[t][i]];
                if (i != j && s != TRIMESH_NONE)
                    b->shortest_m[s] =
                        min_of(b->shortest_m[s], vec_distance(mesh->points[mesh->tris[t][i]], mesh->points[mesh->tris[t][j]]));
            }
}

static void find_edges_at(struct borders *b)
{
    b->first = mem_array(b->point_count + 2, sizeof(*b->first));
    b->at = mem_array(2 * b->edge_count, sizeof(*b->at));
    for (size_t e = 0; e < b->edge_count; e++)
        for (int i = 0; i < 2; i++)
            b->first[b->slot[b->edges[e][i]] + 2]++;
    for (size_t i = 2; i < b->point_count + 2; i++)
        b->first[i] += b->first[i - 1];
    for (uint32_t e = 0; e < b->edge_count; e++)
        for (int i = 0; i < 2; i++)
            b->at[b->first[b->slot[b->edges[e][i]] + 1]++] = e;
}

static void borders_init(struct borders *b, const struct trimesh *mesh)
{
    *b = (struct borders){ 0 };
    find_open_edges(b, mesh);
    find_border_points(b, mesh);
    find_edges_at(b);
}

/* --- seams: one round joins points, the next sets points into edges ---------------------------------------------------------- */

struct seams {
    const struct trimesh *mesh;
    const struct borders *borders;
    struct attach *attach;
    double tolerance_m, end_m; /* places nearer to the end of an edge than end_m are left to the joining of points */
    bool runs_along; /* only where a border runs along the edge: with cracks everywhere, a point lies just on one that it is not of */
    struct nearest { /* of each border point: the best place found on an open edge that is not its own */
        double distance_m, t;
        uint32_t edge;
    } * nearest;
};

static void join_near(void *arg, size_t i, size_t j, double distance_m)
{
    struct seams *s = arg;
    const struct borders *b = s->borders;
    if (i < j && distance_m < GAP_OF_EDGE * min_of(b->shortest_m[i], b->shortest_m[j]))
        attach_points(s->attach, b->points[i], b->points[j], distance_m);
}

/* Whether the border at a point runs along the edge: its next point is on the edge's line as well. */
static bool runs_along(const struct seams *s, size_t i, const double a[3], const double along[3])
{
    const struct borders *b = s->borders;
    for (uint32_t n = b->first[i]; n < b->first[i + 1]; n++) {
        const uint32_t *edge = b->edges[b->at[n]];
        double from[3], across[3];
        vec_sub(s->mesh->points[edge[edge[0] == b->points[i]]], a, from);
        vec_cross(from, along, across);
        if (vec_dot(across, across) <= s->tolerance_m * s->tolerance_m * vec_dot(along, along))
            return true;
    }
    return false;
}

static void try_edge(struct seams *s, size_t i, uint32_t e)
{
    const struct borders *b = s->borders;
    uint32_t p = b->points[i], u = b->edges[e][0], v = b->edges[e][1];
    if (stitch_tri_has(s->mesh, b->edge_tri[e], p))
        return;
    const double *a = s->mesh->points[u], *c = s->mesh->points[v], *q = s->mesh->points[p];
    double ac[3], aq[3], at[3], length2;
    vec_sub(c, a, ac);
    vec_sub(q, a, aq);
    length2 = vec_dot(ac, ac);
    double t = length2 > 0 ? vec_dot(aq, ac) / length2 : 0;
    double end = max_of(STITCH_AT_END, length2 > 0 ? s->end_m / sqrt(length2) : 1);
    if (t <= end || t >= 1 - end)
        return;
    vec_mix(a, c, t, at);
    double distance_m = vec_distance(at, q);
    if (distance_m <= s->tolerance_m && distance_m < s->nearest[i].distance_m && (!s->runs_along || runs_along(s, i, a, ac)))
        s->nearest[i] = (struct nearest){ .distance_m = distance_m, .t = t, .edge = e };
}

struct edge_search {
    struct seams *seams;
    size_t point;
};

static void visit_border_tri(void *arg, uint32_t tri)
{
    struct edge_search *search = arg;
    const struct borders *b = search->seams->borders;
    for (int i = 0; i < 3; i++) {
        uint32_t s = b->slot[search->seams->mesh->tris[tri][i]];
        for (uint32_t n = s == TRIMESH_NONE ? 0 : b->first[s]; s != TRIMESH_NONE && n < b->first[s + 1]; n++)
            if (b->edge_tri[b->at[n]] == tri)
                try_edge(search->seams, search->point, b->at[n]);
    }
}

static void set_into_edges(struct seams *s)
{
    const struct borders *b = s->borders;
    struct bvh *bvh = bvh_create(s->mesh);
    s->nearest = mem_array(b->point_count, sizeof(*s->nearest));
    for (size_t i = 0; i < b->point_count; i++) {
        struct edge_search search = { .seams = s, .point = i };
        const double *p = s->mesh->points[b->points[i]];
        s->nearest[i].distance_m = INFINITY;
        bvh_overlaps(bvh, p, p, s->tolerance_m, visit_border_tri, &search);
        const struct nearest *n = &s->nearest[i];
        if (n->distance_m < INFINITY)
            attach_to_edge(s->attach, b->points[i], b->edges[n->edge][0], b->edges[n->edge][1], n->t, n->distance_m);
    }
    bvh_destroy(&bvh);
    mem_free(s->nearest);
}

/* Joins points on open edges, or sets them into open edges, where they are within tolerance_m. */
static void seam_round(struct trimesh *mesh, double tolerance_m, double end_m, bool into_edges, uint32_t *target, size_t target_count,
                       struct stitch_report *report)
{
    struct borders borders;
    struct attach attach;
    struct seams seams = {
        .mesh = mesh, .borders = &borders, .attach = &attach, .tolerance_m = tolerance_m, .end_m = end_m, .runs_along = end_m > 0
    };
    borders_init(&borders, mesh);
    attach_init(&attach);
    if (into_edges) {
        set_into_edges(&seams);
    } else {
        double(*cloud)[3] = mem_array(borders.point_count, sizeof(*cloud));
        for (size_t i = 0; i < borders.point_count; i++)
            memcpy(cloud[i], mesh->points[borders.points[i]], sizeof(*cloud));
        int k = cloud_near((const double(*)[3])cloud, borders.point_count, tolerance_m, join_near, &seams);
        report->k = k < 0 || report->k < 0 ? -1 : k > report->k ? k : report->k;
        mem_free(cloud);
    }
    borders_finish(&borders);
    stitch_carry_out(&attach, mesh, target, target_count, 0, report);
}

void stitch_seams(struct trimesh *mesh, double tolerance_m, uint32_t *target, struct stitch_report *report)
{
    const double tolerances_m[2] = { EXACT_OF_TOLERANCE * tolerance_m, tolerance_m };
    size_t target_count = mesh->point_count;
    for (uint32_t i = 0; i < target_count; i++)
        target[i] = i;
    /* What fits exactly first: it is no border any more when gaps are closed, and is not drawn to a neighbour. A point that lies on an edge
       by chance does not fit: pieces of that edge too short to be closed would keep its own gap open. */
    for (int i = 0; i < 2; i++) {
        seam_round(mesh, tolerances_m[i], 0, false, target, target_count, report);
        seam_round(mesh, tolerances_m[i], i == 0 ? tolerance_m : 0, true, target, target_count, report);
    }
}
