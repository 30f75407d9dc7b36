/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Triangles that the near plane cuts, or the edge of the band about the picture (one picture wide to either side, one high above and
   below), or a plane that something is cut away by. Corners farther out, as those that lie just before the eye, would leave an edge too few
   digits. Private to soft/. */
#ifndef RENDER_SOFT_CLIP_H
#define RENDER_SOFT_CLIP_H
#include "render/soft/soft_impl.h"

/* The latter: what all planes may make of one triangle. */
enum { NEAR_PLANES = 5, NEAR_CORNERS = 3 + NEAR_PLANES + CLIP_MAX_PLANES, NEAR_TRIANGLES = NEAR_CORNERS - 2 };

struct near_corner { /* in clip space, x and y in pixels; a and b as a vertex carries them */
    float at[4], a, b;
    struct near_patterns { /* soft_lacking, soft_uncertain and soft_no_limits of its flags; between corners what is between these */
        float no_data, uncertain, no_limits;
    } patterns;
};

struct near_corner near_corner_of(const struct soft_mesh *mesh, uint32_t vertex, float a, float b, uint32_t flags);
/* What lies beyond the near plane and in the band, and is left by the first `cuts` planes that cut. How many corners it has, in order:
   0, or 3 and more. */
int near_cut(const struct raster *raster, int cuts, const struct near_corner at[3], struct near_corner out[NEAR_CORNERS]);

static inline struct near_patterns near_patterns_of(uint32_t flags)
{
    return (struct near_patterns){ soft_lacking(flags), soft_uncertain(flags), soft_no_limits(flags) };
}

#endif
