/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds triangles and vertices far from the rest of an asset, and the node they belong to. */
#include "preprocess/geometry/stray.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/math/gap_split.h"
#include "base/mem.h"
#include "base/text/utf8.h"
#include "plant/models/transform.h"
#include "preprocess/geometry/geometry_impl.h"

struct farthest {
    struct extent main; /* bounding box, in the asset frame, of the asset's main part (base/math/gap_split.h) */
    double away_m, at_m[3];
    const struct gltf_node *node;
};

static double away_from(const struct extent *main, const double place_m[3])
{
    double away_m[3];
    for (int axis = 0; axis < 3; axis++)
        away_m[axis] = fmax(fmax(main->low[axis] - place_m[axis], place_m[axis] - main->high[axis]), 0);
    return vec_length(away_m);
}

/* Finds a glTF primitive's farthest vertex from the asset's main part, and keeps it if it is farther away than those found
 * before. Includes vertices used only by triangles without area. */
static void look_at(struct farthest *farthest, const struct node_primitive *part, const struct geometry_params *params)
{
    double world[16], place_m[3];
    primitive_world(params, part->node, world);
    for (uint32_t v = 0; v < part->primitive->vertex_count; v++) {
        const float *p = part->primitive->positions[v];
        transform_point(world, (const double[3]){ (double)p[0], (double)p[1], (double)p[2] }, place_m);
        double away_m = away_from(&farthest->main, place_m);
        if (away_m > farthest->away_m) {
            farthest->away_m = away_m;
            farthest->node = part->node;
            memcpy(farthest->at_m, place_m, sizeof(place_m));
        }
    }
}

/* Returns the name of the node or of its nearest named ancestor, or "" if none has a name. */
static const char *name_of(const struct gltf_model *model, const struct gltf_node *node)
{
    while (!node->name[0] && node->parent >= 0)
        node = &model->nodes[node->parent];
    return node->name;
}

void stray_text(const struct geometry *geometry, const struct gltf_model *model, const struct geometry_params *params,
                char text[STRAY_TEXT_BYTES])
{
    size_t count = geometry->index_count / 3;
    struct gap_tri *tris = gap_tris((const float(*)[3])geometry->positions_m, geometry->indices, count);
    struct farthest farthest = { .main = extent_empty() };
    size_t stray = count - gap_split(tris, count, &farthest.main);
    struct node_primitives parts = { 0 };
    struct geometry counts = { 0 };
    char why[MODEL_WHY_BYTES];
    mem_free(tris);
    text[0] = 0;
    double main_m = extent_size(&farthest.main);
    for (int axis = 0; axis < 3; axis++) {
        farthest.main.low[axis] += geometry->origin_m[axis];
        farthest.main.high[axis] += geometry->origin_m[axis];
    }
    if (node_primitives_find(&parts, &counts, model, params, why))
        for (size_t i = 0; i < parts.count; i++)
            look_at(&farthest, &parts.at[i], params);
    mem_free(parts.at);
    /* ignore the farthest vertex if its distance is mere rounding, or if only triangles without area use it and it is close to
     * the main part */
    if (stray == 0 && !(farthest.away_m > main_m))
        return;
    if (stray > 0)
        snprintf(text, STRAY_TEXT_BYTES, "%zu triangles of the asset lie up to", stray);
    else
        snprintf(text, STRAY_TEXT_BYTES, "a vertex that only triangles without area use lies");
    size_t length = strlen(text);
    snprintf(text + length, STRAY_TEXT_BYTES - length, " %.3g m from the rest of the asset%s at %.7g, %.7g, %.7g (node '%.80s')",
             farthest.away_m, stray > 0 ? ", the farthest" : "", farthest.at_m[0], farthest.at_m[1], farthest.at_m[2],
             name_of(model, farthest.node));
    utf8_drop_invalid(text); /* the shortened name may end inside a character, which JSON does not allow */
}
