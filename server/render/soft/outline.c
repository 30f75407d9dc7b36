/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws the outline of one asset: a dark line with a light line outside; a C version of shaders/outline.frag. */
#include <math.h>
#include <string.h>

#include "render/soft/soft_impl.h"
#include "render/gl/lines.h"
#include "shaders/constants.glsl"

enum { MAX_REACH_PX = 32 };
static const double dark_rgb[3] = { RIM_RGB };

struct brush { /* square brush that is stamped at each pixel on the rim of the outlined asset; reach_px: half its width */
    int reach_px;
    uint8_t rim[2 * MAX_REACH_PX + 1][2 * MAX_REACH_PX + 1];
};

static void brush_init(struct brush *brush, double width_px)
{
    brush->reach_px = (int)fmin(ceil(2 * width_px), MAX_REACH_PX);
    for (int y = -brush->reach_px; y <= brush->reach_px; y++)
        for (int x = -brush->reach_px; x <= brush->reach_px; x++) {
            double away = hypot(x, y) - 0.35;
            brush->rim[y + MAX_REACH_PX][x + MAX_REACH_PX] = away <= width_px ? RIM_DARK : away <= 2 * width_px ? RIM_LIGHT : 0;
        }
}

static void stamp(const struct raster *raster, uint8_t *rim, const struct brush *brush, int x, int y)
{
    int reach = brush->reach_px;
    int left = x - reach > 0 ? x - reach : 0, right = x + reach < raster->width_px ? x + reach : raster->width_px - 1;
    int top = y - reach > 0 ? y - reach : 0, bottom = y + reach < raster->height_px ? y + reach : raster->height_px - 1;
    for (int v = top; v <= bottom; v++)
        for (int u = left; u <= right; u++) {
            uint8_t *at = &rim[(size_t)v * (size_t)raster->pitch_px + (size_t)u];
            uint8_t ink = brush->rim[v - y + MAX_REACH_PX][u - x + MAX_REACH_PX];
            *at = ink > *at ? ink : *at;
        }
}

/* Returns whether the pixel is on the rim: the asset covers it, but not all of its neighbours. */
static bool is_rim(const struct raster *raster, int x, int y)
{
    const uint32_t *mark = raster->marks + (size_t)y * (size_t)raster->pitch_px + (size_t)x;
    return *mark && ((x > 0 && !mark[-1]) || (x + 1 < raster->width_px && !mark[1]) || (y > 0 && !mark[-raster->pitch_px]) ||
                     (y + 1 < raster->height_px && !mark[raster->pitch_px]));
}

static void paint(const struct raster *raster, const uint8_t *rim)
{
    for (int y = 0; y < raster->height_px; y++) {
        size_t row = (size_t)y * (size_t)raster->pitch_px;
        uint8_t *out = raster->out + (size_t)y * raster->out_stride_bytes;
        for (int x = 0; x < raster->width_px; x++) {
            uint8_t ink = raster->marks[row + (size_t)x] ? 0 : rim[row + (size_t)x];
            for (int c = 0; c < 3 && ink; c++)
                out[4 * x + c] =
                    (uint8_t)(ink == RIM_DARK ? 255 * dark_rgb[2 - c] + 0.5 : out[4 * x + c] * (1 - RIM_WHITE) + 255 * RIM_WHITE + 0.5);
        }
    }
}

const uint8_t *raster_rim(const struct raster *raster)
{
    struct brush brush;
    uint8_t *rim = (uint8_t *)raster->depth; /* by pixel: enum soft_rim; uses the memory of the depth buffer, which is no longer needed */
    brush_init(&brush, lines_outline_px(raster->context->view));
    memset(rim, 0, (size_t)raster->pitch_px * (size_t)raster->height_px);
    for (int y = 0; y < raster->height_px; y++)
        for (int x = 0; x < raster->width_px; x++)
            if (is_rim(raster, x, y))
                stamp(raster, rim, &brush, x, y);
    return rim;
}

void raster_outline(const struct raster *raster)
{
    paint(raster, raster_rim(raster));
}
