/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pass that draws the plant itself, in either tier. Thread: the one of the GL context. */
#ifndef RENDER_SOLID_H
#define RENDER_SOLID_H
#include "render/picture.h"

struct solid {
    GLuint programs[2][2]; /* [tier][has a field] */
};

bool solid_init(struct solid *solid, struct log *log); /* false: logged */
void solid_finish(struct solid *solid);
void solid_draw(const struct solid *solid, struct picture *picture);

#endif
