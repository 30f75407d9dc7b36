/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws feature edges: thin dark lines where the depth buffer shows the rim of a shape; a C version of shaders/edges.frag. */

#include "render/soft/kernels.h"
#include "render/soft/refined_impl.h"

struct view_of_depth {
    const float *depth;
    int width_px, height_px, pitch_px;
    /* how stored depths become distances. 0: perspective, where depth is proportional to 1 / distance from the eye; else
       orthographic: view_constants.depth_scale */
    float scale;
};

SOFT_INLINE lanes at(const struct view_of_depth *view, int column, int row)
{
    row = row < 0 ? 0 : row < view->height_px ? row : view->height_px - 1;
    const float *from = view->depth + (size_t)row * (size_t)view->pitch_px;
    if (column >= 0 && column + LANES <= view->width_px)
        return *(const lanes *)(from + column);
    lanes out;
    for (int i = 0; i < LANES; i++) {
        int c = column + i;
        out[i] = from[c < 0 ? 0 : c < view->width_px ? c : view->width_px - 1];
    }
    return out;
}

SOFT_INLINE lanes low(lanes a, lanes b)
{
    return lanes_choose(a < b, a, b);
}

SOFT_INLINE lanes high(lanes a, lanes b)
{
    return lanes_choose(a > b, a, b);
}

SOFT_INLINE lanes line(lanes rise)
{
    lanes t = lanes_clamp((rise - (float)EDGE_FROM) * (1 / ((float)EDGE_TO - (float)EDGE_FROM)), 0, 1);
    return t * t * (3.0f - 2.0f * t);
}

/* Returns a feature edge's coverage, 0..1, of each of eight pixels. It is above 0 where the pixel at the offset (dx, dy) is
   much nearer to the eye. */
SOFT_INLINE lanes edge(const struct view_of_depth *view, int x, int y, lanes here, int dx, int dy)
{
    lanes next = at(view, x + dx, y + dy), zero = { 0 }, lines = zero;
    if (!lanes_any(next > here))
        return zero;
    lanes level = here + high(here - at(view, x - dx, y - dy), zero);
    lanes part = view->scale > 0 ? zero + view->scale : 1.0f / high(next, zero + 1e-9f);
    lanes ahead = next, left = next, right = next;
    if (!lanes_any(next > level))
        return zero;
    for (int i = EDGE_THIN_PX; i <= EDGE_WIDE_PX; i++) {
        ahead = low(ahead, at(view, x + i * dx, y + i * dy));
        left = low(left, at(view, x + dx + (i - 1) * dy, y + dy + (i - 1) * dx));
        right = low(right, at(view, x + dx - (i - 1) * dy, y + dy - (i - 1) * dx));
        lines += line((low(ahead, high(left, right)) - level) * part);
    }
    return lines * (1.0f / (EDGE_WIDE_PX - EDGE_THIN_PX + 1));
}

void refined_ink_band(const struct refined *refined, int number)
{
    const struct raster *raster = &refined->raster;
    struct view_of_depth view = { raster->depth, raster->width_px, raster->height_px, raster->pitch_px, raster->block.back[3] };
    int end = (number + 1) * REFINED_ROWS < raster->height_px ? (number + 1) * REFINED_ROWS : raster->height_px;
    for (int y = number * REFINED_ROWS; y < end; y++)
        for (int x = 0; x < raster->width_px; x += LANES) {
            lanes here = at(&view, x, y);
            lanes most = high(high(edge(&view, x, y, here, 1, 0), edge(&view, x, y, here, -1, 0)),
                              high(edge(&view, x, y, here, 0, 1), edge(&view, x, y, here, 0, -1)));
            uint8_t *ink = refined->buffer->ink + (size_t)y * (size_t)raster->width_px + (size_t)x;
            if (!lanes_any(most > 0.0f))
                continue;
            for (int i = 0; i < LANES && x + i < raster->width_px; i++)
                ink[i] = (uint8_t)(most[i] * VISIBILITY_INK + 0.5f);
        }
}
