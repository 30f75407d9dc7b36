/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pass that fills what the plant leaves open: backdrop, and the shadow on the ground. Thread: the one of the GL context. */
#ifndef RENDER_SKY_H
#define RENDER_SKY_H
#include "render/frame_context.h"

/* Columns by height over the horizon; rows by place in a 4x4 tile, of the light backdrop and then of the dark one. */
enum { SKY_BACKDROPS = 2048, SKY_ROUNDINGS = 16, SKY_ROWS = 2 * SKY_ROUNDINGS };
struct sky {
    GLuint sky_program, ground_programs[2]; /* by tier */
    GLuint backdrops;                       /* by height over the horizon */
    GLuint vao;                             /* without attributes */
};

bool sky_init(struct sky *sky, struct log *log); /* false: logged */
void sky_finish(struct sky *sky);
/* Seen from above; and what throws a shadow on it is there. */
bool sky_sees_ground(const struct frame_context *context, const struct light *light);
void sky_draw(const struct sky *sky, const struct frame_context *context, const struct light *light);

#endif
