/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws small faces in stamps (blocks of pixels drawn as a unit) of 16 pixels, on CPUs with AVX-512. Results are bit-identical to stamps of
   eight. Private to raster.c. */
#ifndef RENDER_SOFT_SIXTEEN_H
#define RENDER_SOFT_SIXTEEN_H
#include "render/soft/small.h"

#if LANES_CHOOSE_AT_ONCE

typedef float sixteen __attribute__((vector_size(64), aligned(4)));
typedef int32_t sixteen_int __attribute__((vector_size(64), aligned(4)));

enum { MANY = 16 };

/* Loads the values of a stamp (block of 16 pixels drawn as a unit) from rows of `width` (4, 8 or 16) pixels, `pitch` elements
   apart. width: a compile-time constant. */
SOFT_INLINE sixteen many_floats(const float *at, size_t pitch, int width)
{
    if (width == MANY)
        return (sixteen)_mm512_loadu_ps(at);
    if (width == MANY / 2)
        return (sixteen)_mm512_insertf32x8(_mm512_castps256_ps512(_mm256_loadu_ps(at)), _mm256_loadu_ps(at + pitch), 1);
    __m512 rows = _mm512_insertf32x4(_mm512_castps128_ps512(_mm_loadu_ps(at)), _mm_loadu_ps(at + pitch), 1);
    rows = _mm512_insertf32x4(rows, _mm_loadu_ps(at + 2 * pitch), 2);
    return (sixteen)_mm512_insertf32x4(rows, _mm_loadu_ps(at + 3 * pitch), 3);
}

SOFT_INLINE void many_put_floats(float *at, size_t pitch, int width, sixteen value)
{
    __m512 all = (__m512)value;
    if (width == MANY) {
        _mm512_storeu_ps(at, all);
    } else if (width == MANY / 2) {
        _mm256_storeu_ps(at, _mm512_castps512_ps256(all));
        _mm256_storeu_ps(at + pitch, _mm512_extractf32x8_ps(all, 1));
    } else {
        _mm_storeu_ps(at, _mm512_castps512_ps128(all));
        _mm_storeu_ps(at + pitch, _mm512_extractf32x4_ps(all, 1));
        _mm_storeu_ps(at + 2 * pitch, _mm512_extractf32x4_ps(all, 2));
        _mm_storeu_ps(at + 3 * pitch, _mm512_extractf32x4_ps(all, 3));
    }
}

/* Stores the pixels of a stamp (block of pixels drawn as a unit) whose bit in `seen` is set. Memory of its other pixels is not accessed,
   since another thread may write there. */
SOFT_INLINE void many_put_ints(uint32_t *at, size_t pitch, int width, uint32_t seen, sixteen_int value)
{
    __m512i all = (__m512i)value;
    if (width == MANY) {
        _mm512_mask_storeu_epi32(at, (__mmask16)seen, all);
    } else if (width == MANY / 2) {
        _mm256_mask_storeu_epi32(at, (__mmask8)seen, _mm512_castsi512_si256(all));
        _mm256_mask_storeu_epi32(at + pitch, (__mmask8)(seen >> 8), _mm512_extracti32x8_epi32(all, 1));
    } else {
        _mm_mask_storeu_epi32(at, (__mmask8)seen, _mm512_castsi512_si128(all));
        _mm_mask_storeu_epi32(at + pitch, (__mmask8)(seen >> 4), _mm512_extracti32x4_epi32(all, 1));
        _mm_mask_storeu_epi32(at + 2 * pitch, (__mmask8)(seen >> 8), _mm512_extracti32x4_epi32(all, 2));
        _mm_mask_storeu_epi32(at + 3 * pitch, (__mmask8)(seen >> 12), _mm512_extracti32x4_epi32(all, 3));
    }
}

SOFT_INLINE sixteen many_x(int width)
{
    if (width == MANY)
        return (sixteen){ 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15 };
    return width == MANY / 2 ? (sixteen){ 0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7 }
                             : (sixteen){ 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3 };
}

SOFT_INLINE sixteen many_y(int width)
{
    if (width == MANY)
        return (sixteen){ 0 };
    return width == MANY / 2 ? (sixteen){ 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1 }
                             : (sixteen){ 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3 };
}

SOFT_INLINE sixteen_int many_side(const struct small *small, int l, int e, sixteen x, sixteen y)
{
    sixteen row = small->edge_dx[e][l] * (y - small->edge_y[e][l]) + small->edge_row[e][l];
    return (sixteen_int)(row - small->edge_dy[e][l] * x) ^ small->negative[e][l];
}

SOFT_INLINE sixteen many_value(const struct small *small, int l, int p, sixteen from_x, sixteen from_y, bool thin)
{
    sixteen value = small->at[p][l] + small->dy[p][l] * from_y + small->dx[p][l] * from_x;
    if (!thin)
        return value;
    __m512 low = _mm512_set1_ps(small->low[p][l]), high = _mm512_set1_ps(small->high[p][l]);
    return (sixteen)_mm512_min_ps(high, _mm512_max_ps(low, (__m512)value)); /* as lanes_clamp */
}

/* Converts sixteen floats to integers: truncates them towards 0, and clamps them to 0..high. */
SOFT_INLINE sixteen_int many_within(sixteen x, int32_t high)
{
    __m512i whole = _mm512_max_epi32(_mm512_cvttps_epi32((__m512)x), _mm512_setzero_si512());
    return (sixteen_int)_mm512_min_epi32(whole, _mm512_set1_epi32(high));
}

/* Draws one stamp (block of 16 pixels drawn as a unit), in rows of `width` pixels. Follows the same rules as draw_stamp(),
   whose stamps have eight pixels. l: index of the face in pen->small. */
SOFT_INLINE void draw_many(const struct small_pen *pen, const struct soft_face *face, int l, int left, int top, int width, bool thin)
{
    const struct soft_tile *tile = pen->tile;
    const struct soft_sample *sample = pen->sample;
    const struct small *small = pen->small;
    size_t pitch = (size_t)tile->pitch_px, place = place_in(tile, left, top);
    sixteen x = many_x(width) + ((float)left + 0.5f + sample->x), y = many_y(width) + ((float)top + 0.5f + sample->y);
    sixteen from_x = x - small->x[l], from_y = y - small->y[l];
    sixteen_int side = many_side(small, l, 0, x, y) | many_side(small, l, 1, x, y) | many_side(small, l, 2, x, y);
    sixteen depth = many_floats(sample->depth + place, pitch, width), here = many_value(small, l, 0, from_x, from_y, thin);
    __mmask16 within = (__mmask16)~_mm512_movepi32_mask((__m512i)side);
    __mmask16 seen = _mm512_mask_cmp_ps_mask(within, (__m512)here, (__m512)depth, _CMP_GE_OS);
    if (sample->marks) {
        sixteen a = many_value(small, l, 1, from_x, from_y, thin), b = many_value(small, l, 2, from_x, from_y, thin);
        sixteen_int marks;
        if (pen->mark != MARK_FIELD)
            marks =
                __builtin_convertvector(a + 0.5f, sixteen_int) << 8 | __builtin_convertvector(b + 0.5f, sixteen_int) | (int32_t)pen->mark;
        else
            marks = (many_within(b, pen->ink->last_row) * COLORMAP_COLUMNS + many_within(a, COLORMAP_PLACES + 1)) | (int32_t)MARK_FIELD;
        many_put_ints(sample->marks + place, pitch, width, seen, marks);
    }
    many_put_floats(sample->depth + place, pitch, width, (sixteen)_mm512_mask_mov_ps((__m512)depth, seen, (__m512)here));
    if (sample->ids)
        many_put_ints(sample->ids + place, pitch, width, seen, (sixteen_int){ 0 } + (int32_t)soft_id(tile, face));
}

SOFT_INLINE void draw_by_many(const struct small_pen *pen, const struct soft_face *face, int l, int width)
{
    int height = MANY / width, last_left = pen->tile->rect.right + 1 - width, last_top = pen->tile->rect.bottom + 1 - height;
    for (int y = face->top; y <= face->bottom; y += height) {
        int top = y < last_top ? y : last_top;
        for (int x = face->left; x <= face->right; x += width) {
            int left = x < last_left ? x : last_left;
            if (pen->small->thin[l])
                draw_many(pen, face, l, left, top, width, true);
            else
                draw_many(pen, face, l, left, top, width, false);
        }
    }
}

/* Returns whether faces may be drawn in stamps (blocks drawn as a unit) of 16 pixels. The tile must be large enough for a stamp
   of any shape, and there must be no isolines. */
SOFT_INLINE bool can_draw_sixteen(const struct soft_tile *tile, const struct mark_ink *ink)
{
    return !ink->rich && tile->rect.right - tile->rect.left >= MANY - 1 && tile->rect.bottom - tile->rect.top >= 3;
}

SOFT_INLINE void draw_sixteen(const struct small_pen *pen, const struct soft_face *const faces[LANES], const struct kinds *kinds,
                              uint32_t rows)
{
    int last_left = pen->tile->rect.right - 3, last_top = pen->tile->rect.bottom - 3;
    for (uint32_t bits = kinds->four; bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        int left = faces[l]->left < last_left ? faces[l]->left : last_left, top = faces[l]->top < last_top ? faces[l]->top : last_top;
        draw_many(pen, faces[l], l, left, top, 4, true);
    }
    for (uint32_t bits = kinds->two; bits; bits &= bits - 1)
        draw_by_many(pen, faces[__builtin_ctz(bits)], __builtin_ctz(bits), 4);
    for (uint32_t bits = kinds->low; bits; bits &= bits - 1)
        draw_by_many(pen, faces[__builtin_ctz(bits)], __builtin_ctz(bits), MANY);
    for (uint32_t bits = rows; bits; bits &= bits - 1)
        draw_by_many(pen, faces[__builtin_ctz(bits)], __builtin_ctz(bits), MANY / 2);
}

#else

SOFT_INLINE bool can_draw_sixteen(const struct soft_tile *tile, const struct mark_ink *ink)
{
    (void)tile;
    (void)ink;
    return false;
}

SOFT_INLINE void draw_sixteen(const struct small_pen *pen, const struct soft_face *const faces[LANES], const struct kinds *kinds,
                              uint32_t rows)
{
    (void)pen, (void)faces, (void)kinds, (void)rows;
}

#endif
#endif
