/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uploads the models of all assets, and draws the depth of one asset. */
#include "render/gl/gpu_scene.h"

#include <math.h>

#include "base/mem.h"
#include "gpu/program.h"
#include "render/gl/materials.h"
#include "render/matrix.h"

static struct gl_model *find_model(struct gpu_scene *gpu_scene, const struct asset *file)
{
    for (size_t i = 0; i < gpu_scene->model_count; i++)
        if (gpu_scene->models[i].file == file)
            return &gpu_scene->models[i];
    return NULL;
}

static void find_ball(struct gpu_scene *gpu_scene)
{
    double square = 0;
    for (int i = 0; i < 3; i++) {
        double half = 0.5 * (gpu_scene->scene->bounds_max_m[i] - gpu_scene->scene->bounds_min_m[i]);
        gpu_scene->middle_m[i] = gpu_scene->scene->bounds_min_m[i] + half;
        square += half * half;
    }
    gpu_scene->radius_m = fmax(sqrt(square) * 1.001, 1e-3);
}

static bool make_depth_programs(struct gpu_scene *gpu_scene)
{
    static const char *const defines[2][2] = { { "", "#define HOLES\n" }, { "#define CLIP\n", "#define CLIP\n#define HOLES\n" } };
    bool good = true;
    for (int cut = 0; cut < 2; cut++)
        for (int holes = 0; holes < 2; holes++) {
            gpu_scene->depth_programs[cut][holes] =
                program_create(gpu_scene->gl->log,
                               program_params(.vertex = "depth.vert", .fragment = "depth.frag", .defines = defines[cut][holes]));
            good = good && gpu_scene->depth_programs[cut][holes];
        }
    return good;
}

/* Uploads the model and the materials of one asset file. On failure, logs the reason and returns false. */
static bool add_model(const struct gpu_scene *gpu_scene, struct gl_model *model, const struct asset *file,
                      const struct environment_light *sky)
{
    struct gl *gl = gpu_scene->gl;
    if (model_init(model, gl, file) && materials_upload(model, gl, sky, gpu_scene->up))
        return true;
    log_err(gl->log, "%s: not drawn: %u vertices and %u textures do not fit into GPU memory", file->path, file->view.header->vertex_count,
            file->view.header->texture_count);
    return false;
}

bool gpu_scene_init(struct gpu_scene *gpu_scene, struct gl *gl, const struct scene *scene, const struct environment_light *sky)
{
    *gpu_scene = (struct gpu_scene){ .gl = gl, .scene = scene, .up = { 0, scene->plant->up == AXIS_Y, scene->plant->up == AXIS_Z } };
    gpu_scene->models = mem_array(scene->asset_count, sizeof(*gpu_scene->models));
    gpu_scene->of_asset = mem_array(scene->asset_count, sizeof(*gpu_scene->of_asset));
    bool good = make_depth_programs(gpu_scene);
    find_ball(gpu_scene);
    for (size_t i = 0; i < scene->asset_count && good; i++) {
        struct gl_model *model = find_model(gpu_scene, scene->assets[i].file);
        if (!model) {
            model = &gpu_scene->models[gpu_scene->model_count++];
            good = add_model(gpu_scene, model, scene->assets[i].file, sky);
        }
        gpu_scene->of_asset[i] = model;
    }
    return good;
}

void gpu_scene_finish(struct gpu_scene *gpu_scene)
{
    for (size_t i = 0; i < gpu_scene->model_count; i++) {
        materials_finish(&gpu_scene->models[i]);
        model_finish(&gpu_scene->models[i]);
    }
    mem_free(gpu_scene->models);
    mem_free(gpu_scene->of_asset);
    for (int i = 0; i < 4; i++)
        program_destroy(&gpu_scene->depth_programs[i / 2][i % 2]);
    *gpu_scene = (struct gpu_scene){ 0 };
}

const struct model_level *gpu_scene_level(const struct gpu_scene *gpu_scene, const struct view_constants *constants, int asset,
                                          double error_px)
{
    const struct scene_asset *at = &gpu_scene->scene->assets[asset];
    double square = 0;
    if (constants->pixel_per_metre > 0)
        return model_level(gpu_scene->of_asset[asset], error_px / constants->pixel_per_metre);
    for (int c = 0; c < 3; c++) {
        double outside = fmax(fmax(at->bounds_min_m[c] - constants->eye_m[c], constants->eye_m[c] - at->bounds_max_m[c]), 0);
        square += outside * outside;
    }
    return model_level(gpu_scene->of_asset[asset], error_px * sqrt(square) / constants->pixel_per_radian);
}

void gpu_scene_clip_begin(const struct clip *clip)
{
    for (int i = 0; i < clip->plane_count; i++)
        glEnable(GL_CLIP_DISTANCE0 + (GLenum)i);
}

void gpu_scene_clip_end(const struct clip *clip)
{
    for (int i = 0; i < clip->plane_count; i++)
        glDisable(GL_CLIP_DISTANCE0 + (GLenum)i);
}

/* Uniform locations and the texture unit of shaders/depth.vert and depth.frag; must match these shaders. */
enum { CLIP_FROM_FILE = 0, MATERIAL = 2, PLANES = 4, UNIT_BASE_COLOR = 3 };

static void set_planes(const double clip_from_plant[16], const struct clip *clip)
{
    float planes[CLIP_MAX_PLANES][4] = { { 0 } };
    double plant_from_clip[16];
    matrix_invert(clip_from_plant, plant_from_clip);
    for (int i = 0; i < clip->plane_count; i++) {
        double plane[4];
        clip_plane(clip, i, plane);
        matrix_plane(plant_from_clip, plane, planes[i]);
    }
    glUniform4fv(PLANES, CLIP_MAX_PLANES, planes[0]);
}

static bool has_holes(const struct gl_model *model, const struct model_submesh *submesh)
{
    const struct model_material *material = &model->materials[submesh->material];
    return material->masked && material->maps[MODEL_BASE_COLOR];
}

void gpu_scene_draw_depth(const struct gpu_scene *gpu_scene, const double clip_from_plant[16], const struct clip *clip, int asset,
                          double error_m, bool blended)
{
    const struct gl_model *model = gpu_scene->of_asset[asset];
    const struct model_level *level = model_level(model, error_m);
    bool cut = clip->plane_count > 0;
    GLuint bound = 0;
    double clip_from_file[16];
    float matrix[16];
    matrix_multiply(clip_from_plant, gpu_scene->scene->assets[asset].placement, clip_from_file);
    matrix_to_float(clip_from_file, matrix);
    glDisable(GL_CULL_FACE);
    gpu_scene_clip_begin(clip);
    mesh_bind(&model->mesh);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, model->material_buffer);
    for (size_t b = 0; b < level->submesh_count; b++) {
        const struct model_submesh *submesh = &level->submeshes[b];
        bool holes = has_holes(model, submesh);
        GLuint program = gpu_scene->depth_programs[cut][holes];
        if (submesh->blend && !blended)
            continue;
        if (program != bound) {
            glUseProgram(program);
            glUniformMatrix4fv(CLIP_FROM_FILE, 1, GL_FALSE, matrix);
            if (cut)
                set_planes(clip_from_plant, clip);
            bound = program;
        }
        if (holes) {
            glUniform1i(MATERIAL, (GLint)submesh->material);
            glBindTextureUnit(UNIT_BASE_COLOR, model->materials[submesh->material].maps[MODEL_BASE_COLOR]);
        }
        model_draw_submesh(submesh);
    }
    gpu_scene_clip_end(clip);
}

void gpu_scene_set_front_face(const struct scene_asset *asset)
{
    glFrontFace(scene_asset_mirrored(asset) ? GL_CW : GL_CCW);
}
