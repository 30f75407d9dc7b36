/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The steps of a plate. */
#include "render/plate/plate.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/srgb.h"
#include "render/pick/markers.h"
#include "render/matrix.h"
#include "render/plate/plate_impl.h"
#include "render/gl/ghosts.h"
#include "render/gl/surface_pass.h"

/* Of a step, for each core: some milliseconds' worth. */
enum { VERTICES = 65536, CHUNKS = 32, SHADED_BANDS = 1, BANDS = 16 };
static const size_t KEPT_BYTES = (size_t)256 << 20; /* some ten pictures of 1920 x 1080 */
static const double OFF_SURFACE_TEXELS = 2.58;      /* as sun_visibility in shaders/shadow.glsl */

/* --- what plates share ------------------------------------------------------------------------------------------------------- */

static void find_models(struct plates *plates)
{
    const struct gpu_scene *gpu_scene = plates->gpu_scene;
    plates->textured = mem_array(gpu_scene->model_count, sizeof(bool));
    plates->masked = mem_array(gpu_scene->model_count, sizeof(bool));
    plates->blended = mem_array(gpu_scene->model_count, sizeof(bool));
    for (size_t m = 0; m < gpu_scene->model_count; m++) {
        const struct model *model = &gpu_scene->models[m];
        for (size_t i = 0; i < model->material_count; i++) {
            plates->textured[m] |= model->materials[i].mask != 0;
            plates->masked[m] |= model->materials[i].masked && model->materials[i].mask;
            plates->blended[m] |= model->file->view.materials[i].alpha == ASSET_ALPHA_BLEND;
        }
    }
}

static void find_tones(struct plates *plates)
{
    for (int i = 0; i <= TONES; i++) {
        double x = (double)i / TONES;
        plates->tones[i] = (float)srgb_from_linear(x);
    }
}

struct plates *plates_create(struct workers *workers, const struct gpu_scene *gpu_scene, const struct sky *sky, struct draft *draft,
                             const struct environments *environments)
{
    struct plates *plates = mem_new(sizeof(*plates));
    *plates = (struct plates){ .workers = workers, .gpu_scene = gpu_scene, .sky = sky, .draft = draft, .environments = environments };
    plates->kept.bound_bytes = KEPT_BYTES;
    find_models(plates);
    find_tones(plates);
    return plates;
}

static void destroy(struct plate **plate_ptr)
{
    struct plate *plate = *plate_ptr;
    if (!plate)
        return;
    draft_destroy(&plate->draft);
    recolor_destroy(&plate->recolor);
    mem_free(plate->normals);
    mem_free(plate->draws);
    mem_free(plate->attributes);
    mem_free(plate->caps);
    mem_free(plate);
    *plate_ptr = NULL;
}

void plates_destroy(struct plates **plates_ptr)
{
    struct plates *plates = *plates_ptr;
    if (!plates)
        return;
    destroy(&plates->spare);
    visibility_buffers_finish(&plates->kept);
    mem_free(plates->textured);
    mem_free(plates->masked);
    mem_free(plates->blended);
    mem_free(plates->surroundings.texels);
    mem_free(plates->light.open);
    mem_free(plates);
    *plates_ptr = NULL;
}

void plates_bound(struct plates *plates, size_t bytes)
{
    visibility_buffers_bound(&plates->kept, bytes);
}

size_t plates_kept_bytes(const struct plates *plates)
{
    return plates->kept.bytes;
}

size_t plates_room_bytes(const struct plates *plates)
{
    const struct plate *spare = plates->spare;
    if (!spare)
        return 0;
    return draft_room_bytes(spare->draft) + spare->attribute_capacity * sizeof(*spare->attributes) +
           spare->mesh_capacity * sizeof(*spare->normals) + spare->draw_capacity * sizeof(*spare->draws);
}

size_t plates_light_bytes(const struct plates *plates)
{
    return plates->light.open ? (size_t)plates->light.open_px * (size_t)plates->light.open_px : 0;
}

void plates_drop_spare(struct plates *plates)
{
    destroy(&plates->spare);
}

void plates_rest(struct plates *plates)
{
    plates_drop_spare(plates);
    visibility_buffers_finish(&plates->kept);
    mem_free(plates->light.open);
    plates->light = (struct plate_light){ 0 };
}

bool plates_can(const struct plates *plates, const struct frame_context *context)
{
    const struct view *view = context->view;
    if (view->tier != TIER_REFINED || view->look == LOOK_GLOSSY || context->reference)
        return false;
    for (size_t i = 0; i < context->visible_count; i++) {
        int asset = context->visible[i];
        size_t model = (size_t)(context->gpu_scene->of_asset[asset] - context->gpu_scene->models);
        bool field = context->fields[asset] != NULL, lost = field && !context->fields[asset]->slice; /* only GL hatches without scalars */
        if (lost || plates->masked[model] || (!field && (plates->textured[model] || plates->blended[model])))
            return false;
    }
    return true;
}

/* --- life -------------------------------------------------------------------------------------------------------------------- */

struct plate *plate_begin(struct plates *plates)
{
    struct plate *plate = plates->spare;
    plates->spare = NULL;
    if (!plate) {
        plate = mem_new(sizeof(*plate));
        plate->plates = plates;
        plate->draft = draft_create(plates->workers, plates->gpu_scene, plates->sky);
        if (!plate->draft)
            destroy(&plate);
    }
    return plate;
}

void plate_end(struct plates *plates, struct plate **plate_ptr)
{
    struct plate *plate = *plate_ptr;
    if (!plate)
        return;
    *plate_ptr = NULL;
    recolor_destroy(&plate->recolor);
    mem_free(plate->caps);
    plate->caps = NULL;
    plate->step = PLATE_CAPS;
    plate->at = 0;
    plate->failed = false;
    if (plates->spare)
        destroy(&plate);
    else
        plates->spare = plate;
}

/* --- steps ------------------------------------------------------------------------------------------------------------------- */

static void copy_columns(const double from[16], float to[4][4])
{
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++)
            to[c][r] = (float)from[4 * c + r];
}

static void aim(struct plate *plate, const struct light *light)
{
    struct draft *draft = plate->draft;
    const struct frame_context *context = plate->context;
    const double *sun = context->light->texture_from_plant;
    double off_m = OFF_SURFACE_TEXELS * context->light->texel_m, matrix[16];
    draft_aim(draft, light);
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++) /* a draft moves surfaces towards the sun, here they step off along their normals */
            plate->sun_from_pixel[c][r] =
                draft->sun_from_pixel[c][r] - (r == 2 ? (float)surface_pass_sun_slack(context) * draft->sun_from_pixel[c][3] : 0);
    for (int c = 0; c < 3; c++)
        for (int r = 0; r < 3; r++)
            plate->sun_from_normal[c][r] = (float)(sun[4 * c + r] * off_m);
    for (int r = 0; r < 3; r++) {
        plate->ground_step[r] = 0;
        for (int c = 0; c < 3; c++)
            plate->ground_step[r] += plate->sun_from_normal[c][r] * (float)plate->plates->gpu_scene->up[c];
    }
    matrix_multiply(sun, light->plant_from_ground, matrix);
    copy_columns(matrix, plate->sun_from_ground);
}

/* Others drew meanwhile. */
static bool take_up(struct plate *plate, const struct frame_context *context, struct frame *frame)
{
    struct draft *draft = plate->draft;
    plate->context = draft->context = context;
    draft->light = draft_get_light(plate->plates->draft, context->light);
    if (!draft->light || !plate_read_light(plate->plates, context->light) ||
        !plate_read_surroundings(plate->plates, context->lit_by.environment))
        return false;
    draft_read_palette(draft, &context->colormap, false);
    frame_uniforms_fill(&draft->block, context);
    draft_aim_cuts(draft);
    draft->out = frame->bgrx;
    draft->out_stride_bytes = (size_t)frame->stride_bytes;
    if (plate->step > PLATE_COLLECT && plate->step < PLATE_INK) /* those of its caps are gone by then */
        for (size_t m = 0; m < draft->mesh_count; m++)
            draft->meshes[m].baked = (const uint8_t(*)[4])draft->light->baked[draft->meshes[m].asset];
    return true;
}

static lanes material_of(const struct asset_material *material)
{
    return (lanes){ material->base_color[0], material->base_color[1], material->base_color[2], material->metallic,
                    material->roughness,     material->emissive[0],   material->emissive[1],   material->emissive[2] };
}

/* The draft's meshes and draws, with what a plate needs of them besides. Marks become numbers of draws. */
static void note_meshes(struct plate *plate)
{
    struct draft *draft = plate->draft;
    const struct gpu_scene *gpu_scene = plate->plates->gpu_scene;
    mem_grow(&plate->normals, &plate->mesh_capacity, draft->mesh_count, sizeof(*plate->normals));
    mem_grow(&plate->draws, &plate->draw_capacity, draft->draw_count, sizeof(*plate->draws));
    for (size_t m = 0; m < draft->mesh_count; m++) {
        const struct draft_mesh *mesh = &draft->meshes[m];
        matrix_normals(gpu_scene->scene->assets[mesh->asset].placement, plate->normals[m]);
        if (mesh->has_field)
            recolor_add_mesh(plate->recolor, &(struct recolor_mesh){
                                                 .asset = mesh->asset,
                                                 .first_vertex = mesh->first_vertex,
                                                 .vertex_count = mesh->vertex_count,
                                             });
    }
    for (size_t d = 0; d < draft->draw_count; d++) {
        struct draft_draw *draw = &draft->draws[d];
        const struct model *model = gpu_scene->of_asset[draft->meshes[draw->mesh].asset];
        bool field = draw->mark == MARK_FIELD;
        size_t row = draw->mark >> 16 & (MOST_RAMPS - 1), material = row - draft->ramp_of_model[model - gpu_scene->models];
        plate->draws[d] = (struct plate_draw){ .mesh = draw->mesh, .field = field, .cut = draft->meshes[draw->mesh].cut };
        if (!field)
            plate->draws[d].material = material_of(&model->file->view.materials[material]);
        draw->mark = (uint32_t)d;
        draw->back = MARK_BACK;
    }
}

static bool collect(struct plate *plate, const struct frame *frame, const struct light *light)
{
    struct draft *draft = plate->draft;
    draft->reach_px = 0.5f;
    if (!draft_make_room(draft, frame, PLATE_ROWS))
        return false;
    draft_aim_cuts(draft);
    plate->recolor = recolor_create(frame->width_px, frame->height_px, PLATE_ROWS);
    if (plate->recolor)
        plate->recolor->lined = plate->context->colormap.lines != 0;
    if (!plate->recolor || !draft_collect(draft) || draft->chunk_count > ID_NOTHING >> ID_BITS)
        return false;
    note_meshes(plate);
    aim(plate, light);
    if (!plate->attributes || plate->attribute_capacity < draft->vertex_count) { /* also of a first picture that shows nothing */
        mem_free(plate->attributes);
        plate->attributes = mem_try_array(draft->vertex_capacity, sizeof(*plate->attributes));
        plate->attribute_capacity = plate->attributes ? draft->vertex_capacity : 0;
    }
    return plate->attributes;
}

/* Which samples of each pixel a body that is cut open covers: those of one number, by a picture that is moved so far. */
static bool find_caps(struct plate *plate, const struct frame *frame, size_t sample)
{
    struct draft *draft = plate->draft;
    size_t pitch, rows = (size_t)frame->height_px;
    memcpy(draft->shift_px, plate_samples[sample], sizeof(draft->shift_px));
    bool good = draft_make_room(draft, frame, BAND_ROWS);
    draft_aim_cuts(draft);
    good = good && draft_find(draft);
    memset(draft->shift_px, 0, sizeof(draft->shift_px));
    if (!good)
        return false;
    pitch = (size_t)draft->pitch_px;
    if (!plate->caps)
        plate->caps = mem_try_array(pitch, rows);
    if (!plate->caps)
        return false;
    draft_tiles(draft, DRAFT_CAPS);
    for (size_t i = 0; i < pitch * rows; i++)
        plate->caps[i] |= (uint8_t)((draft->marks[i] == MARK_CAP) << sample);
    return true;
}

/* For labels of isolines. */
static bool keep_depth(struct plate *plate)
{
    const struct draft *draft = plate->draft;
    struct recolor *recolor = plate->recolor;
    size_t row = (size_t)recolor->width_px;
    if (!recolor->lined)
        return true;
    recolor->depth = mem_try_array(row * (size_t)recolor->height_px, sizeof(*recolor->depth));
    for (size_t y = 0; y < (size_t)recolor->height_px && recolor->depth; y++)
        memcpy(recolor->depth + y * row, draft->depth + y * (size_t)draft->pitch_px, row * sizeof(*recolor->depth));
    return recolor->depth != NULL;
}

static bool find_ghosts(struct plate *plate, const struct frame *frame)
{
    struct draft *draft = plate->draft;
    struct recolor *recolor = plate->recolor;
    if (!ghosts_any(draft->context))
        return true;
    recolor->veil = mem_try_array((size_t)recolor->width_px * (size_t)recolor->height_px, 1);
    return recolor->veil && draft_make_room(draft, frame, BAND_ROWS) && draft_ghosts(draft, recolor->veil, recolor->veil_bgr);
}

static void place_mesh(const struct plate *plate, size_t m, size_t begin, size_t end)
{
    const struct draft_mesh *mesh = &plate->draft->meshes[m];
    const float *turn = plate->normals[m];
    for (size_t v = begin; v < end; v++) {
        const float *n = mesh->file->normals[v];
        const uint8_t *baked = mesh->baked[v], *color = mesh->file->colors ? mesh->file->colors[v] : NULL;
        lanes *to = &plate->attributes[mesh->first_vertex + v];
        for (int r = 0; r < 3; r++) {
            (*to)[NORMAL_X + r] = turn[r] * n[0] + turn[3 + r] * n[1] + turn[6 + r] * n[2];
            (*to)[TINT + r] = color ? (float)color[r] * (1 / 255.0f) : 1;
        }
        (*to)[AMBIENT] = (float)baked[1] * (1 / 255.0f);
        (*to)[OPEN] = (float)baked[2] * (1 / 255.0f);
    }
}

struct piece {
    struct plate *plate;
    size_t first;
};

static void place_some(void *arg, size_t begin, size_t end)
{
    const struct piece *piece = arg;
    const struct draft *draft = piece->plate->draft;
    begin += piece->first;
    end += piece->first;
    for (size_t m = 0; m < draft->mesh_count; m++) {
        size_t first = draft->meshes[m].first_vertex, last = first + draft->meshes[m].vertex_count;
        if (first < end && last > begin)
            place_mesh(piece->plate, m, (begin > first ? begin : first) - first, (end < last ? end : last) - first);
    }
}

static void shade_some(void *arg, size_t begin, size_t end)
{
    const struct piece *piece = arg;
    for (size_t band = begin; band < end; band++)
        if (!plate_shade_band(piece->plate, (int)(piece->first + band)))
            __atomic_store_n(&piece->plate->failed, true, __ATOMIC_RELAXED);
}

static void ink_some(void *arg, size_t begin, size_t end)
{
    const struct piece *piece = arg;
    for (size_t band = begin; band < end; band++)
        plate_ink_band(piece->plate, (int)(piece->first + band));
}

/* The next of `all` pieces of work, so many for each core. True: that was the last. */
static bool advance(struct plate *plate, size_t all, size_t some, size_t *begin, size_t *end)
{
    some *= (size_t)workers_count(plate->plates->workers);
    *begin = plate->at;
    *end = all - plate->at < some ? all : plate->at + some;
    plate->at = *end == all ? 0 : *end;
    return *end == all;
}

static bool is_selected_shown(const struct frame_context *context)
{
    int selected = context->view->selected_asset;
    for (size_t i = 0; i < context->visible_count && selected >= 0; i++)
        if (context->visible[i] == selected)
            return true;
    return false;
}

/* Of the selected asset. */
static bool mark(struct plate *plate, const struct frame *frame)
{
    struct draft *draft = plate->draft;
    if (!draft_make_room(draft, frame, BAND_ROWS) || !draft_find_only(draft, plate->context->view->selected_asset))
        return false;
    draft_tiles(draft, DRAFT_DEPTH);
    return true;
}

static bool complain(struct plate *plate)
{
    log_err(plate->plates->gpu_scene->gl->log, "still picture of %dx%d, %zu vertices: out of memory", plate->draft->width_px,
            plate->draft->height_px, plate->draft->vertex_count);
    plate->failed = true;
    return true;
}

bool plate_step(struct plate *plate, const struct frame_context *context, const struct light *light, struct frame *frame)
{
    struct draft *draft = plate->draft;
    struct workers *workers = plate->plates->workers;
    struct piece piece = { .plate = plate };
    size_t begin = 0, end = 0, bands = plate->recolor ? (size_t)plate->recolor->band_count : 0;
    bool done = true;
    if (plate->failed)
        return true;
    if (!take_up(plate, context, frame))
        return complain(plate);
    switch (plate->step) {
    case PLATE_CAPS:
        if (context->view->visibility.clip.plane_count == 0)
            break;
        begin = plate->at++;
        done = plate->at == SAMPLES;
        if (!find_caps(plate, frame, begin))
            return complain(plate);
        plate->at %= SAMPLES;
        break;
    case PLATE_COLLECT:
        if (!collect(plate, frame, light))
            return complain(plate);
        break;
    case PLATE_PLACE:
        done = advance(plate, draft->vertex_count, VERTICES, &begin, &end);
        piece.first = begin;
        draft_place(draft, begin, end);
        workers_for(workers, end - begin, 4096, place_some, &piece);
        break;
    case PLATE_SORT:
        done = advance(plate, draft->chunk_count, CHUNKS, &begin, &end);
        draft_sort(draft, begin, end);
        break;
    case PLATE_SHADE:
        done = advance(plate, bands, SHADED_BANDS, &begin, &end);
        piece.first = begin;
        workers_for(workers, end - begin, 1, shade_some, &piece);
        if (plate->failed)
            return complain(plate);
        break;
    case PLATE_INK:
        done = advance(plate, bands, BANDS, &begin, &end);
        piece.first = begin;
        workers_for(workers, end - begin, 1, ink_some, &piece);
        if (done)
            markers_find(context, draft->depth, (size_t)draft->pitch_px, frame);
        if (done && !keep_depth(plate))
            return complain(plate);
        break;
    case PLATE_GHOSTS:
        if (!find_ghosts(plate, frame))
            return complain(plate);
        break;
    case PLATE_MARK:
        if (is_selected_shown(context) && !mark(plate, frame))
            return complain(plate);
        break;
    case PLATE_RIM:
        if (is_selected_shown(context))
            draft_keep_rim(plate->draft, plate->recolor);
        break;
    case PLATE_SETTLE:
        if (!recolor_settle(plate->recolor, workers))
            return complain(plate);
        recolor_read(plate->recolor, context, workers);
        break;
    case PLATE_COLOR:
        done = advance(plate, bands, BANDS, &begin, &end);
        recolor_draw(plate->recolor, draft->colormap, &(struct recolor_lines){ draft->block.lines[0], draft->lines }, draft->block.scale[3],
                     workers, (int)begin, (int)(end - begin), frame);
        break;
    case PLATE_DONE: return true;
    }
    if (done)
        plate->step++;
    return plate->step == PLATE_DONE;
}

/* --- once more --------------------------------------------------------------------------------------------------------------- */

bool plates_keep(struct plates *plates, struct plate *plate, const struct frame_context *context, const struct isoline_points *points,
                 struct frame *frame)
{
    struct recolor *recolor = plate->recolor;
    if (plate->failed)
        return false;
    plate->recolor = NULL;
    if (recolor->lined)
        isolines_find(context, points, recolor->depth, (size_t)recolor->width_px, frame);
    draft_give(&plates->kept, context, recolor, frame);
    return true;
}

bool plates_know(struct plates *plates, const struct frame_context *context)
{
    double lines[VIEW_ALL_LINES];
    const struct recolor *recolor =
        plates_can(plates, context) ? visibility_buffers_find(&plates->kept, context->shape) : NULL;
    return recolor && (recolor->lined || view_lines(context->view, lines) == 0);
}

bool plates_recolor(struct plates *plates, const struct frame_context *context, const struct isoline_points *points, struct frame *frame)
{
    return plates_can(plates, context) && draft_recolor(plates->draft, &plates->kept, context, points, frame);
}
