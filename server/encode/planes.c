/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Subsamples chroma while keeping colour edges sharp: averages four pixels with libyuv, and again with weights where a colour
   meets a grey. */
#include "encode/planes.h"

#include <libyuv.h>
#include <stdbool.h>
#include <string.h>

#include "base/math/simd.h"

/* size of a tile in chroma samples, each of which covers 2 x 2 pixels; the weighted mean is computed for whole tiles */
enum { TILE_W = 16, TILE_H = PLANES_BAND_PX / 2 };
/* a pixel counts as coloured if its chroma differs from grey by at least this many steps of 8-bit chroma */
enum { COLOUR = 16 };
static const float GREY = 4; /* weight of a grey pixel in the mean; a coloured pixel's weight is this plus the square of its chroma */

size_t planes_bands(int height_px)
{
    return (size_t)(height_px + PLANES_BAND_PX - 1) / PLANES_BAND_PX;
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

/* Returns true if a tile contains both coloured and grey pixels and thus needs the weighted mean. Between two colours the plain
   mean is as good. */
static bool has_rim(uint8_t *const at[2], const int pitch[2], int width, int height)
{
    bool colour = false, grey = true;
    for (int c = 0; c < 2; c++) {
        uint8_t low = 255, high = 0;
        for (int j = 0; j < height; j++) {
            const uint8_t *row = at[c] + (ptrdiff_t)j * pitch[c];
            for (int i = 0; i < width; i++) {
                low = row[i] < low ? row[i] : low;
                high = row[i] > high ? row[i] : high;
            }
        }
        colour = colour || high >= 128 + COLOUR || low <= 128 - COLOUR;
        grey = grey && low < 128 + COLOUR && high > 128 - COLOUR;
    }
    return colour && grey;
}

SIMD_BODY void weigh_row(const uint32_t *pixels, float u[2 * TILE_W], float v[2 * TILE_W], float weight[2 * TILE_W])
{
    for (int i = 0; i < 2 * TILE_W; i++) {
        float b = (float)(int)(pixels[i] & 255), g = (float)(int)(pixels[i] >> 8 & 255), r = (float)(int)(pixels[i] >> 16 & 255);
        float of_u = 0.5f * b - 0.331264f * g - 0.168736f * r, of_v = 0.5f * r - 0.418688f * g - 0.081312f * b;
        weight[i] = GREY + of_u * of_u + of_v * of_v;
        u[i] = of_u * weight[i];
        v[i] = of_v * weight[i];
    }
}

/* Computes the weighted mean chroma for one row of a tile. pixels: two contiguous rows of 2 * TILE_W pixels; out: TILE_W samples of u
   and of v. */
SIMD_BODY void weigh_pair(const uint32_t *pixels, uint8_t out[2][TILE_W])
{
    float u[2][2 * TILE_W], v[2][2 * TILE_W], weight[2][2 * TILE_W];
    for (int j = 0; j < 2; j++)
        weigh_row(pixels + (ptrdiff_t)j * 2 * TILE_W, u[j], v[j], weight[j]);
    for (int i = 0; i < 2 * TILE_W; i++) {
        u[0][i] += u[1][i];
        v[0][i] += v[1][i];
        weight[0][i] += weight[1][i];
    }
    for (int i = 0; i < TILE_W; i++) { /* the mean chroma lies between -127.5 and 127.5; adding 128.5 makes it positive and rounds it */
        float part = 1 / (weight[0][2 * i] + weight[0][2 * i + 1]);
        out[0][i] = (uint8_t)least((int)((u[0][2 * i] + u[0][2 * i + 1]) * part + 128.5f), 255);
        out[1][i] = (uint8_t)least((int)((v[0][2 * i] + v[0][2 * i + 1]) * part + 128.5f), 255);
    }
}

static void weigh_plain(const uint32_t *pixels, uint8_t out[2][TILE_W])
{
    weigh_pair(pixels, out);
}

SIMD_AVX2 static void weigh_wide(const uint32_t *pixels, uint8_t out[2][TILE_W])
{
    weigh_pair(pixels, out);
}

/* Copies the pixels of a tile; beyond the picture's edge, repeats the edge pixel. */
static void gather(const struct yuv_planes *planes, int x, int y, uint32_t pixels[2][2 * TILE_W])
{
    int width = least(2 * TILE_W, planes->width_px - x);
    for (int j = 0; j < 2; j++) {
        const uint8_t *row = planes->bgrx + (ptrdiff_t)least(y + j, planes->height_px - 1) * planes->stride_bytes;
        memcpy(pixels[j], row + (ptrdiff_t)x * 4, (size_t)width * 4);
        for (int i = width; i < 2 * TILE_W; i++)
            pixels[j][i] = pixels[j][width - 1];
    }
}

static void mend_tile(const struct yuv_planes *planes, int x, int y)
{
    int width = least(TILE_W, (planes->width_px + 1) / 2 - x), height = least(TILE_H, (planes->height_px + 1) / 2 - y);
    const int pitch[2] = { planes->pitch[1], planes->pitch[2] };
    uint8_t *at[2], out[2][TILE_W];
    uint32_t pixels[2][2 * TILE_W];
    for (int c = 0; c < 2; c++)
        at[c] = planes->plane[1 + c] + (ptrdiff_t)y * pitch[c] + x;
    if (!has_rim(at, pitch, width, height))
        return;
    for (int j = 0; j < height; j++) {
        gather(planes, 2 * x, 2 * (y + j), pixels);
        (simd_has_avx2() ? weigh_wide : weigh_plain)(pixels[0], out);
        for (int c = 0; c < 2; c++)
            memcpy(at[c] + (ptrdiff_t)j * pitch[c], out[c], (size_t)width);
    }
}

void planes_convert(const struct yuv_planes *planes, size_t begin, size_t end)
{
    ptrdiff_t y = (ptrdiff_t)begin * PLANES_BAND_PX;
    int rows = least((int)end * PLANES_BAND_PX, planes->height_px) - (int)y;
    ARGBToJ420(planes->bgrx + y * planes->stride_bytes, planes->stride_bytes, planes->plane[0] + y * planes->pitch[0], planes->pitch[0],
               planes->plane[1] + y / 2 * planes->pitch[1], planes->pitch[1], planes->plane[2] + y / 2 * planes->pitch[2], planes->pitch[2],
               planes->width_px, rows);
    for (int band = (int)begin; band < (int)end; band++)
        for (int x = 0; x < (planes->width_px + 1) / 2; x += TILE_W)
            mend_tile(planes, x, band * TILE_H);
}
