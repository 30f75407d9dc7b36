/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws frames: turns a frame plan into a frame with one of the render backends. */
#include "render/renderer.h"

#include <math.h>

#include "base/mem.h"
#include "render/frame_pool.h"
#include "render/gl/gl_backend.h"
#include "render/plan/content_hash.h"
#include "render/plan/frame_planner.h"
#include "render/render_job.h"
#include "render/renderer_impl.h"

struct light_key renderer_usual_light(const struct renderer *renderer)
{
    struct view view;
    view_default(renderer->scene, 16, 16, &view);
    return frame_plan_wanted_light(&view);
}

struct renderer *renderer_create(struct log *log, struct gl *gl, const struct scene *scene, struct field *field)
{
    struct renderer *renderer = mem_new(sizeof(*renderer));
    renderer->gl = gl;
    renderer->scene = scene;
    renderer->frames = frame_pool_create();
    renderer->planner = (struct frame_planner){ .gpu_scene = &renderer->gpu_scene, .fields = &renderer->fields, .light = &renderer->light };
    fields_init(&renderer->fields, log, field);
    isolines_init(&renderer->isolines, scene->asset_count);
    bool good = environments_init(&renderer->environments, gl, scene->plant, field_workers(field));
    struct environment_light sky = environments_get(&renderer->environments, 0);
    good = good && gpu_scene_init(&renderer->gpu_scene, gl, scene, &sky) &&
           light_init(&renderer->light, &renderer->gpu_scene, &renderer->environments) && sky_init(&renderer->sky, log) &&
           (gl->software ? render_backend_soft : render_backend_gl).init(renderer);
    if (!good)
        renderer_destroy(&renderer);
    return renderer;
}

void renderer_destroy(struct renderer **renderer_ptr)
{
    struct renderer *renderer = *renderer_ptr;
    if (!renderer)
        return;
    render_backend_soft.finish(renderer);
    render_backend_gl.finish(renderer);
    shaded_colormap_cache_finish(&renderer->colormaps);
    isolines_finish(&renderer->isolines);
    sky_finish(&renderer->sky);
    reference_finish(&renderer->reference);
    fields_finish(&renderer->fields);
    light_finish(&renderer->light);
    environments_finish(&renderer->environments);
    gpu_scene_finish(&renderer->gpu_scene);
    frame_pool_unref(&renderer->frames);
    mem_free(renderer);
    *renderer_ptr = NULL;
}

struct frame_pool *renderer_frames(const struct renderer *renderer)
{
    return renderer->frames;
}

const struct frame_planner *renderer_planner(const struct renderer *renderer)
{
    return &renderer->planner;
}

void renderer_init_context(struct renderer *renderer, const struct frame_plan *plan, struct frame_context *context)
{
    *context = (struct frame_context){ .gpu_scene = &renderer->gpu_scene,
                                       .view = &plan->view,
                                       .constants = plan->constants,
                                       .lit_by = plan->lit_by,
                                       .field = renderer->fields.field,
                                       .fields = plan->fields,
                                       .visible = plan->visible,
                                       .visible_count = plan->visible_count,
                                       .reference = renderer->per_fragment ? &renderer->reference : NULL,
                                       .error_px = plan->error_px,
                                       .gives_depth = renderer->gives_depth,
                                       .shape = plan->shape };
}

/* Returns the largest field error of the visible assets. It is rounded up to 1, 2 or 5 times a power of ten, so that it seldom
   changes while readings do. */
static double drawn_error_of(const struct frame_context *context)
{
    double most = 0;
    for (size_t i = 0; i < context->visible_count; i++) {
        const struct fields_entry *field = context->fields[context->visible[i]];
        most = field ? fmax(most, field->drawn_error) : most;
    }
    if (!(most > 0))
        return 0;
    double unit = pow(10, floor(log10(most))), parts = most / unit;
    return unit * (parts <= 1 ? 1 : parts <= 2 ? 2 : parts <= 5 ? 5 : 10);
}

/* Returns a new frame whose members are set from the plan, except the pixels, which are not drawn yet. NULL: out of memory (logged). */
static struct frame *start_frame(struct renderer *renderer, const struct frame_plan *plan, const struct frame_context *context)
{
    const struct view *view = &plan->view;
    struct frame *frame = frame_create(renderer->frames, view->width_px, view->height_px);
    if (!frame) {
        log_err(renderer->gl->log, "cannot draw a picture of %dx%d: out of memory", view->width_px, view->height_px);
        return NULL;
    }
    frame->view = *view;
    frame->data_utc_ns = plan->data_utc_ns;
    frame->oldest_age_ns = frame_oldest_age_ns(context);
    frame->drawn_error[0] = drawn_error_of(context);
    frame->content = plan->content;
    frame->field_ns = plan->field_ns;
    frame->triangles = frame_triangles(context);
    field_baseline(renderer->fields.field, &view->field, &frame->baseline[0]);
    return frame;
}

static const struct render_backend *choose_backend(const struct renderer *renderer, const struct frame_context *context)
{
    bool soft = renderer->by_soft && !renderer->always_gl && render_backend_soft.can(context);
    return soft ? &render_backend_soft : &render_backend_gl;
}

bool renderer_is_quick(struct renderer *renderer, const struct frame_plan *plan)
{
    struct frame_context context;
    renderer_init_context(renderer, plan, &context);
    const struct render_backend *backend = choose_backend(renderer, &context);
    return backend->init(renderer) && backend->is_quick(renderer, &context);
}

/* --- jobs ------------------------------------------------------------------------------------------------------------------- */

static struct render_job *begin(struct renderer *renderer, const struct frame_plan *plan, bool at_once)
{
    struct frame_context context;
    renderer_init_context(renderer, plan, &context);
    struct frame *frame = start_frame(renderer, plan, &context);
    if (!frame)
        return NULL;
    struct render_job *job = mem_new(sizeof(*job));
    render_job_init(job, &context, frame);
    job->backend = choose_backend(renderer, &context);
    bool good = job->backend->init(renderer) && job->backend->begin(renderer, job, plan, at_once);
    if (good)
        isolines_collect(&renderer->isolines, &job->context, &job->isolines);
    if (!good || (!at_once && !render_job_hold_fields(job, job->backend->draws_from_gpu)))
        renderer_abandon(renderer, &job);
    return job;
}

struct render_job *renderer_begin(struct renderer *renderer, const struct frame_plan *plan)
{
    return begin(renderer, plan, false);
}

bool renderer_keeps(const struct render_job *job)
{
    return job->keeps;
}

bool renderer_step(struct renderer *renderer, struct render_job *job, int64_t budget_ns)
{
    if (!job->light && !light_step(&renderer->light, &job->context.lit_by, budget_ns))
        return false;
    return job->backend->step(renderer, job, budget_ns);
}

struct frame *renderer_end(struct renderer *renderer, struct render_job **job_ptr)
{
    struct render_job *job = *job_ptr;
    struct frame *frame = job->backend->end(renderer, job) ? job->frame : NULL;
    if (frame)
        job->frame = NULL;
    renderer_abandon(renderer, job_ptr);
    return frame;
}

void renderer_abandon(struct renderer *renderer, struct render_job **job_ptr)
{
    struct render_job *job = *job_ptr;
    if (!job)
        return;
    job->backend->abandon(renderer, job);
    render_job_finish(job);
    mem_free(job);
    *job_ptr = NULL;
}

/* Called after each frame: spends some time on baking the light that the view asks for. */
static void bake_wanted_light(struct renderer *renderer, const struct view *view)
{
    struct light_key wanted = frame_plan_wanted_light(view);
    /* false while a user drags a section plane: no light is baked then, because each position needs another light set, which
       would be outdated before it is ready */
    bool steady = visibility_equal(&wanted.shown, &renderer->shown);
    if (renderer->bake_budget_ns && steady)
        light_step(&renderer->light, &wanted, renderer->bake_budget_ns);
    renderer->shown = view->visibility;
}

struct frame *renderer_draw(struct renderer *renderer, const struct frame_plan *plan)
{
    struct render_job *job = begin(renderer, plan, true);
    struct frame *frame = job ? renderer_end(renderer, &job) : NULL;
    if (frame)
        bake_wanted_light(renderer, &plan->view);
    return frame;
}

bool renderer_submits(const struct renderer *renderer)
{
    return (!renderer->by_soft || renderer->always_gl) && !renderer->per_fragment;
}

struct render_job *renderer_submit(struct renderer *renderer, const struct frame_plan *plan)
{
    struct render_job *job = begin(renderer, plan, true);
    if (job && !job->backend->submit(renderer, job))
        renderer_abandon(renderer, &job);
    if (job)
        bake_wanted_light(renderer, &plan->view);
    return job;
}

bool renderer_is_complete(const struct render_job *job)
{
    return job->backend->is_complete(job);
}

/* --- light ------------------------------------------------------------------------------------------------------------------ */

bool renderer_set_bake_budget(struct renderer *renderer, int64_t bake_ns)
{
    struct light_key usual = renderer_usual_light(renderer);
    renderer->bake_budget_ns = bake_ns;
    renderer->planner.near_light = bake_ns > 0;
    usual.rough = true;
    return !bake_ns || light_near(&renderer->light, &usual) || light_get(&renderer->light, &usual);
}

bool renderer_bake_idle(struct renderer *renderer, int64_t budget_ns)
{
    struct light_key usual = renderer_usual_light(renderer);
    return light_step(&renderer->light, &usual, budget_ns);
}

void renderer_set_per_fragment(struct renderer *renderer, bool per_fragment)
{
    if (per_fragment && !renderer->reference.models)
        reference_init(&renderer->reference, &renderer->gpu_scene, renderer->fields.field);
    renderer->per_fragment = renderer->planner.finest = per_fragment;
    renderer->fields.reference = per_fragment ? &renderer->reference : NULL;
}

void renderer_set_depth(struct renderer *renderer, bool gives_depth)
{
    renderer->gives_depth = gives_depth;
}

bool renderer_gives_depth(const struct renderer *renderer)
{
    return renderer->gives_depth;
}

void renderer_use_gl(struct renderer *renderer, bool always)
{
    renderer->always_gl = always;
    if (always)
        render_backend_gl.init(renderer);
}
