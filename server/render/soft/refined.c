/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The steps of a refined frame. */
#include "render/soft/refined.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "render/pick/markers.h"
#include "render/matrix.h"
#include "render/soft/refined_impl.h"
#include "render/gl/ghosts.h"

/* Of a step, for each core: some milliseconds' worth. */
enum { SHADED_BANDS = 1, BANDS = 8 };
static const size_t KEPT_BYTES = (size_t)256 << 20; /* some ten pictures of 1920 x 1080 */
static const double OFF_SURFACE_TEXELS = 2.58;      /* as sun_visibility in shaders/shadow.glsl */

/* --- what refined frames share ------------------------------------------------------------------------------------------------------- */

static lanes material_of(const struct asset_material *material)
{
    return (lanes){ material->base_color[0], material->base_color[1], material->base_color[2], material->metallic,
                    material->roughness,     material->emissive[0],   material->emissive[1],   material->emissive[2] };
}

static void find_materials(struct refiner *refiner)
{
    const struct gpu_scene *gpu_scene = refiner->gpu_scene;
    refiner->materials = mem_array(refiner->soft->material_count, sizeof(*refiner->materials));
    for (size_t m = 0; m < gpu_scene->model_count; m++)
        for (size_t i = 0; i < gpu_scene->models[m].material_count; i++)
            refiner->materials[refiner->soft->material_of_model[m] + i] = material_of(&gpu_scene->models[m].file->view.materials[i]);
}

struct refiner *refiner_create(struct workers *workers, const struct gpu_scene *gpu_scene, const struct sky *sky, struct soft *soft,
                               const struct environments *environments)
{
    struct refiner *refiner = mem_new(sizeof(*refiner));
    *refiner = (struct refiner){ .workers = workers, .gpu_scene = gpu_scene, .sky = sky, .soft = soft, .environments = environments };
    refiner->kept.bound_bytes = KEPT_BYTES;
    refiner->kept.keeps_newest = true; /* readings that changed while it was made are shown by it, however large it is */
    find_materials(refiner);
    soft_tones_init(&refiner->tones);
    return refiner;
}

static void destroy(struct refined **refined_ptr)
{
    struct refined *refined = *refined_ptr;
    if (!refined)
        return;
    soft_destroy(&refined->soft);
    visibility_buffer_destroy(&refined->buffer);
    mem_free(refined->normals);
    mem_free(refined->caps);
    mem_free(refined);
    *refined_ptr = NULL;
}

void refiner_destroy(struct refiner **refiner_ptr)
{
    struct refiner *refiner = *refiner_ptr;
    if (!refiner)
        return;
    destroy(&refiner->spare);
    visibility_store_finish(&refiner->kept);
    mem_free(refiner->materials);
    mem_free(refiner->light.open);
    mem_free(refiner);
    *refiner_ptr = NULL;
}

void refiner_bound(struct refiner *refiner, size_t bytes)
{
    visibility_store_bound(&refiner->kept, bytes);
}

size_t refiner_kept_bytes(const struct refiner *refiner)
{
    return refiner->kept.bytes;
}

size_t refiner_room_bytes(const struct refiner *refiner)
{
    const struct refined *spare = refiner->spare;
    if (!spare)
        return 0;
    return soft_room_bytes(spare->soft) + spare->mesh_capacity * sizeof(*spare->normals);
}

size_t refiner_light_bytes(const struct refiner *refiner)
{
    return refiner->light.open ? (size_t)refiner->light.open_px * (size_t)refiner->light.open_px : 0;
}

void refiner_drop_spare(struct refiner *refiner)
{
    destroy(&refiner->spare);
}

void refiner_rest(struct refiner *refiner)
{
    refiner_drop_spare(refiner);
    visibility_store_finish(&refiner->kept);
    mem_free(refiner->light.open);
    refiner->light = (struct refined_light){ 0 };
}

/* --- life -------------------------------------------------------------------------------------------------------------------- */

struct refined *refined_begin(struct refiner *refiner)
{
    struct refined *refined = refiner->spare;
    refiner->spare = NULL;
    if (!refined) {
        refined = mem_new(sizeof(*refined));
        refined->refiner = refiner;
        refined->soft = soft_create(refiner->workers, refiner->gpu_scene, refiner->sky, refiner->soft);
        if (!refined->soft)
            destroy(&refined);
    }
    return refined;
}

void refined_end(struct refiner *refiner, struct refined **refined_ptr)
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
    if (refiner->spare)
        destroy(&refined);
    else
        refiner->spare = refined;
}

/* --- steps ------------------------------------------------------------------------------------------------------------------- */

static void copy_columns(const double from[16], float to[4][4])
{
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++)
            to[c][r] = (float)from[4 * c + r];
}

static void aim(struct refined *refined, const struct light *light)
{
    struct soft *soft = refined->soft;
    const struct frame_context *context = refined->context;
    const double *sun = context->light->texture_from_plant;
    double off_m = OFF_SURFACE_TEXELS * context->light->texel_m, matrix[16];
    soft_aim(soft, light);
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++) /* a preview moves surfaces towards the sun, here they step off along their normals */
            refined->sun_from_pixel[c][r] =
                soft->sun_from_pixel[c][r] - (r == 2 ? (float)frame_sun_slack(context) * soft->sun_from_pixel[c][3] : 0);
    for (int c = 0; c < 3; c++)
        for (int r = 0; r < 3; r++)
            refined->sun_from_normal[c][r] = (float)(sun[4 * c + r] * off_m);
    for (int r = 0; r < 3; r++) {
        refined->ground_step[r] = 0;
        for (int c = 0; c < 3; c++)
            refined->ground_step[r] += refined->sun_from_normal[c][r] * (float)refined->refiner->gpu_scene->up[c];
    }
    matrix_multiply(sun, light->plant_from_ground, matrix);
    copy_columns(matrix, refined->sun_from_ground);
}

/* Others drew meanwhile. */
static bool take_up(struct refined *refined, const struct frame_context *context, struct frame *frame)
{
    struct soft *soft = refined->soft;
    refined->context = soft->context = context;
    soft->light = soft_get_light(refined->refiner->soft, context->light);
    refined->surroundings = environments_get(refined->refiner->environments, context->lit_by.environment);
    if (!soft->light || !refined_read_light(refined->refiner, context->light))
        return false;
    soft_take_colormap(soft, &context->colormap, false);
    frame_uniforms_fill(&soft->block, context);
    soft_aim_cuts(soft);
    soft->out = frame->bgrx;
    soft->out_stride_bytes = (size_t)frame->stride_bytes;
    if (refined->step > REFINED_FIND && refined->step < REFINED_INK) /* those of its caps are gone by then */
        for (size_t m = 0; m < soft->mesh_count; m++)
            soft->meshes[m].baked = (const uint8_t(*)[4])soft->light->baked[soft->meshes[m].asset];
    return true;
}

/* What was found, with what a refined frame needs of it besides. */
static void note_meshes(struct refined *refined)
{
    const struct soft *soft = refined->soft;
    mem_grow(&refined->normals, &refined->mesh_capacity, soft->mesh_count, sizeof(*refined->normals));
    for (size_t m = 0; m < soft->mesh_count; m++) {
        const struct soft_mesh *mesh = &soft->meshes[m];
        matrix_normals(refined->refiner->gpu_scene->scene->assets[mesh->asset].placement, refined->normals[m]);
        if (mesh->has_field)
            visibility_buffer_add_mesh(refined->buffer, &(struct visibility_mesh){
                                                            .asset = mesh->asset,
                                                            .first_vertex = mesh->first_vertex,
                                                            .vertex_count = mesh->vertex_count,
                                                        });
    }
}

static bool find(struct refined *refined, const struct frame *frame, const struct light *light)
{
    struct soft *soft = refined->soft;
    bool glossy = refined->context->view->look == LOOK_GLOSSY;
    if (!soft_make_room(soft, frame))
        return false;
    refined->buffer = visibility_buffer_create(frame->width_px, frame->height_px, REFINED_ROWS);
    soft->reach_px = 0.5f;
    bool good = refined->buffer && (!glossy || visibility_buffer_gloss(refined->buffer, &refined->refiner->tones));
    good = good && soft_find(soft, false);
    soft->reach_px = 0;
    if (!good)
        return false;
    refined->buffer->lined = refined->context->colormap.nearest != NULL;
    note_meshes(refined);
    aim(refined, light);
    return true;
}

/* Which samples of each pixel a body that is cut open covers: those of one number, by a picture that is moved so far. */
static bool find_caps(struct refined *refined, const struct frame *frame, size_t sample)
{
    struct soft *soft = refined->soft;
    size_t pitch, rows = (size_t)frame->height_px;
    memcpy(soft->shift_px, refined_samples[sample], sizeof(soft->shift_px));
    bool good = soft_make_room(soft, frame);
    soft_aim_cuts(soft);
    good = good && soft_find(soft, true);
    memset(soft->shift_px, 0, sizeof(soft->shift_px));
    if (!good)
        return false;
    pitch = (size_t)soft->pitch_px;
    if (!refined->caps)
        refined->caps = mem_try_array(pitch, rows);
    if (!refined->caps)
        return false;
    soft_tiles(soft, SOFT_CAPS);
    for (size_t i = 0; i < pitch * rows; i++)
        refined->caps[i] |= (uint8_t)((soft->marks[i] == MARK_CAP) << sample);
    return true;
}

/* For labels of isolines, and arrows. */
static bool keep_depth(struct refined *refined)
{
    const struct soft *soft = refined->soft;
    struct visibility_buffer *buffer = refined->buffer;
    size_t row = (size_t)buffer->width_px;
    if (!buffer->lined && !isolines_has_arrows(refined->context->gpu_scene->scene, refined->context->view))
        return true;
    buffer->depth = mem_try_array(row * (size_t)buffer->height_px, sizeof(*buffer->depth));
    for (size_t y = 0; y < (size_t)buffer->height_px && buffer->depth; y++)
        memcpy(buffer->depth + y * row, soft->depth + y * (size_t)soft->pitch_px, row * sizeof(*buffer->depth));
    return buffer->depth != NULL;
}

static bool find_ghosts(struct refined *refined, const struct frame *frame)
{
    struct soft *soft = refined->soft;
    struct visibility_buffer *buffer = refined->buffer;
    if (!ghosts_any(soft->context))
        return true;
    buffer->veil = mem_try_array((size_t)buffer->width_px * (size_t)buffer->height_px, 1);
    return buffer->veil && soft_make_room(soft, frame) && soft_ghosts(soft, buffer->veil, buffer->veil_bgr);
}

struct piece {
    struct refined *refined;
    size_t first;
};

static void shade_some(void *arg, size_t begin, size_t end)
{
    const struct piece *piece = arg;
    for (size_t band = begin; band < end; band++)
        if (!refined_shade_band(piece->refined, (int)(piece->first + band)))
            __atomic_store_n(&piece->refined->failed, true, __ATOMIC_RELAXED);
}

static void ink_some(void *arg, size_t begin, size_t end)
{
    const struct piece *piece = arg;
    for (size_t band = begin; band < end; band++)
        refined_ink_band(piece->refined, (int)(piece->first + band));
}

/* The next of `all` pieces of work, so many for each core. True: that was the last. */
static bool advance(struct refined *refined, size_t all, size_t some, size_t *begin, size_t *end)
{
    some *= (size_t)workers_count(refined->refiner->workers);
    *begin = refined->at;
    *end = all - refined->at < some ? all : refined->at + some;
    refined->at = *end == all ? 0 : *end;
    return *end == all;
}

/* Of the selected asset. */
static bool mark(struct refined *refined, const struct frame *frame)
{
    struct soft *soft = refined->soft;
    if (!soft_make_room(soft, frame) || !soft_find_only(soft, refined->context->view->selected_asset))
        return false;
    soft_tiles(soft, SOFT_DEPTH);
    return true;
}

static bool complain(struct refined *refined)
{
    log_err(refined->refiner->gpu_scene->gl->log, "refined frame of %dx%d, %zu vertices: out of memory", refined->soft->width_px,
            refined->soft->height_px, refined->soft->vertex_count);
    refined->failed = true;
    return true;
}

bool refined_step(struct refined *refined, const struct frame_context *context, const struct light *light, struct frame *frame)
{
    struct soft *soft = refined->soft;
    struct workers *workers = refined->refiner->workers;
    struct piece piece = { .refined = refined };
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
            markers_find(context, soft->depth, (size_t)soft->pitch_px, frame);
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
            soft_keep_rim(refined->soft, refined->buffer);
        break;
    case REFINED_SETTLE:
        if (!visibility_buffer_settle(refined->buffer, workers))
            return complain(refined);
        resolve_read(refined->buffer, context, workers);
        break;
    case REFINED_COLOR:
        done = advance(refined, bands, BANDS, &begin, &end);
        resolve_colors(refined->buffer, soft->colormap, &(struct resolve_lines){ soft->block.lines[0], soft->lines }, soft->block.scale[3],
                       workers, (int)begin, (int)(end - begin), frame);
        break;
    case REFINED_DONE: return true;
    }
    if (done)
        refined->step++;
    return refined->step == REFINED_DONE;
}

/* --- once more --------------------------------------------------------------------------------------------------------------- */

bool refiner_keep(struct refiner *refiner, struct refined *refined, const struct frame_context *context,
                  const struct isoline_points *points, struct frame *frame)
{
    struct visibility_buffer *buffer = refined->buffer;
    if (refined->failed)
        return false;
    refined->buffer = NULL;
    if (buffer->depth)
        isolines_find(context, points, buffer->depth, (size_t)buffer->width_px, frame);
    soft_give(&refiner->kept, context, buffer, frame);
    return true;
}

bool refiner_know(struct refiner *refiner, const struct frame_context *context)
{
    double lines[VIEW_ALL_LINES];
    const struct visibility_buffer *buffer = visibility_store_find(&refiner->kept, context->shape);
    return buffer && (buffer->lined || view_lines(context->view, lines) == 0) &&
           (buffer->depth || !isolines_has_arrows(context->gpu_scene->scene, context->view));
}

bool refiner_resolve_again(struct refiner *refiner, const struct frame_context *context, const struct isoline_points *points,
                           struct frame *frame)
{
    return soft_resolve_again(refiner->soft, &refiner->kept, context, points, frame);
}
