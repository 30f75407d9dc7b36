/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lookups in the sun's shadow map and in the backdrop texture, for eight pixels at a time. Private to soft/. */
#ifndef RENDER_SOFT_LOOKUPS_H
#define RENDER_SOFT_LOOKUPS_H
#include <math.h>
#include <string.h>

#include "render/soft/soft_impl.h"
#include "render/soft/lanes.h"
#include "render/light/sky.h"

SOFT_INLINE lanes whole_part(lanes x) /* x >= 0 */
{
    return __builtin_convertvector(lanes_whole(x), lanes);
}

SOFT_INLINE lanes_int gather(const uint32_t *table, lanes_int at)
{
#ifdef __AVX2__
    return (lanes_int)_mm256_i32gather_epi32((const int *)table, (__m256i)at, sizeof(*table));
#else
    lanes_int out;
    for (int i = 0; i < LANES; i++)
        out[i] = (int32_t)table[at[i]];
    return out;
#endif
}

SOFT_INLINE lanes byte_of(lanes_int packed, int number)
{
    return __builtin_convertvector(packed >> (8 * number) & 0xff, lanes);
}

/* Lookup of eight points in the sun's shadow map. The smallest and largest depth of each tile of the map decide for most points, without
   reading texels, whether they are lit. The lookup has three steps, sun_aim, sun_bound and sun_look. Each step prefetches the memory that
   the next one reads, so the caller does other work in between. */
struct sun_aim {
    /* u_part, v_part: position between the four nearest texels, 0..1; place: depth of the point, in the integer unit of the shadow map */
    lanes u_part, v_part, place;
    /* tile: index of the shadow map tile; at: index, in soft_light.sun_map, of the upper left of the four texels */
    lanes_int tile, at;
    /* mask of the points whose texels must still be read; for the others, `lit` (visible part of the sun, 0..1) is final */
    lanes_int open;
    lanes lit;
};

/* Begins the lookup of eight shadows: finds tiles and texels. s_t_depth: position on the map and depth, 0..1. wanted: mask of the points
   that need a shadow. */
SOFT_INLINE void sun_aim(const struct soft_light *light, const lanes s_t_depth[3], lanes_int wanted, struct sun_aim *aim)
{
    const float over = 1.0f / SUN_TILE_STEP_PX, size = (float)light->sun_map_px;
    lanes u = lanes_clamp(s_t_depth[0] * size - 0.5f, 0, size - 1), v = lanes_clamp(s_t_depth[1] * size - 0.5f, 0, size - 1);
    lanes_int whole_u = lanes_whole(u), whole_v = lanes_whole(v);
    lanes u0 = __builtin_convertvector(whole_u, lanes), v0 = __builtin_convertvector(whole_v, lanes);
    lanes_int column = lanes_whole((u0 + 0.5f) * over), row = lanes_whole((v0 + 0.5f) * over);
    aim->u_part = u - u0;
    aim->v_part = v - v0;
    aim->place = lanes_clamp(s_t_depth[2], 0, 1) * 65535.0f;
    aim->tile = row * light->sun_tiles + column;
    aim->at = aim->tile * SUN_TILE_TEXELS + (whole_v - row * SUN_TILE_STEP_PX) * SUN_TILE_PX + whole_u - column * SUN_TILE_STEP_PX;
    aim->open = wanted;
}

/* Prefetches the depth bounds of tiles that sun_bound() reads. Usually all eight points lie in one cache line, so prefetching for the first
   and the last point suffices. */
SOFT_INLINE void sun_prefetch_bounds(const struct soft_light *light, const struct sun_aim *aim)
{
    lanes_int tile = aim->tile & aim->open;
    for (int i = 0; i < LANES; i += LANES - 1)
        __builtin_prefetch(light->sun_bounds + tile[i]);
}

/* Decides whether points are lit where the smallest and largest depth of the point's shadow map tile suffice to tell. Undecided
   points remain in aim->open. */
SOFT_INLINE void sun_bound(const struct soft_light *light, struct sun_aim *aim)
{
    lanes_int bounds = gather(light->sun_bounds, aim->tile & aim->open);
    lanes one = (lanes){ 0 } + 1.0f, none = { 0 };
    lanes_int lit = aim->place >= __builtin_convertvector(bounds >> 16 & 0xffff, lanes);
    aim->open &= ~lit & (aim->place >= __builtin_convertvector(bounds & 0xffff, lanes));
    aim->lit = lanes_choose(lit, one, none);
}

/* Prefetches into the CPU cache the shadow map texels of the points that sun_bound() left undecided. */
SOFT_INLINE void sun_prefetch(const struct soft_light *light, const struct sun_aim *aim)
{
    lanes_int at = aim->at & aim->open;
    for (int i = 0; i < LANES; i++)
        __builtin_prefetch(light->sun_map + at[i]);
}

/* Compares the depth of each point with four texels and weights the results, like a GL shadow sampler with linear filter. at: indices as in
   aim->at. */
SOFT_INLINE lanes sun_compare(const struct soft_light *light, const struct sun_aim *aim, lanes_int at)
{
    /* texels of the shadow map; each element holds a left texel and its right neighbour, in 16 bits each; [0]: upper row, [1]: lower row */
    uint32_t pairs[2][LANES];
    for (int i = 0; i < LANES; i++) {
        memcpy(&pairs[0][i], light->sun_map + at[i], 4);
        memcpy(&pairs[1][i], light->sun_map + at[i] + SUN_TILE_PX, 4);
    }
    lanes_uint above = *(const lanes_uint *)pairs[0], below = *(const lanes_uint *)pairs[1];
    lanes one = (lanes){ 0 } + 1.0f, none = { 0 };
#define LIT(pair) lanes_choose(aim->place >= __builtin_convertvector((lanes_int)((pair)&0xffff), lanes), one, none)
    lanes upper = LIT(above) + aim->u_part * (LIT(above >> 16) - LIT(above));
    lanes lower = LIT(below) + aim->u_part * (LIT(below >> 16) - LIT(below));
#undef LIT
    return upper + aim->v_part * (lower - upper);
}

/* Reads shadow map texels for the points that sun_bound() left undecided (aim->open). Returns, for all lanes, the visible part of the sun,
   0..1. */
SOFT_INLINE lanes sun_look(const struct soft_light *light, const struct sun_aim *aim)
{
    if (!lanes_any(aim->open))
        return aim->lit;
    return lanes_choose(aim->open, sun_compare(light, aim, aim->at & aim->open), aim->lit);
}

/* Looks up a shadow in a single step, without using the depth bounds of tiles. Refined frames use this function, because the bounds would
   not speed up their four neighbouring lookups per point. */
SOFT_INLINE lanes sun_tap(const struct soft_light *light, lanes s, lanes t, lanes depth)
{
    struct sun_aim aim;
    sun_aim(light, (lanes[3]){ s, t, depth }, (lanes_int){ 0 }, &aim);
    return sun_compare(light, &aim, aim.at);
}

/* Elevations above the horizon along a row of pixels, as columns of the backdrop table. They are interpolated linearly within a
   stretch of raster->stretch_px pixels (choose_stretch bounds the error). */
struct heights {
    /* first: elevation above the horizon at the centre of the first pixel of a stretch of a row; step: its change per pixel */
    float first, step;
};

static float height_at(const struct raster *raster, float x, float y)
{
    const float(*m)[3] = raster->ray_from_pixel;
    float up = 0, square = 0;
    for (int r = 0; r < 3; r++) {
        float ray = x * m[0][r] + (y * m[1][r] + m[2][r]);
        up += ray * (float)raster->soft->gpu_scene->up[r];
        square += ray * ray;
    }
    return up / sqrtf(square) * 1023.5f + 1024.0f;
}

/* Returns the elevations above the horizon of the view rays of a stretch (stretch_px pixels of a row) that begins at this pixel. */
static inline struct heights heights_from(const struct raster *raster, int column, int row)
{
    float y = (float)row + 0.5f, x = (float)column + 0.5f, first = height_at(raster, x, y);
    return (struct heights){ first, (height_at(raster, x + (float)raster->stretch_px, y) - first) / (float)raster->stretch_px };
}

SOFT_INLINE lanes_int backdrop_at(const struct raster *raster, const struct heights *heights, int column, int row)
{
    lanes x = LANES_IOTA + ((float)column + 0.5f);
    lanes height = (LANES_IOTA + (float)(column & (raster->stretch_px - 1))) * heights->step + heights->first;
    for (int i = 0; i < LANES && raster->stretch_px == 1; i++)
        height[i] = height_at(raster, (float)(column + i) + 0.5f, (float)row + 0.5f);
    lanes_int at = lanes_whole(lanes_clamp(height, 0, SKY_BACKDROPS - 1));
    lanes_int tile = (raster->context->view->dark ? SKY_ROUNDINGS : 0) + (row & 3) * 4 + (lanes_whole(x) & 3);
    return gather(raster->soft->backdrops, tile * SKY_BACKDROPS + at);
}

/* Multiplies each channel of eight packed colours by factor / 256. */
SOFT_INLINE lanes_int darkened(lanes_int color, lanes_int factor)
{
    lanes_uint by = (lanes_uint)factor, bgrx = (lanes_uint)color;
    /* blue and red are multiplied in one multiplication, because their bits are far enough apart */
    lanes_uint blue_red = ((bgrx & 0xff00ff) * by + 0x800080) >> 8 & 0xff00ff;
    lanes_uint green = ((bgrx & 0xff00) * by + 0x8000) >> 8 & 0xff00;
    return (lanes_int)(blue_red | green | 0xff000000);
}

#endif
