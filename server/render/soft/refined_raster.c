/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which triangle is nearest at each sample of a band. As raster.c, but four samples to a pixel, and nothing but depth and
   numbers. */
#include <string.h>

#include "render/soft/refined_impl.h"
#include "render/soft/edges.h"

const float refined_samples[SAMPLES][2] = { { -0.125f, -0.375f }, { 0.375f, -0.125f }, { -0.375f, 0.125f }, { 0.125f, 0.375f } };

enum { TILE_PX = 32, MOST_TILES = VIEW_MAX_SIDE_PX / TILE_PX + 1, LOOK_AFTER = 384, AHEAD = 8 };
static const float REACH = 0.375f;

struct band {
    const struct samples *samples;
    int pitch_px, top_px, bottom_px; /* last row included */
    int tile_count, drawn;           /* triangles since the tiles were looked at */
    float farthest[MOST_TILES];      /* depth in each tile; what lies behind all of it is hidden */
    bool touched[MOST_TILES];
};

struct setup {
    float x, y;
    struct edge edges[3];
    struct plane depth;
    int left, right, top, bottom;
    bool thin;
};

SOFT_INLINE bool is_hidden(const struct band *band, int left, int right, float nearest)
{
    for (int tile = left / TILE_PX; tile <= right / TILE_PX; tile++)
        if (nearest >= band->farthest[tile])
            return false;
    return true;
}

SOFT_INLINE float farthest_in(const struct band *band, int tile)
{
    int rows = band->bottom_px - band->top_px + 1, left = tile * TILE_PX;
    int right = left + TILE_PX < band->pitch_px ? left + TILE_PX : band->pitch_px;
    lanes least = (lanes){ 0 } + 1.0f;
    float farthest = 1;
    for (int s = 0; s < SAMPLES; s++)
        for (int row = 0; row < rows; row++)
            for (int column = left; column < right; column += LANES) {
                lanes here = *(const lanes *)(band->samples->depth[s] + (size_t)row * (size_t)band->pitch_px + column);
                least = lanes_choose(here < least, here, least);
            }
    for (int i = 0; i < LANES; i++)
        farthest = least[i] < farthest ? least[i] : farthest;
    return farthest;
}

SOFT_INLINE void look_at_tiles(struct band *band)
{
    if (++band->drawn < LOOK_AFTER)
        return;
    band->drawn = 0;
    for (int tile = 0; tile < band->tile_count; tile++)
        if (band->touched[tile]) {
            band->farthest[tile] = farthest_in(band, tile);
            band->touched[tile] = false;
        }
}

/* False: no sample lies in the band, or all are hidden. */
SOFT_INLINE bool setup_init(struct setup *setup, const struct band *band, int width_px, const struct soft_vertex *p,
                            const struct soft_vertex *q, const struct soft_vertex *r)
{
    setup->left = clip_low(smallest(p->x, q->x, r->x) - REACH, 0);
    setup->right = clip_high(largest(p->x, q->x, r->x) + REACH, width_px - 1);
    setup->top = clip_low(smallest(p->y, q->y, r->y) - REACH, band->top_px);
    setup->bottom = clip_high(largest(p->y, q->y, r->y) + REACH, band->bottom_px);
    if (setup->left > setup->right || setup->top > setup->bottom ||
        is_hidden(band, setup->left, setup->right, largest(p->depth, q->depth, r->depth)))
        return false;
    struct slopes slopes = { q->x - p->x, q->y - p->y, r->x - p->x, r->y - p->y };
    float area = slopes.x1 * slopes.y2 - slopes.x2 * slopes.y1, over = 1 / area;
    float longest = largest(slopes.x1 * slopes.x1 + slopes.y1 * slopes.y1, slopes.x2 * slopes.x2 + slopes.y2 * slopes.y2, 0);
    setup->thin = area * area < 1e-3f * longest;
    slopes = (struct slopes){ slopes.x1 * over, slopes.y1 * over, slopes.x2 * over, slopes.y2 * over };
    setup->x = p->x;
    setup->y = p->y;
    edge_init(&setup->edges[0], p, q);
    edge_init(&setup->edges[1], q, r);
    edge_init(&setup->edges[2], r, p);
    setup->depth = plane_of(&slopes, p->depth, q->depth, r->depth);
    return true;
}

/* Narrows the row to where edges let samples be; one too many at each end. */
SOFT_INLINE void narrow(const struct setup *setup, float y, int *left, int *right)
{
    for (int e = 0; e < 3; e++) {
        const struct edge *edge = &setup->edges[e];
        if (edge->dy < 1e-3f)
            continue;
        float slope = edge->dx / edge->dy, x = edge->x + slope * (y - edge->y), spread = REACH * (slope < 0 ? 1 - slope : 1 + slope) + 1;
        x = x < -1e5f ? -1e5f : x > 1e5f ? 1e5f : x;
        spread = spread > 1e5f ? 1e5f : spread;
        if (edge->negative && (int)(x - spread) > *left)
            *left = (int)(x - spread);
        if (!edge->negative && (int)(x + spread) < *right)
            *right = (int)(x + spread);
    }
}

SOFT_INLINE void draw_triangle(const struct setup *setup, const struct band *band, uint32_t id)
{
    bool wide = setup->right - setup->left >= 2 * LANES;
    int last = band->pitch_px - LANES;
    lanes_int ids = (lanes_int){ 0 } + (int32_t)id;
    for (int row = setup->top; row <= setup->bottom; row++) {
        size_t start = (size_t)(row - band->top_px) * (size_t)band->pitch_px;
        int left = setup->left, right = setup->right;
        if (wide)
            narrow(setup, (float)row + 0.5f, &left, &right);
        for (int s = 0; s < SAMPLES; s++) {
            float y = (float)row + 0.5f + refined_samples[s][1], from_y = y - setup->y, sides[3];
            float *depths = band->samples->depth[s] + start;
            uint32_t *shown = band->samples->ids[s] + start;
            for (int e = 0; e < 3; e++)
                sides[e] = edge_row(&setup->edges[e], y);
            for (int column = left; column <= right; column += LANES) {
                column = column < last ? column : last; /* nothing is written beyond the row */
                lanes x = LANES_IOTA + ((float)column + 0.5f + refined_samples[s][0]);
                lanes_int side = edge_side(&setup->edges[0], sides[0], x) | edge_side(&setup->edges[1], sides[1], x) |
                                 edge_side(&setup->edges[2], sides[2], x);
                lanes *depth = (lanes *)(depths + column);
                lanes here = plane_at(&setup->depth, x - setup->x, from_y, setup->thin);
                lanes_int seen = (side >= 0) & (here >= *depth);
                if (!lanes_any(seen))
                    continue;
                *depth = lanes_choose(seen, here, *depth);
                *(lanes_int *)(shown + column) = lanes_choose_int(seen, ids, *(lanes_int *)(shown + column));
            }
        }
    }
}

SOFT_INLINE const struct soft_vertex *vertex_of(const struct soft *soft, const struct soft_chunk *chunk, uint32_t v)
{
    return v & EXTRA_VERTEX ? &chunk->extra[v & ~EXTRA_VERTEX] : &soft->vertices[v];
}

static void clear(const struct samples *samples, size_t pixels)
{
    for (int s = 0; s < SAMPLES; s++) {
        memset(samples->depth[s], 0, pixels * sizeof(float));
        memset(samples->ids[s], 0xff, pixels * sizeof(uint32_t));
    }
}

/* They hide what is behind them. */
static void draw_caps(const struct refined *refined, const struct band *band)
{
    for (int row = band->top_px; row <= band->bottom_px; row++) {
        const uint8_t *caps = refined->caps + (size_t)row * (size_t)band->pitch_px;
        size_t start = (size_t)(row - band->top_px) * (size_t)band->pitch_px;
        for (int column = 0; column < refined->soft->width_px; column++)
            for (int s = 0; s < SAMPLES && caps[column]; s++) {
                float x = (float)column + 0.5f + refined_samples[s][0], y = (float)row + 0.5f + refined_samples[s][1];
                if (!(caps[column] >> s & 1))
                    continue;
                band->samples->depth[s][start + (size_t)column] = soft_entry_depth(refined->soft, x, y);
                band->samples->ids[s][start + (size_t)column] = ID_CAP;
            }
    }
}

SOFT_KERNEL void refined_raster_band(const struct refined *refined, int number, const struct samples *samples)
{
    const struct soft *soft = refined->soft;
    int bottom = (number + 1) * REFINED_ROWS - 1;
    struct band band = {
        .samples = samples,
        .pitch_px = soft->pitch_px,
        .top_px = number * REFINED_ROWS,
        .bottom_px = bottom < soft->height_px - 1 ? bottom : soft->height_px - 1,
        .tile_count = (soft->pitch_px + TILE_PX - 1) / TILE_PX,
    };
    clear(samples, (size_t)(band.bottom_px - band.top_px + 1) * (size_t)soft->pitch_px);
    if (refined->caps)
        draw_caps(refined, &band);
    for (size_t c = 0; c < soft->chunk_count; c++) {
        const struct soft_chunk *chunk = &soft->chunks[c];
        for (uint32_t i = chunk->starts[number]; i < chunk->starts[number + 1]; i++) {
            const struct soft_triangle *triangle = &chunk->triangles[chunk->sorted[i]];
            struct setup setup;
            if (i + AHEAD < chunk->starts[number + 1])
                for (int v = 0; v < 3; v++)
                    __builtin_prefetch(vertex_of(soft, chunk, chunk->triangles[chunk->sorted[i + AHEAD]].vertices[v]));
            if (!setup_init(&setup, &band, soft->width_px, vertex_of(soft, chunk, triangle->vertices[0]),
                            vertex_of(soft, chunk, triangle->vertices[1]), vertex_of(soft, chunk, triangle->vertices[2])))
                continue;
            draw_triangle(&setup, &band, (uint32_t)c << ID_BITS | chunk->sorted[i]);
            for (int tile = setup.left / TILE_PX; tile <= setup.right / TILE_PX; tile++)
                band.touched[tile] = true;
            look_at_tiles(&band);
        }
    }
}
