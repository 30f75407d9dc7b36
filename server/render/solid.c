/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws assets: with their field, or as muted context. */
#include "render/solid.h"

#include <limits.h>

#include "base/text.h"
#include "gpu/program.h"
#include "render/culling.h"
#include "render/detail.h"
#include "render/matrix.h"

/* Uniform locations and texture units, as in the shaders. */
enum { MATERIAL = 2, TEXTURES = 3 };
/* Of how much depth changes from pixel to pixel, for each step of scene_asset.front: GPUs round corners to parts of a pixel, each triangle
   in its own way. */
static const double FORWARD_SLOPE = 0.05;
static const double SUN_SLACK_TEXELS = 3;                                           /* against surfaces that shade themselves */
enum { UNIT_PALETTE = 0, UNIT_RAMPS = 1, UNIT_SUN_MAP = 2, UNIT_MAPS = 3, UNIT_LIGHTS = 12, UNIT_SCALARS = 13, UNIT_LINES = 15 };

/* From the beginning. Of textures the moving tier has only the holes that they cut; rich scales and gloss go with a field. */
static bool is_used(int tier, int variant)
{
    if (variant & SOLID_CLIP)
        return false;
    if (!(variant & SOLID_FIELD))
        return variant == 0 || (variant == SOLID_TEXTURED && tier == TIER_STILL);
    return !(tier == TIER_MOVING && variant & SOLID_TEXTURED);
}

static GLuint make_program(struct log *log, enum solid_kind kind, int tier, int variant)
{
    static const char *const stages[2][2] = { { "moving.vert", "moving.frag" }, { "still.vert", "still.frag" } };
    bool reference = kind == SOLID_PER_FRAGMENT || kind == SOLID_MEASURE_PER_FRAGMENT;
    bool measure = kind == SOLID_MEASURE || kind == SOLID_MEASURE_PER_FRAGMENT;
    struct text defines = { 0 };
    text_add(&defines, "%s%s%s%s%s%s%s", tier == TIER_STILL ? "#define STILL\n" : "", variant & SOLID_FIELD ? "#define FIELD\n" : "",
             variant & SOLID_CLIP ? "#define CLIP\n" : "",
             variant & SOLID_RICH ? "#define RICH\n" : "", variant & SOLID_GLOSSY ? "#define GLOSSY\n" : "",
             variant & SOLID_TEXTURED ? "#define TEXTURED\n" : "", reference && variant & SOLID_FIELD ? "#define PER_FRAGMENT\n" : "");
    GLuint program = program_create(log, program_params(.vertex = stages[tier][0], .fragment = measure ? "measure.frag" : stages[tier][1],
                                                        .defines = defines.at));
    text_finish(&defines);
    return program;
}

bool solid_init(struct solid *solid, struct log *log)
{
    bool good = occlusion_init(&solid->occlusion, log);
    solid->log = solid->solids.log = solid->blended.log = log;
    for (int tier = 0; tier < 2; tier++)
        for (int variant = 0; variant < SOLID_VARIANTS; variant++)
            if (is_used(tier, variant)) {
                solid->programs[SOLID_PICTURE][tier][variant] = make_program(log, SOLID_PICTURE, tier, variant);
                good = good && solid->programs[SOLID_PICTURE][tier][variant];
            }
    return good;
}

void solid_finish(struct solid *solid)
{
    occlusion_finish(&solid->occlusion);
    bundles_finish(&solid->solids);
    bundles_finish(&solid->blended);
    for (int i = 0; i < SOLID_KINDS * 2 * SOLID_VARIANTS; i++)
        program_destroy(&solid->programs[i / (2 * SOLID_VARIANTS)][i / SOLID_VARIANTS % 2][i % SOLID_VARIANTS]);
}

static bool is_per_fragment(const struct picture *picture, const struct fields_entry *field)
{
    return picture->reference && field && field->sensors;
}

static enum solid_kind kind_of(const struct picture *picture, const struct fields_entry *field)
{
    bool reference = is_per_fragment(picture, field);
    if (picture->measured)
        return reference ? SOLID_MEASURE_PER_FRAGMENT : SOLID_MEASURE;
    return reference ? SOLID_PER_FRAGMENT : SOLID_PICTURE;
}

/* cut: some of the asset is cut away. */
static int choose_variant(const struct picture *picture, const struct model_material *material, const struct fields_entry *field, bool cut)
{
    const struct view *view = picture->view;
    int variant = field ? SOLID_FIELD : 0;
    if (field && (picture->palette.lines || view->paint.log))
        variant |= SOLID_RICH;
    if (!field && view_is_operator(view)) /* grey: no material near the tints that mean limits */
        variant |= SOLID_RICH;
    if (field && view->look == LOOK_GLOSSY)
        variant |= SOLID_GLOSSY;
    if (view->tier == TIER_MOVING && material->masked && material->maps[MODEL_BASE_COLOR])
        variant |= SOLID_TEXTURED;
    if (view->tier == TIER_STILL && material->mask && (!field || view->look == LOOK_GLOSSY || material->masked))
        variant |= SOLID_TEXTURED;
    if (picture->measured)
        variant &= SOLID_FIELD;
    return variant | (cut ? SOLID_CLIP : 0);
}

/* 0: it could not be made; logged. */
static GLuint choose_program(struct solid *solid, const struct picture *picture, const struct fields_entry *field, int variant)
{
    enum solid_kind kind = kind_of(picture, field);
    int tier = picture->view->tier;
    GLuint *program = &solid->programs[kind][tier][variant];
    if (!*program)
        *program = make_program(solid->log, kind, tier, variant);
    return *program;
}

static bool looks_at_material(const struct picture *picture, int variant)
{
    bool rich_light = picture->view->tier == TIER_STILL && variant & SOLID_GLOSSY;
    return !picture->measured && (!(variant & SOLID_FIELD) || variant & SOLID_TEXTURED || rich_light);
}

double solid_sun_slack(const struct picture *picture)
{
    return SUN_SLACK_TEXELS * picture->light->texel_m / picture->light->depth_m;
}

static void to_rows(const double matrix[16], float rows[3][4])
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            rows[r][c] = (float)matrix[4 * c + r];
}

static void place_instance(const struct picture *picture, int index, const struct fields_entry *field, struct bundle_instance *out)
{
    const struct shot *shot = &picture->shot;
    const struct scene_asset *asset = &picture->stage->scene->assets[index];
    double clip_from_file[16], from_file[16];
    float normals[9];
    matrix_multiply(shot->clip_from_plant, asset->placement, clip_from_file);
    shot_bring_forward(shot, asset, clip_from_file);
    matrix_to_float(clip_from_file, out->clip_from_file);
    if (picture->view->tier == TIER_MOVING) {
        matrix_multiply(picture->light->texture_from_plant, asset->placement, from_file);
        from_file[14] += solid_sun_slack(picture);
    } else {
        matrix_translation((double[3]){ -shot->eye_m[0], -shot->eye_m[1], -shot->eye_m[2] }, from_file);
        matrix_multiply(from_file, asset->placement, from_file);
    }
    to_rows(from_file, out->from_file);
    matrix_normals(asset->placement, normals);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            out->normals[r][c] = normals[3 * c + r];
    out->normals[0][3] = (float)picture->light->baked[index]->block;
    out->normals[1][3] = field && field->slice ? (float)field->slice->block : -1;
    out->normals[2][3] = 0;
}

const struct model_level *solid_level(const struct picture *picture, int asset)
{
    return detail_level(picture, asset, picture->reference && !picture->measured ? 0 : picture->error_px);
}

/* One asset's surfaces, those that are blended or those that are not. A field is never blended: it would mix its colours. hidden: it is
   drawn only if the GPU says so. */
static void gather(struct solid *solid, struct bundles *bundles, const struct picture *picture, int index, bool hidden)
{
    const struct stage *stage = picture->stage;
    const struct model *model = stage->of_asset[index];
    const struct model_level *level = solid_level(picture, index);
    const struct fields_entry *field = picture->fields[index];
    const struct scene_asset *asset = &stage->scene->assets[index];
    bool blend = bundles == &solid->blended, alone = is_per_fragment(picture, field);
    bool all = alone || solid->least_hiding != INT_MAX || picture->measured, placed = false;
    struct bundle_state state = { .model = model,
                                  .light = picture->light->baked[index]->page,
                                  .field = field && field->slice ? field->slice->page : NULL,
                                  .front = asset->front,
                                  .alone = alone ? index : -1,
                                  .mirrored = stage_mirrored(asset),
                                  .blend = blend,
                                  .cut = clip_touches(&picture->view->visibility.clip, asset->bounds_min_m, asset->bounds_max_m) };
    struct culling culling;
    uint32_t instance = 0;
    for (size_t b = 0; b < level->batch_count; b++) {
        const struct model_batch *batch = &level->batches[b];
        int variant = choose_variant(picture, &model->materials[batch->material], field, state.cut);
        if ((batch->blend && !field) != blend)
            continue;
        state.program = choose_program(solid, picture, field, variant);
        if (!state.program)
            continue;
        state.two_sided = batch->double_sided || state.cut; /* the inner side of what is cut shows */
        state.material = looks_at_material(picture, variant) ? (int)batch->material : -1;
        if (!placed) {
            struct bundle_instance place;
            place_instance(picture, index, field, &place);
            instance = bundles_add_instance(bundles, &place);
            if (!all)
                culling_init(&culling, &picture->shot, asset);
            placed = true;
        }
        size_t bundle = bundles_choose(bundles, &state, (size_t)(model - stage->models), blend);
        if (all)
            bundles_add_batch(bundles, bundle, batch, instance, !hidden);
        else
            solid->triangles += bundles_add_seen(bundles, bundle, batch, instance, &culling);
    }
}

/* --- drawing ---------------------------------------------------------------------------------------------------------------- */

static void set_material(const struct picture *picture, const struct bundle_state *state)
{
    const struct model_material *material = &state->model->materials[state->material];
    glUniform1i(MATERIAL, state->material);
    if (picture->view->tier == TIER_STILL)
        glUniform1i(TEXTURES, material->mask | material->second << 8);
    if (material->mask)
        glBindTextures(UNIT_MAPS, MODEL_MAPS, material->maps);
}

/* was: what is set; NULL: nothing. */
static void set_state(const struct bundles *bundles, const struct picture *picture, const struct bundle_state *is,
                      const struct bundle_state *was)
{
    const struct clip *clip = &picture->view->visibility.clip;
    if (!was || is->program != was->program)
        glUseProgram(is->program);
    if (!was || is->two_sided != was->two_sided)
        (is->two_sided ? glDisable : glEnable)(GL_CULL_FACE);
    if (!was || is->mirrored != was->mirrored)
        glFrontFace(is->mirrored ? GL_CW : GL_CCW);
    if (!was || is->front != was->front)
        glPolygonOffset((float)(FORWARD_SLOPE * is->front), 0);
    if (is->cut != (was && was->cut))
        (is->cut ? stage_clip_begin : stage_clip_end)(clip);
    if (!was || is->model != was->model) {
        mesh_bind_instances(&is->model->mesh, bundles->instance_buffer);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, is->model->material_buffer);
        glBindTextureUnit(UNIT_RAMPS, picture->view->look == LOOK_MATERIALS ? is->model->own_ramps : is->model->ramps);
    }
    if (!was || is->light != was->light)
        glBindTextureUnit(UNIT_LIGHTS, is->light->texture);
    if (is->field && (!was || is->field != was->field))
        glBindTextureUnit(UNIT_SCALARS, is->field->texture);
    if (is->material >= 0 && (!was || is->program != was->program || is->model != was->model || is->material != was->material))
        set_material(picture, is);
}

/* The bundles from `first` on. */
static void draw_bundles(const struct bundles *bundles, const struct picture *picture, size_t first, size_t end)
{
    const struct bundle_state *was = NULL;
    for (size_t i = first; i < end; i++) {
        const struct bundle *bundle = &bundles->at[i];
        const struct bundle_state *is = &bundle->state;
        if (bundle->count == 0)
            continue;
        set_state(bundles, picture, is, was);
        was = is;
        if (is->alone < 0)
            bundles_draw(bundles, bundle);
        else if (reference_bind(picture->reference, is->alone, picture->fields[is->alone]->sensors))
            reference_draw(&bundles->sorted[bundle->first], bundle->count);
    }
    if (was && was->cut)
        stage_clip_end(&picture->view->visibility.clip);
}

static void begin_pass(const struct picture *picture)
{
    gl_pass_enter("solid");
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    glBindTextureUnit(UNIT_PALETTE, picture->palette.colors);
    glBindTextureUnit(UNIT_LINES, picture->palette.lines);
    glBindTextureUnit(UNIT_SUN_MAP, picture->light->sun_map);
    glVertexAttrib4f(MESH_COLOR, 1, 1, 1, 1);
}

static void end_pass(const struct picture *picture)
{
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_POLYGON_OFFSET_FILL);
    gl_pass_leave(picture->stage->gl, "solid");
}

static void draw_gathered(struct bundles *bundles, const struct picture *picture)
{
    if (bundles->command_count > 0 && bundles_upload(bundles, false))
        draw_bundles(bundles, picture, 0, bundles->count);
    bundles_begin(bundles, picture->stage->model_count);
}

static bool leaves_out(struct solid *solid, const struct picture *picture)
{
    return !picture->measured && !picture->reference && occlusion_begin(&solid->occlusion, picture, solid->least_hiding);
}

/* In rounds, nearest first: each is tested against all before it. */
static void draw_seen(struct solid *solid, const struct picture *picture)
{
    struct occlusion *occlusion = &solid->occlusion;
    struct bundles *bundles = &solid->solids;
    size_t ends[OCCLUSION_ROUNDS], rounds = 0;
    for (size_t first = 0, end; first < picture->visible_count; first = end) {
        end = first + occlusion_round(occlusion, first);
        bundles->from = bundles->count;
        for (size_t i = first; i < end; i++) {
            struct occlusion_asset *asset = &occlusion->assets[i];
            size_t command = bundles->command_count;
            bool hidden = first > 0 && asset->tested;
            gather(solid, bundles, picture, picture->visible[i], hidden);
            if (hidden)
                occlusion_decides(occlusion, asset, command, bundles->command_count - command);
        }
        ends[rounds++] = bundles->count;
    }
    bool good = bundles_upload(bundles, true) && occlusion_upload(occlusion);
    for (size_t first = 0, end, round = 0; good && first < picture->visible_count; first = end, round++) {
        end = first + occlusion_round(occlusion, first);
        if (round > 0)
            occlusion_test(occlusion, bundles, first, end);
        draw_bundles(bundles, picture, round ? ends[round - 1] : 0, ends[round]);
    }
    bundles->command_count = 0;
}

size_t solid_draw_some(struct solid *solid, const struct picture *picture, size_t first, int triangles)
{
    struct bundles *bundles = &solid->solids;
    int before = solid->triangles;
    begin_pass(picture);
    bundles_begin(bundles, picture->stage->model_count);
    if (first == 0 && triangles == INT_MAX && leaves_out(solid, picture)) {
        draw_seen(solid, picture);
        first = picture->visible_count;
    }
    while (first < picture->visible_count && solid->triangles - before < triangles) {
        gather(solid, bundles, picture, picture->visible[first++], false);
        if (solid->one_by_one)
            draw_gathered(bundles, picture);
    }
    draw_gathered(bundles, picture);
    end_pass(picture);
    return first;
}

void solid_draw_blended(struct solid *solid, const struct picture *picture)
{
    begin_pass(picture);
    if (!picture->measured)
        glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE);
    bundles_begin(&solid->blended, picture->stage->model_count);
    for (size_t i = picture->visible_count; i-- > 0;) {
        gather(solid, &solid->blended, picture, picture->visible[i], false);
        if (solid->one_by_one)
            draw_gathered(&solid->blended, picture);
    }
    draw_gathered(&solid->blended, picture);
    end_pass(picture);
}

void solid_draw(struct solid *solid, const struct picture *picture)
{
    solid_draw_some(solid, picture, 0, INT_MAX);
    solid_draw_blended(solid, picture);
}

int solid_triangles(const struct picture *picture)
{
    int count = 0;
    for (size_t i = 0; i < picture->visible_count; i++)
        count += solid_level(picture, picture->visible[i])->triangles;
    return count;
}
