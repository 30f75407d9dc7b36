/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a view and the field to a frame: the order of the passes. */
#include "render/renderer.h"

#include <limits.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "gpu/mesh.h"
#include "render/plan/content_hash.h"
#include "render/plan/frame_planner.h"
#include "render/gl/frame_uniforms.h"
#include "render/renderer_compare.h"
#include "render/renderer_impl.h"
#include "render/render_job.h"

static const int64_t QUICK_NS = 12 * NS_PER_MS; /* a still picture that a GPU draws in less is drawn as moving ones are */
/* Of pictures of so many triangles what is hidden is left out: half a millisecond of a slow GPU's. On a processor boxes cost more than they
   save. */
enum { LEAST_HIDING = 250000 };
/* Expected of GL on a processor before anything was measured. */
static const double FIRST_PIXEL_NS[PASSES] = { 200, 20 };

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
    memcpy(renderer->pixel_ns, FIRST_PIXEL_NS, sizeof(renderer->pixel_ns));
    renderer->planner = (struct frame_planner){ .gpu_scene = &renderer->gpu_scene, .fields = &renderer->fields, .light = &renderer->light };
    fields_init(&renderer->fields, log, field);
    isolines_init(&renderer->isolines, scene->asset_count);
    renderer->frame_buffer = mesh_buffer(log, "frame block", sizeof(struct frame_uniforms), NULL, GL_DYNAMIC_STORAGE_BIT);
    if (!renderer->frame_buffer || !environments_init(&renderer->environments, gl, scene->plant, field_workers(field))) {
        renderer_destroy(&renderer);
        return NULL;
    }
    environments_bind(&renderer->environments, 0);
    if (!gpu_scene_init(&renderer->gpu_scene, gl, scene) || !light_init(&renderer->light, &renderer->gpu_scene, &renderer->environments) ||
        !surface_pass_init(&renderer->surface_pass, log) || !sky_init(&renderer->sky, log) || !lines_init(&renderer->lines, log) ||
        !ghosts_init(&renderer->ghosts, log) || !section_caps_init(&renderer->section_caps, log) ||
        !frames_in_flight_init(&renderer->frames_in_flight, log)) {
        renderer_destroy(&renderer);
        return NULL;
    }
    renderer->surface_pass.least_hiding = gl->software ? INT_MAX : LEAST_HIDING;
    if (gl->software)
        renderer->soft = soft_create(field_workers(field), &renderer->gpu_scene, &renderer->sky);
    if (renderer->soft)
        renderer->refiner =
            refiner_create(field_workers(field), &renderer->gpu_scene, &renderer->sky, renderer->soft, &renderer->environments);
    return renderer;
}

void renderer_destroy(struct renderer **renderer_ptr)
{
    struct renderer *renderer = *renderer_ptr;
    if (!renderer)
        return;
    refiner_destroy(&renderer->refiner);
    soft_destroy(&renderer->soft);
    targets_finish(&renderer->targets);
    shaded_colormap_cache_finish(&renderer->colormaps);
    glDeleteBuffers(1, &renderer->frame_buffer);
    frames_in_flight_finish(&renderer->frames_in_flight);
    isolines_finish(&renderer->isolines);
    ghosts_finish(&renderer->ghosts);
    section_caps_finish(&renderer->section_caps);
    lines_finish(&renderer->lines);
    sky_finish(&renderer->sky);
    surface_pass_finish(&renderer->surface_pass);
    reference_finish(&renderer->reference);
    fields_finish(&renderer->fields);
    light_finish(&renderer->light);
    environments_finish(&renderer->environments);
    gpu_scene_finish(&renderer->gpu_scene);
    mem_free(renderer);
    *renderer_ptr = NULL;
}

const struct frame_planner *renderer_planner(const struct renderer *renderer)
{
    return &renderer->planner;
}

/* What every pass is handed, but for light, colour map and target. It points into the plan, which must outlive it. */
static void init_context(struct renderer *renderer, const struct frame_plan *plan, struct frame_context *context)
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
                                       .shape = plan->shape };
}

static int64_t oldest_age_of(const struct frame_context *context)
{
    int64_t oldest_ns = INT64_MAX;
    for (size_t i = 0; i < context->visible_count; i++) {
        const struct fields_entry *field = context->fields[context->visible[i]];
        if (field && field->oldest_age_ns != INT64_MAX && (oldest_ns == INT64_MAX || field->oldest_age_ns > oldest_ns))
            oldest_ns = field->oldest_age_ns;
    }
    return oldest_ns;
}

struct frame *renderer_start(struct renderer *renderer, const struct frame_plan *plan, struct frame_context *context)
{
    const struct view *view = &plan->view;
    struct frame *frame = frame_create(view->width_px, view->height_px);
    if (!frame) {
        log_err(renderer->gl->log, "frame of %dx%d: out of memory", view->width_px, view->height_px);
        return NULL;
    }
    init_context(renderer, plan, context);
    frame->view = *view;
    frame->data_utc_ns = plan->data_utc_ns;
    frame->oldest_age_ns = oldest_age_of(context);
    frame->content = plan->content;
    frame->field_ns = plan->field_ns;
    frame->triangles = frame_triangles(context);
    field_baseline(renderer->fields.field, &view->field, &frame->baseline);
    return frame;
}

void renderer_upload_fields(struct renderer *renderer, const struct frame_plan *plan, const struct frame_context *context,
                            struct frame *frame)
{
    struct frame_plan shown = *plan;
    if (fields_upload(&renderer->fields, context->visible, context->visible_count, context->fields))
        return;
    shown.fields = context->fields;
    frame->content = content_hash(&shown);
    frame->oldest_age_ns = oldest_age_of(context);
}

bool renderer_take_up(struct renderer *renderer, struct frame_context *context)
{
    struct frame_uniforms block;
    if (!context->light)
        context->light = light_get(&renderer->light, &context->lit_by);
    context->colormap = shaded_colormap_cache_get(&renderer->colormaps, context->view);
    if (!context->light || !context->colormap.colors)
        return false;
    environments_bind(&renderer->environments, context->lit_by.environment);
    frame_uniforms_fill(&block, context);
    glNamedBufferSubData(renderer->frame_buffer, 0, sizeof(block), &block);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, renderer->frame_buffer);
    glViewport(0, 0, context->view->width_px, context->view->height_px);
    return true;
}

/* --- at once ---------------------------------------------------------------------------------------------------------------- */

/* Fields that there was no memory for. */
static bool has_lost(const struct frame_context *context)
{
    for (size_t i = 0; i < context->visible_count; i++)
        if (context->fields[context->visible[i]] && !context->fields[context->visible[i]]->slice)
            return true;
    return false;
}

static struct frame *draw_preview(struct renderer *renderer, const struct frame_plan *plan)
{
    struct frame_context context;
    struct frame *frame = renderer_start(renderer, plan, &context);
    if (frame && has_lost(&context)) { /* only GL hatches without scalars */
        frame_unref(&frame);
        return renderer_draw_job(renderer, plan);
    }
    if (!frame)
        return NULL;
    int64_t start_ns = clock_mono_ns();
    context.light = light_get(&renderer->light, &context.lit_by);
    context.colormap = shaded_colormap_cache_get(&renderer->colormaps, context.view);
    if (!context.light || !context.colormap.colors || !preview_draw(renderer->soft, &context, &renderer->light, &renderer->isolines, frame))
        frame_unref(&frame);
    else
        frame->render_ns = clock_mono_ns() - start_ns;
    return frame;
}

bool renderer_is_quick(struct renderer *renderer, const struct frame_plan *plan)
{
    struct frame_context context;
    if (plan->view.tier == TIER_PREVIEW || !renderer->refiner || renderer->always_gl)
        return plan->view.tier == TIER_PREVIEW || (renderer->refined_ns > 0 && renderer->refined_ns <= QUICK_NS);
    init_context(renderer, plan, &context);
    return refiner_know(renderer->refiner, &context);
}

/* A refined frame that was drawn before and differs in values and colours only. NULL: there is none. */
static struct frame *draw_again(struct renderer *renderer, const struct frame_plan *plan)
{
    struct frame_context context;
    struct frame *frame = renderer->refiner && renderer_is_quick(renderer, plan) ? renderer_start(renderer, plan, &context) : NULL;
    if (!frame)
        return NULL;
    int64_t start_ns = clock_mono_ns();
    context.light = light_get(&renderer->light, &context.lit_by);
    context.colormap = shaded_colormap_cache_get(&renderer->colormaps, context.view);
    struct isoline_points points = { 0 };
    isolines_collect(&renderer->isolines, &context, &points);
    if (!context.light || !context.colormap.colors || !refiner_resolve_again(renderer->refiner, &context, &points, frame))
        frame_unref(&frame);
    else
        frame->render_ns = clock_mono_ns() - start_ns;
    mem_free(points.at);
    return frame;
}

/* After a picture: works on the light that it should have had. */
static void bake_wanted_light(struct renderer *renderer, const struct view *view)
{
    struct light_key wanted = frame_plan_wanted_light(view);
    bool steady = visibility_equal(&wanted.shown, &renderer->shown); /* not at each place of a cut that somebody drags */
    if (renderer->bake_budget_ns && steady)
        light_step(&renderer->light, &wanted, renderer->bake_budget_ns);
    renderer->shown = view->visibility;
}

struct frame *renderer_draw(struct renderer *renderer, const struct frame_plan *plan)
{
    bool soft = renderer->soft && !renderer->always_gl && !renderer->per_fragment && preview_can(renderer->soft, &plan->view);
    struct frame *frame = plan->view.tier == TIER_REFINED ? draw_again(renderer, plan) : NULL;
    if (!frame)
        frame = soft ? draw_preview(renderer, plan) : renderer_draw_job(renderer, plan);
    if (frame)
        bake_wanted_light(renderer, &plan->view);
    return frame;
}

bool renderer_submits(const struct renderer *renderer)
{
    return (!renderer->gl->software || renderer->always_gl) && !renderer->per_fragment;
}

struct render_job *renderer_submit(struct renderer *renderer, const struct frame_plan *plan)
{
    struct render_job *job = renderer_submit_job(renderer, plan);
    if (job)
        bake_wanted_light(renderer, &plan->view);
    return job;
}

bool renderer_is_complete(const struct render_job *job)
{
    return readback_is_done(&job->in_flight->readback);
}

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

/* --- numbers --------------------------------------------------------------------------------------------------------------- */

void renderer_set_per_fragment(struct renderer *renderer, bool per_fragment)
{
    if (per_fragment && !renderer->reference.models)
        reference_init(&renderer->reference, &renderer->gpu_scene, renderer->fields.field);
    renderer->per_fragment = renderer->planner.finest = per_fragment;
    renderer->fields.reference = per_fragment ? &renderer->reference : NULL;
}

bool renderer_measure(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot, bool finest, float (*out)[4])
{
    struct frame_planner planner = renderer->planner;
    struct view plain = *view;
    struct frame_context context;
    struct measure_target measure = { 0 };
    plain.color_scale.log = false;
    planner.finest = finest;
    struct frame_plan *plan = frame_plan_create(&planner, &plain);
    frame_plan_complete(plan, &planner, snapshot);
    fields_upload(&renderer->fields, plan->visible, plan->visible_count, plan->fields);
    init_context(renderer, plan, &context);
    context.measured = true;
    bool good = renderer_take_up(renderer, &context) && measure_target_begin(&measure, renderer->gl->log, view->width_px, view->height_px);
    if (good) {
        surface_pass_draw(&renderer->surface_pass, &context);
        measure_target_read(&measure, out);
    }
    measure_target_finish(&measure);
    frame_plan_destroy(&plan);
    return good;
}

void renderer_use_gl(struct renderer *renderer, bool always)
{
    renderer->always_gl = always;
}

void renderer_set_occlusion_least(struct renderer *renderer, int least_triangles)
{
    renderer->surface_pass.least_hiding = least_triangles;
}

void renderer_set_batching_off(struct renderer *renderer, bool one_by_one)
{
    renderer->surface_pass.one_by_one = one_by_one;
}

size_t renderer_occluded_count(const struct renderer *renderer)
{
    return occlusion_count(&renderer->surface_pass.occlusion, &renderer->surface_pass.opaque);
}
