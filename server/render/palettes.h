/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Palettes that were used lately. Thread: the one of the GL context. */
#ifndef RENDER_PALETTES_H
#define RENDER_PALETTES_H
#include "render/palette.h"

struct palette {
    GLuint colors; /* palette_create */
    GLuint lines;  /* palette_create_lines; 0: the picture has no lines */
    uint64_t version; /* another one for each that was made, from 1 */
};

struct palettes_entry {
    struct scale scale;
    double lines[VIEW_ALL_LINES];
    int line_count;
    struct palette palette;
    uint64_t used;
};

enum { PALETTES = 16 };
struct palettes {           /* zero-initialise */
    struct shaded **shaded; /* by colour map, then the operator's; NULL: not made yet */
    struct palettes_entry at[PALETTES];
    int count;
    uint64_t uses;
};

/* Valid until PALETTES others were asked for. Nothing in it: out of GPU memory. */
struct palette palettes_get(struct palettes *palettes, const struct view *view);
void palettes_finish(struct palettes *palettes);

#endif
