/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a view and the field to a frame: the order of the passes. */
#include "render/renderer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "gpu/readback.h"
#include "render/content.h"
#include "render/frame_block.h"
#include "render/lines.h"
#include "render/markers.h"
#include "render/matrix.h"
#include "render/palette.h"
#include "render/sky.h"
#include "render/solid.h"

enum { TARGETS = 6, STILL_SAMPLES = 4 };

struct renderer {
    struct gl *gl;
    const struct scene *scene;
    struct stage stage;
    struct light light;
    struct fields fields;
    struct solid solid;
    struct sky sky;
    struct lines lines;
    struct markers markers;
    struct readback readback;
    GLuint frame_buffer;                      /* struct frame_block */
    GLuint *palettes;                         /* by colour map; 0: not made yet */
    struct target targets[TARGETS];           /* least recently used last; width 0: empty */
    const struct fields_entry **asset_fields; /* per asset, of the picture being drawn */
    int *visible;
    double *distance_m; /* per asset */
};

/* Bakes the light that most views have, so that the first picture does not wait for it. */
static bool bake_default_light(struct renderer *renderer)
{
    struct view view;
    view_default(renderer->scene, 16, 16, &view);
    return light_get(&renderer->light, view.light_dir) != NULL;
}

struct renderer *renderer_create(struct log *log, struct gl *gl, const struct scene *scene, struct field *field)
{
    struct renderer *renderer = mem_new(sizeof(*renderer));
    renderer->gl = gl;
    renderer->scene = scene;
    renderer->palettes = mem_array(colormap_count(), sizeof(*renderer->palettes));
    renderer->asset_fields = mem_array(scene->asset_count, sizeof(*renderer->asset_fields));
    renderer->visible = mem_array(scene->asset_count, sizeof(*renderer->visible));
    renderer->distance_m = mem_array(scene->asset_count, sizeof(*renderer->distance_m));
    fields_init(&renderer->fields, log, field);
    renderer->frame_buffer = mesh_buffer(log, "frame block", sizeof(struct frame_block), NULL, GL_DYNAMIC_STORAGE_BIT);
    if (!renderer->frame_buffer || !stage_init(&renderer->stage, gl, scene) || !light_init(&renderer->light, &renderer->stage) ||
        !solid_init(&renderer->solid, log) || !sky_init(&renderer->sky, log) || !lines_init(&renderer->lines, log) ||
        !markers_init(&renderer->markers, log) || !bake_default_light(renderer))
        renderer_destroy(&renderer);
    return renderer;
}

void renderer_destroy(struct renderer **renderer_ptr)
{
    struct renderer *renderer = *renderer_ptr;
    if (!renderer)
        return;
    for (int i = 0; i < TARGETS; i++)
        if (renderer->targets[i].width_px)
            target_finish(&renderer->targets[i]);
    glDeleteTextures((GLsizei)colormap_count(), renderer->palettes);
    glDeleteBuffers(1, &renderer->frame_buffer);
    readback_finish(&renderer->readback);
    markers_finish(&renderer->markers);
    lines_finish(&renderer->lines);
    sky_finish(&renderer->sky);
    solid_finish(&renderer->solid);
    fields_finish(&renderer->fields);
    light_finish(&renderer->light);
    stage_finish(&renderer->stage);
    mem_free(renderer->palettes);
    mem_free(renderer->asset_fields);
    mem_free(renderer->visible);
    mem_free(renderer->distance_m);
    mem_free(renderer);
    *renderer_ptr = NULL;
}

/* The camera's matrices, with depth turned round: 32-bit floats are finest near 0, and most of the scene lies far away. */
static void aim(struct renderer *renderer, const struct view *view, struct shot *shot)
{
    static const double reverse[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -0.5, 0, 0, 0, 0.5, 1 };
    double rotation[16], projection[16];
    double aspect = (double)view->width_px / view->height_px;
    camera_matrices(&view->camera, aspect, renderer->scene->bounds_min_m, renderer->scene->bounds_max_m, rotation, projection);
    rotation[12] = rotation[13] = rotation[14] = 0;
    matrix_multiply(projection, rotation, projection);
    matrix_multiply(reverse, projection, projection);
    shot_init(shot, view->camera.eye_m, projection, view->height_px / (2 * tan(view->camera.fov_deg * M_PI / 360)));
}

static int by_distance(const void *a, const void *b, void *distance_m)
{
    const double *d = distance_m;
    double first = d[*(const int *)a], second = d[*(const int *)b];
    return (first > second) - (first < second);
}

/* Assets in the frustum, nearest first, so that what is hidden costs little. */
static void find_visible(struct renderer *renderer, struct picture *picture)
{
    for (size_t i = 0; i < renderer->scene->asset_count; i++) {
        const struct scene_asset *asset = &renderer->scene->assets[i];
        double square = 0;
        if (!shot_sees(&picture->shot, asset))
            continue;
        for (int c = 0; c < 3; c++) {
            double by = 0.5 * (asset->bounds_min_m[c] + asset->bounds_max_m[c]) - picture->shot.eye_m[c];
            square += by * by;
        }
        renderer->distance_m[i] = sqrt(square);
        renderer->visible[picture->visible_count++] = (int)i;
    }
    qsort_r(renderer->visible, picture->visible_count, sizeof(*renderer->visible), by_distance, renderer->distance_m);
    picture->visible = renderer->visible;
}

/* What there is to draw, with the field brought up to date. */
static void picture_init(struct renderer *renderer, struct picture *picture, const struct view *view, const struct snapshot *snapshot)
{
    *picture = (struct picture){ .stage = &renderer->stage, .view = view, .fields = renderer->asset_fields };
    aim(renderer, view, &picture->shot);
    find_visible(renderer, picture);
    fields_trim(&renderer->fields);
    memset(renderer->asset_fields, 0, renderer->scene->asset_count * sizeof(*renderer->asset_fields));
    for (size_t i = 0; i < picture->visible_count; i++) {
        int asset = renderer->visible[i];
        renderer->asset_fields[asset] = fields_get(&renderer->fields, asset, &view->field, view->range_max - view->range_min, snapshot);
    }
}

uint64_t renderer_content(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    struct picture picture;
    picture_init(renderer, &picture, view, snapshot);
    return content_hash(&picture);
}

static const struct target *get_target(struct renderer *renderer, const struct view *view)
{
    int samples = view->tier == TIER_STILL && renderer->gl->max_samples >= STILL_SAMPLES ? STILL_SAMPLES : 1, found = TARGETS - 1;
    for (int i = 0; i < TARGETS; i++) {
        const struct target *target = &renderer->targets[i];
        if (target->width_px == view->width_px && target->height_px == view->height_px && target->samples == samples)
            found = i;
    }
    struct target target = renderer->targets[found];
    bool known = target.width_px == view->width_px && target.height_px == view->height_px && target.samples == samples;
    if (!known && target.width_px)
        target_finish(&target);
    memmove(&renderer->targets[1], &renderer->targets[0], (size_t)found * sizeof(target));
    renderer->targets[0] = (struct target){ 0 };
    if (!known && !target_init(&target, renderer->gl->log, view->width_px, view->height_px, samples))
        return NULL;
    renderer->targets[0] = target;
    return &renderer->targets[0];
}

static GLuint get_palette(struct renderer *renderer, int colormap)
{
    if (!renderer->palettes[colormap])
        renderer->palettes[colormap] = palette_create(colormap_at((size_t)colormap));
    return renderer->palettes[colormap];
}

static void draw_passes(struct renderer *renderer, struct picture *picture)
{
    struct frame_block block;
    frame_block_fill(&block, picture);
    glNamedBufferSubData(renderer->frame_buffer, 0, sizeof(block), &block);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, renderer->frame_buffer);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, picture->target->framebuffer);
    glViewport(0, 0, picture->target->width_px, picture->target->height_px);
    glClear(GL_DEPTH_BUFFER_BIT);
    solid_draw(&renderer->solid, picture);
    sky_draw(&renderer->sky, picture, &renderer->light);
    target_resolve(picture->target);
    if (picture->view->tier == TIER_STILL)
        lines_draw_edges(&renderer->lines, picture);
    lines_draw_outline(&renderer->lines, picture);
}

static void describe(struct frame *frame, const struct picture *picture, const struct snapshot *snapshot)
{
    frame->view = *picture->view;
    frame->data_utc_ns = snapshot->taken_utc_ns;
    frame->oldest_age_ns = INT64_MAX;
    for (size_t i = 0; i < picture->visible_count; i++) {
        const struct fields_entry *field = picture->fields[picture->visible[i]];
        if (!field || field->oldest_age_ns == INT64_MAX)
            continue;
        if (frame->oldest_age_ns == INT64_MAX || field->oldest_age_ns > frame->oldest_age_ns)
            frame->oldest_age_ns = field->oldest_age_ns;
    }
    frame->content = content_hash(picture);
    frame->triangles = picture->triangles;
}

struct frame *renderer_draw(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    struct picture picture;
    struct frame *frame = frame_create(view->width_px, view->height_px);
    if (!frame) {
        log_err(renderer->gl->log, "frame of %dx%d: out of memory", view->width_px, view->height_px);
        return NULL;
    }
    int64_t start_ns = clock_mono_ns();
    picture_init(renderer, &picture, view, snapshot);
    int64_t field_done_ns = clock_mono_ns();
    picture.light = light_get(&renderer->light, view->light_dir);
    picture.target = get_target(renderer, view);
    picture.palette = get_palette(renderer, view->colormap);
    if (!picture.light || !picture.target)
        goto error;
    draw_passes(renderer, &picture);
    if (!markers_start(&renderer->markers, &picture) || !readback_start(&renderer->readback, renderer->gl->log, picture.target))
        goto error;
    describe(frame, &picture, snapshot);
    if (!readback_wait(&renderer->readback, renderer->gl->log))
        goto error;
    int64_t drawn_ns = clock_mono_ns();
    if (!readback_get(&renderer->readback, renderer->gl->log, frame->bgrx, (size_t)frame->stride_bytes))
        goto error;
    markers_get(&renderer->markers, &picture, frame);
    frame->field_ns = field_done_ns - start_ns;
    frame->render_ns = drawn_ns - field_done_ns;
    frame->readback_ns = clock_mono_ns() - drawn_ns;
    return frame;
error:
    frame_unref(&frame);
    return NULL;
}
