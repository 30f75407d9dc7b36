/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws a refined frame (camera at rest, four samples per pixel) with the software renderer, in steps of a few milliseconds. */
#include "render/soft/soft.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "render/pick/markers.h"
#include "render/matrix.h"
#include "render/soft/kernels.h"
#include "render/soft/refined_impl.h"
#include "render/gl/ghosts.h"

/* number of bands (groups of pixel rows) that one step of a refined frame processes per core, which takes a few milliseconds. SHADED_BANDS:
   when shading; BANDS: in other work */
enum { SHADED_BANDS = 1, BANDS = 8 };
/* how far surface points are lifted along their normal, in texels of the shadow map; like sun_visibility() in shaders/shadow.glsl */
static const double OFF_SURFACE_TEXELS = 1 + SUN_SPREAD;

/* --- life -------------------------------------------------------------------------------------------------------------------- */

struct refined *refined_begin(struct soft *soft)
{
    struct refined *refined = soft->spare ? soft->spare : mem_new(sizeof(*refined));
    soft->spare = NULL;
    refined->raster.soft = soft;
    return refined;
}

void refined_end(struct refined **refined_ptr)
{
    struct refined *refined = *refined_ptr;
    if (!refined)
        return;
    *refined_ptr = NULL;
    visibility_buffer_destroy(&refined->buffer);
    mem_free(refined->caps);
    refined->caps = NULL;
    refined->step = REFINED_CAPS;
    refined->at = 0;
    refined->failed = false;
    if (refined->raster.soft->spare)
        refined_destroy(&refined);
    else
        refined->raster.soft->spare = refined;
}

void refined_destroy(struct refined **refined_ptr)
{
    struct refined *refined = *refined_ptr;
    if (!refined)
        return;
    raster_finish(&refined->raster);
    visibility_buffer_destroy(&refined->buffer);
    mem_free(refined->normals);
    mem_free(refined->caps);
    mem_free(refined);
    *refined_ptr = NULL;
}

size_t refined_bytes(const struct refined *refined)
{
    return raster_bytes(&refined->raster) + refined->mesh_capacity * sizeof(*refined->normals);
}

/* --- steps ------------------------------------------------------------------------------------------------------------------- */

static void aim(struct refined *refined, const struct light *light)
{
    struct raster *raster = &refined->raster;
    const struct frame_context *context = refined->context;
    const double *sun = context->light->texture_from_plant;
    double off_m = OFF_SURFACE_TEXELS * context->light->texel_m, matrix[16];
    raster_aim(raster, light);
    raster_aim_depth(raster, light);
    for (int c = 0; c < 4; c++)
        /* removes the bias of previews, which move surfaces towards the sun to avoid shadow acne; refined frames move surfaces
           along their normals instead */
        for (int r = 0; r < 4; r++)
            refined->sun_from_pixel[c][r] =
                raster->sun_from_pixel[c][r] - (r == 2 ? (float)frame_sun_slack(context) * raster->sun_from_pixel[c][3] : 0);
    for (int c = 0; c < 3; c++)
        for (int r = 0; r < 3; r++)
            refined->sun_from_normal[c][r] = (float)(sun[4 * c + r] * off_m);
    for (int r = 0; r < 3; r++) {
        refined->ground_step[r] = 0;
        for (int c = 0; c < 3; c++)
            refined->ground_step[r] += refined->sun_from_normal[c][r] * (float)refined->raster.soft->gpu_scene->up[c];
    }
    matrix_multiply(sun, light->plant_from_ground, matrix);
    raster_copy_columns(matrix, refined->sun_from_ground);
}

/* Prepares the refined frame for its next step; called because other frames may have been drawn since the last step. Returns false when out
   of memory. */
static bool take_up(struct refined *refined, const struct frame_context *context, struct frame *frame)
{
    struct raster *raster = &refined->raster;
    refined->context = raster->context = context;
    raster->light = soft_get_light(raster->soft, context->light);
    refined->surroundings = environments_get(refined->raster.soft->environments, context->lit_by.environment);
    if (!raster->light)
        return false;
    raster->colormap = soft_colormap(raster->soft, &context->colormap, false);
    raster->lines = context->colormap.nearest;
    frame_uniforms_fill(&raster->block, context);
    raster_aim_cuts(raster);
    raster->out = frame->bgrx;
    raster->out_stride_bytes = (size_t)frame->stride_bytes;
    /* the light set (baked light) may have been copied again since the last step, so the meshes' pointers into its copy are set again */
    if (refined->step > REFINED_FIND && refined->step < REFINED_INK)
        for (size_t m = 0; m < raster->mesh_count; m++)
            raster->meshes[m].baked = (const uint8_t(*)[4])raster->light->baked[raster->meshes[m].asset];
    return true;
}

/* Computes for each mesh the matrix that rotates its normals, and adds the meshes with a field to the visibility buffer. */
static void note_meshes(struct refined *refined)
{
    const struct raster *raster = &refined->raster;
    mem_grow(&refined->normals, &refined->mesh_capacity, raster->mesh_count, sizeof(*refined->normals));
    for (size_t m = 0; m < raster->mesh_count; m++) {
        const struct soft_mesh *mesh = &raster->meshes[m];
        matrix_normals(refined->raster.soft->gpu_scene->scene->assets[mesh->asset].placement, refined->normals[m]);
        if (mesh->has_field)
            visibility_buffer_add_mesh(refined->buffer, &(struct visibility_mesh){
                                                            .asset = mesh->asset,
                                                            .file = mesh->file,
                                                            .first_vertex = mesh->first_vertex,
                                                            .vertex_count = mesh->vertex_count,
                                                        });
    }
}

static bool find(struct refined *refined, const struct frame *frame, const struct light *light)
{
    struct raster *raster = &refined->raster;
    bool glossy = refined->context->view->look == LOOK_GLOSSY;
    if (!raster_make_room(raster, frame))
        return false;
    refined->buffer = visibility_buffer_create(frame->width_px, frame->height_px, REFINED_ROWS);
    raster->reach_px = 0.5f;
    bool good = refined->buffer && (!glossy || visibility_buffer_gloss(refined->buffer, refined->raster.soft->tones));
    good = good && raster_find(raster, false);
    raster->reach_px = 0;
    if (!good)
        return false;
    refined->buffer->lined = refined->context->colormap.nearest != NULL;
    note_meshes(refined);
    aim(refined, light);
    return true;
}

/* Finds the pixels in which section caps (cut faces of closed bodies) cover the sample with index `sample`, by drawing the
   frame shifted by that sample's offset. Returns false when out of memory. */
static bool find_caps(struct refined *refined, const struct frame *frame, size_t sample)
{
    struct raster *raster = &refined->raster;
    size_t pitch, rows = (size_t)frame->height_px;
    memcpy(raster->shift_px, refined_samples[sample], sizeof(raster->shift_px));
    bool good = raster_make_room(raster, frame);
    raster_aim_cuts(raster);
    good = good && raster_find(raster, true);
    memset(raster->shift_px, 0, sizeof(raster->shift_px));
    if (!good)
        return false;
    pitch = (size_t)raster->pitch_px;
    if (!refined->caps)
        refined->caps = mem_try_array(pitch, rows);
    if (!refined->caps)
        return false;
    raster_tiles(raster, SOFT_CAPS);
    for (size_t i = 0; i < pitch * rows; i++)
        refined->caps[i] |= (uint8_t)((raster->marks[i] == MARK_CAP) << sample);
    return true;
}

/* Stores the depth of each pixel in the visibility buffer, if labels of isolines or arrows will need it. Returns false when out of
   memory. */
static bool keep_depth(struct refined *refined)
{
    const struct raster *raster = &refined->raster;
    struct visibility_buffer *buffer = refined->buffer;
    size_t row = (size_t)buffer->width_px;
    if (!buffer->lined && !isolines_has_arrows(refined->context->gpu_scene->scene, refined->context->view))
        return true;
    buffer->depth = mem_try_array(row * (size_t)buffer->height_px, sizeof(*buffer->depth));
    for (size_t y = 0; y < (size_t)buffer->height_px && buffer->depth; y++)
        memcpy(buffer->depth + y * row, raster->depth + y * (size_t)raster->pitch_px, row * sizeof(*buffer->depth));
    return buffer->depth != NULL;
}

static void find_cells(void *arg, size_t begin, size_t end)
{
    const struct raster *raster = arg;
    int bottom = (int)end * DEPTH_CELL_PX;
    raster_find_cells(raster, &(struct soft_rect){ 0, (int)begin * DEPTH_CELL_PX, raster->width_px - 1,
                                                   (bottom < raster->height_px ? bottom : raster->height_px) - 1 });
}

static void give_depth(struct refined *refined, struct frame *frame)
{
    struct raster *raster = &refined->raster;
    if (raster->finds_cells)
        workers_for(raster->soft->workers, (size_t)depth_cells_along(raster->height_px), 8, find_cells, raster);
    frame->depth[0] = raster_depth_grid(raster);
}

static bool find_ghosts(struct refined *refined, const struct frame *frame)
{
    struct raster *raster = &refined->raster;
    struct visibility_buffer *buffer = refined->buffer;
    if (!ghosts_any(raster->context))
        return true;
    buffer->veil = mem_try_array((size_t)buffer->width_px * (size_t)buffer->height_px, 1);
    return buffer->veil && raster_make_room(raster, frame) && raster_ghosts(raster, buffer->veil, buffer->veil_bgr);
}

struct refined_piece {
    struct refined *refined;
    size_t first;
};

static void shade_some(void *arg, size_t begin, size_t end)
{
    const struct refined_piece *piece = arg;
    for (size_t band = begin; band < end; band++)
        if (!refined_shade_band(piece->refined, (int)(piece->first + band)))
            __atomic_store_n(&piece->refined->failed, true, __ATOMIC_RELAXED);
}

static void ink_some(void *arg, size_t begin, size_t end)
{
    const struct refined_piece *piece = arg;
    for (size_t band = begin; band < end; band++)
        piece->refined->raster.soft->kernels->ink_band(piece->refined, (int)(piece->first + band));
}

/* Chooses which work items (bands or rows of the frame) this step processes: from *begin to *end - 1, `some` items per core, of
   `all` items in total. Returns true if the last item is among them. */
static bool advance(struct refined *refined, size_t all, size_t some, size_t *begin, size_t *end)
{
    some *= (size_t)workers_count(refined->raster.soft->workers);
    *begin = refined->at;
    *end = all - refined->at < some ? all : refined->at + some;
    refined->at = *end == all ? 0 : *end;
    return *end == all;
}

/* Draws the outline of the selected asset into the visibility buffer's `ink` (lines drawn over pixels). Returns false when out of
   memory. */
static bool mark(struct refined *refined, const struct frame *frame)
{
    struct raster *raster = &refined->raster;
    if (!raster_make_room(raster, frame) || !raster_find_only(raster, refined->context->view->selected_asset))
        return false;
    raster_tiles(raster, SOFT_DEPTH);
    return true;
}

static bool complain(struct refined *refined)
{
    log_err(refined->raster.soft->gpu_scene->gl->log, "cannot draw a refined picture of %dx%d with %zu vertices: out of memory",
            refined->raster.width_px, refined->raster.height_px, refined->raster.vertex_count);
    refined->failed = true;
    return true;
}

bool refined_step(struct refined *refined, const struct frame_context *context, const struct light *light, struct frame *frame)
{
    struct raster *raster = &refined->raster;
    struct workers *workers = refined->raster.soft->workers;
    struct refined_piece piece = { .refined = refined };
    size_t begin = 0, end = 0, bands = refined->buffer ? (size_t)refined->buffer->band_count : 0;
    bool done = true;
    if (refined->failed)
        return true;
    if (!take_up(refined, context, frame))
        return complain(refined);
    switch (refined->step) {
    case REFINED_CAPS:
        if (context->view->visibility.clip.plane_count == 0)
            break;
        begin = refined->at++;
        done = refined->at == SAMPLES;
        if (!find_caps(refined, frame, begin))
            return complain(refined);
        refined->at %= SAMPLES;
        break;
    case REFINED_FIND:
        if (!find(refined, frame, light))
            return complain(refined);
        break;
    case REFINED_SHADE:
        done = advance(refined, bands, SHADED_BANDS, &begin, &end);
        piece.first = begin;
        workers_for(workers, end - begin, 1, shade_some, &piece);
        if (refined->failed)
            return complain(refined);
        break;
    case REFINED_INK:
        done = advance(refined, bands, BANDS, &begin, &end);
        piece.first = begin;
        workers_for(workers, end - begin, 1, ink_some, &piece);
        if (done)
            markers_find(context, raster->depth, (size_t)raster->pitch_px, frame);
        if (done)
            give_depth(refined, frame);
        if (done && !keep_depth(refined))
            return complain(refined);
        break;
    case REFINED_GHOSTS:
        if (!find_ghosts(refined, frame))
            return complain(refined);
        break;
    case REFINED_MARK:
        if (frame_shows_selected(context) && !mark(refined, frame))
            return complain(refined);
        break;
    case REFINED_RIM:
        if (frame_shows_selected(context))
            raster_keep_rim(&refined->raster, refined->buffer);
        break;
    case REFINED_SETTLE:
        if (!visibility_buffer_settle(refined->buffer, workers))
            return complain(refined);
        resolve_read(refined->buffer, context, workers);
        break;
    case REFINED_COLOR:
        done = advance(refined, bands, BANDS, &begin, &end);
        struct resolve_job coloring = { .buffer = refined->buffer, .first = begin, .frame = frame };
        coloring.paint = (struct resolve_paint){ raster->colormap, raster->block.scale[3], raster->block.lines[0], raster->lines };
        workers_for(workers, end - begin, 2, raster->soft->kernels->color_bands, &coloring);
        break;
    case REFINED_DONE: return true;
    }
    if (done)
        refined->step++;
    return refined->step == REFINED_DONE;
}

/* --- reuse ------------------------------------------------------------------------------------------------------------------- */

bool refined_keep(struct refined *refined, const struct frame_context *context, const struct isoline_points *points, struct frame *frame)
{
    struct visibility_buffer *buffer = refined->buffer;
    if (refined->failed)
        return false;
    refined->buffer = NULL;
    if (buffer->depth)
        isolines_find(context, points, buffer->depth, (size_t)buffer->width_px, frame);
    soft_keep(refined->raster.soft, context, buffer, frame);
    return true;
}

bool soft_has_refined(struct soft *soft, const struct frame_context *context)
{
    double lines[VIEW_ALL_LINES];
    const struct visibility_buffer *buffer = visibility_store_find(&soft->kept[TIER_REFINED], context->shape);
    return buffer && (buffer->grid || !context->gives_depth) && (buffer->lined || view_lines(context->view, lines) == 0) &&
           (buffer->depth || !isolines_has_arrows(context->gpu_scene->scene, context->view));
}
