/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flipped faces: each triangle's side by those of its neighbours; what is on the smaller side is turned. */
#include "preprocess/geometry/winding.h"

#include "base/mem.h"
#include "base/vec.h"
#include "preprocess/geometry/welded_positions.h"
#include "surface/mesh/trimesh.h"

#define MOST_TURNED 0.25 /* of the area of what hangs together */

struct edge_corners { /* of the triangles at an edge: 3 t + i where it begins at corner i of triangle t */
    uint32_t at[2], count;
};

struct winding {
    const float (*positions)[3];
    const uint32_t *indices, *place;
    size_t tri_count;
    struct edge_table table;
    struct edge_corners *edges;
    uint32_t *edge_of; /* by corner */
    signed char *side; /* of each triangle: 1 or -1; 0: not known yet */
    uint32_t *queue;
};

static uint32_t place_at(const struct winding *w, uint32_t t, uint32_t i)
{
    return w->place[w->indices[3 * t + i % 3]];
}

static void find_edges(struct winding *w)
{
    for (uint32_t t = 0; t < w->tri_count; t++)
        for (uint32_t i = 0; i < 3; i++) {
            uint32_t e = edge_table_add(&w->table, place_at(w, t, i), place_at(w, t, i + 1));
            struct edge_corners *edge = &w->edges[e];
            if (edge->count < 2)
                edge->at[edge->count] = 3 * t + i;
            edge->count++;
            w->edge_of[3 * t + i] = e;
        }
}

static double area_of(const struct winding *w, uint32_t t)
{
    double n[3];
    const uint32_t *v = w->indices + 3 * (size_t)t;
    vecf_normal(w->positions[v[0]], w->positions[v[1]], w->positions[v[2]], n);
    return vec_length(n) / 2;
}

/* Both run along their edge the same way: one of them is flipped. */
static bool are_contrary(const struct winding *w, uint32_t corner, uint32_t other)
{
    return place_at(w, corner / 3, corner % 3) == place_at(w, other / 3, other % 3);
}

/* Puts all triangles that hang together with the first into the queue, finds the side of each, and sums up the area of each side, of -1
   first. Sets *two_sided to false where sides contradict each other. Returns how many triangles these are. */
static size_t spread(struct winding *w, uint32_t first, double area_m2[2], bool *two_sided)
{
    size_t count = 0;
    w->side[first] = 1;
    w->queue[count++] = first;
    *two_sided = true;
    area_m2[0] = area_m2[1] = 0;
    for (size_t done = 0; done < count; done++) {
        uint32_t t = w->queue[done];
        area_m2[w->side[t] > 0] += area_of(w, t);
        for (uint32_t corner = 3 * t; corner < 3 * t + 3; corner++) {
            const struct edge_corners *edge = &w->edges[w->edge_of[corner]];
            uint32_t other = edge->at[edge->at[0] == corner];
            if (edge->count != 2 || other / 3 == t)
                continue;
            signed char side = are_contrary(w, corner, other) ? (signed char)-w->side[t] : w->side[t];
            if (w->side[other / 3] == 0) {
                w->side[other / 3] = side;
                w->queue[count++] = other / 3;
            }
            *two_sided &= w->side[other / 3] == side;
        }
    }
    return count;
}

static uint32_t turn_smaller(const struct winding *w, uint32_t *indices, size_t count, const double area_m2[2])
{
    const signed char smaller = area_m2[0] < area_m2[1] ? -1 : 1;
    uint32_t turned = 0;
    for (size_t i = 0; i < count && area_m2[smaller > 0] <= MOST_TURNED * (area_m2[0] + area_m2[1]); i++) {
        uint32_t *v = indices + 3 * (size_t)w->queue[i], swap = v[1];
        if (w->side[w->queue[i]] != smaller)
            continue;
        v[1] = v[2];
        v[2] = swap;
        turned++;
    }
    return turned;
}

bool winding_mend(const float (*positions)[3], size_t vertex_count, uint32_t *indices, size_t index_count, uint32_t *turned)
{
    struct welded_positions welded;
    struct winding w = { .positions = positions, .indices = indices, .tri_count = index_count / 3 };
    if (!welded_init(&welded, positions, vertex_count))
        return false;
    w.place = welded.of_vertex;
    w.edges = mem_try_array(index_count, sizeof(*w.edges));
    w.edge_of = mem_try_array(index_count, sizeof(*w.edge_of));
    w.side = mem_try_array(w.tri_count, 1);
    w.queue = mem_try_array(w.tri_count, sizeof(*w.queue));
    bool good = w.edges && w.edge_of && w.side && w.queue;
    if (good) {
        edge_table_init(&w.table, index_count / 2);
        find_edges(&w);
        for (uint32_t t = 0; t < w.tri_count; t++) {
            double area_m2[2];
            bool two_sided;
            size_t count = w.side[t] ? 0 : spread(&w, t, area_m2, &two_sided);
            if (count > 0 && two_sided)
                *turned += turn_smaller(&w, indices, count, area_m2);
        }
        edge_table_finish(&w.table);
    }
    mem_free(w.edges);
    mem_free(w.edge_of);
    mem_free(w.side);
    mem_free(w.queue);
    welded_finish(&welded);
    return good;
}
