/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The renderer struct. Private to renderer.c, memory.c and the backends. */
#ifndef RENDER_RENDERER_IMPL_H
#define RENDER_RENDERER_IMPL_H
#include "render/light/sky.h"
#include "render/pick/isolines.h"
#include "render/plan/frame_planner.h"
#include "render/renderer.h"
#include "render/shaded_colormap_cache.h"

struct gl_backend; /* render/gl/gl_backend.h */
struct render_job;
struct soft; /* render/soft/soft.h */

struct renderer {
    struct gl *gl;
    const struct scene *scene;
    struct frame_pool *frames; /* pool from which this renderer takes the pixel buffers of its frames */
    struct gpu_scene gpu_scene;
    struct environments environments;
    struct light light;
    struct fields fields;
    struct frame_planner planner;
    struct reference reference;
    bool per_fragment;
    struct sky sky;
    struct isolines isolines;
    struct shaded_colormap_cache colormaps;
    struct gl_backend *by_gl;
    struct soft *by_soft; /* software renderer, used if there is no GPU; NULL: a GPU draws all frames */
    bool always_gl;
    bool gives_depth; /* frames get depth grids */
    int64_t bake_budget_ns;  /* time that each preview spends on baking light, ns; 0: a preview waits until its light is baked */
    /* assets shown in the last frame that was drawn in one call; light is baked only while these stay the same */
    struct visibility shown;
};

/* Fills in a frame context from the plan. Light, colour map and target are set later. The context points into the plan, which must outlive
   it. */
void renderer_init_context(struct renderer *renderer, const struct frame_plan *plan, struct frame_context *context);
/* Uploads the fields of context->fields to the GPU. A field that does not fit is replaced in that array by one that shows no
   data, so the array must belong to the caller. The frame's content hash and age are then updated. */
void renderer_upload_fields(struct renderer *renderer, const struct frame_plan *plan, const struct frame_context *context,
                            struct frame *frame);
/* Sets the context's colour map and, unless it is set already, its light set (baked light). Logs and returns false when out of
   GPU memory. */
bool renderer_find_light(struct renderer *renderer, struct frame_context *context);
/* Sets the light set (baked light) and the colour map of a job; the job holds a reference to the light set. Logs and returns
   false when out of GPU memory. */
bool renderer_light_job(struct renderer *renderer, struct render_job *job);
/* Returns the key of the default light, which most views use. */
struct light_key renderer_usual_light(const struct renderer *renderer);

#endif
