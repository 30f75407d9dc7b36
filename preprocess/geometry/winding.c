/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Determines each triangle's orientation relative to its neighbours, and reverses the minority orientation (by area). */
#include "preprocess/geometry/winding.h"

#include "base/math/vec.h"
#include "base/mem.h"
#include "preprocess/geometry/welded_positions.h"
#include "surface/mesh/tri_edges.h"

/* largest share of a connected group's area that triangles of the minority orientation may cover; above it, no triangle of the group is
 * turned */
#define MAX_TURNED 0.25

struct winding {
    const float (*positions)[3];
    size_t tri_count;
    uint32_t (*places)[3]; /* by triangle: the position index of each corner; vertices at the same position share an index */
    signed char *facing;   /* by triangle: orientation relative to the first triangle of its group, 1 or -1; 0: not known yet */
    uint32_t *joined;
};

/* Writes the total area of the group's triangles with orientation -1 to area_m2[0], and of those with orientation 1 to area_m2[1]. */
static void sum_area(const struct winding *w, const uint32_t *indices, size_t count, double area_m2[2])
{
    area_m2[0] = area_m2[1] = 0;
    for (size_t i = 0; i < count; i++) {
        const uint32_t *v = indices + 3 * (size_t)w->joined[i];
        double n[3];
        vecf_normal(w->positions[v[0]], w->positions[v[1]], w->positions[v[2]], n);
        area_m2[w->facing[w->joined[i]] > 0] += vec_length(n) / 2;
    }
}

/* Reverses the triangles of a connected group that have the minority orientation (by area). Returns their number. */
static uint32_t turn_smaller(const struct winding *w, uint32_t *indices, size_t count)
{
    double area_m2[2];
    sum_area(w, indices, count, area_m2);
    const signed char smaller = area_m2[0] < area_m2[1] ? -1 : 1;
    uint32_t turned = 0;
    for (size_t i = 0; i < count && area_m2[smaller > 0] <= MAX_TURNED * (area_m2[0] + area_m2[1]); i++) {
        uint32_t *v = indices + 3 * (size_t)w->joined[i], swap = v[1];
        if (w->facing[w->joined[i]] != smaller)
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
    struct winding w = { .positions = positions, .tri_count = index_count / 3 };
    if (!welded_init(&welded, positions, vertex_count))
        return false;
    w.places = mem_try_array(w.tri_count, sizeof(*w.places));
    w.facing = mem_try_array(w.tri_count, 1);
    w.joined = mem_try_array(w.tri_count, sizeof(*w.joined));
    bool good = w.places && w.facing && w.joined;
    for (size_t i = 0; good && i < 3 * w.tri_count; i++)
        w.places[i / 3][i % 3] = welded.of_vertex[indices[i]];
    struct tri_edges edges;
    good = good && tri_edges_try_init(&edges, (const uint32_t(*)[3])w.places, w.tri_count);
    if (good) {
        for (uint32_t t = 0; t < w.tri_count; t++) {
            bool two_sided;
            size_t count = w.facing[t] ? 0 : tri_edges_orient(&edges, t, w.facing, w.joined, &two_sided);
            if (count > 0 && two_sided)
                *turned += turn_smaller(&w, indices, count);
        }
        tri_edges_finish(&edges);
    }
    mem_free(w.places);
    mem_free(w.facing);
    mem_free(w.joined);
    welded_finish(&welded);
    return good;
}
