/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Works out one set of light, bit by bit, so that pictures can be drawn in between: a map of what the sun sees, and what reaches each
   vertex and the ground. Sky light and openness come from depth maps taken from 32 directions all round; they do not depend on the
   sun, and are taken over from a set that has them. Thread: the one of the GL context. */
#ifndef RENDER_BAKE_H
#define RENDER_BAKE_H
#include "render/stage.h"

struct light_set { /* for one place of the sun */
    uint64_t id;   /* of no other set, ever; 0: empty */
    double towards[3];
    double texture_from_plant[16]; /* texture coordinates and depth of sun_map */
    double texel_m;
    GLuint sun_map;
    GLuint ground; /* RG8: sun and openness on the ground */
    GLuint *baked; /* per asset: 4 bytes a vertex: light, ambient, openness, sun */
    size_t bytes;
    uint64_t used;
    int holds;
};

struct bake_programs {
    GLuint sky, sun, ground_sky, ground_sun;
};
bool bake_programs_init(struct bake_programs *programs, struct log *log); /* false: logged */
void bake_programs_finish(struct bake_programs *programs);

struct bake;
/* Of a set that is to be; `from` need only live for the call. NULL for `from`: sky light is worked out too. NULL: out of GPU memory,
   logged. */
struct bake *bake_begin(const struct stage *stage, const struct bake_programs *programs, const double plant_from_ground[16],
                        const double towards[3], const struct light_set *from);
const double *bake_towards(const struct bake *bake);
/* Issues a bit of the work, of a few milliseconds. True: all was issued. */
bool bake_step(struct bake *bake);
/* Hands the set over, with everything but its place among others. False: a GL error, logged; there is no set. */
bool bake_end(struct bake **bake, struct light_set *set);
void bake_abandon(struct bake **bake); /* &NULL is fine; leaves NULL */

size_t bake_bytes(const struct stage *stage); /* of any set */
void light_set_finish(struct light_set *set, const struct stage *stage);

#endif
