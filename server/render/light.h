/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light that stands still: shadow maps, and what reaches each vertex and the ground, worked out once for each place of the sun.
   Sky light and openness come from 32 depth maps, seen from all round. Thread: the one of the GL context. */
#ifndef RENDER_LIGHT_H
#define RENDER_LIGHT_H
#include "render/stage.h"

struct light_set { /* for one place of the sun */
    double towards[3];
    double texture_from_plant[16]; /* texture coordinates and depth of sun_map */
    double texel_m;
    GLuint sun_map;
    GLuint ground; /* RG8: sun and openness on the ground */
    GLuint *baked; /* per asset: 4 bytes a vertex: light, ambient, openness, sun */
    uint64_t used;
};

enum { LIGHT_SETS = 3 };
struct light {
    const struct stage *stage;
    GLuint sky_program, sun_program, ground_sky_program, ground_sun_program;
    double plant_from_ground[16];      /* from texture coordinates on the ground, and height over it */
    double ground_height_m;            /* along `up` */
    struct light_set sets[LIGHT_SETS]; /* sun_map 0: empty */
    uint64_t uses;
};

bool light_init(struct light *light, const struct stage *stage);
void light_finish(struct light *light);
/* The light with the sun in that direction; baked now if it is not known. NULL: out of GPU memory, logged. */
const struct light_set *light_get(struct light *light, const double towards[3]);

#endif
