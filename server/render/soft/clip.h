/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clipping of triangles against the near plane, section planes and the guard band (one frame width to either side, one frame
   height above and below). Corners farther out, such as those just in front of the eye, would be too imprecise for the edge
   functions, which are 32-bit floats. Private to soft/. */
#ifndef RENDER_SOFT_CLIP_H
#define RENDER_SOFT_CLIP_H
#include "render/soft/soft_impl.h"

/* NEAR_CORNERS, NEAR_TRIANGLES: maximum numbers of corners and of triangles that result from clipping one triangle by all planes. */
enum { NEAR_PLANES = 5, NEAR_CORNERS = 3 + NEAR_PLANES + CLIP_MAX_PLANES, NEAR_TRIANGLES = NEAR_CORNERS - 2 };

/* Corner of a clipped triangle. at: position in clip space, with x and y in pixels. a, b: members as in struct soft_vertex:
   column and row of the colour map if the surface shows a field, otherwise its light. */
struct near_corner {
    float at[4], a, b;
    /* strength, 0..1, of each pattern (no data, uncertain, no limits) at the corner; from the vertex's flags, interpolated
       linearly between corners */
    struct near_patterns {
        float no_data, uncertain, no_limits;
    } patterns;
};

struct near_corner near_corner_of(const struct soft_mesh *mesh, uint32_t vertex, float a, float b, uint32_t flags);
/* Clips a triangle against the near plane, the guard band (a border around the frame) and the first `cuts` section planes. Returns the
   number of corners of the remaining polygon, in order: 0, or 3 and more. */
int near_cut(const struct raster *raster, int cuts, const struct near_corner at[3], struct near_corner out[NEAR_CORNERS]);

static inline struct near_patterns near_patterns_of(uint32_t flags)
{
    return (struct near_patterns){ soft_lacking(flags), soft_uncertain(flags), soft_no_limits(flags) };
}

#endif
