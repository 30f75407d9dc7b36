/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models by asset, frustum and levels of detail. */
#include "render/stage.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "gpu/program.h"
#include "render/matrix.h"
#include "scene/coincident.h"

static struct model *find_model(struct stage *stage, const struct asset *file)
{
    for (size_t i = 0; i < stage->model_count; i++)
        if (stage->models[i].file == file)
            return &stage->models[i];
    return NULL;
}

static void find_ball(struct stage *stage)
{
    double square = 0;
    for (int i = 0; i < 3; i++) {
        double half = 0.5 * (stage->scene->bounds_max_m[i] - stage->scene->bounds_min_m[i]);
        stage->middle_m[i] = stage->scene->bounds_min_m[i] + half;
        square += half * half;
    }
    stage->radius_m = fmax(sqrt(square) * 1.001, 1e-3);
}

bool stage_init(struct stage *stage, struct gl *gl, const struct scene *scene)
{
    *stage = (struct stage){ .gl = gl, .scene = scene, .up = { 0, scene->plant->up == AXIS_Y, scene->plant->up == AXIS_Z } };
    stage->models = mem_array(scene->asset_count, sizeof(*stage->models));
    stage->of_asset = mem_array(scene->asset_count, sizeof(*stage->of_asset));
    stage->depth_program = program_create(gl->log, program_params(.vertex = "depth.vert", .fragment = "depth.frag"));
    GLuint ramp_program = program_create(gl->log, program_params(.compute = "ramp.comp"));
    stage->clipped_depth_program =
        program_create(gl->log, program_params(.vertex = "depth.vert", .fragment = "depth.frag", .defines = "#define CLIP\n"));
    bool good = stage->depth_program && stage->clipped_depth_program && ramp_program;
    if (good)
        glProgramUniform3f(ramp_program, 0, (float)stage->up[0], (float)stage->up[1], (float)stage->up[2]);
    find_ball(stage);
    for (size_t i = 0; i < scene->asset_count && good; i++) {
        struct model *model = find_model(stage, scene->assets[i].file);
        if (!model) {
            model = &stage->models[stage->model_count++];
            good = model_init(model, gl, scene->assets[i].file, ramp_program);
        }
        stage->of_asset[i] = model;
    }
    program_destroy(&ramp_program);
    return good;
}

void stage_finish(struct stage *stage)
{
    for (size_t i = 0; i < stage->model_count; i++)
        model_finish(&stage->models[i]);
    mem_free(stage->models);
    mem_free(stage->of_asset);
    program_destroy(&stage->depth_program);
    program_destroy(&stage->clipped_depth_program);
    *stage = (struct stage){ 0 };
}

void shot_init(struct shot *shot, const double eye_m[3], const double clip_from_eye[16], double pixel_per_radian)
{
    double eye_from_plant[16];
    *shot = (struct shot){ .pixel_per_radian = pixel_per_radian };
    memcpy(shot->eye_m, eye_m, sizeof(shot->eye_m));
    memcpy(shot->clip_from_eye, clip_from_eye, sizeof(shot->clip_from_eye));
    matrix_translation((double[3]){ -eye_m[0], -eye_m[1], -eye_m[2] }, eye_from_plant);
    matrix_multiply(clip_from_eye, eye_from_plant, shot->clip_from_plant);
    const double *m = shot->clip_from_plant;
    for (int p = 0; p < 6; p++) /* w + x, w - x, w + y, w - y, z, w - z: all >= 0 inside */
        for (int c = 0; c < 4; c++) {
            double row = m[4 * c + p / 2], w = m[4 * c + 3];
            shot->planes[p][c] = p == 4 ? row : p % 2 ? w - row : w + row;
        }
}

void shot_narrow(struct shot *shot, const double low[2], const double high[2])
{
    const double *m = shot->clip_from_plant;
    for (int p = 0; p < 4; p++)
        for (int c = 0; c < 4; c++) {
            double row = m[4 * c + p / 2], w = m[4 * c + 3];
            shot->planes[p][c] = p % 2 ? high[p / 2] * w - row : row - low[p / 2] * w;
        }
}

bool shot_sees(const struct shot *shot, const struct scene_asset *asset)
{
    for (int p = 0; p < 6; p++) {
        double far = shot->planes[p][3]; /* of the corner that lies farthest inward */
        for (int c = 0; c < 3; c++)
            far += shot->planes[p][c] * (shot->planes[p][c] > 0 ? asset->bounds_max_m[c] : asset->bounds_min_m[c]);
        if (far < 0)
            return false;
    }
    return true;
}

void shot_bring_forward(const struct shot *shot, const struct scene_asset *asset, double clip_from_file[16])
{
    double forward = coincident_forward(asset);
    if (shot->pixel_per_metre > 0)
        clip_from_file[14] += forward / shot->depth_scale;
    else
        for (int c = 0; c < 4; c++)
            clip_from_file[4 * c + 2] *= 1 + forward;
}

const struct model_level *stage_level(const struct stage *stage, const struct shot *shot, int asset, double error_px)
{
    const struct scene_asset *at = &stage->scene->assets[asset];
    double square = 0;
    if (shot->pixel_per_metre > 0)
        return model_level(stage->of_asset[asset], error_px / shot->pixel_per_metre);
    for (int c = 0; c < 3; c++) {
        double outside = fmax(fmax(at->bounds_min_m[c] - shot->eye_m[c], shot->eye_m[c] - at->bounds_max_m[c]), 0);
        square += outside * outside;
    }
    return model_level(stage->of_asset[asset], error_px * sqrt(square) / shot->pixel_per_radian);
}

void stage_clip_begin(const struct clip *clip)
{
    for (int i = 0; i < clip->plane_count; i++)
        glEnable(GL_CLIP_DISTANCE0 + (GLenum)i);
}

void stage_clip_end(const struct clip *clip)
{
    for (int i = 0; i < clip->plane_count; i++)
        glDisable(GL_CLIP_DISTANCE0 + (GLenum)i);
}

static bool is_cut(const struct clip *clip)
{
    return clip && clip->plane_count > 0;
}

void stage_depth_begin(const struct stage *stage, const double clip_from_plant[16], const struct clip *clip)
{
    double plant_from_clip[16];
    float planes[CLIP_MAX_PLANES][4] = { { 0 } };
    glUseProgram(is_cut(clip) ? stage->clipped_depth_program : stage->depth_program);
    glDisable(GL_CULL_FACE);
    if (!is_cut(clip))
        return;
    matrix_invert(clip_from_plant, plant_from_clip);
    for (int i = 0; i < clip->plane_count; i++) {
        double plane[4];
        clip_plane(clip, i, plane);
        matrix_plane(plant_from_clip, plane, planes[i]);
    }
    glUniform4fv(1, CLIP_MAX_PLANES, planes[0]);
    stage_clip_begin(clip);
}

void stage_depth_end(const struct clip *clip)
{
    if (is_cut(clip))
        stage_clip_end(clip);
}

void stage_draw_depth(const struct stage *stage, const double clip_from_plant[16], const struct clip *clip, int asset, double error_m)
{
    stage_depth_begin(stage, clip_from_plant, clip);
    for (size_t i = 0; i < stage->scene->asset_count; i++) {
        if (asset >= 0 && i != (size_t)asset)
            continue;
        const struct model_level *level = model_level(stage->of_asset[i], error_m);
        double clip_from_file[16];
        float matrix[16];
        matrix_multiply(clip_from_plant, stage->scene->assets[i].placement, clip_from_file);
        matrix_to_float(clip_from_file, matrix);
        glUniformMatrix4fv(0, 1, GL_FALSE, matrix);
        mesh_bind(&stage->of_asset[i]->mesh, 0, 0);
        for (size_t b = 0; b < level->batch_count; b++)
            if (!level->batches[b].blend || asset >= 0)
                model_draw_batch(&level->batches[b]);
    }
    stage_depth_end(clip);
}

bool stage_mirrored(const struct scene_asset *asset)
{
    const double *m = asset->placement;
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[4] * (m[1] * m[10] - m[2] * m[9]) + m[8] * (m[1] * m[6] - m[2] * m[5]) < 0;
}

void stage_set_front_face(const struct scene_asset *asset)
{
    glFrontFace(stage_mirrored(asset) ? GL_CW : GL_CCW);
}
