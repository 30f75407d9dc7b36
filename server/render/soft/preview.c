/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The steps of a preview, and what it keeps between pictures. */
#include "render/soft/soft.h"

#include <string.h>

#include "base/mem.h"
#include "render/soft/kernels.h"
#include "render/soft/lanes.h"
#include "render/soft/ramp_rows.h"
#include "render/soft/ramps.h"
#include "render/gl/ghosts.h"
#include "render/pick/markers.h"

static const size_t KEPT_BYTES = (size_t)128 << 20; /* some five pictures of 1920x1080 */

/* The widest ones that this machine has. */
static const struct soft_kernels *choose_kernels(void)
{
#ifdef __x86_64__
    enum simd_level level = simd_level();
    if (level == SIMD_HAS_AVX512)
        return &soft_kernels_widest;
    if (level == SIMD_HAS_AVX2)
        return &soft_kernels_wide;
#endif
    return &soft_kernels_plain;
}

/* Of all models, those that are equal once. */
static void copy_ramps(struct soft *soft)
{
    const struct gpu_scene *gpu_scene = soft->gpu_scene;
    soft->material_of_model = mem_array(gpu_scene->model_count, sizeof(*soft->material_of_model));
    for (size_t m = 0; m < gpu_scene->model_count; m++) {
        soft->material_of_model[m] = (uint32_t)soft->material_count;
        soft->material_count += gpu_scene->models[m].material_count;
    }
    soft->muted_ramps = mem_array(soft->material_count * RAMP_STEPS, sizeof(*soft->muted_ramps));
    soft->own_ramps = mem_array(soft->material_count * RAMP_STEPS, sizeof(*soft->own_ramps));
    for (size_t m = 0; m < gpu_scene->model_count; m++) {
        const struct model *model = &gpu_scene->models[m];
        size_t first = (size_t)soft->material_of_model[m] * RAMP_STEPS, bytes = model->material_count * RAMP_STEPS * sizeof(uint32_t);
        memcpy(soft->muted_ramps + first, model->ramp_texels[MODEL_MUTED], bytes);
        memcpy(soft->own_ramps + first, model->ramp_texels[MODEL_OWN], bytes);
    }
    soft->ramp_of_material = mem_array(soft->material_count, sizeof(*soft->ramp_of_material));
    ramp_rows_pack(soft->muted_ramps, soft->own_ramps, soft->material_count, RAMP_STEPS, MOST_RAMPS, soft->ramp_of_material);
}

struct soft *soft_create(struct workers *workers, const struct gpu_scene *gpu_scene, const struct sky *sky, struct soft *keeper)
{
    struct soft *soft = mem_new(sizeof(*soft));
    soft->workers = workers;
    soft->keeper = keeper ? keeper : soft;
    soft->kernels = choose_kernels();
    soft->gpu_scene = gpu_scene;
    soft->kept.bound_bytes = KEPT_BYTES;
    soft->parts = mem_array(gpu_scene->model_count, sizeof(*soft->parts));
    soft->backdrops = sky->texels[0];
    copy_ramps(soft);
    if (!keeper && !soft_materials_init(&soft->own_materials, gpu_scene->models, gpu_scene->model_count, workers)) {
        soft_destroy(&soft);
        return NULL;
    }
    soft->materials = soft->keeper->own_materials.at;
    return soft;
}

void soft_destroy(struct soft **soft_ptr)
{
    struct soft *soft = *soft_ptr;
    if (!soft)
        return;
    soft_rest(soft);
    soft_materials_finish(&soft->own_materials);
    mem_free(soft->parts);
    mem_free(soft->muted_ramps);
    mem_free(soft->own_ramps);
    mem_free(soft->ramp_of_material);
    mem_free(soft->material_of_model);
    mem_free(soft->glossy);
    mem_free(soft);
    *soft_ptr = NULL;
}

/* Lines are worked out with the triangles: such a picture is drawn anew each time. */
static bool has_lines(const struct frame_context *context)
{
    return context->colormap.lines || view_is_operator(context->view);
}

/* Rows end in whole lanes. */
bool soft_make_room(struct soft *soft, const struct frame *frame)
{
    soft->width_px = frame->width_px;
    soft->height_px = frame->height_px;
    soft->pitch_px = (frame->width_px + LANES - 1) / LANES * LANES;
    size_t pixels = (size_t)soft->pitch_px * (size_t)frame->height_px;
    if (pixels <= soft->pixel_capacity)
        return true;
    mem_free(soft->depth);
    mem_free(soft->marks);
    soft->depth = mem_try_array(pixels, sizeof(*soft->depth));
    soft->marks = mem_try_array(pixels, sizeof(*soft->marks));
    soft->pixel_capacity = soft->depth && soft->marks ? pixels : 0;
    return soft->pixel_capacity > 0;
}

static bool complain(const struct soft *soft)
{
    log_err(soft->gpu_scene->gl->log, "preview of %dx%d, %zu vertices: out of memory", soft->width_px, soft->height_px, soft->vertex_count);
    return false;
}

/* True: the last pictures had this shape already, so that the camera stands still. */
static bool is_still(struct soft *soft, uint64_t shape)
{
    for (size_t i = 0; i < SOFT_SHAPES; i++)
        if (soft->shapes[i] == shape)
            return true;
    soft->shapes[soft->shape_count++ % SOFT_SHAPES] = shape;
    return false;
}

static bool draw_selected(struct soft *soft, struct visibility_buffer *buffer)
{
    if (!frame_shows_selected(soft->context))
        return true;
    if (!soft_find_only(soft, soft->context->view->selected_asset))
        return complain(soft);
    soft_tiles(soft, SOFT_DEPTH);
    if (buffer)
        soft_keep_rim(soft, buffer);
    soft_outline(soft);
    return true;
}

static bool draw_ghosts(struct soft *soft, struct visibility_buffer *buffer)
{
    uint8_t bgr[3], *veil;
    if (!ghosts_any(soft->context))
        return true;
    veil = mem_try_array((size_t)soft->width_px * (size_t)soft->height_px, 1);
    if (!veil || !soft_ghosts(soft, veil, bgr)) {
        mem_free(veil);
        return complain(soft);
    }
    soft_paint_ghosts(soft, veil, bgr);
    if (buffer) {
        buffer->veil = veil;
        memcpy(buffer->veil_bgr, bgr, sizeof(bgr));
    } else {
        mem_free(veil);
    }
    return true;
}

/* keep: to colour it again, if there is room for that. */
static bool draw_all(struct soft *soft, const struct isoline_points *points, struct frame *frame, bool keep)
{
    if (keep)
        soft->ids = mem_try_array((size_t)soft->pitch_px * (size_t)soft->height_px, sizeof(*soft->ids));
    soft_tiles(soft, SOFT_COLORS);
    struct visibility_buffer *buffer = soft->ids ? soft_keep(soft) : NULL;
    mem_free(soft->ids);
    soft->ids = NULL;
    markers_find(soft->context, soft->depth, (size_t)soft->pitch_px, frame);
    isolines_find(soft->context, points, soft->depth, (size_t)soft->pitch_px, frame);
    bool good = draw_ghosts(soft, buffer) && draw_selected(soft, buffer);
    if (buffer && good && visibility_buffer_settle(buffer, soft->workers))
        soft_give(&soft->kept, soft->context, buffer, frame);
    else
        visibility_buffer_destroy(&buffer);
    return good;
}

/* Rows: the colours that the middle one has, in each step of light: GLOSSY in shaders/preview.frag. */
static void make_glossy(struct soft *soft, const struct shaded_colormap *colormap)
{
    if (soft->glossy_version == colormap->version)
        return;
    if (!soft->glossy)
        soft->glossy = mem_array(COLORMAP_ROWS * COLORMAP_COLUMNS, sizeof(*soft->glossy));
    for (int column = 0; column < COLORMAP_COLUMNS; column++)
        ramp_fill_glossy(colormap->texels[COLORMAP_ROWS / 2][column], COLORMAP_ROWS, soft->glossy + column, COLORMAP_COLUMNS);
    soft->glossy_version = colormap->version;
}

void soft_take_colormap(struct soft *soft, const struct shaded_colormap *colormap, bool glossy)
{
    if (glossy)
        make_glossy(soft, colormap);
    soft->colormap = glossy ? soft->glossy : colormap->texels[0];
    soft->lines = colormap->nearest;
}

bool preview_draw(struct soft *soft, const struct frame_context *context, const struct light *light, const struct isoline_points *points,
                  struct frame *frame)
{
    bool lined = has_lines(context) || points->count > 0; /* of what is kept, depths are not */
    if (!lined && soft_resolve_again(soft, &soft->kept, context, NULL, frame))
        return true;
    soft->context = context;
    soft->light = soft_get_light(soft, context->light);
    if (!soft->light)
        return false;
    soft_take_colormap(soft, &context->colormap, context->view->look == LOOK_GLOSSY);
    if (!soft_make_room(soft, frame))
        return complain(soft);
    frame_uniforms_fill(&soft->block, context);
    if (context->view->look == LOOK_GLOSSY) { /* rows are steps of light */
        soft->block.shade[0] = COLORMAP_ROWS - 1;
        soft->block.shade[1] = 0.5f;
    }
    soft->ramps = context->view->look == LOOK_MATERIALS ? soft->own_ramps : soft->muted_ramps;
    soft->greys = view_is_operator(context->view);
    soft->out = frame->bgrx;
    soft->out_stride_bytes = (size_t)frame->stride_bytes;
    soft_aim_cuts(soft);
    soft_aim(soft, light);
    if (!soft_find(soft, true))
        return complain(soft);
    return draw_all(soft, points, frame, !lined && is_still(soft, context->shape));
}
