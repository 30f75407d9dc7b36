/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of the renderer share. Private to renderer*.c. */
#ifndef RENDER_RENDERER_IMPL_H
#define RENDER_RENDERER_IMPL_H
#include "render/gl/section_caps.h"
#include "render/soft/soft.h"
#include "render/gl/frames_in_flight.h"
#include "render/gl/ghosts.h"
#include "render/pick/isolines.h"
#include "render/light/sky.h"
#include "render/gl/lines.h"
#include "render/pick/markers.h"
#include "render/shaded_colormap_cache.h"
#include "render/plan/frame_planner.h"
#include "render/soft/refined.h"
#include "render/renderer.h"
#include "render/gl/surface_pass.h"
#include "render/gl/targets.h"

enum { SURFACES, EDGES, PASSES }; /* of what GL draws bit by bit */

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
    struct surface_pass surface_pass;
    struct sky sky;
    struct lines lines;
    struct ghosts ghosts;
    struct section_caps section_caps;
    struct isolines isolines;
    struct frames_in_flight frames_in_flight;
    GLuint frame_buffer; /* struct frame_uniforms */
    struct shaded_colormap_cache colormaps;
    struct targets targets;
    double pixel_ns[PASSES]; /* as measured lately */
    int64_t bake_budget_ns;  /* 0: none */
    int64_t refined_ns;      /* what a GPU took for the last still picture; 0: not known */
    struct soft *soft;       /* NULL: a GPU draws moving pictures too; and below */
    struct refiner *refiner; /* still ones */
    bool always_gl;
    struct visibility shown; /* by the last picture that was drawn at once */
};

/* Returns an empty frame with all that the plan says of it, and fills in the context. NULL: out of memory, logged. */
struct frame *renderer_start(struct renderer *renderer, const struct frame_plan *plan, struct frame_context *context);
/* Before GL draws with them: brings the context's fields, which are the caller's own, to the GPU. What there is no room for becomes one of
   no data there, and the frame says so. */
void renderer_upload_fields(struct renderer *renderer, const struct frame_plan *plan, const struct frame_context *context,
                            struct frame *frame);
/* Light, colormap and uniforms of the picture: others drew meanwhile. False: out of GPU memory, logged. */
bool renderer_take_up(struct renderer *renderer, struct frame_context *context);
/* The whole picture at once by the steps of a job. As renderer_draw. */
struct frame *renderer_draw_job(struct renderer *renderer, const struct frame_plan *plan);
/* The light that most views have. */
struct light_key renderer_usual_light(const struct renderer *renderer);
/* As renderer_submit. */
struct render_job *renderer_submit_job(struct renderer *renderer, const struct frame_plan *plan);

#endif
