/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Triangles that cover a pixel's middle and look this way, into bands of rows. */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "render/soft/near.h"

/* --- the near plane and the band -------------------------------------------------------------------------------------------- */

static uint32_t add_extra(struct soft_chunk *chunk, const struct near_corner *corner, uint32_t source)
{
    float inverse = 1 / fmaxf(corner->at[3], 1e-30f);
    mem_grow(&chunk->extra, &chunk->extra_capacity, chunk->extra_count + 1, sizeof(*chunk->extra));
    chunk->extra[chunk->extra_count] = (struct soft_vertex){
        .x = corner->at[0] * inverse,
        .y = corner->at[1] * inverse,
        .depth = corner->at[2] * inverse,
        .inverse_w = inverse,
        .a = corner->a,
        .b = corner->b,
        .source = source,
    };
    return EXTRA_VERTEX | (uint32_t)chunk->extra_count++;
}

static int cut(const struct soft *soft, struct soft_chunk *chunk, const struct soft_mesh *mesh, const uint32_t *indices,
               uint32_t corners[NEAR_CORNERS])
{
    struct near_corner at[3], left[NEAR_CORNERS];
    uint32_t source = (uint32_t)(indices - mesh->file->indices);
    for (int i = 0; i < 3; i++) {
        const struct soft_vertex *vertex = &soft->vertices[mesh->first_vertex + indices[i]];
        at[i] = near_corner_of(mesh, indices[i], vertex->a, vertex->b, 0);
    }
    int count = near_cut(soft, mesh->cut ? soft->cut_count : 0, at, left);
    for (int i = 0; i < count; i++)
        corners[i] = add_extra(chunk, &left[i], source);
    return count;
}

/* --- bands ------------------------------------------------------------------------------------------------------------------ */

static const struct soft_vertex *vertex_of(const struct soft *soft, const struct soft_chunk *chunk, uint32_t v)
{
    return v & EXTRA_VERTEX ? &chunk->extra[v & ~EXTRA_VERTEX] : &soft->vertices[v];
}

static inline float least(float a, float b)
{
    return a < b ? a : b;
}

static inline float most(float a, float b)
{
    return a > b ? a : b;
}

/* The first pixel whose middle may be covered, and the last one, kept to the picture. */
static inline int first_pixel(float x)
{
    return (int)(most(x, -0.4f) + 0.4999f);
}

static inline int last_pixel(float x, int count)
{
    return (int)(least(most(x, -0.5f), (float)count) + 0.5f) - 1;
}

static void add_triangle(const struct soft *soft, struct soft_chunk *chunk, const struct soft_draw *draw, uint32_t v0, uint32_t v1,
                         uint32_t v2)
{
    const struct soft_vertex *p = vertex_of(soft, chunk, v0), *q = vertex_of(soft, chunk, v1), *r = vertex_of(soft, chunk, v2);
    float area = (q->x - p->x) * (r->y - p->y) - (r->x - p->x) * (q->y - p->y); /* rows go down: what faces us is negative */
    bool turned = area > 0;
    bool back = turned != soft->meshes[draw->mesh].mirrored;
    if (area == 0 || (!draw->double_sided && back))
        return;
    float reach = soft->reach_px;
    int left = first_pixel(least(least(p->x, q->x), r->x) - reach), top = first_pixel(least(least(p->y, q->y), r->y) - reach);
    int right = last_pixel(most(most(p->x, q->x), r->x) + reach, soft->width_px);
    int bottom = last_pixel(most(most(p->y, q->y), r->y) + reach, soft->height_px);
    if (left > right || top > bottom)
        return;
    uint32_t first = (uint32_t)(top / soft->band_rows), last = (uint32_t)(bottom / soft->band_rows);
    size_t i = chunk->triangle_count++;
    chunk->triangles[i] = (struct soft_triangle){ { v0, turned ? v1 : v2, turned ? v2 : v1 }, /* area > 0 from here on */
                                                  draw->mark | (back ? draw->back : 0) };
    chunk->bands[i] = first | last << 16;
    for (uint32_t b = first; b <= last; b++)
        chunk->starts[b + 1]++;
}

/* Room for so many triangles together. */
static void reserve(struct soft_chunk *chunk, size_t count)
{
    mem_grow(&chunk->triangles, &chunk->triangle_capacity, count, sizeof(*chunk->triangles));
    mem_grow(&chunk->bands, &chunk->band_capacity, count, sizeof(*chunk->bands));
}

/* Where a triangle is cut there may be more of them than the draw has: few are. */
static void add_draw(const struct soft *soft, struct soft_chunk *chunk, const struct soft_draw *draw)
{
    const struct soft_mesh *mesh = &soft->meshes[draw->mesh];
    const uint32_t *indices = mesh->file->indices + draw->first_index;
    const struct soft_vertex *vertices = soft->vertices + mesh->first_vertex;
    reserve(chunk, chunk->triangle_count + draw->index_count / 3);
    for (uint32_t i = 0; i < draw->index_count; i += 3) {
        const uint32_t *at = &indices[i];
        if (vertices[at[0]].inverse_w > 0 && vertices[at[1]].inverse_w > 0 && vertices[at[2]].inverse_w > 0) {
            add_triangle(soft, chunk, draw, mesh->first_vertex + at[0], mesh->first_vertex + at[1], mesh->first_vertex + at[2]);
            continue;
        }
        uint32_t corners[NEAR_CORNERS];
        int count = cut(soft, chunk, mesh, at, corners);
        reserve(chunk, chunk->triangle_count + (draw->index_count - i) / 3 + NEAR_TRIANGLES);
        for (int c = 2; c < count; c++)
            add_triangle(soft, chunk, draw, corners[0], corners[c - 1], corners[c]);
    }
}

/* Counting sort: stable, so that the order of drawing stays. */
static void sort(const struct soft *soft, struct soft_chunk *chunk)
{
    uint32_t bands = (uint32_t)soft->band_count;
    for (uint32_t b = 0; b < bands; b++)
        chunk->starts[b + 1] += chunk->starts[b];
    mem_grow(&chunk->sorted, &chunk->sorted_capacity, chunk->starts[bands], sizeof(*chunk->sorted));
    for (size_t i = 0; i < chunk->triangle_count; i++)
        for (uint32_t b = chunk->bands[i] & 0xffff; b <= chunk->bands[i] >> 16; b++)
            chunk->sorted[chunk->starts[b]++] = (uint16_t)i;
    memmove(chunk->starts + 1, chunk->starts, bands * sizeof(*chunk->starts)); /* the loop moved each to the next one's start */
    chunk->starts[0] = 0;
}

struct sorting {
    struct soft *soft;
    size_t first;
};

static void sort_chunks(void *arg, size_t begin, size_t end)
{
    const struct sorting *sorting = arg;
    struct soft *soft = sorting->soft;
    for (size_t c = sorting->first + begin; c < sorting->first + end; c++) {
        struct soft_chunk *chunk = &soft->chunks[c];
        size_t starts = (size_t)soft->band_count + 1;
        chunk->triangle_count = chunk->extra_count = 0;
        mem_grow(&chunk->starts, &chunk->start_capacity, starts, sizeof(*chunk->starts));
        memset(chunk->starts, 0, starts * sizeof(*chunk->starts));
        for (size_t d = 0; d < chunk->draw_count; d++)
            add_draw(soft, chunk, &soft->draws[chunk->first_draw + d]);
        sort(soft, chunk);
    }
}

void soft_sort(struct soft *soft, size_t begin, size_t end)
{
    struct sorting sorting = { soft, begin };
    workers_for(soft->workers, end - begin, 1, sort_chunks, &sorting);
}
