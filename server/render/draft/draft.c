/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The steps of a draft, and what it keeps between pictures. */
#include "render/draft/draft.h"

#include <string.h>

#include "base/mem.h"
#include "render/draft/draft_kernels.h"
#include "render/draft/draft_simd.h"
#include "render/gl/ghosts.h"
#include "render/pick/markers.h"

static const size_t KEPT_BYTES = (size_t)128 << 20; /* some five pictures of 1920x1080 */

/* The widest ones that this machine has. */
static const struct draft_kernels *choose_kernels(void)
{
#ifdef __x86_64__
    enum simd_level level = simd_level();
    if (level == SIMD_HAS_AVX512)
        return &draft_kernels_widest;
    if (level == SIMD_HAS_AVX2)
        return &draft_kernels_wide;
#endif
    return &draft_kernels_plain;
}

struct draft *draft_create(struct workers *workers, const struct gpu_scene *gpu_scene, const struct sky *sky)
{
    struct draft *draft = mem_new(sizeof(*draft));
    draft->workers = workers;
    draft->kernels = choose_kernels();
    draft->gpu_scene = gpu_scene;
    draft->kept.bound_bytes = KEPT_BYTES;
    draft->parts = mem_array(gpu_scene->model_count, sizeof(*draft->parts));
    if (!draft_read_textures(draft, sky))
        draft_destroy(&draft);
    return draft;
}

void draft_destroy(struct draft **draft_ptr)
{
    struct draft *draft = *draft_ptr;
    if (!draft)
        return;
    draft_rest(draft);
    mem_free(draft->parts);
    mem_free(draft->muted_ramps);
    mem_free(draft->own_ramps);
    mem_free(draft->ramp_of_model);
    mem_free(draft->backdrops);
    mem_free(draft->colormap);
    mem_free(draft->lines);
    mem_free(draft);
    *draft_ptr = NULL;
}

/* Holes need textures; what is see-through is another pass's work. */
bool draft_can(const struct draft *draft, const struct view *view)
{
    return view->tier == TIER_PREVIEW && draft->ramp_count <= MOST_RAMPS && !draft->has_holes;
}

/* Lines are worked out with the triangles: such a picture is drawn anew each time. */
static bool has_lines(const struct frame_context *context)
{
    return context->colormap.lines || view_is_operator(context->view);
}

/* Rows end in whole lanes. */
bool draft_make_room(struct draft *draft, const struct frame *frame, int band_rows)
{
    draft->width_px = frame->width_px;
    draft->height_px = frame->height_px;
    draft->pitch_px = (frame->width_px + LANES - 1) / LANES * LANES;
    draft->band_rows = band_rows;
    draft->band_count = (frame->height_px + band_rows - 1) / band_rows;
    size_t pixels = (size_t)draft->pitch_px * (size_t)frame->height_px;
    if (pixels <= draft->pixel_capacity)
        return true;
    mem_free(draft->depth);
    mem_free(draft->marks);
    draft->depth = mem_try_array(pixels, sizeof(*draft->depth));
    draft->marks = mem_try_array(pixels, sizeof(*draft->marks));
    draft->pixel_capacity = draft->depth && draft->marks ? pixels : 0;
    return draft->pixel_capacity > 0;
}

static bool is_selected_shown(const struct frame_context *context)
{
    int selected = context->view->selected_asset;
    for (size_t i = 0; i < context->visible_count && selected >= 0; i++)
        if (context->visible[i] == selected)
            return true;
    return false;
}

static bool complain(const struct draft *draft)
{
    log_err(draft->gpu_scene->gl->log, "moving picture of %dx%d, %zu vertices: out of memory", draft->width_px, draft->height_px,
            draft->vertex_count);
    return false;
}

/* True: the last pictures had this shape already, so that the camera stands still. */
static bool is_still(struct draft *draft, uint64_t shape)
{
    for (size_t i = 0; i < DRAFT_SHAPES; i++)
        if (draft->shapes[i] == shape)
            return true;
    draft->shapes[draft->shape_count++ % DRAFT_SHAPES] = shape;
    return false;
}

static bool draw_selected(struct draft *draft, struct recolor *recolor)
{
    if (!is_selected_shown(draft->context))
        return true;
    if (!draft_find_only(draft, draft->context->view->selected_asset))
        return complain(draft);
    draft_tiles(draft, DRAFT_DEPTH);
    if (recolor)
        draft_keep_rim(draft, recolor);
    draft_outline(draft);
    return true;
}

static bool draw_ghosts(struct draft *draft, struct recolor *recolor)
{
    uint8_t bgr[3], *veil;
    if (!ghosts_any(draft->context))
        return true;
    veil = mem_try_array((size_t)draft->width_px * (size_t)draft->height_px, 1);
    if (!veil || !draft_ghosts(draft, veil, bgr)) {
        mem_free(veil);
        return complain(draft);
    }
    draft_paint_ghosts(draft, veil, bgr);
    if (recolor) {
        recolor->veil = veil;
        memcpy(recolor->veil_bgr, bgr, sizeof(bgr));
    } else {
        mem_free(veil);
    }
    return true;
}

/* keep: to colour it again, if there is room for that. */
static bool draw_all(struct draft *draft, struct isolines *isolines, struct frame *frame, bool keep)
{
    struct isoline_points points = { 0 };
    if (keep)
        draft->ids = mem_try_array((size_t)draft->pitch_px * (size_t)draft->height_px, sizeof(*draft->ids));
    draft_tiles(draft, DRAFT_COLORS);
    struct recolor *recolor = draft->ids ? draft_keep(draft) : NULL;
    mem_free(draft->ids);
    draft->ids = NULL;
    markers_find(draft->context, draft->depth, (size_t)draft->pitch_px, frame);
    isolines_collect(isolines, draft->context, &points);
    isolines_find(draft->context, &points, draft->depth, (size_t)draft->pitch_px, frame);
    mem_free(points.at);
    bool good = draw_ghosts(draft, recolor) && draw_selected(draft, recolor);
    if (recolor && good && recolor_settle(recolor, draft->workers))
        draft_give(&draft->kept, draft->context, recolor, frame);
    else
        recolor_destroy(&recolor);
    return good;
}

bool draft_draw(struct draft *draft, const struct frame_context *context, const struct light *light, struct isolines *isolines,
                struct frame *frame)
{
    bool lined = has_lines(context);
    if (!lined && draft_recolor(draft, &draft->kept, context, NULL, frame))
        return true;
    draft->context = context;
    draft->light = draft_get_light(draft, context->light);
    if (!draft->light)
        return false;
    draft_read_palette(draft, &context->colormap, context->view->look == LOOK_GLOSSY);
    if (!draft_make_room(draft, frame, BAND_ROWS))
        return complain(draft);
    frame_uniforms_fill(&draft->block, context);
    if (context->view->look == LOOK_GLOSSY) { /* rows are steps of light */
        draft->block.shade[0] = COLORMAP_ROWS - 1;
        draft->block.shade[1] = 0.5f;
    }
    draft->ramps = context->view->look == LOOK_MATERIALS ? draft->own_ramps : draft->muted_ramps;
    draft->greys = view_is_operator(context->view);
    draft->out = frame->bgrx;
    draft->out_stride_bytes = (size_t)frame->stride_bytes;
    draft_aim_cuts(draft);
    draft_aim(draft, light);
    if (!draft_find(draft))
        return complain(draft);
    return draw_all(draft, isolines, frame, !lined && is_still(draft, context->shape));
}
