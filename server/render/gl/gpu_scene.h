/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The whole scene on the GPU: one model for each asset file, with its levels. Thread: the one of the GL context. */
#ifndef RENDER_GL_GPU_SCENE_H
#define RENDER_GL_GPU_SCENE_H
#include "gpu/gl.h"
#include "render/gl/model.h"
#include "render/plan/view_constants.h"
#include "scene/visibility.h"

struct gpu_scene {
    struct gl *gl;
    const struct scene *scene;
    struct model *models;
    size_t model_count;
    const struct model **of_asset; /* by index in scene->assets */
    double middle_m[3], radius_m;  /* a ball that holds the scene */
    double up[3];
    GLuint depth_programs[2][2]; /* by: something is cut away; textures cut holes */
};

/* With the sky bound (render/light/environments.h). False: logged. */
bool gpu_scene_init(struct gpu_scene *gpu_scene, struct gl *gl, const struct scene *scene);
void gpu_scene_finish(struct gpu_scene *gpu_scene);

/* The coarsest level of detail that errs by no more than that here. */
const struct model_level *gpu_scene_level(const struct gpu_scene *gpu_scene, const struct view_constants *constants, int asset,
                                          double error_px);

/* Only depth, of one asset, with errors up to error_m; clip: what is cut away; blended: what is see-through too. What textures cut are
   holes. Framebuffer and viewport are the caller's. */
void gpu_scene_draw_depth(const struct gpu_scene *gpu_scene, const double clip_from_plant[16], const struct clip *clip, int asset,
                          double error_m, bool blended);
/* Between the two: programs that cut are drawn with. */
void gpu_scene_clip_begin(const struct clip *clip);
void gpu_scene_clip_end(const struct clip *clip);
/* For drawing one-sided surfaces of this asset: a mirrored placement turns them round. */
void gpu_scene_set_front_face(const struct scene_asset *asset);

#endif
