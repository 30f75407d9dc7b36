/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared parts of GL tests: the context named by PLANTCAST_GL, a plant to draw, and pictures of it. */
#ifndef TESTS_SUPPORT_RIG_H
#define TESTS_SUPPORT_RIG_H
#include "plant/colormaps.h"
#include "gpu/gl.h"
#include "render/renderer.h"
#include "tests/support/toy.h"

struct rig {
    struct log *log;
    struct gl *gl;
    struct workers *workers;
};

/* Makes the GL context that PLANTCAST_GL names. Returns false if this machine lacks it: prints a TAP line that skips the
   program, which should then exit with success. */
bool rig_init(struct rig *rig, const char *test);
void rig_finish(struct rig *rig);
/* Makes the rig, runs the tests of the program (tests/support/test.h) and finishes the rig. Returns the exit code for main. */
int rig_run(struct rig *rig);

struct stand { /* one plant and its renderer */
    struct rig *rig;
    struct toy *toy;
    struct field *field;
    struct renderer *renderer;
    struct snapshot *snapshot;
};
/* Sets up a field, a snapshot and a renderer for the toy (a plant made in memory); the stand owns the toy from now on. */
void stand_init(struct stand *stand, struct rig *rig, struct toy *toy);
void stand_finish(struct stand *stand);
/* Writes the i-th camera of a tour: all around, from far away, from below, and among the pipes, where triangles extend behind the eye. */
void stand_look(const struct stand *stand, int i, struct view *view);
struct frame *stand_draw(struct stand *stand, const struct view *view); /* draws the view; never returns NULL */

const uint8_t *frame_pixel(const struct frame *frame, int x, int y); /* returns the bytes b, g, r, x of a pixel */
bool is_color(const uint8_t *bgrx, const uint8_t rgb[3]); /* returns whether the pixel has this colour */
bool is_grey(const uint8_t *bgrx);
/* Returns the index (0..255) of the map's entry that equals the pixel's colour, or -1 if there is none. */
int map_index_exact(const struct colormap *map, const uint8_t *bgrx);
/* Compares a pixel's colour with the map's colour at `place` (0..1, or outside). Returns the difference of their indices in the
   map, or -1 if the map lacks the pixel's colour. */
int map_colors_off(const struct colormap *map, const uint8_t *bgrx, double place);
/* Returns the index of the map's nearest colour in CIELAB, which is the one that a reader of the legend picks. deuteranope:
   compares the colours as a reader without green vision sees them (Machado, Oliveira and Fernandes, 2009). */
int map_index_nearest(const struct colormap *map, const uint8_t *bgrx, bool deuteranope);

#endif
