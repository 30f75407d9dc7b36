/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Works out one set of light, bit by bit, so that pictures can be drawn in between: a map of what the sun sees, and what reaches each
   vertex and the ground. Sky light and openness come from depth maps taken from 32 directions all round; how open a place is
   depends on neither sun nor surroundings, and is taken over from a set that has it. That is of the plant as it starts; where less of it
   is shown, it is only kept from being too dark. Thread: the one of the GL context. */
#ifndef RENDER_BAKE_H
#define RENDER_BAKE_H
#include "gpu/pool.h"
#include "render/gl/gpu_scene.h"

struct light_key {
    double towards[3];       /* the sun; plant frame, unit length */
    int environment;         /* number of the surroundings */
    struct visibility shown; /* what throws shadows */
    bool rough;              /* every place is taken to be equally open */
};

struct light_set {
    uint64_t id; /* of no other set, ever; 0: empty */
    struct light_key key;
    double texture_from_plant[16]; /* texture coordinates and depth of sun_map */
    double texel_m, depth_m;       /* of sun_map: side of a texel; what its depths span */
    GLuint sun_map;
    GLuint ground; /* RG8: sun and openness on the ground */
    struct pool *pool;
    struct pool_slice **baked; /* per asset: 4 bytes a vertex: light, ambient, openness, sun */
    size_t bytes;
    uint64_t used;
    int holds;
};

struct bake_programs {
    GLuint sky, sun, faces_sky, faces_sun, ground_sky, ground_sun;
};
bool bake_programs_init(struct bake_programs *programs, struct log *log); /* false: logged */
void bake_programs_finish(struct bake_programs *programs);

struct bake;
/* Where a part of the plant is hidden, what it hid must not stay in the dark: how open any place there is at least, 0..1. */
double bake_least_open(const struct gpu_scene *gpu_scene, const struct visibility *shown);
/* Of a set that is to be; `from` need only live for the call, is not rough, and is of no larger bake_least_open. NULL for `from`: openness
   is worked out too, which is most of the work, unless the key is rough. NULL: out of GPU memory, logged. */
struct bake *bake_begin(const struct gpu_scene *gpu_scene, const struct bake_programs *programs, const double plant_from_ground[16],
                        const struct light_key *key, const struct light_set *from);
const struct light_key *bake_key(const struct bake *bake);
/* Issues a bit of the work, of a few milliseconds, with its surroundings bound (render/light/environments.h). True: all was issued. */
bool bake_step(struct bake *bake);
/* Hands the set over, with everything but its place among others. False: a GL error, logged; there is no set. */
bool bake_end(struct bake **bake, struct light_set *set);
void bake_abandon(struct bake **bake); /* &NULL is fine; leaves NULL */

size_t bake_bytes(const struct gpu_scene *gpu_scene); /* of any set */
void light_set_finish(struct light_set *set, const struct gpu_scene *gpu_scene);

#endif
