/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Applies a batch of edits (mesh_edit.h): inserts points into edges and faces of the mesh, and divides the faces concerned into new
   triangles. */
#include "surface/repair/mesh_edit.h"

#include <stdlib.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/mesh/bvh.h"
#include "surface/repair/face_triangulation.h"

void mesh_edit_init(struct mesh_edit *edit)
{
    *edit = (struct mesh_edit){ 0 };
}

void mesh_edit_finish(struct mesh_edit *edit)
{
    mem_free(edit->items);
    mem_free(edit->pairs);
    mem_free(edit->joins);
    *edit = (struct mesh_edit){ 0 };
}

void mesh_edit_merge_points(struct mesh_edit *edit, uint32_t a, uint32_t b, double distance_m)
{
    mem_grow(&edit->pairs, &edit->pair_capacity, edit->pair_count + 1, sizeof(*edit->pairs));
    edit->pairs[edit->pair_count++] = (struct mesh_edit_pair){ a, b };
    edit->longest_m = max_of(edit->longest_m, distance_m);
}

static void add_item(struct mesh_edit *edit, struct mesh_edit_insertion item, double distance_m)
{
    mem_grow(&edit->items, &edit->item_capacity, edit->item_count + 1, sizeof(*edit->items));
    edit->items[edit->item_count++] = item;
    edit->longest_m = max_of(edit->longest_m, distance_m);
}

void mesh_edit_insert_in_edge(struct mesh_edit *edit, uint32_t point, uint32_t a, uint32_t b, double t, double distance_m)
{
    bool swap = a > b;
    add_item(edit,
             (struct mesh_edit_insertion){
                 .point = point, .a = swap ? b : a, .b = swap ? a : b, .tri = TRIMESH_NONE, .t = swap ? 1 - t : t },
             distance_m);
}

void mesh_edit_insert_in_tri(struct mesh_edit *edit, uint32_t point, uint32_t tri, double distance_m)
{
    add_item(edit, (struct mesh_edit_insertion){ .point = point, .a = TRIMESH_NONE, .b = TRIMESH_NONE, .tri = tri }, distance_m);
}

void mesh_edit_connect(struct mesh_edit *edit, uint32_t a, uint32_t b)
{
    mem_grow(&edit->joins, &edit->join_capacity, edit->join_count + 1, sizeof(*edit->joins));
    edit->joins[edit->join_count++] = (struct mesh_edit_pair){ a, b };
}

/* --- applying the edits --------------------------------------------------------------------------------------------------- */

static void find_targets(const struct mesh_edit *edit, size_t point_count, uint32_t *target)
{
    for (uint32_t i = 0; i < point_count; i++)
        target[i] = i;
    for (size_t i = 0; i < edit->pair_count; i++) {
        trimesh_join(target, edit->pairs[i].a, edit->pairs[i].b);
    }
    for (uint32_t i = 0; i < point_count; i++)
        target[i] = trimesh_root(target, i);
}

/* inserted points, grouped by edge (sorted by position from the end with the lower index) and by triangle */
struct crossing_lists {
    struct edge_table edges;
    /* by edge index (edge_first) or triangle (tri_first): index of its first insertion; one additional element at the end */
    uint32_t *edge_first, *tri_first;
    struct mesh_edit_insertion *by_edge;
    uint32_t *by_tri;
    uint32_t *target; /* by mesh point: index of the point that replaces it when points are merged */
    /* edges requested from each point (after merging): the points to which point p must get an edge are
       partners[partner_first[p]] to partners[partner_first[p + 1] - 1]. NULL: no edge is requested */
    uint32_t *partner_first, *partners;
    /* by point after replacement: 1 + its index in the triangulation of the current face; 0: the triangulation does not have it */
    uint32_t *slot;
};

static int by_t(const void *a, const void *b)
{
    const struct mesh_edit_insertion *p = a, *q = b;
    return p->t < q->t ? -1 : p->t > q->t;
}

/* Lists, for each point, the points to connect it to (edit->joins), in both directions, after replacement of merged points. */
static void lists_partners(struct crossing_lists *lists, const struct mesh_edit_pair *joins, size_t count, size_t point_count)
{
    if (!count)
        return;
    lists->partner_first = mem_array(point_count + 2, sizeof(*lists->partner_first));
    lists->partners = mem_array(2 * count, sizeof(*lists->partners));
    lists->slot = mem_array(point_count, sizeof(*lists->slot));
    for (size_t i = 0; i < count; i++) {
        lists->partner_first[lists->target[joins[i].a] + 2]++;
        lists->partner_first[lists->target[joins[i].b] + 2]++;
    }
    for (size_t i = 2; i < point_count + 2; i++)
        lists->partner_first[i] += lists->partner_first[i - 1];
    for (size_t i = 0; i < count; i++) {
        uint32_t a = lists->target[joins[i].a], b = lists->target[joins[i].b];
        lists->partners[lists->partner_first[a + 1]++] = b;
        lists->partners[lists->partner_first[b + 1]++] = a;
    }
}

static void lists_init(struct crossing_lists *lists, const struct mesh_edit *edit, const struct trimesh *mesh)
{
    *lists = (struct crossing_lists){ .target = mem_array(mesh->point_count, sizeof(*lists->target)) };
    find_targets(edit, mesh->point_count, lists->target);
    edge_table_init(&lists->edges, edit->item_count);
    for (size_t i = 0; i < edit->item_count; i++)
        if (edit->items[i].a != TRIMESH_NONE)
            edge_table_add(&lists->edges, edit->items[i].a, edit->items[i].b);
    lists->edge_first = mem_array(lists->edges.count + 2, sizeof(*lists->edge_first));
    lists->tri_first = mem_array(mesh->tri_count + 2, sizeof(*lists->tri_first));
    lists->by_edge = mem_array(edit->item_count, sizeof(*lists->by_edge));
    lists->by_tri = mem_array(edit->item_count, sizeof(*lists->by_tri));
    for (size_t i = 0; i < edit->item_count; i++) {
        const struct mesh_edit_insertion *item = &edit->items[i];
        if (item->a != TRIMESH_NONE)
            lists->edge_first[edge_table_find(&lists->edges, item->a, item->b) + 2]++;
        else
            lists->tri_first[item->tri + 2]++;
    }
    for (size_t e = 2; e < lists->edges.count + 2; e++)
        lists->edge_first[e] += lists->edge_first[e - 1];
    for (size_t t = 2; t < mesh->tri_count + 2; t++)
        lists->tri_first[t] += lists->tri_first[t - 1];
    for (size_t i = 0; i < edit->item_count; i++) {
        const struct mesh_edit_insertion *item = &edit->items[i];
        if (item->a != TRIMESH_NONE)
            lists->by_edge[lists->edge_first[edge_table_find(&lists->edges, item->a, item->b) + 1]++] = *item;
        else
            lists->by_tri[lists->tri_first[item->tri + 1]++] = item->point;
    }
    for (size_t e = 0; e < lists->edges.count; e++)
        qsort(lists->by_edge + lists->edge_first[e], lists->edge_first[e + 1] - lists->edge_first[e], sizeof(*lists->by_edge), by_t);
    lists_partners(lists, edit->joins, edit->join_count, mesh->point_count);
}

static void lists_finish(struct crossing_lists *lists)
{
    edge_table_finish(&lists->edges);
    mem_free(lists->edge_first);
    mem_free(lists->tri_first);
    mem_free(lists->by_edge);
    mem_free(lists->by_tri);
    mem_free(lists->target);
    mem_free(lists->partner_first);
    mem_free(lists->partners);
    mem_free(lists->slot);
}

static bool is_corner(const uint32_t corners[3], uint32_t point)
{
    return point == corners[0] || point == corners[1] || point == corners[2];
}

/* Lists the points inserted on the side from a to b, in this order, excluding a and b, as indices in the face's triangulation.
 * Returns their number. */
static size_t side(struct face_triangulation *face, const struct crossing_lists *lists, const uint32_t corners[3], uint32_t a, uint32_t b,
                   uint32_t *out)
{
    uint32_t e = edge_table_find(&lists->edges, corners[a], corners[b]);
    size_t count = 0;
    if (e == TRIMESH_NONE)
        return 0;
    uint32_t first = lists->edge_first[e], n = lists->edge_first[e + 1] - first;
    for (uint32_t i = 0; i < n; i++) {
        const struct mesh_edit_insertion *item = &lists->by_edge[corners[a] < corners[b] ? first + i : first + n - 1 - i];
        double t = corners[a] < corners[b] ? item->t : 1 - item->t;
        if (is_corner(corners, item->point))
            continue;
        out[count++] = face_triangulation_add_point(face, item->point, face->at[a][0] + t * (face->at[b][0] - face->at[a][0]),
                                                    face->at[a][1] + t * (face->at[b][1] - face->at[a][1]));
    }
    return count;
}

static double distance2(const struct face_triangulation *face, uint32_t a, uint32_t b)
{
    double x = face->at[a][0] - face->at[b][0], y = face->at[a][1] - face->at[b][1];
    return x * x + y * y;
}

/* Triangulates a face between two chains of points on its sides, the way a zip closes. One chain is `low`, along a-b, the side
   with most points; the other is a-c-b. trimesh_sample() uses the same method. */
static void zip(struct face_triangulation *face, const uint32_t *low, size_t low_count, const uint32_t *high, size_t high_count)
{
    size_t i = 1, j = 1, ab = low_count - 1, acb = high_count - 1;
    face_triangulation_add_tri(face, low[0], low[1], high[1]);
    while (i < ab) {
        bool high_done = j == acb - 1, low_waits = i == ab - 1;
        if (high_done || (!low_waits && distance2(face, low[i + 1], high[j]) < distance2(face, low[i], high[j + 1]))) {
            face_triangulation_add_tri(face, low[i], low[i + 1], high[j]);
            i++;
        } else {
            face_triangulation_add_tri(face, low[i], high[j + 1], high[j]);
            j++;
        }
    }
}

static size_t list_chain(struct face_triangulation *face, const struct crossing_lists *lists, const uint32_t corners[3],
                         const uint32_t *way, int steps, uint32_t **chain, size_t *capacity)
{
    size_t count = 0, most = 2;
    for (int s = 0; s < steps; s++) {
        uint32_t e = edge_table_find(&lists->edges, corners[way[s]], corners[way[s + 1]]);
        most += e == TRIMESH_NONE ? 1 : lists->edge_first[e + 1] - lists->edge_first[e] + 1;
    }
    mem_grow(chain, capacity, most, sizeof(**chain));
    for (int s = 0; s < steps; s++) {
        (*chain)[count++] = way[s];
        count += side(face, lists, corners, way[s], way[s + 1], *chain + count);
    }
    (*chain)[count++] = way[steps];
    return count;
}

struct cutter {
    struct face_triangulation face;
    uint32_t *low, *high;
    size_t low_capacity, high_capacity;
};

static void lay_out(struct face_triangulation *face, const struct trimesh *mesh, const uint32_t corners[3])
{
    const double *p = mesh->points[corners[0]], *q = mesh->points[corners[1]], *r = mesh->points[corners[2]];
    double pq[3], pr[3], n[3], length = vec_distance(p, q);
    vec_sub(q, p, pq);
    vec_sub(r, p, pr);
    vec_cross(pq, pr, n);
    face->count = face->tri_count = 0;
    face_triangulation_add_point(face, corners[0], 0, 0);
    face_triangulation_add_point(face, corners[1], length, 0);
    face_triangulation_add_point(face, corners[2], vec_dot(pq, pr) / length, vec_length(n) / length);
}

static size_t side_count(const struct crossing_lists *lists, const uint32_t corners[3], uint32_t i)
{
    uint32_t e = edge_table_find(&lists->edges, corners[i], corners[(i + 1) % 3]);
    size_t count = 0;
    for (uint32_t n = e == TRIMESH_NONE ? 0 : lists->edge_first[e]; e != TRIMESH_NONE && n < lists->edge_first[e + 1]; n++)
        count += !is_corner(corners, lists->by_edge[n].point);
    return count;
}

static bool touched(const struct crossing_lists *lists, const uint32_t v[3], size_t t)
{
    return lists->tri_first[t + 1] > lists->tri_first[t] || edge_table_find(&lists->edges, v[0], v[1]) != TRIMESH_NONE ||
           edge_table_find(&lists->edges, v[1], v[2]) != TRIMESH_NONE || edge_table_find(&lists->edges, v[2], v[0]) != TRIMESH_NONE;
}

/* Adds a point to the face's triangulation, at its projection onto the face's plane. */
static void set_point(struct face_triangulation *face, const struct trimesh *mesh, const uint32_t corners[3], uint32_t id)
{
    double w[3];
    triangle_nearest(mesh->points[id], mesh->points[corners[0]], mesh->points[corners[1]], mesh->points[corners[2]], w);
    double x = 0, y = 0;
    for (int i = 0; i < 3; i++) {
        x += w[i] * face->at[i][0];
        y += w[i] * face->at[i][1];
    }
    for (size_t i = 0; i < face->count; i++)
        if (face->ids[i] == id)
            return; /* the triangulation already has this point, as a corner or on a side */
    face_triangulation_insert(face, face_triangulation_add_point(face, id, x, y));
}

static void join_points(struct face_triangulation *face, const struct crossing_lists *lists)
{
    if (!lists->partners)
        return;
    for (uint32_t i = 0; i < face->count; i++)
        lists->slot[lists->target[face->ids[i]]] = i + 1;
    for (uint32_t i = 0; i < face->count; i++) {
        uint32_t own = lists->target[face->ids[i]];
        for (uint32_t n = lists->partner_first[own]; n < lists->partner_first[own + 1]; n++) {
            uint32_t other = lists->slot[lists->partners[n]];
            if (other > i + 1)
                face_triangulation_connect(face, i, other - 1);
        }
    }
    for (uint32_t i = 0; i < face->count; i++)
        lists->slot[lists->target[face->ids[i]]] = 0;
}

static void cut(struct cutter *cutter, const struct crossing_lists *lists, struct trimesh *mesh, size_t t)
{
    struct face_triangulation *face = &cutter->face;
    uint32_t corners[3], source = mesh->tri_source[t];
    memcpy(corners, mesh->tris[t], sizeof(corners));
    lay_out(face, mesh, corners);
    uint32_t a = 0; /* index (0 to 2) of the corner that begins the side with most inserted points */
    for (uint32_t i = 1; i < 3; i++)
        if (side_count(lists, corners, i) > side_count(lists, corners, a))
            a = i;
    uint32_t b = (a + 1) % 3, c = (a + 2) % 3;
    size_t low = list_chain(face, lists, corners, (const uint32_t[2]){ a, b }, 1, &cutter->low, &cutter->low_capacity);
    size_t high = list_chain(face, lists, corners, (const uint32_t[3]){ a, c, b }, 2, &cutter->high, &cutter->high_capacity);
    zip(face, cutter->low, low, cutter->high, high);
    for (uint32_t i = lists->tri_first[t]; i < lists->tri_first[t + 1]; i++)
        set_point(face, mesh, corners, lists->by_tri[i]);
    join_points(face, lists);
    for (size_t i = 0; i < face->tri_count; i++) {
        const uint32_t *v = face->tris[i];
        if (i == 0)
            memcpy(mesh->tris[t], (const uint32_t[3]){ face->ids[v[0]], face->ids[v[1]], face->ids[v[2]] }, sizeof(*mesh->tris));
        else
            trimesh_add_tri(mesh, face->ids[v[0]], face->ids[v[1]], face->ids[v[2]], source);
        if (mesh->tri_times && i > 0)
            mesh->tri_times[mesh->tri_count - 1] = mesh->tri_times[t];
    }
}

void mesh_edit_apply(const struct mesh_edit *edit, struct trimesh *mesh, uint32_t *target)
{
    struct crossing_lists lists;
    struct cutter cutter = { 0 };
    size_t tri_count = mesh->tri_count, dropped = 0, repeated = 0;
    lists_init(&lists, edit, mesh);
    for (size_t t = 0; t < tri_count; t++)
        if (touched(&lists, mesh->tris[t], t))
            cut(&cutter, &lists, mesh, t);
    memcpy(target, lists.target, mesh->point_count * sizeof(*target));
    lists_finish(&lists);
    face_triangulation_finish(&cutter.face);
    mem_free(cutter.low);
    mem_free(cutter.high);
    trimesh_rename(mesh, target, &dropped, &repeated);
}
