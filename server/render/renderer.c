/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a view and the field to a frame: the order of the passes. */
#include "render/renderer.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "gpu/mesh.h"
#include "render/plan/content_hash.h"
#include "render/plan/lod_selection.h"
#include "render/gl/frame_uniforms.h"
#include "render/matrix.h"
#include "render/pick/measure_target.h"
#include "render/renderer_impl.h"
#include "render/render_job.h"

static const int64_t QUICK_NS = 12 * NS_PER_MS; /* a still picture that a GPU draws in less is drawn as moving ones are */
/* Of pictures of so many triangles what is hidden is left out: half a millisecond of a slow GPU's. On a processor boxes cost more than they
   save. */
enum { LEAST_HIDING = 250000 };
/* Expected of GL on a processor before anything was measured. */
static const double FIRST_PIXEL_NS[PASSES] = { 200, 20 };

static struct light_key wanted_light(const struct view *view)
{
    struct light_key key = { .environment = view->environment, .shown = view->visibility };
    memcpy(key.towards, view->light_dir, sizeof(key.towards));
    return key;
}

struct light_key renderer_usual_light(const struct renderer *renderer)
{
    struct view view;
    view_default(renderer->scene, 16, 16, &view);
    return wanted_light(&view);
}

struct renderer *renderer_create(struct log *log, struct gl *gl, const struct scene *scene, struct field *field)
{
    struct renderer *renderer = mem_new(sizeof(*renderer));
    renderer->gl = gl;
    renderer->scene = scene;
    memcpy(renderer->pixel_ns, FIRST_PIXEL_NS, sizeof(renderer->pixel_ns));
    renderer->asset_fields = mem_array(scene->asset_count, sizeof(*renderer->asset_fields));
    renderer->visible = mem_array(scene->asset_count, sizeof(*renderer->visible));
    renderer->distance_m = mem_array(scene->asset_count, sizeof(*renderer->distance_m));
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
        renderer->draft = draft_create(field_workers(field), &renderer->gpu_scene, &renderer->sky);
    if (renderer->draft)
        renderer->plates =
            plates_create(field_workers(field), &renderer->gpu_scene, &renderer->sky, renderer->draft, &renderer->environments);
    return renderer;
}

void renderer_destroy(struct renderer **renderer_ptr)
{
    struct renderer *renderer = *renderer_ptr;
    if (!renderer)
        return;
    plates_destroy(&renderer->plates);
    draft_destroy(&renderer->draft);
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
    mem_free(renderer->asset_fields);
    mem_free(renderer->visible);
    mem_free(renderer->distance_m);
    mem_free(renderer);
    *renderer_ptr = NULL;
}

/* The camera's matrices, with depth turned round: 32-bit floats are finest near 0, and most of the scene lies far away. */
static void aim(struct renderer *renderer, const struct view *view, struct view_constants *constants)
{
    static const double reverse[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -0.5, 0, 0, 0, 0.5, 1 };
    double rotation[16], projection[16];
    double aspect = (double)view->width_px / view->height_px;
    camera_matrices(&view->camera, aspect, renderer->scene->bounds_min_m, renderer->scene->bounds_max_m, rotation, projection);
    double back[3] = { rotation[2], rotation[6], rotation[10] }, depth_m = -2 / projection[10];
    rotation[12] = rotation[13] = rotation[14] = 0;
    matrix_multiply(projection, rotation, projection);
    matrix_multiply(reverse, projection, projection);
    view_constants_init(constants, view->camera.eye_m, projection, view->height_px / (2 * tan(view->camera.fov_deg * M_PI / 360)));
    if (view->camera.height_m > 0) {
        constants->pixel_per_metre = view->height_px / view->camera.height_m;
        constants->depth_scale = depth_m / camera_parallel_m(&view->camera);
        memcpy(constants->back, back, sizeof(back));
    }
}

static int by_distance(const void *a, const void *b, void *distance_m)
{
    const double *d = distance_m;
    double first = d[*(const int *)a], second = d[*(const int *)b];
    return (first > second) - (first < second);
}

/* Drawn as it is, some of it at least. */
static bool is_left(const struct visibility *visibility, int index, const struct scene_asset *asset)
{
    return visibility_of(visibility, index) == ASSET_SHOWN && !clip_drops(&visibility->clip, asset->bounds_min_m, asset->bounds_max_m);
}

/* Assets in the frustum, nearest first, so that what is hidden costs little. */
static void find_visible(struct renderer *renderer, struct frame_context *context)
{
    for (size_t i = 0; i < renderer->scene->asset_count; i++) {
        const struct scene_asset *asset = &renderer->scene->assets[i];
        double square = 0;
        if (!view_constants_sees(&context->constants, asset) || !is_left(&context->view->visibility, (int)i, asset))
            continue;
        for (int c = 0; c < 3; c++) {
            double by = fmax(fabs(asset->bounds_min_m[c] - context->constants.eye_m[c]),
                             fabs(asset->bounds_max_m[c] - context->constants.eye_m[c]));
            square += by * by;
        }
        renderer->distance_m[i] = sqrt(square);
        renderer->visible[context->visible_count++] = (int)i;
    }
    qsort_r(renderer->visible, context->visible_count, sizeof(*renderer->visible), by_distance, renderer->distance_m);
    context->visible = renderer->visible;
}

/* What the picture shows. */
static struct light_key choose_light(struct renderer *renderer, const struct view *view)
{
    struct light_key key = wanted_light(view);
    const struct light_set *near = view->tier == TIER_PREVIEW && renderer->bake_budget_ns ? light_near(&renderer->light, &key) : NULL;
    return near ? near->key : key;
}

/* What there is to draw, but for the field. */
static void look(struct renderer *renderer, struct frame_context *context, const struct view *view)
{
    *context = (struct frame_context){ .gpu_scene = &renderer->gpu_scene,
                                       .view = view,
                                       .field = renderer->fields.field,
                                       .fields = renderer->asset_fields,
                                       .reference = renderer->per_fragment ? &renderer->reference : NULL };
    context->lit_by = choose_light(renderer, view);
    aim(renderer, view, &context->constants);
    find_visible(renderer, context);
    context->error_px = lod_error_px(context);
}

/* So many of the first vertices are drawn, or looked at for labels. */
static size_t count_vertices(const struct frame_context *context, int asset)
{
    double lines[VIEW_ALL_LINES];
    size_t count = surface_pass_level(context, asset)->vertex_count;
    size_t labels = view_lines(context->view, lines) > 0 ? isolines_vertex_count(&context->gpu_scene->scene->assets[asset]) : 0;
    return count > labels ? count : labels;
}

/* With the field brought up to date. */
static void picture_init(struct renderer *renderer, struct frame_context *context, const struct view *view, const struct snapshot *snapshot,
                         bool finest)
{
    look(renderer, context, view);
    if (finest)
        context->error_px = 0;
    fields_trim(&renderer->fields);
    memset(renderer->asset_fields, 0, renderer->scene->asset_count * sizeof(*renderer->asset_fields));
    struct scale scale;
    view_scale(view, &scale);
    if (view->look == LOOK_MATERIALS)
        return;
    size_t *counts = mem_array(context->visible_count, sizeof(*counts));
    for (size_t i = 0; i < context->visible_count; i++)
        counts[i] = count_vertices(context, renderer->visible[i]);
    fields_get(&renderer->fields,
               &(struct fields_ask){ .assets = renderer->visible,
                                     .counts = counts,
                                     .asset_count = context->visible_count,
                                     .params = &view->field,
                                     .step = scale_step(&scale),
                                     .snapshot = snapshot },
               renderer->asset_fields);
    mem_free(counts);
}

bool renderer_prepare(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot, int64_t budget_ns)
{
    static const double slice = 1e6;
    struct frame_context context;
    int64_t end_ns = clock_mono_ns() + budget_ns;
    look(renderer, &context, view);
    for (size_t i = 0; i < context.visible_count && view->look != LOOK_MATERIALS; i++) {
        int asset = renderer->visible[i];
        size_t count = count_vertices(&context, asset);
        while (!field_advance(renderer->fields.field, asset, &view->field, snapshot, count, slice))
            if (clock_mono_ns() >= end_ns)
                return false;
    }
    return true;
}

uint64_t renderer_content(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    struct frame_context context;
    renderer->fields.without_gl = true;
    picture_init(renderer, &context, view, snapshot, false);
    renderer->fields.without_gl = false;
    return content_hash(&context);
}

static void describe(const struct renderer *renderer, struct frame *frame, const struct frame_context *context,
                     const struct snapshot *snapshot)
{
    frame->view = *context->view;
    frame->data_utc_ns = snapshot->taken_utc_ns;
    frame->oldest_age_ns = INT64_MAX;
    for (size_t i = 0; i < context->visible_count; i++) {
        const struct fields_entry *field = context->fields[context->visible[i]];
        if (!field || field->oldest_age_ns == INT64_MAX)
            continue;
        if (frame->oldest_age_ns == INT64_MAX || field->oldest_age_ns > frame->oldest_age_ns)
            frame->oldest_age_ns = field->oldest_age_ns;
    }
    field_baseline(renderer->fields.field, &context->view->field, &frame->baseline);
    frame->content = content_hash(context);
    frame->triangles = surface_pass_triangles(context);
}

struct frame *renderer_start(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot,
                             struct frame_context *context)
{
    struct frame *frame = frame_create(view->width_px, view->height_px);
    if (!frame) {
        log_err(renderer->gl->log, "frame of %dx%d: out of memory", view->width_px, view->height_px);
        return NULL;
    }
    int64_t start_ns = clock_mono_ns();
    picture_init(renderer, context, view, snapshot, false);
    frame->field_ns = clock_mono_ns() - start_ns;
    describe(renderer, frame, context, snapshot);
    return frame;
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

static struct frame *draw_draft(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    struct frame_context context;
    renderer->fields.without_gl = true;
    struct frame *frame = renderer_start(renderer, view, snapshot, &context);
    renderer->fields.without_gl = false;
    if (frame && has_lost(&context)) { /* only GL hatches without scalars */
        frame_unref(&frame);
        return renderer_draw_job(renderer, view, snapshot);
    }
    if (!frame)
        return NULL;
    int64_t start_ns = clock_mono_ns();
    context.light = light_get(&renderer->light, &context.lit_by);
    context.colormap = shaded_colormap_cache_get(&renderer->colormaps, view);
    if (!context.light || !context.colormap.colors || !draft_draw(renderer->draft, &context, &renderer->light, &renderer->isolines, frame))
        frame_unref(&frame);
    else
        frame->render_ns = clock_mono_ns() - start_ns;
    return frame;
}

bool renderer_is_quick(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    struct frame_context context;
    if (view->tier == TIER_PREVIEW || !renderer->plates || renderer->always_gl)
        return view->tier == TIER_PREVIEW || (renderer->refined_ns > 0 && renderer->refined_ns <= QUICK_NS);
    renderer->fields.without_gl = true;
    picture_init(renderer, &context, view, snapshot, false);
    renderer->fields.without_gl = false;
    return plates_know(renderer->plates, &context);
}

/* A still picture that was drawn before and differs in values and colours only. NULL: there is none. */
static struct frame *draw_again(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    struct frame_context context;
    if (!renderer->plates || !renderer_is_quick(renderer, view, snapshot))
        return NULL;
    renderer->fields.without_gl = true;
    struct frame *frame = renderer_start(renderer, view, snapshot, &context);
    renderer->fields.without_gl = false;
    if (!frame)
        return NULL;
    int64_t start_ns = clock_mono_ns();
    context.light = light_get(&renderer->light, &context.lit_by);
    context.colormap = shaded_colormap_cache_get(&renderer->colormaps, view);
    struct isoline_points points = { 0 };
    isolines_collect(&renderer->isolines, &context, &points);
    if (!context.light || !context.colormap.colors || !plates_recolor(renderer->plates, &context, &points, frame))
        frame_unref(&frame);
    else
        frame->render_ns = clock_mono_ns() - start_ns;
    mem_free(points.at);
    return frame;
}

/* After a picture: works on the light that it should have had. */
static void bake_wanted_light(struct renderer *renderer, const struct view *view)
{
    struct light_key wanted = wanted_light(view);
    bool steady = visibility_equal(&wanted.shown, &renderer->shown); /* not at each place of a cut that somebody drags */
    if (renderer->bake_budget_ns && steady)
        light_step(&renderer->light, &wanted, renderer->bake_budget_ns);
    renderer->shown = view->visibility;
}

struct frame *renderer_draw(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    bool draft = renderer->draft && !renderer->always_gl && !renderer->per_fragment && draft_can(renderer->draft, view);
    struct frame *frame = view->tier == TIER_REFINED ? draw_again(renderer, view, snapshot) : NULL;
    if (!frame)
        frame = draft ? draw_draft(renderer, view, snapshot) : renderer_draw_job(renderer, view, snapshot);
    if (frame)
        bake_wanted_light(renderer, view);
    return frame;
}

bool renderer_submits(const struct renderer *renderer)
{
    return (!renderer->gl->software || renderer->always_gl) && !renderer->per_fragment;
}

struct render_job *renderer_submit(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    struct render_job *job = renderer_submit_job(renderer, view, snapshot);
    if (job)
        bake_wanted_light(renderer, view);
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
    renderer->per_fragment = per_fragment;
    renderer->fields.reference = per_fragment ? &renderer->reference : NULL;
}

bool renderer_measure(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot, bool finest, float (*out)[4])
{
    struct view plain = *view;
    struct frame_context context;
    struct measure_target measure = { 0 };
    plain.color_scale.log = false;
    picture_init(renderer, &context, &plain, snapshot, finest);
    context.measured = true;
    bool good = renderer_take_up(renderer, &context) && measure_target_begin(&measure, renderer->gl->log, view->width_px, view->height_px);
    if (good) {
        surface_pass_draw(&renderer->surface_pass, &context);
        measure_target_read(&measure, out);
    }
    measure_target_finish(&measure);
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
