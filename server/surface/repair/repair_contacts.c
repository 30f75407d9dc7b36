/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mesh repair: joins parts of the mesh that touch or cross each other (repair_contacts()). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/math/vec.h"
#include "surface/repair/mesh_edit.h"
#include "surface/mesh/bvh.h"
#include "surface/repair/crossing_faces.h"
#include "surface/repair/line_of_sight.h"
#include "surface/repair/repair.h"
#include "surface/repair/repair_impl.h"

#define PARALLEL 1e-4 /* maximum squared sine of the angle between two edges for them to count as parallel */

struct contacts {
    struct trimesh *mesh;
    struct body_parts *parts;
    const uint32_t *part, *body; /* by triangle of `mesh`: its part and its body */
    const struct bvh *bvh;
    struct mesh_edit *edit;
    /* while edges are tested for crossings: the part of the current edge; while points are tested for contact: the body of the current
       point */
    uint32_t own;
    double reach_m; /* reach (distance up to which a part counts as touching) of the part whose point or rim is being tested */
    uint32_t edge[2];
    uint32_t *touched; /* by point: the body that it touches, or TRIMESH_NONE */
    struct contact_crossing {
        uint32_t tri, a, b, c, d; /* the edge a-b passes through triangle tri or, if tri is TRIMESH_NONE, crosses the edge c-d */
        uint32_t point;           /* the inserted point */
        double t, s, weights[3];
        bool own; /* true: edge a-b and triangle tri belong to the same part, which therefore crosses itself */
    } * crossings;
    size_t crossing_count, crossing_capacity;
};

static struct contact_crossing *add_crossing(struct contacts *c)
{
    mem_grow(&c->crossings, &c->crossing_capacity, c->crossing_count + 1, sizeof(*c->crossings));
    return &c->crossings[c->crossing_count++];
}

static double reach_of(const struct contacts *c, uint32_t tri)
{
    return c->parts->reach_m[c->part[tri]];
}

/* Returns whether both ends of the edge being tested (c->edge) are far enough from the plane of the triangle with the points v. Otherwise
 * the edge's face and the triangle, which belong to one part, may lie on each other without crossing. */
static bool stands_clear(const struct contacts *c, const uint32_t *v)
{
    double n[3], up[3];
    vec_normal(c->mesh->points[v[0]], c->mesh->points[v[1]], c->mesh->points[v[2]], n);
    for (int i = 0; i < 2; i++) {
        vec_sub(c->mesh->points[c->edge[i]], c->mesh->points[v[0]], up);
        if (fabs(vec_dot(up, n)) < CROSSING_CLEAR * c->parts->reach_m[c->own] * vec_length(n))
            return false;
    }
    return true;
}

static void visit_crossed(void *arg, uint32_t tri)
{
    struct contacts *c = arg;
    const uint32_t *v = c->mesh->tris[tri];
    double t, w[3];
    bool own = c->part[tri] == c->own;
    if (own && (trimesh_has(c->mesh, tri, c->edge[0]) || trimesh_has(c->mesh, tri, c->edge[1])))
        return;
    const double *p = c->mesh->points[c->edge[0]], *q = c->mesh->points[c->edge[1]];
    if (!triangle_crossed(p, q, c->mesh->points[v[0]], c->mesh->points[v[1]], c->mesh->points[v[2]], &t, w))
        return;
    double length = vec_distance(p, q), reach_m = min_of(c->parts->reach_m[c->own], reach_of(c, tri));
    if (t * length < reach_m || (1 - t) * length < reach_m || (own && !stands_clear(c, v)))
        return; /* not a crossing, because only an end of the edge touches the triangle; find_touches() handles such contacts */
    struct contact_crossing *found = add_crossing(c);
    *found = (struct contact_crossing){ .tri = tri, .a = c->edge[0], .b = c->edge[1], .t = t, .own = own };
    memcpy(found->weights, w, sizeof(w));
    if (own)
        c->parts->crossed[c->own] = c->parts->tangled[c->own] = 1;
}

/* Inserts a point into a triangle, at the barycentric weights w. If the position is on a side, inserts the point into that side; if it is
   at a corner, merges the point with the corner. */
static void set_into_face(const struct contacts *c, uint32_t point, uint32_t tri, const double w[3], double distance_m)
{
    const uint32_t *v = c->mesh->tris[tri];
    for (int i = 0; i < 3; i++)
        if (w[i] > 1 - REPAIR_AT_END) {
            mesh_edit_merge_points(c->edit, point, v[i], distance_m);
            return;
        }
    for (int i = 0; i < 3; i++)
        if (w[i] < REPAIR_AT_END) {
            uint32_t a = v[(i + 1) % 3], b = v[(i + 2) % 3];
            mesh_edit_insert_in_edge(c->edit, point, a, b, w[(i + 2) % 3] / (w[(i + 1) % 3] + w[(i + 2) % 3]), distance_m);
            return;
        }
    mesh_edit_insert_in_tri(c->edit, point, tri, distance_m);
}

/* Calls `visit` for each triangle near the edge being tested (c->edge): each whose bounding box is within margin_m of the edge's bounding
   box. */
static void look_around(struct contacts *c, void (*visit)(void *arg, uint32_t tri), double margin_m)
{
    const double *p = c->mesh->points[c->edge[0]], *q = c->mesh->points[c->edge[1]];
    double low[3], high[3];
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = min_of(p[axis], q[axis]);
        high[axis] = max_of(p[axis], q[axis]);
    }
    bvh_overlaps(c->bvh, low, high, margin_m, visit, c);
}

/* Finds where edges pass through triangles. Each edge is searched once, as an edge of the first triangle that has it, which determines the
 * edge's part. If that triangle cannot cross any other, the edge is skipped. may_cross: by model triangle, from crossing_faces_find(). */
static void find_crossings(struct contacts *c, const char *may_cross)
{
    struct edge_table edges;
    char *at_crossing = mem_array(c->mesh->point_count, 1);
    edge_table_init(&edges, 1024);
    for (uint32_t t = 0; t < c->mesh->tri_count; t++)
        for (int i = 0; i < 3 && may_cross[c->mesh->tri_source[t]]; i++)
            at_crossing[c->mesh->tris[t][i]] = 1;
    for (uint32_t t = 0; t < c->mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            size_t before = edges.count;
            c->edge[0] = c->mesh->tris[t][i];
            c->edge[1] = c->mesh->tris[t][(i + 1) % 3];
            if (!at_crossing[c->edge[0]] || !at_crossing[c->edge[1]])
                continue;
            edge_table_add(&edges, c->edge[0], c->edge[1]);
            if (edges.count == before || !may_cross[c->mesh->tri_source[t]])
                continue;
            c->own = c->part[t];
            look_around(c, visit_crossed, 0);
        }
    edge_table_finish(&edges);
    mem_free(at_crossing);
}

static bool reaches_as_far(const void *arg, uint32_t tri)
{
    const struct contacts *c = arg;
    return reach_of(c, tri) >= c->reach_m;
}

/* Finds the point of another body that is nearest to point_m. It must be within the reach (distance up to which a part counts
 * as touching) of both bodies' parts. place->tri is TRIMESH_NONE if there is none. */
static void find_touch(const struct contacts *c, const double point_m[3], struct bvh_place *place)
{
    bvh_nearest_unlike(c->bvh, point_m, c->reach_m, c->own, NULL, NULL, place);
    if (place->tri != TRIMESH_NONE && place->distance_m > reach_of(c, place->tri))
        bvh_nearest_unlike(c->bvh, point_m, c->reach_m, c->own, reaches_as_far, c, place);
}

/* Finds points that touch another body, and requests their insertion there. A surface within the reach of a thin part (half of
   its thickness) touches the part, from either side. A surface beyond the reach touches only if both face each other: the
   distance is then a gap to bridge. Rims and intersections do not use such touches, because the part does not cover the other
   surface there. */
static void find_touches(struct contacts *c)
{
    struct line_of_sight sight;
    line_of_sight_init(&sight, c->mesh, c->parts, c->body, c->bvh);
    char *seen = mem_array(c->mesh->point_count, 1);
    for (uint32_t t = 0; t < c->mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t p = c->mesh->tris[t][i];
            struct bvh_place place;
            if (seen[p])
                continue;
            seen[p] = 1;
            c->own = c->body[t];
            c->reach_m = reach_of(c, t);
            find_touch(c, c->mesh->points[p], &place);
            if (place.tri != TRIMESH_NONE)
                c->touched[p] = c->body[place.tri];
            else if (!line_of_sight_find(&sight, p, c->own, &place))
                continue;
            if (!trimesh_has(c->mesh, place.tri, p))
                set_into_face(c, p, place.tri, place.weights, place.distance_m);
        }
    line_of_sight_finish(&sight);
    mem_free(seen);
}

/* --- rims: edges where a face leaves the body that it lies on --- */

/* Computes where two edges are nearest to each other: t, fraction from a to b, and s, fraction from c to d. Returns false if
 * the edges are parallel, or if one of these positions is not inside its edge. */
static bool edges_meet(const double a[3], const double b[3], const double c[3], const double d[3], double *t, double *s)
{
    double ab[3], cd[3], ac[3];
    vec_sub(b, a, ab);
    vec_sub(d, c, cd);
    vec_sub(c, a, ac);
    double aa = vec_dot(ab, ab), cc = vec_dot(cd, cd), both = vec_dot(ab, cd), det = aa * cc - both * both;
    if (!(det > PARALLEL * aa * cc))
        return false;
    *t = (vec_dot(ac, ab) * cc - vec_dot(ac, cd) * both) / det;
    *s = (vec_dot(ac, ab) * both - vec_dot(ac, cd) * aa) / det;
    return *t > 0 && *t < 1 && *s > 0 && *s < 1;
}

static bool is_known(const struct contacts *c, uint32_t u, uint32_t v)
{
    for (size_t i = c->crossing_count; i-- > 0;) {
        const struct contact_crossing *x = &c->crossings[i];
        if (x->tri != TRIMESH_NONE || x->a != c->edge[0] || x->b != c->edge[1])
            return false;
        if ((x->c == u && x->d == v) || (x->c == v && x->d == u))
            return true;
    }
    return false;
}

static void visit_rim(void *arg, uint32_t tri)
{
    struct contacts *c = arg;
    if (c->body[tri] != c->touched[c->edge[0]])
        return;
    for (int i = 0; i < 3; i++) {
        uint32_t u = c->mesh->tris[tri][i], v = c->mesh->tris[tri][(i + 1) % 3];
        const double *p = c->mesh->points[c->edge[0]], *q = c->mesh->points[c->edge[1]], *a = c->mesh->points[u], *b = c->mesh->points[v];
        double t, s, at[3], beside[3], end = min_of(c->reach_m, reach_of(c, tri));
        if (!edges_meet(p, q, a, b, &t, &s) || is_known(c, u, v))
            continue;
        double length = vec_distance(p, q), other = vec_distance(a, b);
        vec_mix(p, q, t, at);
        vec_mix(a, b, s, beside);
        if (vec_distance(at, beside) <= end && fmin(t, 1 - t) * length > end && fmin(s, 1 - s) * other > end)
            *add_crossing(c) =
                (struct contact_crossing){ .tri = TRIMESH_NONE, .a = c->edge[0], .b = c->edge[1], .c = u, .d = v, .t = t, .s = s };
    }
}

/* Finds rims: edges of a triangle with both ends on another body while the triangle's third corner is not on that body. Records where rims
 * cross edges of that body, so that the body is cut there. */
static void find_rims(struct contacts *c)
{
    for (uint32_t t = 0; t < c->mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            const uint32_t *v = c->mesh->tris[t];
            uint32_t p = v[i], q = v[(i + 1) % 3], apex = v[(i + 2) % 3], body = c->touched[p];
            if (body == TRIMESH_NONE || body != c->touched[q] || body == c->touched[apex])
                continue;
            c->edge[0] = p;
            c->edge[1] = q;
            c->reach_m = reach_of(c, t);
            look_around(c, visit_rim, c->reach_m);
        }
}

/* Adds a mesh point for each crossing, and requests its insertion into both the edge and the triangle (or other edge). Points
   are added only after all searches, because the searches read the array of points. */
static void set_crossings(struct contacts *c, struct repair_report *report)
{
    for (size_t i = 0; i < c->crossing_count; i++) {
        struct contact_crossing *x = &c->crossings[i];
        double place[3];
        vec_mix(c->mesh->points[x->a], c->mesh->points[x->b], x->t, place);
        x->point = trimesh_add_point(c->mesh, place);
        mesh_edit_insert_in_edge(c->edit, x->point, x->a, x->b, x->t, 0);
        if (x->tri == TRIMESH_NONE)
            mesh_edit_insert_in_edge(c->edit, x->point, x->c, x->d, x->s, 0);
        else
            set_into_face(c, x->point, x->tri, x->weights, 0);
        if (!x->own)
            continue;
        mem_grow(&report->crossings, &report->crossing_capacity, report->crossing_count + 1, sizeof(*report->crossings));
        report->crossings[report->crossing_count++] = x->point;
    }
}

/* --- the lines along which triangles intersect --------------------------------------------------------------------------------- */

struct meeting {             /* a point where two triangles intersect: an edge of one passes through the other there */
    uint32_t tris[2], point; /* tris: the lower one first */
};

struct meetings {
    struct meeting *at;
    size_t count, capacity;
};

static int compare_meetings(const void *a, const void *b)
{
    const struct meeting *x = a, *y = b;
    for (int i = 0; i < 2; i++)
        if (x->tris[i] != y->tris[i])
            return x->tris[i] < y->tris[i] ? -1 : 1;
    return (x->point > y->point) - (x->point < y->point);
}

/* Lists the points where triangles intersect. Where an edge passes through a triangle, each triangle at the edge intersects
 * that triangle. */
static void find_meetings(const struct contacts *c, struct meetings *meetings)
{
    struct edge_table edges;
    uint32_t *number = mem_array(c->crossing_count, sizeof(*number)), *first = mem_array(c->crossing_count + 2, sizeof(*first));
    edge_table_init(&edges, c->crossing_count);
    for (size_t i = 0; i < c->crossing_count; i++) {
        number[i] = edge_table_add(&edges, c->crossings[i].a, c->crossings[i].b);
        first[number[i] + 2]++;
    }
    for (size_t e = 2; e < edges.count + 2; e++)
        first[e] += first[e - 1];
    uint32_t *of_edge = mem_array(c->crossing_count, sizeof(*of_edge));
    for (uint32_t i = 0; i < c->crossing_count; i++)
        of_edge[first[number[i] + 1]++] = i;
    for (uint32_t t = 0; t < c->mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t e = edge_table_find(&edges, c->mesh->tris[t][i], c->mesh->tris[t][(i + 1) % 3]);
            for (uint32_t n = e == TRIMESH_NONE ? 0 : first[e]; e != TRIMESH_NONE && n < first[e + 1]; n++) {
                const struct contact_crossing *x = &c->crossings[of_edge[n]];
                if (x->tri == TRIMESH_NONE || x->tri == t)
                    continue;
                mem_grow(&meetings->at, &meetings->capacity, meetings->count + 1, sizeof(*meetings->at));
                meetings->at[meetings->count++] = (struct meeting){ { t < x->tri ? t : x->tri, t < x->tri ? x->tri : t }, x->point };
            }
        }
    edge_table_finish(&edges);
    mem_free(number);
    mem_free(first);
    mem_free(of_edge);
}

/* Requests an edge between the point and the corners of `tri` that touch triangle `other`, because the line of intersection ends there. */
static void join_corners(const struct contacts *c, uint32_t point, uint32_t tri, uint32_t other)
{
    const uint32_t *v = c->mesh->tris[tri], *u = c->mesh->tris[other];
    double w[3], at[3];
    for (int i = 0; i < 3; i++) {
        if (c->touched[v[i]] != c->body[other])
            continue;
        const double *p = c->mesh->points[v[i]];
        triangle_nearest(p, c->mesh->points[u[0]], c->mesh->points[u[1]], c->mesh->points[u[2]], w);
        for (int axis = 0; axis < 3; axis++)
            at[axis] = w[0] * c->mesh->points[u[0]][axis] + w[1] * c->mesh->points[u[1]][axis] + w[2] * c->mesh->points[u[2]][axis];
        if (vec_distance(p, at) <= min_of(reach_of(c, tri), reach_of(c, other)))
            mesh_edit_connect(c->edit, point, v[i]);
    }
}

/* Requests edges along the intersection of two triangles: from the farthest of their common points to the others. Usually there are two
 * points; near a corner, some may be found twice. */
static void join_meetings(const struct contacts *c, const struct meeting *meetings, size_t count)
{
    size_t far = 0;
    const double *from = c->mesh->points[meetings[0].point];
    for (size_t i = 1; i < count; i++)
        if (vec_distance2(from, c->mesh->points[meetings[i].point]) > vec_distance2(from, c->mesh->points[meetings[far].point]))
            far = i;
    for (size_t i = 0; i < count; i++)
        if (i != far)
            mesh_edit_connect(c->edit, meetings[i].point, meetings[far].point);
    if (count == 1)
        for (int i = 0; i < 2; i++)
            join_corners(c, meetings[0].point, meetings[0].tris[i], meetings[0].tris[1 - i]);
}

/* Cuts all pairs of intersecting triangles along their intersection. Afterwards each triangle is on one side of the other, and can be
 * hidden or visible as a whole. */
static void cut_along(struct contacts *c)
{
    struct meetings meetings = { 0 };
    find_meetings(c, &meetings);
    if (meetings.count)
        qsort(meetings.at, meetings.count, sizeof(*meetings.at), compare_meetings);
    for (size_t first = 0, end; first < meetings.count; first = end) {
        const struct meeting *m = &meetings.at[first];
        for (end = first + 1; end < meetings.count && meetings.at[end].tris[0] == m->tris[0] && meetings.at[end].tris[1] == m->tris[1];)
            end++;
        join_meetings(c, m, end - first);
    }
    mem_free(meetings.at);
}

static bool is_one_body(const struct contacts *c)
{
    size_t t = 0;
    while (t < c->mesh->tri_count && c->body[t] == c->body[0])
        t++;
    return t == c->mesh->tri_count;
}

/* Finds all contacts between bodies. If the mesh has a single body, searches only for places where that body crosses itself. */
static void find_contacts(struct contacts *c)
{
    char *may_cross = crossing_faces_find(c->parts);
    bool is_one = is_one_body(c);
    struct bvh *bvh = is_one && !may_cross ? NULL : bvh_create(c->mesh);
    if (!is_one)
        bvh_set_labels(bvh, c->body);
    c->bvh = bvh;
    memset(c->touched, 0xff, c->mesh->point_count * sizeof(*c->touched));
    if (!is_one)
        find_touches(c);
    if (may_cross)
        find_crossings(c, may_cross);
    if (!is_one)
        find_rims(c);
    bvh_destroy(&bvh);
    mem_free(may_cross);
}

void repair_contacts(struct trimesh *mesh, struct body_parts *parts, uint32_t *target, struct repair_report *report)
{
    struct mesh_edit edit;
    uint32_t *part = parts_spread(mesh, parts->of_source), *body = parts_spread(mesh, parts->body_of_source);
    size_t target_count = mesh->point_count;
    struct contacts contacts = { .mesh = mesh,
                                 .parts = parts,
                                 .part = part,
                                 .body = body,
                                 .edit = &edit,
                                 .touched = mem_array(target_count, sizeof(*contacts.touched)) };
    mesh_edit_init(&edit);
    for (uint32_t i = 0; i < target_count; i++)
        target[i] = i;
    find_contacts(&contacts);
    set_crossings(&contacts, report);
    if (contacts.crossing_count)
        cut_along(&contacts);
    repair_apply(&edit, mesh, target, target_count, contacts.crossing_count, report);
    mem_free(contacts.crossings);
    mem_free(contacts.touched);
    mem_free(part);
    mem_free(body);
}
