/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws a preview with the software renderer: finds parts, draws tiles, then edges, outline and labels. */
#include "render/soft/soft.h"

#include <string.h>

#include "base/system/huge_pages.h"
#include "base/mem.h"
#include "render/soft/soft_impl.h"
#include "render/gl/ghosts.h"
#include "render/pick/markers.h"

/* Returns whether the frame shows isolines. Isolines are computed while triangles are drawn. So when readings change, a preview
   with isolines is drawn again rather than just recoloured. */
static bool has_lines(const struct frame_context *context)
{
    return context->colormap.lines || view_is_operator(context->view);
}

/* Allocates the raster's buffers for a frame of this size. Rows are padded to a multiple of LANES pixels. */
bool raster_make_room(struct raster *raster, const struct frame *frame)
{
    raster->width_px = frame->width_px;
    raster->height_px = frame->height_px;
    raster->pitch_px = (frame->width_px + LANES - 1) / LANES * LANES;
    size_t pixels = (size_t)raster->pitch_px * (size_t)frame->height_px;
    if (pixels <= raster->pixel_capacity)
        return true;
    mem_free(raster->depth);
    mem_free(raster->marks);
    raster->depth = mem_try_array(pixels, sizeof(*raster->depth));
    raster->marks = mem_try_array(pixels, sizeof(*raster->marks));
    huge_pages_advise(raster->depth, pixels * sizeof(*raster->depth));
    huge_pages_advise(raster->marks, pixels * sizeof(*raster->marks));
    raster->pixel_capacity = raster->depth && raster->marks ? pixels : 0;
    return raster->pixel_capacity > 0;
}

static bool complain(const struct raster *raster)
{
    log_err(raster->soft->gpu_scene->gl->log, "cannot draw a preview of %dx%d with %zu vertices: out of memory", raster->width_px,
            raster->height_px, raster->vertex_count);
    return false;
}

/* Returns whether a recent preview had this hash of geometry and light (content_hash_shape()), which means that the camera stands still.
   Stores the hash for later calls. */
static bool is_still(struct soft *soft, uint64_t shape)
{
    for (size_t i = 0; i < SOFT_SHAPES; i++)
        if (soft->shapes[i] == shape)
            return true;
    soft->shapes[soft->shape_count++ % SOFT_SHAPES] = shape;
    return false;
}

static bool draw_selected(struct raster *raster, struct visibility_buffer *buffer)
{
    if (!frame_shows_selected(raster->context))
        return true;
    if (!raster_find_only(raster, raster->context->view->selected_asset))
        return complain(raster);
    raster_tiles(raster, SOFT_DEPTH);
    if (buffer)
        raster_keep_rim(raster, buffer);
    raster_outline(raster);
    return true;
}

static bool draw_ghosts(struct raster *raster, struct visibility_buffer *buffer)
{
    uint8_t bgr[3], *veil;
    if (!ghosts_any(raster->context))
        return true;
    veil = mem_try_array((size_t)raster->width_px * (size_t)raster->height_px, 1);
    if (!veil || !raster_ghosts(raster, veil, bgr)) {
        mem_free(veil);
        return complain(raster);
    }
    raster_paint_ghosts(raster, veil, bgr);
    if (buffer) {
        buffer->veil = veil;
        memcpy(buffer->veil_bgr, bgr, sizeof(bgr));
    } else {
        mem_free(veil);
    }
    return true;
}

/* Draws a whole preview. keep: also stores a visibility buffer, if memory allows, from which later previews with other readings
   are recoloured without drawing the geometry again. Returns false when out of memory. */
static bool draw_all(struct raster *raster, const struct isoline_points *points, struct frame *frame, bool keep)
{
    if (keep)
        raster->ids = mem_try_array((size_t)raster->pitch_px * (size_t)raster->height_px, sizeof(*raster->ids));
    raster_tiles(raster, SOFT_COLORS);
    frame->depth[0] = raster_depth_grid(raster);
    struct visibility_buffer *buffer = raster->ids ? raster_keep(raster) : NULL;
    mem_free(raster->ids);
    raster->ids = NULL;
    markers_find(raster->context, raster->depth, (size_t)raster->pitch_px, frame);
    isolines_find(raster->context, points, raster->depth, (size_t)raster->pitch_px, frame);
    bool good = draw_ghosts(raster, buffer) && draw_selected(raster, buffer);
    if (buffer && good && visibility_buffer_settle(buffer, raster->soft->workers))
        soft_keep(raster->soft, raster->context, buffer, frame);
    else
        visibility_buffer_destroy(&buffer);
    return good;
}

bool preview_draw(struct soft *soft, const struct frame_context *context, const struct light *light, const struct isoline_points *points,
                  struct frame *frame)
{
    struct raster *raster = &soft->preview;
    /* a preview with isolines is always drawn again: labels of isolines need the depth of each pixel, which visibility buffers
       of previews do not store */
    bool lined = has_lines(context) || points->count > 0;
    if (!lined && soft_resolve_again(soft, context, points, frame))
        return true;
    raster->context = context;
    raster->light = soft_get_light(soft, context->light);
    if (!raster->light)
        return false;
    raster->colormap = soft_colormap(soft, &context->colormap, context->view->look == LOOK_GLOSSY);
    raster->lines = context->colormap.nearest;
    if (!raster_make_room(raster, frame))
        return complain(raster);
    frame_uniforms_fill(&raster->block, context);
    /* in the glossy look, the colours come from the table soft->glossy, with one row per brightness step */
    if (context->view->look == LOOK_GLOSSY) {
        raster->block.shade[0] = COLORMAP_ROWS - 1;
        raster->block.shade[1] = 0.5f;
    }
    raster->ramps = context->view->look == LOOK_MATERIALS ? soft->own_ramps : soft->muted_ramps;
    raster->greys = view_is_operator(context->view);
    raster->out = frame->bgrx;
    raster->out_stride_bytes = (size_t)frame->stride_bytes;
    raster_aim_cuts(raster);
    raster_aim(raster, light);
    raster_aim_depth(raster, light);
    if (!raster_find(raster, true))
        return complain(raster);
    return draw_all(raster, points, frame, !lined && is_still(soft, context->shape));
}
