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
enum { CLIP_FROM_FILE = 0, EYE_FROM_FILE = 1, SUN_FROM_FILE = 1, MATERIAL = 2, TEXTURES = 3, EYE_FROM_NORMAL = 4 };
/* Of how much depth changes from pixel to pixel, for each step of scene_asset.front: GPUs round corners to parts of a pixel, each triangle
   in its own way. */
static const double FORWARD_SLOPE = 0.05;
static const double SUN_SLACK_TEXELS = 3;                                           /* against surfaces that shade themselves */
enum { UNIT_PALETTE = 0, UNIT_RAMPS = 1, UNIT_SUN_MAP = 2, UNIT_MAPS = 3, UNIT_LINES = 15 };

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
    solid->log = log;
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
    model_draws_finish(&solid->draws);
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

/* cut: some of the asset is cut away. 0: it could not be made; logged. */
static GLuint choose_program(struct solid *solid, const struct picture *picture, const struct model_material *material,
                             const struct fields_entry *field, bool cut)
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
    enum solid_kind kind = kind_of(picture, field);
    if (picture->measured)
        variant &= SOLID_FIELD;
    if (cut)
        variant |= SOLID_CLIP;
    GLuint *program = &solid->programs[kind][view->tier][variant];
    if (!*program)
        *program = make_program(solid->log, kind, view->tier, variant);
    return *program;
}

double solid_sun_slack(const struct picture *picture)
{
    return SUN_SLACK_TEXELS * picture->light->texel_m / picture->light->depth_m;
}

static void set_placement(const struct picture *picture, const struct scene_asset *asset)
{
    const struct shot *shot = &picture->shot;
    double clip_from_file[16], eye_from_file[16], sun_from_file[16];
    float matrix[16], normals[9];
    matrix_multiply(shot->clip_from_plant, asset->placement, clip_from_file);
    shot_bring_forward(shot, asset, clip_from_file);
    matrix_to_float(clip_from_file, matrix);
    glUniformMatrix4fv(CLIP_FROM_FILE, 1, GL_FALSE, matrix);
    if (picture->measured)
        return;
    if (picture->view->tier == TIER_MOVING) {
        matrix_multiply(picture->light->texture_from_plant, asset->placement, sun_from_file);
        sun_from_file[14] += solid_sun_slack(picture);
        matrix_to_float(sun_from_file, matrix);
        glUniformMatrix4fv(SUN_FROM_FILE, 1, GL_FALSE, matrix);
        return;
    }
    matrix_translation((double[3]){ -shot->eye_m[0], -shot->eye_m[1], -shot->eye_m[2] }, eye_from_file);
    matrix_multiply(eye_from_file, asset->placement, eye_from_file);
    matrix_to_float(eye_from_file, matrix);
    glUniformMatrix4fv(EYE_FROM_FILE, 1, GL_FALSE, matrix);
    matrix_normals(asset->placement, normals);
    glUniformMatrix3fv(EYE_FROM_NORMAL, 1, GL_FALSE, normals);
}

/* cut: its inner side shows. */
static void set_material(const struct picture *picture, const struct model_material *material, const struct model_batch *batch,
                         bool field, bool cut)
{
    if (batch->double_sided || cut)
        glDisable(GL_CULL_FACE);
    else
        glEnable(GL_CULL_FACE);
    bool holes = picture->view->tier == TIER_MOVING && material->masked;
    if (picture->measured || (picture->view->tier == TIER_MOVING && field && !holes))
        return;
    glUniform1i(MATERIAL, (GLint)batch->material);
    if (holes && material->maps[MODEL_BASE_COLOR])
        glBindTextureUnit(UNIT_MAPS + MODEL_BASE_COLOR, material->maps[MODEL_BASE_COLOR]);
    if (picture->view->tier == TIER_MOVING)
        return;
    glUniform1i(TEXTURES, material->mask | material->second << 8);
    for (GLuint i = 0; i < MODEL_MAPS; i++)
        if (material->maps[i])
            glBindTextureUnit(UNIT_MAPS + i, material->maps[i]);
}

const struct model_level *solid_level(const struct picture *picture, int asset)
{
    return detail_level(picture, asset, picture->reference && !picture->measured ? 0 : picture->error_px);
}

/* One asset's surfaces, those that are blended or those that are not. A field is never blended: it would mix its colours. seen: not NULL:
   it is drawn by these commands, if others do not hide it. */
static void draw_asset(struct solid *solid, const struct picture *picture, int index, bool blend, const struct occlusion_asset *seen)
{
    const struct model *model = picture->stage->of_asset[index];
    const struct model_level *level = solid_level(picture, index);
    const struct fields_entry *field = picture->fields[index];
    const struct clip *clip = &picture->view->visibility.clip;
    const struct scene_asset *asset = &picture->stage->scene->assets[index];
    bool cut = clip_touches(clip, asset->bounds_min_m, asset->bounds_max_m);
    struct culling culling;
    GLuint bound = 0;
    size_t command = seen ? seen->first_command : 0;
    culling_init(&culling, &picture->shot, asset);
    if (cut)
        stage_clip_begin(clip);
    for (size_t b = 0; b < level->batch_count; command += (size_t)level->batches[b++].draws) {
        const struct model_batch *batch = &level->batches[b];
        const struct model_material *material = &model->materials[batch->material];
        GLuint program = choose_program(solid, picture, material, field, cut);
        if (!program || (batch->blend && !field) != blend)
            continue;
        if (!bound) {
            stage_set_front_face(asset);
            glPolygonOffset((float)(FORWARD_SLOPE * asset->front), 0);
            mesh_bind(&model->mesh, picture->light->baked[index], field ? field->buffer : 0);
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, model->material_buffer);
            glBindTextureUnit(UNIT_RAMPS, picture->view->look == LOOK_MATERIALS ? model->own_ramps : model->ramps);
            if (is_per_fragment(picture, field) && !reference_bind(picture->reference, index, field->sensors))
                return;
        }
        if (bound != program) {
            glUseProgram(program);
            set_placement(picture, asset);
            bound = program;
        }
        set_material(picture, material, batch, field != NULL, cut);
        if (is_per_fragment(picture, field))
            reference_draw_batch(batch);
        else if (seen)
            occlusion_draw_batch(&solid->occlusion, command, batch);
        else if (solid->least_hiding == INT_MAX && !picture->measured)
            solid->triangles += model_draw_seen(&solid->draws, model, batch, &culling, batch->double_sided || cut);
        else
            model_draw_batch(batch);
    }
    if (cut)
        stage_clip_end(clip);
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
    glVertexAttrib1f(MESH_SCALAR, 0); /* of a field without a buffer: no data */
    glVertexAttrib2f(MESH_FLAGS, 1, 0);
}

static void end_pass(const struct picture *picture)
{
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_POLYGON_OFFSET_FILL);
    gl_pass_leave(picture->stage->gl, "solid");
}

static bool leaves_out(struct solid *solid, const struct picture *picture)
{
    return !picture->measured && !picture->reference && occlusion_begin(&solid->occlusion, picture, solid->least_hiding);
}

/* In rounds, nearest first: each is tested against all before it. */
static void draw_seen(struct solid *solid, const struct picture *picture)
{
    struct occlusion *occlusion = &solid->occlusion;
    for (size_t first = 0, end; first < picture->visible_count; first = end) {
        end = first + occlusion_round(occlusion, first);
        if (first > 0)
            occlusion_test(occlusion, first, end);
        for (size_t i = first; i < end; i++)
            draw_asset(solid, picture, picture->visible[i], false, first > 0 && occlusion->assets[i].tested ? &occlusion->assets[i] : NULL);
    }
}

size_t solid_draw_some(struct solid *solid, const struct picture *picture, size_t first, int triangles)
{
    int before = solid->triangles;
    begin_pass(picture);
    if (first == 0 && triangles == INT_MAX && leaves_out(solid, picture)) {
        draw_seen(solid, picture);
        first = picture->visible_count;
    }
    while (first < picture->visible_count && solid->triangles - before < triangles)
        draw_asset(solid, picture, picture->visible[first++], false, NULL);
    end_pass(picture);
    return first;
}

void solid_draw_blended(struct solid *solid, const struct picture *picture)
{
    begin_pass(picture);
    if (!picture->measured)
        glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE);
    for (size_t i = picture->visible_count; i-- > 0;)
        draw_asset(solid, picture, picture->visible[i], true, NULL);
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
