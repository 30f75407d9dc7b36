/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clips one triangle against the near plane, the guard band (a border around the frame, clip.h) and section planes. */
#include <string.h>

#include "render/soft/clip.h"

struct near_corner near_corner_of(const struct soft_mesh *mesh, uint32_t vertex, float a, float b, uint32_t flags)
{
    const float *p = mesh->file->positions_m[vertex];
    struct near_corner corner = { .a = a, .b = b, .patterns = near_patterns_of(flags) };
    for (int r = 0; r < 4; r++)
        corner.at[r] = mesh->place[0][r] * p[0] + mesh->place[1][r] * p[1] + mesh->place[2][r] * p[2] + mesh->place[3][r];
    return corner;
}

/* Returns the signed distance of a triangle's corner from a clipping plane, positive on the side that is kept. plane: 0: near
   plane; 1 to 4: left, right, top, bottom of the guard band (a border around the frame); 5 and up: section planes. */
static float inside(const struct raster *raster, const struct near_corner *corner, int plane)
{
    const float *at = corner->at;
    if (plane >= NEAR_PLANES) {
        const float *cut = raster->cuts[plane - NEAR_PLANES];
        return cut[0] * at[0] + cut[1] * at[1] + cut[2] * at[2] + cut[3] * at[3];
    }
    float width = (float)raster->width_px * at[3], height = (float)raster->height_px * at[3];
    switch (plane) {
    case 0: return at[3] - at[2];
    case 1: return at[0] + width;
    case 2: return 2 * width - at[0];
    case 3: return at[1] + height;
    default: return 2 * height - at[1];
    }
}

static float part_way(float in, float out, float part)
{
    return in + part * (out - in);
}

/* Returns a point on an edge, at the fraction `part` (0..1) of the way from `in` (inside a clipping plane) to `out` (outside).
   Both triangles that share the edge get exactly the same point, because both start from the inner end. */
static struct near_corner between(const struct near_corner *in, const struct near_corner *out, float part)
{
    struct near_corner corner = { .a = part_way(in->a, out->a, part), .b = part_way(in->b, out->b, part) };
    for (int r = 0; r < 4; r++)
        corner.at[r] = part_way(in->at[r], out->at[r], part);
    corner.patterns.no_data = part_way(in->patterns.no_data, out->patterns.no_data, part);
    corner.patterns.uncertain = part_way(in->patterns.uncertain, out->patterns.uncertain, part);
    corner.patterns.no_limits = part_way(in->patterns.no_limits, out->patterns.no_limits, part);
    return corner;
}

static int cut_by(const struct raster *raster, int plane, const struct near_corner *at, int count, struct near_corner *out)
{
    int kept = 0;
    for (int i = 0; i < count; i++) {
        const struct near_corner *here = &at[i], *next = &at[(i + 1) % count];
        float from = inside(raster, here, plane), to = inside(raster, next, plane);
        if (from >= 0)
            out[kept++] = *here;
        if (from >= 0 && to < 0)
            out[kept++] = between(here, next, from / (from - to));
        if (from < 0 && to >= 0)
            out[kept++] = between(next, here, to / (to - from));
    }
    return kept;
}

int near_cut(const struct raster *raster, int cuts, const struct near_corner at[3], struct near_corner out[NEAR_CORNERS])
{
    struct near_corner before[NEAR_CORNERS];
    int count = cut_by(raster, 0, at, 3, out);
    for (int plane = 1; plane < NEAR_PLANES + cuts; plane++) {
        memcpy(before, out, (size_t)count * sizeof(*before));
        count = cut_by(raster, plane, before, count, out);
    }
    return count >= 3 ? count : 0;
}
