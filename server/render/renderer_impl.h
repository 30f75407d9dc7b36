/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of the renderer share. Private to renderer.c, memory.c and the backends. */
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
    struct soft *by_soft; /* NULL: a GPU draws all */
    bool always_gl;
    int64_t bake_budget_ns;  /* 0: none */
    struct visibility shown; /* by the last frame that was drawn at once */
};

/* Brings the context's fields, which are the caller's own, to the GPU. What there is no room for becomes one of no data there, and the
   frame says so. */
void renderer_upload_fields(struct renderer *renderer, const struct frame_plan *plan, const struct frame_context *context,
                            struct frame *frame);
/* Finds the context's light, unless it has it, and its colour map. Returns false when out of GPU memory, logged. */
bool renderer_find_light(struct renderer *renderer, struct frame_context *context);
/* Likewise for a job, which holds its light from now on. */
bool renderer_light_job(struct renderer *renderer, struct render_job *job);
/* Returns the light that most views have. */
struct light_key renderer_usual_light(const struct renderer *renderer);

#endif
