/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bakes one light set in small steps, so that frames can be drawn in between. The set has a shadow map of the sun, and the
   light that reaches each vertex and the ground. Sky light and openness (ambient occlusion) come from depth maps in 32
   directions. Openness depends on neither sun nor environment, so it is copied from another set, or read from a file. Openness
   is always that of the whole plant; hiding assets only raises its lower bound. Call only in the thread that owns the GL
   context. */
#ifndef RENDER_BAKE_H
#define RENDER_BAKE_H
#include "gpu/pool.h"
#include "render/gl/gpu_scene.h"
#include "render/light/openness.h"

struct light_key {
    double towards[3];       /* unit vector towards the sun, in the plant frame */
    int environment;         /* number of the environment (render/light/environments.h) */
    struct visibility shown; /* assets that cast shadows */
    bool rough;              /* true: a rough light set (baked light), whose openness is not baked but constant, which is much faster */
};

struct light_set {
    uint64_t id; /* unique, never reused; 0: empty */
    struct light_key key;
    double texture_from_plant[16]; /* matrix from plant coordinates to texture coordinates and depth of sun_map */
    /* texel_m: side of a texel of sun_map in metres; depth_m: distance in metres from depth 0 to depth 1 of sun_map */
    double texel_m, depth_m;
    GLuint sun_map;
    GLuint ground; /* texture of the ground in the format RG8: visible part of the sun, and openness (visible part of the sky) */
    struct pool *pool;
    /* baked light per asset, 4 bytes per vertex: sun and sky together, sky only, openness (visible part of the sky), cosine of
       the angle to the sun */
    struct pool_slice **baked;
    size_t bytes;
    uint64_t used;
    int holds;
};

struct bake_programs {
    GLuint sky, sun, faces_sky, faces_sun, ground_sky, ground_sun;
};
/* Compiles the shader programs of the bake. On failure, logs the reason and returns false. */
bool bake_programs_init(struct bake_programs *programs, struct log *log);
void bake_programs_finish(struct bake_programs *programs);

struct bake;
/* Returns the lower bound of openness (0..1) for a light set that shows only the assets in `shown`. The bound keeps surfaces
   next to hidden assets from staying dark. */
double bake_least_open(const struct gpu_scene *gpu_scene, const struct visibility *shown);
/* Begins to bake a light set for `key`. Openness is most of the work, so it is taken from elsewhere if possible. from: a light
   set whose openness is copied; read during the call only. `from` must not be rough, and bake_least_open() of its visibility
   must not exceed that of the key's. kept: the plant's openness file, used if `from` is NULL; read during the call only. If
   both are NULL, openness is baked as well, unless the key is rough. The caller ends the bake with bake_end() or
   bake_abandon(). Logs and returns NULL when the GPU is out of memory. */
struct bake *bake_begin(const struct gpu_scene *gpu_scene, const struct bake_programs *programs, const double plant_from_ground[16],
                        const struct light_key *key, const struct light_set *from, struct openness *kept);
/* Returns the key (sun, environment, visible assets) of the light set being baked. */
const struct light_key *bake_key(const struct bake *bake);
/* Issues GL calls for the next few milliseconds of the bake; the key's environment must be bound (render/light/environments.h). Returns
   true once all calls of the bake are issued. */
bool bake_step(struct bake *bake);
/* Moves the finished light set into *set, except the members `used` and `holds`, and frees *bake. Returns false on a GL error, which is
   logged; *set is unchanged then. */
bool bake_end(struct bake **bake, struct light_set *set);
/* Frees *bake without a result and sets it to NULL. Accepts a pointer to NULL. */
void bake_abandon(struct bake **bake);

/* Returns the bytes of GPU memory that one light set of this scene takes. Pure. */
size_t bake_bytes(const struct gpu_scene *gpu_scene);
/* Deletes the textures and buffers of a light set (baked light). */
void light_set_finish(struct light_set *set, const struct gpu_scene *gpu_scene);

#endif
