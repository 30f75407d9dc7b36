/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Carrying out what the bridging found, and noting each bridge. */
#include <string.h>

#include "base/mem.h"
#include "base/vec.h"
#include "surface/bvh.h"
#include "surface/stitch_impl.h"

bool stitch_tri_has(const struct trimesh *mesh, uint32_t tri, uint32_t point)
{
    return mesh->tris[tri][0] == point || mesh->tris[tri][1] == point || mesh->tris[tri][2] == point;
}

static void compose(uint32_t *target, size_t count, const uint32_t *then)
{
    for (size_t i = 0; i < count; i++)
        target[i] = then[target[i]];
}

static void note_bridge(struct stitch_report *report, const double from_m[3], const double to_m[3])
{
    mem_grow(&report->made, &report->made_capacity, report->made_count + 1, sizeof(*report->made));
    struct stitch_bridge *bridge = &report->made[report->made_count++];
    memcpy(bridge->from_m, from_m, sizeof(bridge->from_m));
    memcpy(bridge->to_m, to_m, sizeof(bridge->to_m));
}

static void place_of(const struct trimesh *mesh, const struct attach_item *item, double place[3])
{
    if (item->tri == TRIMESH_NONE) {
        vec_mix(mesh->points[item->a], mesh->points[item->b], item->t, place);
        return;
    }
    const uint32_t *v = mesh->tris[item->tri];
    double w[3];
    triangle_nearest(mesh->points[item->point], mesh->points[v[0]], mesh->points[v[1]], mesh->points[v[2]], w);
    for (int axis = 0; axis < 3; axis++)
        place[axis] = w[0] * mesh->points[v[0]][axis] + w[1] * mesh->points[v[1]][axis] + w[2] * mesh->points[v[2]][axis];
}

/* Points from first_new on are crossings: each is set into an edge first, and then into a face or one with a corner of it. */
static void note_bridges(struct stitch_report *report, const struct attach *attach, const struct trimesh *mesh, uint32_t first_new)
{
    uint32_t last_new = TRIMESH_NONE;
    for (size_t i = 0; i < attach->pair_count; i++)
        if (attach->pairs[i].a < first_new)
            note_bridge(report, mesh->points[attach->pairs[i].a], mesh->points[attach->pairs[i].b]);
    for (size_t i = 0; i < attach->item_count; i++) {
        const struct attach_item *item = &attach->items[i];
        double place[3];
        if (item->point >= first_new && item->point == last_new)
            continue;
        last_new = item->point;
        place_of(mesh, item, place);
        note_bridge(report, mesh->points[item->point], place);
    }
}

void stitch_carry_out(struct attach *attach, struct trimesh *mesh, uint32_t *target, size_t target_count, size_t crossings,
                      struct stitch_report *report)
{
    uint32_t *then = mem_array(mesh->point_count, sizeof(*then));
    report->bridges += attach->item_count + attach->pair_count - crossings; /* a crossing is set into both parts, and is one */
    report->longest_m = max_of(report->longest_m, attach->longest_m);
    note_bridges(report, attach, mesh, (uint32_t)(mesh->point_count - crossings));
    if (attach->item_count + attach->pair_count) {
        attach_apply(attach, mesh, then);
        compose(target, target_count, then);
        compose(report->crossings, report->crossing_count, then);
    }
    attach_finish(attach);
    mem_free(then);
}
