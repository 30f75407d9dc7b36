/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strokes along the directions of a field: short streamlines on the surface of one asset. Each begins at a place of an arrow, steps from
   triangle to triangle as the interpolated direction says there, and ends where the direction is not known, where the surface ends, or when
   it is long enough. So none crosses a gap or goes through a wall. Thread: the one of the GL context. */
#ifndef RENDER_PICK_STROKES_H
#define RENDER_PICK_STROKES_H
#include "render/pick/arrows.h"

enum { STROKE_POINTS = 12, STROKES_MOST = 100 }; /* of one asset */

struct stroke_point {
    struct direction_place place;
    struct direction to;
};
struct stroke_set { /* of one asset; zero-initialise, finish with strokes_finish() */
    uint32_t (*across)[3]; /* by triangle of the level: 3 times the neighbour plus its edge, over the edge from corner i; STROKE_NONE */
    struct stroke_point (*points)[STROKE_POINTS];
    int *lengths;          /* points of each stroke; 0: nothing is known where it would begin */
    size_t count;
    bool sought;
    uint64_t content; /* of the directions that they follow */
};

/* Brings the strokes up to date with the arrows, which must be. */
void strokes_update(struct stroke_set *set, const struct arrow_set *arrows, const struct scene *scene, int asset,
                    const struct fields_entry *field);
void strokes_finish(struct stroke_set *set);

#endif
