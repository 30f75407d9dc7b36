/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Image-based light of an environment map or of the built-in sky: irradiance as spherical harmonics, and prefiltered
   reflections for each roughness. Exposure and white balance are such that a level white surface under the open sky reflects 1
   in every channel. No GL. Call from any thread. Irradiance: Ramamoorthi and Hanrahan, "An efficient representation for
   irradiance environment maps", 2001. Prefiltered reflections: Karis, "Real shading in Unreal Engine 4", 2013. */
#ifndef RENDER_ENVIRONMENT_H
#define RENDER_ENVIRONMENT_H
#include <stdbool.h>

#include "base/image/image.h"
#include "base/workers.h"

enum { ENVIRONMENT_PX = 128, ENVIRONMENT_LAYERS = 8, ENVIRONMENT_TERMS = 9 };
struct environment {
    /* Coefficients of irradiance over pi, in the order of the terms 1, y, z, x, xy, yz, 3zz-1, xz, xx-yy of a direction's
       components. The basis functions' constant factors are multiplied in. */
    float irradiance[ENVIRONMENT_TERMS][4];
    /* Reflection maps: octahedral (shaders/environment.glsl), one per roughness from 0 to 1. A texel holds the mean radiance around the
       reflected ray. */
    float (*mirrored)[4];
};

/* image: equirectangular, its middle row the horizon, its middle column towards +x of the plant; NULL: the built-in sky. y_up:
   +y of the plant is up; else +z. Keeps no pointer to the image. Free with environment_finish(). Returns false if no light
   comes from above in a colour channel: the image is black, or the channel is 0 everywhere. */
bool environment_init(struct environment *environment, const struct image_float *image, bool y_up, struct workers *workers);
void environment_finish(struct environment *environment);

/* Writes the table of the split-sum approximation. In a uniform environment, a surface with the reflectance F0 at normal
   incidence reflects F0 * scale + bias of the light. The table has side x side texels: cosine to the viewer from left to right,
   roughness from top to bottom, both at texel centres of (0, 1). */
void environment_brdf(int side, float (*scale_bias)[2]);

#endif
