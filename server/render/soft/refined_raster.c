/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the nearest triangle at each sample of a band (group of pixel rows), tile by tile. Writes the triangles' ids and depths
   to rows of the frame's width. */
#include <string.h>

#include "render/soft/refined_impl.h"

const float refined_samples[SAMPLES][2] = { { -0.125f, -0.375f }, { 0.375f, -0.125f }, { -0.375f, 0.125f }, { 0.125f, 0.375f } };
static const float MAX_SAMPLE_OFFSET_PX = 0.375f;

/* Draws section caps (cut faces of closed bodies) into the samples before any triangle, because caps hide everything behind
   them. */
static void draw_caps(const struct refined *refined, int top, int bottom, const struct soft_sample samples[SAMPLES])
{
    size_t pitch = (size_t)refined->raster.pitch_px;
    for (int row = top; row <= bottom; row++) {
        const uint8_t *caps = refined->caps + (size_t)row * pitch;
        size_t start = (size_t)(row - top) * pitch;
        for (int column = 0; column < refined->raster.width_px; column++)
            for (int s = 0; s < SAMPLES && caps[column]; s++) {
                float x = (float)column + 0.5f + samples[s].x, y = (float)row + 0.5f + samples[s].y;
                if (!(caps[column] >> s & 1))
                    continue;
                samples[s].depth[start + (size_t)column] = raster_entry_depth(&refined->raster, x, y);
                samples[s].ids[start + (size_t)column] = ID_CAP;
            }
    }
}

void refined_raster_band(const struct refined *refined, int band, const struct soft_sample samples[SAMPLES],
                         struct soft_fragments *fragments)
{
    const struct raster *raster = &refined->raster;
    int top = band * REFINED_ROWS, bottom = top + REFINED_ROWS < raster->height_px ? top + REFINED_ROWS - 1 : raster->height_px - 1;
    size_t pixels = (size_t)(bottom + 1 - top) * (size_t)raster->pitch_px;
    for (int s = 0; s < SAMPLES; s++) {
        memset(samples[s].depth, 0, pixels * sizeof(float));
        memset(samples[s].ids, 0xff, pixels * sizeof(uint32_t));
    }
    if (refined->caps)
        draw_caps(refined, top, bottom, samples);
    for (int left = 0; left < raster->pitch_px; left += TILE_WIDTH_PX) {
        int right = left + TILE_WIDTH_PX < raster->pitch_px ? left + TILE_WIDTH_PX - 1 : raster->pitch_px - 1;
        struct soft_sample of_tile[SAMPLES];
        memcpy(of_tile, samples, sizeof(of_tile));
        for (int s = 0; s < SAMPLES; s++) {
            of_tile[s].depth += left;
            of_tile[s].ids += left;
        }
        raster_samples(raster, &(struct soft_rect){ left, top, right, bottom }, of_tile, raster->pitch_px, MAX_SAMPLE_OFFSET_PX, fragments);
    }
}
