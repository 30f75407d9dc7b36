/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One picture being drawn: what every pass needs to know. Thread: the one of the GL context. */
#ifndef RENDER_FRAME_CONTEXT_H
#define RENDER_FRAME_CONTEXT_H
#include "gpu/target.h"
#include "render/plan/fields.h"
#include "render/light/light.h"
#include "render/shaded_colormap_cache.h"
#include "render/reference/reference.h"
#include "render/view.h"

struct frame_context {
    const struct gpu_scene *gpu_scene;
    const struct view *view;
    struct view_constants constants;
    struct light_key lit_by; /* what it is drawn with: what the view asks for, or the most alike */
    const struct light_set *light;
    const struct target *target;
    struct field *field;
    const struct fields_entry **fields; /* per asset; NULL: context */
    const int *visible;                 /* assets, nearest first */
    size_t visible_count;
    struct shaded_colormap colormap;
    struct reference *reference; /* NULL: the field is interpolated between vertices; else worked out at each fragment */
    double error_px;             /* of levels of detail, at most (render/plan/lod_selection.h); 0: no coarser ones */
    uint64_t shape;              /* content_hash_shape of its plan */
    bool measured;               /* the field's numbers instead of colours, into floats */
};

/* Returns the level of an asset that the frame plan chose. */
const struct model_level *frame_level(const struct frame_context *context, int asset);
/* Returns whether the selected asset is among the visible ones. */
bool frame_shows_selected(const struct frame_context *context);
/* Returns the number of triangles of the planned levels of all visible assets. */
int frame_triangles(const struct frame_context *context);
/* Returns by how much previews move surfaces towards the sun against shadow acne, in depth of the shadow map. */
double frame_sun_slack(const struct frame_context *context);

#endif
