/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Applies the edits that mesh repair found, and records each bridge (pair of joined points). */
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/mesh/bvh.h"
#include "surface/repair/repair_impl.h"

static void compose(uint32_t *target, size_t count, const uint32_t *then)
{
    for (size_t i = 0; i < count; i++)
        target[i] = then[target[i]];
}

static void note_bridge(struct repair_report *report, const double from_m[3], const double to_m[3])
{
    mem_grow(&report->made, &report->made_capacity, report->made_count + 1, sizeof(*report->made));
    struct crack_bridge *bridge = &report->made[report->made_count++];
    memcpy(bridge->from_m, from_m, sizeof(bridge->from_m));
    memcpy(bridge->to_m, to_m, sizeof(bridge->to_m));
}

static void place_of(const struct trimesh *mesh, const struct mesh_edit_insertion *item, double place[3])
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

/* Records a bridge for each merged or inserted point. Points with index first_new or higher are crossings (an edge passes through a face).
   The edit contains each crossing twice: first inserted into an edge, then into a face, or merged with a corner of the face. */
static void note_bridges(struct repair_report *report, const struct mesh_edit *edit, const struct trimesh *mesh, uint32_t first_new)
{
    uint32_t last_new = TRIMESH_NONE;
    for (size_t i = 0; i < edit->pair_count; i++)
        if (edit->pairs[i].a < first_new)
            note_bridge(report, mesh->points[edit->pairs[i].a], mesh->points[edit->pairs[i].b]);
    for (size_t i = 0; i < edit->item_count; i++) {
        const struct mesh_edit_insertion *item = &edit->items[i];
        double place[3];
        if (item->point >= first_new && item->point == last_new)
            continue;
        last_new = item->point;
        place_of(mesh, item, place);
        note_bridge(report, mesh->points[item->point], place);
    }
}

void repair_apply(struct mesh_edit *edit, struct trimesh *mesh, uint32_t *target, size_t target_count, size_t crossings,
                  struct repair_report *report)
{
    uint32_t *then = mem_array(mesh->point_count, sizeof(*then));
    /* each crossing is inserted twice, into an edge and a face, but counts once */
    report->bridges += edit->item_count + edit->pair_count - crossings;
    report->longest_m = max_of(report->longest_m, edit->longest_m);
    note_bridges(report, edit, mesh, (uint32_t)(mesh->point_count - crossings));
    if (edit->item_count + edit->pair_count) {
        mesh_edit_apply(edit, mesh, then);
        compose(target, target_count, then);
        compose(report->crossings, report->crossing_count, then);
    }
    mesh_edit_finish(edit);
    mem_free(then);
}
