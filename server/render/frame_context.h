/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frame context: everything that the render passes need to know about the frame being drawn. Call only in the thread that owns the
   GL context. */
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
    /* key of the light set (baked light) that lights this frame: the view's own or, while that is not ready, the most similar one */
    struct light_key lit_by;
    const struct light_set *light;
    const struct target *target;
    struct field *field;
    /* by index of the asset: cache entry with the values of its field (interpolated between sensors); NULL: the asset shows no
       field */
    const struct fields_entry **fields;
    const int *visible;                 /* indices of the visible assets, the nearest asset first */
    size_t visible_count;
    struct shaded_colormap colormap;
    /* reference method, for tests: shaders compute the field at each fragment from all sensors; NULL: the field is interpolated between
       vertices */
    struct reference *reference;
    /* maximum surface error of a level of detail, in pixels of the frame (render/plan/lod_selection.h); 0: finest levels only */
    double error_px;
    uint64_t shape; /* content_hash_shape() of the frame plan: a hash of all that the frame shows except values and colours */
    bool gives_depth; /* true: the frame gets a depth grid, with which clients warp the picture for a moved camera (render/depth_grid.h) */
    bool measured;  /* true: the frame gets the field's values as floats instead of colours */
};

/* Returns the level of detail that the frame plan chose for an asset. */
const struct model_level *frame_level(const struct frame_context *context, int asset);
/* Returns whether view->selected_asset gets an outline: true if it is shown or ghosted, in the frame, and not cut away. */
bool frame_shows_selected(const struct frame_context *context);
/* Returns the number of triangles in the planned levels of detail of all visible assets. */
int frame_triangles(const struct frame_context *context);
/* Returns the age of the oldest reading used by the fields of the visible assets; INT64_MAX: none. */
int64_t frame_oldest_age_ns(const struct frame_context *context);
/* Returns how far previews move surfaces towards the sun to avoid shadow acne, in depth units of the shadow map. */
double frame_sun_slack(const struct frame_context *context);

#endif
