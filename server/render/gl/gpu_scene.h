/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The whole scene on the GPU, and what of it a camera sees. Thread: the one of the GL context. */
#ifndef RENDER_GL_GPU_SCENE_H
#define RENDER_GL_GPU_SCENE_H
#include "gpu/gl.h"
#include "render/gl/model.h"
#include "scene/scene.h"
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

/* A camera, ready to draw with. Eye space: axes of the plant frame, origin at the camera. */
struct view_constants {
    double eye_m[3];
    double clip_from_eye[16]; /* depth 1 near, 0 far */
    double clip_from_plant[16];
    double pixel_per_radian;
    double pixel_per_metre; /* orthographic; 0: perspective, and so below */
    double back[3];         /* towards the viewer */
    double depth_scale;     /* of depth, in units of what would be the distance in perspective */
    double planes[6][4];    /* of the frustum, inward, plant frame */
};

/* With the sky bound (render/light/environments.h). False: logged. */
bool gpu_scene_init(struct gpu_scene *gpu_scene, struct gl *gl, const struct scene *scene);
void gpu_scene_finish(struct gpu_scene *gpu_scene);

/* clip_from_plant: depth 1 near, 0 far. */
void view_constants_init(struct view_constants *constants, const double eye_m[3], const double clip_from_eye[16], double pixel_per_radian);
/* Lets it see only that part of the picture, and draw as before. Corners: -1 to 1 over the picture. */
void view_constants_narrow(struct view_constants *constants, const double low[2], const double high[2]);
bool view_constants_sees(const struct view_constants *constants, const struct scene_asset *asset);
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
/* Brings an asset forward where its faces coincide with others' (scene/coincident.h). */
void view_constants_bring_forward(const struct view_constants *constants, const struct scene_asset *asset, double clip_from_file[16]);
bool gpu_scene_mirrored(const struct scene_asset *asset); /* its placement turns the winding of triangles round */
/* For drawing one-sided surfaces of this asset: a mirrored placement turns them round. */
void gpu_scene_set_front_face(const struct scene_asset *asset);

#endif
