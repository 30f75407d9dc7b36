/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scene on the GPU: one model for each asset file, with all its levels of detail. Call only in the thread that owns the GL context. */
#ifndef RENDER_GL_GPU_SCENE_H
#define RENDER_GL_GPU_SCENE_H
#include "gpu/gl.h"
#include "render/gl/model.h"
#include "render/light/environments.h"
#include "render/plan/view_constants.h"
#include "scene/visibility.h"

struct gpu_scene {
    struct gl *gl;
    const struct scene *scene;
    struct gl_model *models;
    size_t model_count;
    const struct gl_model **of_asset; /* model of each asset, by index in scene->assets */
    double middle_m[3], radius_m;     /* centre and radius of a sphere that encloses the scene, in the plant frame */
    double up[3];
    GLuint depth_programs[2][2]; /* [clip planes][alpha-masked textures] */
};

/* Uploads all models. sky: the light with which the colour ramps of materials (colours from dark to bright, for previews) are
   computed. On failure, logs the reason and returns false. */
bool gpu_scene_init(struct gpu_scene *gpu_scene, struct gl *gl, const struct scene *scene, const struct environment_light *sky);
void gpu_scene_finish(struct gpu_scene *gpu_scene);

/* Returns the asset's coarsest level of detail whose error, projected at its distance from the camera, is at most error_px. */
const struct model_level *gpu_scene_level(const struct gpu_scene *gpu_scene, const struct view_constants *constants, int asset,
                                          double error_px);

/* Draws the depth of one asset into the caller's framebuffer and viewport, using the coarsest level of detail with an error of at most
   error_m. clip: section planes. blended true: draws transparent submeshes as well. Holes that a texture's alpha mask cuts stay holes. */
void gpu_scene_draw_depth(const struct gpu_scene *gpu_scene, const double clip_from_plant[16], const struct clip *clip, int asset,
                          double error_m, bool blended);
/* Enable and disable GL's clip distances for the view's section planes, before and after draw calls of shader programs that write them. */
void gpu_scene_clip_begin(const struct clip *clip);
void gpu_scene_clip_end(const struct clip *clip);
/* Tells GL which winding of triangles is the front for an asset: a mirrored placement reverses the winding. */
void gpu_scene_set_front_face(const struct scene_asset *asset);

#endif
