/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inserts hanging vertices (vertices that lie inside an edge, not at its end) into edges that have several faces and so are not
   borders. One of the bodies that meet at such an edge has a slit along it. */
#include "surface/repair/repair.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/math/vec.h"
#include "surface/repair/mesh_edit.h"
#include "surface/repair/borders.h"
#include "surface/repair/repair_impl.h"

/* maximum number of rounds of insertions. An edge whose faces are all split at different points needs one round fewer than it has faces */
#define MAX_ROUNDS 4

struct hanging {
    const struct trimesh *mesh;
    const struct borders *borders;
    struct mesh_edit *edit;
    double within_m;
    uint32_t *last; /* by border point: index of the edge into which it was inserted last; prevents a second insertion there */
};

/* Returns the position of the point p along the edge a-b, as a fraction of its length; *distance_m receives the distance of p
   from the edge. Returns a negative number if p is not on the edge, or is at an end. */
static double place_on(const struct hanging *h, uint32_t p, uint32_t a, uint32_t b, double *distance_m)
{
    double ab[3], ap[3], at[3];
    vec_sub(h->mesh->points[b], h->mesh->points[a], ab);
    vec_sub(h->mesh->points[p], h->mesh->points[a], ap);
    double length2 = vec_dot(ab, ab), t = length2 > 0 ? vec_dot(ap, ab) / length2 : 0, end = h->within_m / sqrt(length2);
    if (!(t > end && t < 1 - end))
        return -1;
    vec_mix(h->mesh->points[a], h->mesh->points[b], t, at);
    *distance_m = vec_distance(at, h->mesh->points[p]);
    return *distance_m <= h->within_m ? t : -1;
}

/* Returns whether the border that comes from a to p continues beyond p in the same direction. */
static bool runs_straight(const struct hanging *h, uint32_t p, uint32_t a)
{
    const struct borders *b = h->borders;
    uint32_t slot = b->slot[p];
    for (uint32_t n = b->first[slot]; n < b->first[slot + 1]; n++) {
        const uint32_t *edge = b->edges[b->at[n]];
        double distance_m;
        if (place_on(h, p, a, edge[edge[0] == p], &distance_m) > 0)
            return true;
    }
    return false;
}

/* Inserts border points into edge a-b, whose index is `number`: those that lie on the edge and that a border edge connects with
   a. */
static void look_from(struct hanging *h, uint32_t a, uint32_t b, uint32_t number)
{
    const struct borders *borders = h->borders;
    uint32_t slot = borders->slot[a];
    for (uint32_t n = slot == TRIMESH_NONE ? 0 : borders->first[slot]; slot != TRIMESH_NONE && n < borders->first[slot + 1]; n++) {
        const uint32_t *edge = borders->edges[borders->at[n]];
        uint32_t p = edge[edge[0] == a];
        double distance_m, t = p == b ? -1 : place_on(h, p, a, b, &distance_m);
        if (t < 0 || h->last[borders->slot[p]] == number || !runs_straight(h, p, a))
            continue;
        h->last[borders->slot[p]] = number;
        mesh_edit_insert_in_edge(h->edit, p, a, b, t, distance_m);
    }
}

static bool is_at_border(const struct hanging *h, uint32_t a, uint32_t b)
{
    return h->borders->slot[a] != TRIMESH_NONE || h->borders->slot[b] != TRIMESH_NONE;
}

/* Returns a flag for each edge index: 1 if the edge has an end on a border, and an odd number of faces greater than one. A body
 * has a slit at such an edge. Edges with an even number of faces are closed, and edges with one face are closed as seams. */
static char *find_odd(const struct hanging *h, struct edge_table *edges)
{
    const struct trimesh *mesh = h->mesh;
    struct count {
        uint32_t faces, times;
    } *counts = NULL;
    size_t capacity = 0;
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t a = mesh->tris[t][i], b = mesh->tris[t][(i + 1) % 3];
            if (!is_at_border(h, a, b))
                continue;
            uint32_t number = edge_table_add(edges, a, b);
            mem_grow(&counts, &capacity, edges->count, sizeof(*counts));
            counts[number].faces++;
            counts[number].times += mesh->tri_times[t];
        }
    char *odd = mem_array(edges->count, 1);
    for (size_t e = 0; e < edges->count; e++)
        odd[e] = counts[e].times > 1 && (counts[e].faces % 2 || counts[e].times % 2);
    mem_free(counts);
    return odd;
}

static bool set_hanging(struct trimesh *mesh, const struct borders *borders, double within_m, uint32_t *target, size_t target_count,
                        struct repair_report *report)
{
    struct mesh_edit edit;
    struct edge_table edges;
    mesh_edit_init(&edit);
    edge_table_init(&edges, 4 * borders->edge_count);
    struct hanging h = {
        .mesh = mesh, .borders = borders, .edit = &edit, .within_m = within_m, .last = mem_array(borders->point_count, sizeof(*h.last))
    };
    memset(h.last, 0xff, borders->point_count * sizeof(*h.last));
    char *odd = find_odd(&h, &edges);
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t a = mesh->tris[t][i], b = mesh->tris[t][(i + 1) % 3], number;
            if (!is_at_border(&h, a, b) || !odd[number = edge_table_find(&edges, a, b)])
                continue;
            odd[number] = 0; /* handles each edge only once */
            look_from(&h, a, b, number);
            look_from(&h, b, a, number);
        }
    bool any = edit.item_count > 0;
    edge_table_finish(&edges);
    mem_free(odd);
    mem_free(h.last);
    repair_apply(&edit, mesh, target, target_count, 0, report);
    return any;
}

void repair_hanging(struct trimesh *mesh, struct borders *borders, double within_m, uint32_t *target, size_t target_count,
                    struct repair_report *report)
{
    int rounds = borders->edge_count ? MAX_ROUNDS : 0;
    while (rounds-- > 0 && set_hanging(mesh, borders, within_m, target, target_count, report)) {
        borders_finish(borders);
        borders_init(borders, mesh);
    }
}
