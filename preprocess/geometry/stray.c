/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds stray triangles of an asset and the node that they came from. */
#include "preprocess/geometry/stray.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/math/gap_split.h"
#include "base/mem.h"

static struct gap_tri *triangles_of(const struct geometry *geometry)
{
    size_t count = geometry->index_count / 3;
    struct gap_tri *tris = mem_array(count, sizeof(*tris));
    for (size_t t = 0; t < count; t++) {
        double normal[3];
        for (size_t k = 0; k < 3; k++)
            for (int axis = 0; axis < 3; axis++)
                tris[t].at[k][axis] = (double)geometry->positions_m[geometry->indices[3 * t + k]][axis] + geometry->origin_m[axis];
        vec_normal(tris[t].at[0], tris[t].at[1], tris[t].at[2], normal);
        tris[t].area_m2 = 0.5 * vec_length(normal);
    }
    return tris;
}

static double away_from(const struct extent *main, const double place_m[3])
{
    double away_m[3];
    for (int axis = 0; axis < 3; axis++)
        away_m[axis] = fmax(fmax(main->low[axis] - place_m[axis], place_m[axis] - main->high[axis]), 0);
    return vec_length(away_m);
}

/* Returns the name of the smallest node whose box, grown by the rounding of floats, holds the place; "": no such node has a name. */
static const char *node_at(const struct gltf_model *model, const struct geometry_params *params, const double place_m[3],
                           double rim_m)
{
    double(*boxes)[2][3] = geometry_node_boxes(model, params);
    const char *name = "";
    double least_m = INFINITY;
    for (uint32_t i = 0; i < model->node_count; i++) {
        bool holds = true;
        for (int axis = 0; axis < 3; axis++)
            holds = holds && place_m[axis] >= boxes[i][0][axis] - rim_m && place_m[axis] <= boxes[i][1][axis] + rim_m;
        double size_m = vec_distance(boxes[i][0], boxes[i][1]);
        if (holds && size_m <= least_m && model->nodes[i].name[0]) {
            least_m = size_m;
            name = model->nodes[i].name;
        }
    }
    mem_free(boxes);
    return name;
}

void stray_text(const struct geometry *geometry, const struct gltf_model *model, const struct geometry_params *params,
                char text[STRAY_TEXT_BYTES])
{
    struct gap_tri *tris = triangles_of(geometry);
    struct extent main = extent_empty();
    size_t count = geometry->index_count / 3, kept = gap_split(tris, count, &main);
    double most_m = 0, at_m[3] = { 0 };
    for (size_t t = kept; t < count; t++)
        for (int k = 0; k < 3; k++)
            if (away_from(&main, tris[t].at[k]) > most_m) {
                most_m = away_from(&main, tris[t].at[k]);
                memcpy(at_m, tris[t].at[k], sizeof(at_m));
            }
    text[0] = 0;
    if (most_m > 0)
        snprintf(text, STRAY_TEXT_BYTES,
                 "%zu of its triangles lie up to %.3g m from the rest, the farthest at %.7g, %.7g, %.7g (node '%.80s')", count - kept,
                 most_m, at_m[0], at_m[1], at_m[2], node_at(model, params, at_m, 1e-6 * most_m));
    mem_free(tris);
}
