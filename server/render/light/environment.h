/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The light of the surroundings, worked out from a picture of them or from the built-in sky: irradiance as spherical harmonics, and
   what surfaces of each roughness mirror. Exposed and balanced so that a level white surface under the open sky reflects 1 in every
   channel. No GL here. Thread: any.
   Irradiance: Ramamoorthi and Hanrahan, "An efficient representation for irradiance environment maps", 2001. Mirrored light: Karis,
   "Real shading in Unreal Engine 4", 2013. */
#ifndef RENDER_ENVIRONMENT_H
#define RENDER_ENVIRONMENT_H
#include <stdbool.h>

#include "base/image.h"
#include "base/workers.h"

enum { ENVIRONMENT_PX = 128, ENVIRONMENT_LAYERS = 8, ENVIRONMENT_TERMS = 9 };
struct environment {
    /* Of the irradiance over pi, in the order 1, y, z, x, xy, yz, 3zz-1, xz, xx-yy of a direction's components, factors taken in. */
    float irradiance[ENVIRONMENT_TERMS][4];
    /* By roughness 0 to 1, then octahedral (render: shaders/environment.glsl): mean radiance around the mirrored ray. */
    float (*mirrored)[4];
};

/* image: equirectangular, its middle row the horizon, its middle column towards +x of the plant;
   NULL: the built-in sky. y_up: +y of the plant is up; else +z. Keeps no pointer to the image. Free with environment_finish().
   Returns false if no light comes from above in some colour channel: a black image, or one without, say, any blue. */
bool environment_init(struct environment *environment, const struct image_float *image, bool y_up, struct workers *workers);
void environment_finish(struct environment *environment);

/* Scale and bias of F0 that the surroundings, all alike, would be reflected with. side x side texels: cosine to the viewer from left
   to right, roughness from top to bottom, both at texel centres of (0, 1). */
void environment_brdf(int side, float (*scale_bias)[2]);

#endif
