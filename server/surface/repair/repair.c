/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mesh repair: closes seams, which are gaps between border edges (edges with one face). This includes edges that became borders
   because triangles next to them were hidden. */
#include "surface/repair/repair.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/math/vec.h"
#include "surface/repair/mesh_edit.h"
#include "surface/repair/borders.h"
#include "surface/mesh/bvh.h"
#include "surface/mesh/point_cloud.h"
#include "surface/repair/repair_impl.h"

/* two points are merged only if they are at most this fraction of the shortest edge at either point apart, so that no feature
   of the model collapses */
#define GAP_OF_EDGE 0.45
#define EXACT_OF_TOLERANCE 0.01
/* A border counts as straight if it deviates from a line by at most this, in units of the tolerance. Welding may cause such
   deviations; distinct points of a border are farther apart */
#define STRAIGHT 0.1
/* minimum cosine between the directions of two faces that count as lying on each other, and of two edges that count as running
   alongside each other */
#define FLUSH 0.99

/* --- seams (gaps between border edges): rounds that merge points alternate with rounds that insert points into edges --- */

struct seams {
    const struct trimesh *mesh;
    const struct borders *borders;
    struct mesh_edit *edit;
    /* tolerance_m: widest gap that is closed. end_m: minimum distance of an inserted point from both ends of its edge (a nearer
       point is merged with that end in another round) */
    double tolerance_m, end_m;
    bool fits;            /* true: the current round joins only borders with nearly no gap between them */
    struct nearest_edge { /* by border point: the nearest position on another border edge, excluding the edges that end at the point */
        double distance_m, t;
        uint32_t edge;
    } * nearest;
};

static void outwards(const struct seams *s, uint32_t e, uint32_t p, double along[3])
{
    const uint32_t *edge = s->borders->edges[e];
    vec_sub(s->mesh->points[edge[edge[0] == p]], s->mesh->points[p], along);
}

/* Returns whether two border edges in the same direction have their faces on the same side and nearly in one plane, so that one
   face lies on the other. */
static bool lie_on_each_other(const struct seams *s, uint32_t e, uint32_t f)
{
    const uint32_t edges[2] = { e, f };
    double side[2][3];
    for (int i = 0; i < 2; i++) {
        const uint32_t *edge = s->borders->edges[edges[i]], *v = s->mesh->tris[s->borders->edge_tri[edges[i]]];
        uint32_t apex = v[0] ^ v[1] ^ v[2] ^ edge[0] ^ edge[1];
        double along[3];
        outwards(s, edges[i], edge[0], along);
        vec_sub(s->mesh->points[apex], s->mesh->points[edge[0]], side[i]);
        double share = vec_dot(side[i], along) / vec_dot(along, along);
        for (int axis = 0; axis < 3; axis++)
            side[i][axis] -= share * along[axis];
    }
    return vec_dot(side[0], side[1]) > FLUSH * sqrt(vec_dot(side[0], side[0]) * vec_dot(side[1], side[1]));
}

/* Returns whether merging border points i and j would join two border edges whose faces lie on each other. Such faces belong to
   two bodies that touch. Once joined, the two edges would no longer be borders, so that the gap between the two bodies and the
   rest of the surface could not be closed. */
static bool would_fold(const struct seams *s, size_t i, size_t j)
{
    const struct borders *b = s->borders;
    for (uint32_t n = b->first[i]; n < b->first[i + 1]; n++)
        for (uint32_t m = b->first[j]; m < b->first[j + 1]; m++) {
            double one[3], other[3];
            outwards(s, b->at[n], b->points[i], one);
            outwards(s, b->at[m], b->points[j], other);
            if (vec_dot(one, other) > FLUSH * sqrt(vec_dot(one, one) * vec_dot(other, other)) && lie_on_each_other(s, b->at[n], b->at[m]))
                return true;
        }
    return false;
}

static double limit_of(const struct seams *s, size_t i, size_t j)
{
    const double *reach_m = s->borders->reach_m;
    return reach_m ? min_of(reach_m[i], reach_m[j]) : s->tolerance_m;
}

static void join_near(void *arg, size_t i, size_t j, double distance_m)
{
    struct seams *s = arg;
    const struct borders *b = s->borders;
    if (i < j && distance_m <= limit_of(s, i, j) && distance_m < GAP_OF_EDGE * min_of(b->shortest_m[i], b->shortest_m[j]) &&
        !(s->fits && would_fold(s, i, j)))
        mesh_edit_merge_points(s->edit, b->points[i], b->points[j], distance_m);
}

/* Returns the other end point of a border edge that ends at point p. n: index of the element of borders->at that has the edge's
   index. */
static uint32_t beyond(const struct seams *s, uint32_t n, uint32_t p)
{
    const uint32_t *edge = s->borders->edges[s->borders->at[n]];
    return edge[edge[0] == p];
}

/* Returns whether a border edge from point p runs along edge e: whether the other end of such an edge is within within_m of the
   line through e. A single point may be near e by chance in a model with many cracks, so this test of a second point is needed.
   towards: that border edge must run in this direction; NULL: in any direction. */
static bool runs_along(const struct seams *s, uint32_t p, uint32_t e, const double towards[3], double within_m)
{
    const struct borders *b = s->borders;
    const double *a = s->mesh->points[b->edges[e][0]];
    double along[3];
    outwards(s, e, b->edges[e][0], along);
    for (uint32_t n = b->first[b->slot[p]]; n < b->first[b->slot[p] + 1]; n++) {
        double from[3], across[3], next[3];
        vec_sub(s->mesh->points[beyond(s, n, p)], a, from);
        vec_cross(from, along, across);
        outwards(s, b->at[n], p, next);
        if (vec_dot(across, across) <= within_m * within_m * vec_dot(along, along) && (!towards || vec_dot(next, towards) > 0))
            return true;
    }
    return false;
}

/* Returns whether the border runs along edge e on both sides of point p. The border of a gap is rarely straight at a point, so
   such a point is a hanging vertex of e (a vertex that lies inside an edge, not at its end). */
static bool hangs(const struct seams *s, uint32_t p, uint32_t e)
{
    double forth[3], back[3], within_m = STRAIGHT * s->tolerance_m;
    outwards(s, e, s->borders->edges[e][0], forth);
    outwards(s, e, s->borders->edges[e][1], back);
    return s->fits && runs_along(s, p, e, forth, within_m) && runs_along(s, p, e, back, within_m);
}

static bool have_an_edge(const struct seams *s, uint32_t p, uint32_t q)
{
    const struct borders *b = s->borders;
    for (uint32_t n = b->first[b->slot[p]]; n < b->first[b->slot[p] + 1]; n++)
        if (beyond(s, n, p) == q)
            return true;
    return false;
}

/* Returns whether point p, at distance_m from an end of edge e, is treated as that end of the edge. If both are hanging
   vertices of e (vertices that lie inside an edge, not at its end), they stay separate points, however near each other. */
static bool is_at_end(const struct seams *s, uint32_t p, uint32_t e, uint32_t end, double distance_m, double length_m)
{
    if (distance_m > max_of(REPAIR_AT_END * length_m, s->end_m))
        return false;
    bool apart = s->fits && distance_m > STRAIGHT * s->tolerance_m;
    return !(apart && (have_an_edge(s, p, end) || (hangs(s, p, e) && hangs(s, end, e))));
}

/* Tries to insert border point i into edge e. A hanging vertex (a vertex that lies inside an edge, not at its end) is inserted
   immediately, and so into every edge along which its border runs: with an insertion only into the nearest edge, the other
   edges would stay open. For any other point, remembers e if it is the nearest edge so far. */
static void try_edge(struct seams *s, size_t i, uint32_t e)
{
    const struct borders *b = s->borders;
    uint32_t p = b->points[i], u = b->edges[e][0], v = b->edges[e][1];
    if (trimesh_has(s->mesh, b->edge_tri[e], p))
        return;
    const double *a = s->mesh->points[u], *c = s->mesh->points[v], *q = s->mesh->points[p];
    double ac[3], aq[3], at[3], length2;
    vec_sub(c, a, ac);
    vec_sub(q, a, aq);
    length2 = vec_dot(ac, ac);
    double length_m = sqrt(length2), t = length2 > 0 ? vec_dot(aq, ac) / length2 : 0;
    if (t <= 0 || t >= 1 || is_at_end(s, p, e, u, t * length_m, length_m) || is_at_end(s, p, e, v, (1 - t) * length_m, length_m))
        return;
    vec_mix(a, c, t, at);
    double distance_m = vec_distance(at, q);
    if (distance_m > limit_of(s, i, b->slot[u]) || (s->fits && !runs_along(s, p, e, NULL, s->tolerance_m)))
        return;
    if (hangs(s, p, e))
        mesh_edit_insert_in_edge(s->edit, p, u, v, t, distance_m);
    else if (distance_m < s->nearest[i].distance_m)
        s->nearest[i] = (struct nearest_edge){ .distance_m = distance_m, .t = t, .edge = e };
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
        uint32_t corner = search->seams->mesh->tris[tri][i], s = b->slot[corner];
        for (uint32_t n = s == TRIMESH_NONE ? 0 : b->first[s]; s != TRIMESH_NONE && n < b->first[s + 1]; n++)
            if (b->edge_tri[b->at[n]] == tri && b->edges[b->at[n]][0] == corner)
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
        const struct nearest_edge *n = &s->nearest[i];
        if (n->distance_m < INFINITY)
            mesh_edit_insert_in_edge(s->edit, b->points[i], b->edges[n->edge][0], b->edges[n->edge][1], n->t, n->distance_m);
    }
    bvh_destroy(&bvh);
    mem_free(s->nearest);
}

/* One round of closing seams: merges border points within tolerance_m of each other or, if into_edges is true, inserts border points into
   border edges. */
static void seam_round(struct trimesh *mesh, struct seams seams, bool into_edges, uint32_t *target, size_t target_count,
                       struct repair_report *report)
{
    const struct borders *borders = seams.borders;
    struct mesh_edit edit;
    seams.mesh = mesh;
    seams.edit = &edit;
    mesh_edit_init(&edit);
    if (into_edges) {
        set_into_edges(&seams);
    } else {
        double(*cloud)[3] = mem_array(borders->point_count, sizeof(*cloud));
        for (size_t i = 0; i < borders->point_count; i++)
            memcpy(cloud[i], mesh->points[borders->points[i]], sizeof(*cloud));
        int k = point_cloud_neighbours((const double(*)[3])cloud, borders->point_count, seams.tolerance_m, join_near, &seams);
        report->k = k < 0 || report->k < 0 ? -1 : k > report->k ? k : report->k;
        mem_free(cloud);
    }
    repair_apply(&edit, mesh, target, target_count, 0, report);
}

void repair_seams(struct trimesh *mesh, double tolerance_m, uint32_t *target, struct repair_report *report)
{
    const double tolerances_m[2] = { EXACT_OF_TOLERANCE * tolerance_m, tolerance_m };
    size_t target_count = mesh->point_count;
    for (uint32_t i = 0; i < target_count; i++)
        target[i] = i;
    /* Rounds 0 and 1 close only gaps of at most a hundredth of the tolerance; rounds 2 and 3 close wider gaps. Edges closed in
       rounds 0 and 1 are then no longer borders, so that rounds 2 and 3 cannot pull them to a wrong neighbour. Round 1 does not
       insert a point that is near an edge by chance: that would split the edge into pieces too short to be closed. */
    for (int round = 0; round < 4; round++) {
        struct borders borders;
        borders_init(&borders, mesh);
        if (round == 1)
            repair_hanging(mesh, &borders, tolerances_m[0], target, target_count, report);
        const struct seams seams = {
            .borders = &borders, .tolerance_m = tolerances_m[round / 2], .end_m = round == 1 ? tolerance_m : 0, .fits = round < 2
        };
        seam_round(mesh, seams, round % 2 == 1, target, target_count, report);
        borders_finish(&borders);
    }
}

void repair_join_points(struct trimesh *mesh, double tolerance_m, uint32_t *target, struct repair_report *report)
{
    struct borders borders;
    size_t target_count = mesh->point_count;
    for (uint32_t i = 0; i < target_count; i++)
        target[i] = i;
    borders_init(&borders, mesh);
    const struct seams seams = { .borders = &borders, .tolerance_m = tolerance_m, .fits = true };
    seam_round(mesh, seams, false, target, target_count, report);
    borders_finish(&borders);
}

/* --- rims ------------------------------------------------------------------------------------------------------------------- */

/* Copies the triangles whose element of `hidden` equals `which` to the mesh `to`. */
static void copy_triangles(struct trimesh *to, const struct trimesh *from, const char *hidden, char which)
{
    *to = (struct trimesh){ .points = from->points, .point_count = from->point_count };
    for (size_t t = 0; t < from->tri_count; t++)
        if (hidden[t] == which)
            trimesh_add_tri(to, from->tris[t][0], from->tris[t][1], from->tris[t][2], from->tri_source[t]);
}

size_t repair_rims(struct trimesh *mesh, const char *hidden, const struct body_parts *parts, uint32_t *target, struct repair_report *report)
{
    struct trimesh seen, rest;
    double widest_m = 0;
    for (uint32_t i = 0; i < mesh->point_count; i++)
        target[i] = i;
    for (size_t p = 0; p < parts->count; p++)
        widest_m = max_of(widest_m, parts->reach_m[p]);
    copy_triangles(&seen, mesh, hidden, 0);
    copy_triangles(&rest, mesh, hidden, 1);
    for (int round = 0; round < 2 && rest.tri_count; round++) {
        struct borders borders;
        size_t degenerate = 0, repeated = 0;
        uint32_t *then = mem_array(mesh->point_count, sizeof(*then));
        for (uint32_t i = 0; i < mesh->point_count; i++)
            then[i] = i;
        borders_init_rims(&borders, &seen, &rest, parts);
        const struct seams seams = { .borders = &borders, .tolerance_m = widest_m };
        seam_round(&seen, seams, round == 1, then, mesh->point_count, report);
        borders_finish(&borders);
        trimesh_rename(&rest, then, &degenerate, &repeated);
        for (uint32_t i = 0; i < mesh->point_count; i++)
            target[i] = then[target[i]];
        mem_free(then);
    }
    size_t seen_count = seen.tri_count;
    for (size_t t = 0; t < rest.tri_count; t++)
        trimesh_add_tri(&seen, rest.tris[t][0], rest.tris[t][1], rest.tris[t][2], rest.tri_source[t]);
    rest.points = mesh->points = NULL;
    trimesh_finish(&rest);
    seen.point_capacity = mesh->point_capacity;
    trimesh_finish(mesh);
    *mesh = seen;
    return seen_count;
}
