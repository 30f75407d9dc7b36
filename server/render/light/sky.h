/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pass that draws the background where no surface is: backdrop, and the shadow on the ground. Call only in the thread that
   owns the GL context. */
#ifndef RENDER_SKY_H
#define RENDER_SKY_H
#include "render/frame_context.h"

/* Size of the backdrop texture. SKY_BACKDROPS: number of columns, one per elevation above the horizon. SKY_ROUNDINGS: number of
   dither offsets, one per pixel of a 4x4 square. SKY_ROWS: number of rows, one per dither offset for the light theme, then the
   same for the dark one. */
enum { SKY_BACKDROPS = 2048, SKY_ROUNDINGS = 16, SKY_ROWS = 2 * SKY_ROUNDINGS };
struct sky {
    GLuint sky_program, ground_programs[2]; /* ground_programs: by enum tier */
    uint32_t (*texels)[SKY_BACKDROPS];      /* colours of the backdrop, in SKY_ROWS rows: blue | green << 8 | red << 16 | 0xff000000 */
    GLuint backdrops;                       /* GL texture with the colours of the backdrop, copied from `texels` */
    GLuint vao;                             /* without attributes */
};

/* Compiles the shader programs and computes the colours of the backdrops. On failure, logs the reason and returns false. */
bool sky_init(struct sky *sky, struct log *log);
void sky_finish(struct sky *sky);
/* Returns whether the ground is drawn: the camera is above it, and no asset is cut, hidden or ghosted. (The ground shows the
   shadow of the whole plant, which would otherwise be wrong.) Pure. */
bool sky_sees_ground(const struct frame_context *context, const struct light *light);
/* Draws backdrop and ground shadow at all pixels that no surface covers. */
void sky_draw(const struct sky *sky, const struct frame_context *context, const struct light *light);

#endif
