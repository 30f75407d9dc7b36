/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws assets with their field, or in muted colours as context. */
#include "render/gl/surface_pass.h"

#include <limits.h>

#include "base/text/text.h"
#include "gpu/program.h"
#include "render/plan/culling.h"
#include "render/matrix.h"

/* Uniform locations of the shaders preview.* and refined.*; must match these shaders. */
enum { MATERIAL = 2, TEXTURES = 3 };
/* Factor of the polygon offset for each rank in scene_asset.front, which orders assets whose faces coincide. GPUs round corners
   to fractions of a pixel, differently for each triangle. The depths of coincident faces therefore differ by a fraction of the
   faces' depth slope. */
static const double FORWARD_SLOPE = 0.05;
/* A field that each pixel computes from at least this many sensors is drawn in two passes: first depth alone, then colours. The
   sums over all sensors are then computed only for visible surfaces. */
enum { DEPTH_FIRST_SENSORS = 16 };
enum { UNIT_COLORMAP = 0, UNIT_RAMPS = 1, UNIT_SUN_MAP = 2, UNIT_MAPS = 3, UNIT_LIGHTS = 12, UNIT_SCALARS = 13, UNIT_LINES = 15 };

/* Returns whether a variant of the shader program is compiled at start because most plants use it; other variants are compiled
   on first use. Variants for section planes are rare. Previews use textures only to cut holes, which is rare, too. Without a
   field, only the plain program and, in refined frames, the textured one are frequent. */
static bool is_used(int tier, int variant)
{
    if (variant & SURFACE_CLIP)
        return false;
    if (!(variant & SURFACE_FIELD))
        return variant == 0 || (variant == SURFACE_TEXTURED && tier == TIER_REFINED);
    return !(tier == TIER_PREVIEW && variant & SURFACE_TEXTURED);
}

static GLuint make_program(struct log *log, enum surface_program_kind kind, int tier, int variant)
{
    static const char *const stages[2][2] = { { "preview.vert", "preview.frag" }, { "refined.vert", "refined.frag" } };
    static const char *const sources[] = { "", "#define PIXEL_FIELD\n", "#define PER_FRAGMENT\n" };
    bool measure = kind >= SURFACE_MEASURE;
    struct text defines = { 0 };
    text_add(&defines, "%s%s%s%s%s%s%s", tier == TIER_REFINED ? "#define REFINED\n" : "", variant & SURFACE_FIELD ? "#define FIELD\n" : "",
             variant & SURFACE_CLIP ? "#define CLIP\n" : "", variant & SURFACE_RICH ? "#define RICH\n" : "",
             variant & SURFACE_GLOSSY ? "#define GLOSSY\n" : "", variant & SURFACE_TEXTURED ? "#define TEXTURED\n" : "",
             variant & SURFACE_FIELD ? sources[kind % SURFACE_MEASURE] : "");
    GLuint program = program_create(log, program_params(.vertex = stages[tier][0], .fragment = measure ? "measure.frag" : stages[tier][1],
                                                        .defines = defines.at));
    text_finish(&defines);
    return program;
}

bool surface_pass_init(struct surface_pass *pass, struct log *log)
{
    bool good = occlusion_init(&pass->occlusion, log);
    pass->log = pass->opaque.log = pass->blended.log = pass->sensor_grids.log = log;
    for (int tier = 0; tier < 2; tier++)
        for (int variant = 0; variant < SURFACE_VARIANTS; variant++)
            if (is_used(tier, variant)) {
                pass->programs[SURFACE_PICTURE][tier][variant] = make_program(log, SURFACE_PICTURE, tier, variant);
                good = good && pass->programs[SURFACE_PICTURE][tier][variant];
            }
    return good;
}

void surface_pass_finish(struct surface_pass *pass)
{
    for (int i = 0; i < 4; i++)
        program_destroy(&pass->depth_programs[i / 2][i % 2]);
    sensor_grids_finish(&pass->sensor_grids);
    occlusion_finish(&pass->occlusion);
    draw_batches_finish(&pass->opaque);
    draw_batches_finish(&pass->blended);
    for (int i = 0; i < SURFACE_KINDS * 2 * SURFACE_VARIANTS; i++)
        program_destroy(&pass->programs[i / (2 * SURFACE_VARIANTS)][i / SURFACE_VARIANTS % 2][i % SURFACE_VARIANTS]);
}

static bool is_per_fragment(const struct frame_context *context, const struct fields_entry *field)
{
    return context->reference && field && field->sensors;
}

/* Returns whether shaders compute the field at each pixel from its sensors (field/pixel_field.h) instead of interpolating between
   vertices. */
static bool has_pixel_field(const struct frame_context *context, const struct fields_entry *field)
{
    return !context->reference && field && field->pixels.count > 0 && field->sensors;
}

static enum surface_program_kind kind_of(const struct frame_context *context, const struct fields_entry *field)
{
    enum surface_program_kind picture = is_per_fragment(context, field)   ? SURFACE_PER_FRAGMENT
                                        : has_pixel_field(context, field) ? SURFACE_PIXEL_FIELD
                                                                          : SURFACE_PICTURE;
    return context->measured ? picture + SURFACE_MEASURE : picture;
}

/* Returns the shader features (enum surface_variant) needed to draw one material of an asset. field NULL: the asset shows no
   field. cut: a section plane cuts the asset. */
static int choose_variant(const struct frame_context *context, const struct model_material *material, const struct fields_entry *field,
                          bool cut)
{
    const struct view *view = context->view;
    int variant = field ? SURFACE_FIELD : 0;
    if (field && (context->colormap.lines || view->color_scale.log))
        variant |= SURFACE_RICH;
    /* draws assets without a field in grey (RICH without FIELD) in the operator's display, because no material colour may
       resemble an alarm colour */
    if (!field && view_is_operator(view))
        variant |= SURFACE_RICH;
    if (field && view->look == LOOK_GLOSSY)
        variant |= SURFACE_GLOSSY;
    if (view->tier == TIER_PREVIEW && material->masked && material->maps[MODEL_BASE_COLOR])
        variant |= SURFACE_TEXTURED;
    if (view->tier == TIER_REFINED && material->mask && (!field || view->look == LOOK_GLOSSY || material->masked))
        variant |= SURFACE_TEXTURED;
    if (context->measured)
        variant &= SURFACE_FIELD;
    return variant | (cut ? SURFACE_CLIP : 0);
}

/* Returns the shader program with the features `variant`, compiled on first use. 0: compiling failed (logged). */
static GLuint choose_program(struct surface_pass *pass, const struct frame_context *context, const struct fields_entry *field, int variant)
{
    enum surface_program_kind kind = kind_of(context, field);
    int tier = context->view->tier;
    GLuint *program = &pass->programs[kind][tier][variant];
    if (!*program)
        *program = make_program(pass->log, kind, tier, variant);
    return *program;
}

/* Returns the shader program that writes only the depth of a batch with the features `variant`. 0: the batch has holes, its field
   is interpolated or has few sensors, or compiling failed (logged); its depth is then not drawn first. */
static GLuint choose_depth_program(struct surface_pass *pass, const struct frame_context *context, const struct fields_entry *field,
                                   int variant)
{
    if (!has_pixel_field(context, field) || field->pixels.count < DEPTH_FIRST_SENSORS || variant & SURFACE_TEXTURED)
        return 0;
    int tier = context->view->tier;
    bool cut = variant & SURFACE_CLIP;
    GLuint *program = &pass->depth_programs[tier][cut];
    if (!*program)
        *program = program_create(pass->log, program_params(.vertex = tier == TIER_REFINED ? "refined.vert" : "preview.vert",
                                                            .fragment = "depth.frag", .defines = cut ? "#define CLIP\n" : ""));
    return *program;
}

static bool looks_at_material(const struct frame_context *context, int variant)
{
    bool rich_light = context->view->tier == TIER_REFINED && variant & SURFACE_GLOSSY;
    return !context->measured && (!(variant & SURFACE_FIELD) || variant & SURFACE_TEXTURED || rich_light);
}

static void to_rows(const double matrix[16], float rows[3][4])
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            rows[r][c] = (float)matrix[4 * c + r];
}

static void place_instance(const struct frame_context *context, int index, const struct fields_entry *field, struct draw_instance *out)
{
    const struct view_constants *constants = &context->constants;
    const struct scene_asset *asset = &context->gpu_scene->scene->assets[index];
    double clip_from_file[16], from_file[16];
    float normals[9];
    matrix_multiply(constants->clip_from_plant, asset->placement, clip_from_file);
    view_constants_bring_forward(constants, asset, clip_from_file);
    matrix_to_float(clip_from_file, out->clip_from_file);
    if (context->view->tier == TIER_PREVIEW) {
        matrix_multiply(context->light->texture_from_plant, asset->placement, from_file);
        from_file[14] += frame_sun_slack(context);
    } else {
        matrix_translation((double[3]){ -constants->eye_m[0], -constants->eye_m[1], -constants->eye_m[2] }, from_file);
        matrix_multiply(from_file, asset->placement, from_file);
    }
    to_rows(from_file, out->from_file);
    matrix_normals(asset->placement, normals);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            out->normals[r][c] = normals[3 * c + r];
    out->normals[0][3] = (float)context->light->baked[index]->block;
    out->normals[1][3] = field && field->slice ? (float)field->slice->block : -1;
    out->normals[2][3] = 0;
}

/* Adds draw commands for one asset's blended or opaque surfaces to `batches`. An asset that shows a field is always opaque, since blending
   would mix the field's colours. hidden true: the GPU draws the asset only if its occlusion test enables the commands. */
static void gather(struct surface_pass *pass, struct draw_batches *batches, const struct frame_context *context, int index, bool hidden)
{
    const struct gpu_scene *gpu_scene = context->gpu_scene;
    const struct gl_model *model = gpu_scene->of_asset[index];
    const struct model_level *level = frame_level(context, index);
    const struct fields_entry *field = context->fields[index];
    const struct scene_asset *asset = &gpu_scene->scene->assets[index];
    bool blend = batches == &pass->blended, per_fragment = is_per_fragment(context, field);
    bool alone = per_fragment || has_pixel_field(context, field), placed = false;
    bool all = per_fragment || pass->least_hiding != INT_MAX || context->measured;
    struct draw_batch_state state = { .model = model,
                                      .light = context->light->baked[index]->page,
                                      .field = field && field->slice ? field->slice->page : NULL,
                                      .front = asset->front,
                                      .alone = alone ? index : -1,
                                      .mirrored = scene_asset_mirrored(asset),
                                      .blend = blend,
                                      .cut = clip_touches(&context->view->visibility.clip, asset->bounds_min_m, asset->bounds_max_m) };
    struct culling culling;
    uint32_t instance = 0;
    for (size_t b = 0; b < level->submesh_count; b++) {
        const struct model_submesh *submesh = &level->submeshes[b];
        int variant = choose_variant(context, &model->materials[submesh->material], field, state.cut);
        if ((submesh->blend && !field) != blend)
            continue;
        state.program = choose_program(pass, context, field, variant);
        if (!state.program)
            continue;
        state.depth_program = choose_depth_program(pass, context, field, variant);
        /* assets that a section plane cuts show their inner side, so back faces are drawn */
        state.two_sided = submesh->double_sided || state.cut;
        state.material = looks_at_material(context, variant) ? (int)submesh->material : -1;
        if (!placed) {
            struct draw_instance place;
            place_instance(context, index, field, &place);
            instance = draw_batches_add_instance(batches, &place);
            if (!all)
                culling_init(&culling, &context->constants, asset);
            placed = true;
        }
        size_t batch = draw_batches_choose(batches, &state, (size_t)(model - gpu_scene->models), blend);
        if (all)
            draw_batches_add_submesh(batches, batch, submesh, instance, !hidden);
        else
            pass->triangles += draw_batches_add_seen(batches, batch, submesh, instance, &culling);
    }
}

/* --- lists of near sensors --------------------------------------------------------------------------------------------------- */

void surface_pass_prepare(struct surface_pass *pass, struct fields *fields, const struct frame_context *context)
{
    for (size_t i = 0; i < context->visible_count; i++) {
        int asset = context->visible[i];
        struct fields_entry *entry = (struct fields_entry *)context->fields[asset];
        if (!has_pixel_field(context, entry))
            continue;
        fields->bytes -= entry->cells ? entry->cells->bytes : 0;
        const struct sensor_cells_params params = { .gl = context->gpu_scene->gl,
                                                    .model = context->gpu_scene->of_asset[asset],
                                                    .field = &entry->pixels,
                                                    .sensors = entry->sensors,
                                                    .step = entry->step };
        sensor_cells_update(&pass->sensor_grids, &params, &entry->cells);
        fields->bytes += entry->cells ? entry->cells->bytes : 0;
    }
}

/* --- drawing ---------------------------------------------------------------------------------------------------------------- */

static void set_material(const struct frame_context *context, const struct draw_batch_state *state)
{
    const struct model_material *material = &state->model->materials[state->material];
    glUniform1i(MATERIAL, state->material);
    if (context->view->tier == TIER_REFINED)
        glUniform1i(TEXTURES, material->mask | material->second << 8);
    if (material->mask)
        glBindTextures(UNIT_MAPS, MODEL_MAPS, material->maps);
}

/* Sets the members of the GL state that differ between a batch (`is`) and the current state (`was`). was NULL: the current
   state is unknown, so everything is set. */
static void set_state(const struct draw_batches *batches, const struct frame_context *context, const struct draw_batch_state *is,
                      const struct draw_batch_state *was)
{
    const struct clip *clip = &context->view->visibility.clip;
    if (!was || is->program != was->program)
        glUseProgram(is->program);
    if (!was || is->two_sided != was->two_sided)
        (is->two_sided ? glDisable : glEnable)(GL_CULL_FACE);
    if (!was || is->mirrored != was->mirrored)
        glFrontFace(is->mirrored ? GL_CW : GL_CCW);
    if (!was || is->front != was->front)
        glPolygonOffset((float)(FORWARD_SLOPE * is->front), 0);
    if (is->cut != (was && was->cut))
        (is->cut ? gpu_scene_clip_begin : gpu_scene_clip_end)(clip);
    if (!was || is->model != was->model) {
        mesh_bind_instances(&is->model->mesh, batches->instance_buffer);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, is->model->material_buffer);
        glBindTextureUnit(UNIT_RAMPS, is->model->ramps[context->view->look == LOOK_MATERIALS ? MODEL_OWN : MODEL_MUTED]);
    }
    if (!was || is->light != was->light)
        glBindTextureUnit(UNIT_LIGHTS, is->light->texture);
    if (is->field && (!was || is->field != was->field))
        glBindTextureUnit(UNIT_SCALARS, is->field->texture);
    if (is->material >= 0 && (!was || is->program != was->program || is->model != was->model || is->material != was->material))
        set_material(context, is);
}

/* Draws the depth of a batch, and leaves the batch's own program in use. */
static void draw_depth(const struct draw_batches *batches, const struct draw_batch *batch)
{
    glUseProgram(batch->state.depth_program);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    draw_batches_draw(batches, batch);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glUseProgram(batch->state.program);
}

/* Draws the batches first..end-1. */
static void draw_batch_range(struct surface_pass *pass, const struct draw_batches *batches, const struct frame_context *context,
                             size_t first, size_t end)
{
    const struct draw_batch_state *was = NULL;
    for (size_t i = first; i < end; i++) {
        const struct draw_batch *batch = &batches->at[i];
        const struct draw_batch_state *is = &batch->state;
        if (batch->count == 0)
            continue;
        set_state(batches, context, is, was);
        was = is;
        if (is->depth_program)
            draw_depth(batches, batch);
        if (is->alone >= 0 && !context->reference)
            sensor_cells_bind(&pass->sensor_grids, context->fields[is->alone]->sensors, context->fields[is->alone]->cells);
        if (is->alone < 0 || !context->reference)
            draw_batches_draw(batches, batch);
        else if (reference_bind(context->reference, is->alone, context->fields[is->alone]->sensors))
            reference_draw(&batches->sorted[batch->first], batch->count);
    }
    if (was && was->cut)
        gpu_scene_clip_end(&context->view->visibility.clip);
}

static void begin_pass(const struct frame_context *context)
{
    gl_pass_enter("pass");
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    glBindTextureUnit(UNIT_COLORMAP, context->colormap.colors);
    glBindTextureUnit(UNIT_LINES, context->colormap.lines);
    glBindTextureUnit(UNIT_SUN_MAP, context->light->sun_map);
    glVertexAttrib4f(MESH_COLOR, 1, 1, 1, 1);
}

static void end_pass(const struct frame_context *context)
{
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_POLYGON_OFFSET_FILL);
    gl_pass_leave(context->gpu_scene->gl, "pass");
}

static void draw_gathered(struct surface_pass *pass, struct draw_batches *batches, const struct frame_context *context)
{
    if (batches->command_count > 0 && draw_batches_upload(batches, false))
        draw_batch_range(pass, batches, context, 0, batches->count);
    draw_batches_begin(batches, context->gpu_scene->model_count);
}

static bool leaves_out(struct surface_pass *pass, const struct frame_context *context)
{
    return !context->measured && !context->reference && occlusion_begin(&pass->occlusion, context, pass->least_hiding);
}

/* Draws opaque assets with occlusion culling, in rounds, nearest first. Before each round, the bounding boxes of its assets are
   tested against the depth of all earlier rounds. */
static void draw_seen(struct surface_pass *pass, const struct frame_context *context)
{
    struct occlusion *occlusion = &pass->occlusion;
    struct draw_batches *batches = &pass->opaque;
    size_t ends[OCCLUSION_ROUNDS], rounds = 0;
    for (size_t first = 0, end; first < context->visible_count; first = end) {
        end = first + occlusion_round(occlusion, first);
        batches->from = batches->count;
        for (size_t i = first; i < end; i++) {
            struct occlusion_asset *asset = &occlusion->assets[i];
            size_t command = batches->command_count;
            bool hidden = first > 0 && asset->tested;
            gather(pass, batches, context, context->visible[i], hidden);
            if (hidden)
                occlusion_decides(occlusion, asset, command, batches->command_count - command);
        }
        ends[rounds++] = batches->count;
    }
    bool good = draw_batches_upload(batches, true) && occlusion_upload(occlusion);
    for (size_t first = 0, end, round = 0; good && first < context->visible_count; first = end, round++) {
        end = first + occlusion_round(occlusion, first);
        if (round > 0)
            occlusion_test(occlusion, batches, first, end);
        draw_batch_range(pass, batches, context, round ? ends[round - 1] : 0, ends[round]);
    }
    batches->command_count = 0;
}

size_t surface_pass_draw_some(struct surface_pass *pass, const struct frame_context *context, size_t first, int triangles)
{
    struct draw_batches *batches = &pass->opaque;
    int before = pass->triangles;
    begin_pass(context);
    draw_batches_begin(batches, context->gpu_scene->model_count);
    if (first == 0 && triangles == INT_MAX && leaves_out(pass, context)) {
        draw_seen(pass, context);
        first = context->visible_count;
    }
    while (first < context->visible_count && pass->triangles - before < triangles) {
        gather(pass, batches, context, context->visible[first++], false);
        if (pass->one_by_one)
            draw_gathered(pass, batches, context);
    }
    draw_gathered(pass, batches, context);
    end_pass(context);
    return first;
}

void surface_pass_draw_blended(struct surface_pass *pass, const struct frame_context *context)
{
    begin_pass(context);
    if (!context->measured)
        glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE);
    draw_batches_begin(&pass->blended, context->gpu_scene->model_count);
    for (size_t i = context->visible_count; i-- > 0;) {
        gather(pass, &pass->blended, context, context->visible[i], false);
        if (pass->one_by_one)
            draw_gathered(pass, &pass->blended, context);
    }
    draw_gathered(pass, &pass->blended, context);
    end_pass(context);
}
