/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strokes along the directions of a field: short streamlines on the surface of one asset. A stroke begins at an arrow position
   and follows the interpolated direction from triangle to triangle. It ends where the direction is unknown, where the surface
   ends, or at its full length. Therefore no stroke crosses a gap or a wall. Call only in the thread that owns the GL context. */
#ifndef RENDER_PICK_STROKES_H
#define RENDER_PICK_STROKES_H
#include "render/pick/arrows.h"

/* STROKE_POINTS: maximum number of points of a stroke (short streamline); STROKES_MOST: of strokes on an asset */
enum { STROKE_POINTS = 12, STROKES_MOST = 100 };

struct stroke_point {
    struct direction_place place;
    struct direction to;
};
struct stroke_set { /* strokes (short streamlines) on one asset; zero-initialise, free with strokes_finish() */
    /* [triangle][i]: neighbour across the edge that begins at corner i: 3 * index of the triangle + index of its edge; STROKE_NONE: none */
    uint32_t (*across)[3];
    struct stroke_point (*points)[STROKE_POINTS];
    int *lengths; /* number of points of each stroke (short streamline); 0: the direction at its start is unknown */
    size_t count;
    bool sought;
    uint64_t content; /* hash of the sensor directions used to trace the strokes (short streamlines) */
};

/* Traces the asset's strokes (short streamlines) again if the directions of its arrows changed; `arrows` must be up to date. */
void strokes_update(struct stroke_set *set, const struct arrow_set *arrows, const struct scene *scene, int asset,
                    const struct fields_entry *field);
void strokes_finish(struct stroke_set *set);

#endif
