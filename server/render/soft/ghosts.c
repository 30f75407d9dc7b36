/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws ghosted assets: lines where their depth has edges or creases, and a thin horizontal line every ten pixels; a C version of
   shaders/ghost.frag. */
#include <math.h>

#include "base/mem.h"
#include "render/soft/soft_impl.h"
#include "shaders/constants.glsl"

static const double ghost_rgb[2][3] = { { GHOST_ON_LIGHT_RGB }, { GHOST_ON_DARK_RGB } }; /* by backdrop: light, dark */

struct hinting {
    const struct raster *raster;
    const float *ghosts; /* depth of the ghosted assets */
    uint8_t *veil;
};

static float at(const struct hinting *hinting, int x, int y)
{
    const struct raster *raster = hinting->raster;
    x = x < 0 ? 0 : x < raster->width_px ? x : raster->width_px - 1;
    y = y < 0 ? 0 : y < raster->height_px ? y : raster->height_px - 1;
    return hinting->ghosts[(size_t)y * (size_t)raster->pitch_px + (size_t)x];
}

static float smooth_step(float low, float high, float x)
{
    float t = fminf(fmaxf((x - low) / (high - low), 0), 1);
    return t * t * (3 - 2 * t);
}

static float line_at(const struct hinting *hinting, int x, int y, float here)
{
    float orthographic = hinting->raster->block.back[3], scale = orthographic > 0 ? orthographic : 1 / here, falls = 0, bends = 0;
    for (int axis = 0; axis < 2; axis++) {
        float a = at(hinting, x - !axis, y - axis), b = at(hinting, x + !axis, y + axis);
        falls = fmaxf(falls, (here - fminf(a, b) - fmaxf(fmaxf(a, b) - here, 0)) * scale);
        bends = fmaxf(bends, fabsf(a + b - 2 * here) * scale);
    }
    float line = fmaxf((float)GHOST_FALL_MOST * smooth_step((float)GHOST_FALL_FROM, (float)GHOST_FALL_TO, falls),
                       (float)GHOST_BEND_MOST * smooth_step((float)GHOST_BEND_FROM, (float)GHOST_BEND_TO, bends));
    bool level = y % GHOST_LEVEL_PX == 0;
    return line < (float)GHOST_LEAST && !level ? 0 : fmaxf(line, level ? (float)GHOST_LEVEL : 0);
}

static void hint_rows(void *arg, size_t begin, size_t end)
{
    const struct hinting *hinting = arg;
    const struct raster *raster = hinting->raster;
    for (size_t y = begin; y < end; y++) {
        const float *ghosts = hinting->ghosts + y * (size_t)raster->pitch_px, *depth = raster->depth + y * (size_t)raster->pitch_px;
        uint8_t *veil = hinting->veil + y * (size_t)raster->width_px;
        for (int x = 0; x < raster->width_px; x++)
            veil[x] = ghosts[x] > 0 && ghosts[x] >= depth[x] ? (uint8_t)(255 * line_at(hinting, x, (int)y, ghosts[x]) + 0.5f) : 0;
    }
}

bool raster_ghosts(struct raster *raster, uint8_t *veil, uint8_t bgr[3])
{
    float *depth = raster->depth, *ghosts = mem_try_array((size_t)raster->pitch_px * (size_t)raster->height_px, sizeof(*ghosts));
    if (!ghosts || !raster_find_ghosts(raster)) {
        mem_free(ghosts);
        return false;
    }
    raster->depth = ghosts;
    raster_tiles(raster, SOFT_DEPTH);
    raster->depth = depth;
    struct hinting hinting = { raster, ghosts, veil };
    workers_for(raster->soft->workers, (size_t)raster->height_px, 16, hint_rows, &hinting);
    for (int c = 0; c < 3; c++)
        bgr[c] = (uint8_t)lround(255 * ghost_rgb[raster->context->view->dark][2 - c]);
    mem_free(ghosts);
    return true;
}

struct painting {
    const struct raster *raster;
    const uint8_t *veil, *bgr;
};

static void paint_rows(void *arg, size_t begin, size_t end)
{
    const struct painting *painting = arg;
    const struct raster *raster = painting->raster;
    const uint8_t *bgr = painting->bgr, *veil = painting->veil + begin * (size_t)raster->width_px;
    for (size_t y = begin; y < end; y++) {
        uint8_t *out = raster->out + y * raster->out_stride_bytes;
        for (int x = 0; x < raster->width_px; x++, veil++)
            for (int c = 0; c < 3 && *veil; c++)
                out[4 * x + c] = (uint8_t)(out[4 * x + c] + (bgr[c] - out[4 * x + c]) * *veil / 255.0 + 0.5);
    }
}

void raster_paint_ghosts(const struct raster *raster, const uint8_t *veil, const uint8_t bgr[3])
{
    struct painting painting = { raster, veil, bgr };
    workers_for(raster->soft->workers, (size_t)raster->height_px, 16, paint_rows, &painting);
}
