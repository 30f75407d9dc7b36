/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What GL tests share: the context that PLANTCAST_GL names, a plant to draw, and pictures of it. */
#ifndef TESTS_SUPPORT_RIG_H
#define TESTS_SUPPORT_RIG_H
#include "field/colormap.h"
#include "gpu/gl.h"
#include "render/renderer.h"
#include "tests/support/toy.h"

struct rig {
    struct log *log;
    struct gl *gl;
    struct workers *workers;
};

/* False: there is no such context here; a line of TAP says so, and the program ends well. */
bool rig_init(struct rig *rig, const char *test);
void rig_finish(struct rig *rig);
/* Makes the rig, runs the tests of the program (tests/support/test.h) and finishes the rig. Returns what main returns. */
int rig_run(struct rig *rig);

struct stand { /* one plant on its renderer */
    struct rig *rig;
    struct toy *toy;
    struct field *field;
    struct renderer *renderer;
    struct snapshot *snapshot;
};
/* Takes the toy. */
void stand_init(struct stand *stand, struct rig *rig, struct toy *toy);
void stand_finish(struct stand *stand);
/* The i-th camera of a walk: all round, from far away, from below and from among the pipes, where triangles pass the eye. */
void stand_look(const struct stand *stand, int i, struct view *view);
struct frame *stand_draw(struct stand *stand, const struct view *view); /* never NULL */

const uint8_t *frame_pixel(const struct frame *frame, int x, int y); /* b, g, r, x */
/* Place on the map (0..255) of a colour that is exactly one of its own, or -1. */
int map_index_exact(const struct colormap *map, const uint8_t *bgrx);
/* By how many colours of the map a pixel's is another one than of that place (0..1, or outside); -1: it is none of the map. */
int map_colors_off(const struct colormap *map, const uint8_t *bgrx, double place);
/* Place on the map of the colour nearest in CIELAB: what a reader of the legend would say; or one who sees no green, to whom both look
   as Machado, Oliveira and Fernandes (2009) have it. */
int map_index_nearest(const struct colormap *map, const uint8_t *bgrx, bool deuteranope);

#endif
