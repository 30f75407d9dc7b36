/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Assets that are only hinted at: lines where their depth breaks or bends, and thin level ones: shaders/ghost.frag once more. */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "render/soft/soft_impl.h"

static const uint8_t ghost_bgr[2][3] = { { 84, 66, 51 }, { 184, 163, 143 } }; /* by backdrop: light, dark */
enum { LEVEL_PX = 10 };

struct hinting {
    const struct soft *soft;
    const float *ghosts; /* their depth */
    uint8_t *veil;
};

static float at(const struct hinting *hinting, int x, int y)
{
    const struct soft *soft = hinting->soft;
    x = x < 0 ? 0 : x < soft->width_px ? x : soft->width_px - 1;
    y = y < 0 ? 0 : y < soft->height_px ? y : soft->height_px - 1;
    return hinting->ghosts[(size_t)y * (size_t)soft->pitch_px + (size_t)x];
}

static float smooth_step(float low, float high, float x)
{
    float t = fminf(fmaxf((x - low) / (high - low), 0), 1);
    return t * t * (3 - 2 * t);
}

static float line_at(const struct hinting *hinting, int x, int y, float here)
{
    float orthographic = hinting->soft->block.back[3], scale = orthographic > 0 ? orthographic : 1 / here, falls = 0, bends = 0;
    for (int axis = 0; axis < 2; axis++) {
        float a = at(hinting, x - !axis, y - axis), b = at(hinting, x + !axis, y + axis);
        falls = fmaxf(falls, (here - fminf(a, b) - fmaxf(fmaxf(a, b) - here, 0)) * scale);
        bends = fmaxf(bends, fabsf(a + b - 2 * here) * scale);
    }
    float line = fmaxf(0.9f * smooth_step(0.004f, 0.012f, falls), 0.55f * smooth_step(0.0003f, 0.0009f, bends));
    bool level = y % LEVEL_PX == 0;
    return line < 0.05f && !level ? 0 : fmaxf(line, level ? 0.4f : 0);
}

static void hint_rows(void *arg, size_t begin, size_t end)
{
    const struct hinting *hinting = arg;
    const struct soft *soft = hinting->soft;
    for (size_t y = begin; y < end; y++) {
        const float *ghosts = hinting->ghosts + y * (size_t)soft->pitch_px, *depth = soft->depth + y * (size_t)soft->pitch_px;
        uint8_t *veil = hinting->veil + y * (size_t)soft->width_px;
        for (int x = 0; x < soft->width_px; x++)
            veil[x] = ghosts[x] > 0 && ghosts[x] >= depth[x] ? (uint8_t)(255 * line_at(hinting, x, (int)y, ghosts[x]) + 0.5f) : 0;
    }
}

bool soft_ghosts(struct soft *soft, uint8_t *veil, uint8_t bgr[3])
{
    float *depth = soft->depth, *ghosts = mem_try_array((size_t)soft->pitch_px * (size_t)soft->height_px, sizeof(*ghosts));
    if (!ghosts || !soft_find_ghosts(soft)) {
        mem_free(ghosts);
        return false;
    }
    soft->depth = ghosts;
    soft_tiles(soft, SOFT_DEPTH);
    soft->depth = depth;
    struct hinting hinting = { soft, ghosts, veil };
    workers_for(soft->workers, (size_t)soft->height_px, 16, hint_rows, &hinting);
    memcpy(bgr, ghost_bgr[soft->context->view->dark], 3);
    mem_free(ghosts);
    return true;
}

struct painting {
    const struct soft *soft;
    const uint8_t *veil, *bgr;
};

static void paint_rows(void *arg, size_t begin, size_t end)
{
    const struct painting *painting = arg;
    const struct soft *soft = painting->soft;
    const uint8_t *bgr = painting->bgr, *veil = painting->veil + begin * (size_t)soft->width_px;
    for (size_t y = begin; y < end; y++) {
        uint8_t *out = soft->out + y * soft->out_stride_bytes;
        for (int x = 0; x < soft->width_px; x++, veil++)
            for (int c = 0; c < 3 && *veil; c++)
                out[4 * x + c] = (uint8_t)(out[4 * x + c] + (bgr[c] - out[4 * x + c]) * *veil / 255.0 + 0.5);
    }
}

void soft_paint_ghosts(const struct soft *soft, const uint8_t *veil, const uint8_t bgr[3])
{
    struct painting painting = { soft, veil, bgr };
    workers_for(soft->workers, (size_t)soft->height_px, 16, paint_rows, &painting);
}
