/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The steps of a preview, and what it keeps between pictures. */
#include "render/soft/soft.h"

#include <string.h>

#include "base/mem.h"
#include "render/soft/kernels.h"
#include "render/soft/lanes.h"
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

struct soft *soft_create(struct workers *workers, const struct gpu_scene *gpu_scene, const struct sky *sky, struct soft *keeper)
{
    struct soft *soft = mem_new(sizeof(*soft));
    soft->workers = workers;
    soft->keeper = keeper ? keeper : soft;
    soft->kernels = choose_kernels();
    soft->gpu_scene = gpu_scene;
    soft->kept.bound_bytes = KEPT_BYTES;
    soft->parts = mem_array(gpu_scene->model_count, sizeof(*soft->parts));
    if (!soft_read_textures(soft, sky) ||
        (!keeper && !soft_materials_init(&soft->own_materials, gpu_scene->models, gpu_scene->model_count, workers))) {
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
    mem_free(soft->ramp_of_model);
    mem_free(soft->backdrops);
    mem_free(soft->colormap);
    mem_free(soft->lines);
    mem_free(soft);
    *soft_ptr = NULL;
}

bool preview_can(const struct soft *soft)
{
    return soft->ramp_count <= MOST_RAMPS;
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

bool preview_draw(struct soft *soft, const struct frame_context *context, const struct light *light, const struct isoline_points *points,
                  struct frame *frame)
{
    bool lined = has_lines(context);
    if (!lined && soft_resolve_again(soft, &soft->kept, context, NULL, frame))
        return true;
    soft->context = context;
    soft->light = soft_get_light(soft, context->light);
    if (!soft->light)
        return false;
    soft_read_palette(soft, &context->colormap, context->view->look == LOOK_GLOSSY);
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
