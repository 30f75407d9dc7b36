/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Small faces that need neither patterns nor perspective correction. They are set up eight at a time and drawn in stamps
   (blocks of 8 or 16 pixels drawn as a unit). Private to raster.c. */
#ifndef RENDER_SOFT_SMALL_H
#define RENDER_SOFT_SMALL_H
#include "render/soft/pixel_marks.h"
#include "render/soft/tile.h"
#include "render/soft/edges.h"

enum { SMALL_PX = 4 * LANES };

/* Returns whether a face counts as small. Faces one or two pixels high are small at any width, because stamps (blocks of pixels drawn as a
   unit) fit them well. */
SOFT_INLINE bool is_small(const struct soft_face *face)
{
    return face->bottom - face->top < SMALL_PX && (face->right - face->left < SMALL_PX || face->bottom - face->top < 2);
}

/* Returns whether draw_eight() can draw the face: all corners have almost the same depth, so perspective is negligible, and no
   corner has a pattern. */
SOFT_INLINE bool is_plain(const struct soft_corners *corners, const struct soft_face *face)
{
    int i = face->corners[0], j = face->corners[1], k = face->corners[2];
    if (!corners->flat) {
        float low = smallest(corners->inverse_w[i], corners->inverse_w[j], corners->inverse_w[k]);
        if (largest(corners->inverse_w[i], corners->inverse_w[j], corners->inverse_w[k]) > SOFT_LITTLE * low)
            return false;
    }
    return !corners->all_flags || !((corners->flags[i] | corners->flags[j] | corners->flags[k]) & SOFT_PATTERNS);
}

struct small { /* eight faces, as structure of arrays: lane i belongs to face i */
    lanes x, y;
    /* edge functions of the faces, with members as in struct raster_edge; edge_row: edge_dy times x, where x is that of the
       edge's upper end */
    lanes edge_y[3], edge_dx[3], edge_dy[3], edge_row[3];
    lanes_int negative[3];
    /* functions that are linear over the face: [0] depth, [1] a, [2] b of struct soft_vertex. at: value at (x, y); dx, dy: change per
       pixel; low, high: bounds of the value */
    lanes at[3], dx[3], dy[3], low[3], high[3];
    lanes_int thin;
};

struct eight_faces { /* eight faces, one per lane: indices of their corners, and their sizes */
    lanes_int corners[3];
    lanes_int width, height; /* size in pixels, minus 1 */
};

SOFT_INLINE struct eight_faces read_faces(const struct soft_face *const faces[LANES])
{
    lanes_int pairs[4], words[4];
    for (int i = 0; i < 4; i++)
        pairs[i] = __builtin_shufflevector(*(const quad_int *)faces[i], *(const quad_int *)faces[i + 4], 0, 1, 2, 3, 4, 5, 6, 7);
    for (int i = 0; i < 4; i += 2) { /* transposes eight faces of four 32-bit words each, so that lane l of each word belongs to face l */
        words[i] = __builtin_shufflevector(pairs[i], pairs[i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
        words[i + 1] = __builtin_shufflevector(pairs[i], pairs[i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
    }
    lanes_int first = __builtin_shufflevector(words[0], words[2], 0, 1, 8, 9, 4, 5, 12, 13);
    lanes_int second = __builtin_shufflevector(words[0], words[2], 2, 3, 10, 11, 6, 7, 14, 15);
    lanes_int across = __builtin_shufflevector(words[1], words[3], 0, 1, 8, 9, 4, 5, 12, 13);
    lanes_int down = __builtin_shufflevector(words[1], words[3], 2, 3, 10, 11, 6, 7, 14, 15);
    return (struct eight_faces){
        .corners = { first & 0xffff, first >> 16, second & 0xffff },
        .width = (across >> 16) - (across & 0xffff),
        .height = (down >> 16) - (down & 0xffff),
    };
}

/* Sets up the edge functions of eight faces, and the interpolation of depth. shaded true: also that of a and b (colour map
   column and row, or light). at: for each face, its corners as indices in `corners`. */
SOFT_INLINE void small_init(struct small *small, const struct soft_corners *corners, const lanes_int at[3], bool shaded)
{
    lanes x[3], y[3];
    for (int i = 0; i < 3; i++) {
        x[i] = lanes_look_up(corners->x, at[i]);
        y[i] = lanes_look_up(corners->y, at[i]);
    }
    for (int e = 0; e < 3; e++) {
        lanes px = x[e], py = y[e], qx = x[(e + 1) % 3], qy = y[(e + 1) % 3];
        lanes_int swap = (qy < py) | ((qy == py) & (qx < px));
        lanes upper_x = lanes_choose(swap, qx, px), upper_y = lanes_choose(swap, qy, py);
        small->edge_y[e] = upper_y;
        small->edge_dx[e] = lanes_choose(swap, px, qx) - upper_x;
        small->edge_dy[e] = lanes_choose(swap, py, qy) - upper_y;
        small->edge_row[e] = small->edge_dy[e] * upper_x;
        small->negative[e] = swap;
    }
    lanes x1 = x[1] - x[0], y1 = y[1] - y[0], x2 = x[2] - x[0], y2 = y[2] - y[0];
    lanes area = x1 * y2 - x2 * y1, over = 1.0f / area, one = x1 * x1 + y1 * y1, two = x2 * x2 + y2 * y2;
    small->thin = area * area < 1e-3f * lanes_most(one, two);
    small->x = x[0];
    small->y = y[0];
    const float *tables[3] = { corners->depth, corners->a, corners->b };
    for (int p = 0; p < (shaded ? 3 : 1); p++) {
        lanes v0 = lanes_look_up(tables[p], at[0]), v1 = lanes_look_up(tables[p], at[1]), v2 = lanes_look_up(tables[p], at[2]);
        lanes d1 = v1 - v0, d2 = v2 - v0, low = lanes_least(v1, v0), high = lanes_most(v1, v0);
        small->at[p] = v0;
        small->low[p] = lanes_least(v2, low);
        small->high[p] = lanes_most(v2, high);
        small->dx[p] = (d1 * y2 - d2 * y1) * over;
        small->dy[p] = (d2 * x1 - d1 * x2) * over;
    }
}

/* Loads the values of eight pixels: one row of eight or, if `two` is true, two rows of four. two: a compile-time constant. */
SOFT_INLINE lanes stamp_floats(const float *at, size_t pitch, bool two)
{
    if (!two)
        return *(const lanes *)at;
    return __builtin_shufflevector(*(const quad *)at, *(const quad *)(at + pitch), 0, 1, 2, 3, 4, 5, 6, 7);
}

SOFT_INLINE lanes_int stamp_ints(const uint32_t *at, size_t pitch, bool two)
{
    if (!two)
        return *(const lanes_int *)at;
    return __builtin_shufflevector(*(const quad_int *)at, *(const quad_int *)(at + pitch), 0, 1, 2, 3, 4, 5, 6, 7);
}

SOFT_INLINE void stamp_put_floats(float *at, size_t pitch, bool two, lanes value)
{
    if (two) {
        *(quad *)at = __builtin_shufflevector(value, value, 0, 1, 2, 3);
        *(quad *)(at + pitch) = __builtin_shufflevector(value, value, 4, 5, 6, 7);
    } else {
        *(lanes *)at = value;
    }
}

SOFT_INLINE void stamp_put_ints(uint32_t *at, size_t pitch, bool two, lanes_int value)
{
    if (two) {
        *(quad_int *)at = __builtin_shufflevector(value, value, 0, 1, 2, 3);
        *(quad_int *)(at + pitch) = __builtin_shufflevector(value, value, 4, 5, 6, 7);
    } else {
        *(lanes_int *)at = value;
    }
}

SOFT_INLINE lanes_int small_side(const struct small *small, int l, int e, lanes x, lanes y)
{
    lanes row = small->edge_dx[e][l] * (y - small->edge_y[e][l]) + small->edge_row[e][l];
    return (lanes_int)(row - small->edge_dy[e][l] * x) ^ small->negative[e][l];
}

SOFT_INLINE lanes small_value(const struct small *small, int l, int p, lanes from_x, lanes from_y, bool thin)
{
    lanes value = small->at[p][l] + small->dy[p][l] * from_y + small->dx[p][l] * from_x;
    return thin ? lanes_clamp(value, small->low[p][l], small->high[p][l]) : value;
}

/* Returns the index, in the tile's sample arrays, of a pixel given in coordinates of the frame. */
SOFT_INLINE size_t place_in(const struct soft_tile *tile, int column, int row)
{
    return (size_t)(row - tile->rect.top) * (size_t)tile->pitch_px + (size_t)(column - tile->rect.left);
}

/* Parameters that are the same for all small faces drawn together in one sample of a tile. */
struct small_pen {
    const struct soft_tile *tile;
    const struct soft_sample *sample;
    const struct small *small; /* equations of the faces */
    const struct mark_ink *ink;
    uint32_t mark; /* mark (content of a pixel) of the faces */
};

/* Draws one stamp (block of pixels drawn as a unit) of eight pixels: depth and mark where the face covers a pixel and is nearest. l: index
   of the face in pen->small. left, top: position in the frame. two: two rows of four instead of one of eight. two, thin: compile-time
   constants. */
SOFT_INLINE void draw_stamp(const struct small_pen *pen, const struct soft_face *face, int l, int left, int top, bool two, bool thin)
{
    const struct soft_tile *tile = pen->tile;
    const struct soft_sample *sample = pen->sample;
    const struct small *small = pen->small;
    size_t pitch = (size_t)tile->pitch_px, place = place_in(tile, left, top);
    lanes x = (two ? (lanes){ 0, 1, 2, 3, 0, 1, 2, 3 } : LANES_IOTA) + ((float)left + 0.5f + sample->x);
    lanes y = (two ? (lanes){ 0, 0, 0, 0, 1, 1, 1, 1 } : (lanes){ 0 }) + ((float)top + 0.5f + sample->y);
    lanes from_x = x - small->x[l], from_y = y - small->y[l];
    lanes_int side = small_side(small, l, 0, x, y) | small_side(small, l, 1, x, y) | small_side(small, l, 2, x, y);
    lanes depth = stamp_floats(sample->depth + place, pitch, two), here = small_value(small, l, 0, from_x, from_y, thin), none = { 0 };
    lanes_int seen = (side >= 0) & (here >= depth);
    /* Nearly half of all stamps (blocks of pixels drawn as a unit) change no pixel. The function returns early for them, except where
       lanes_choose() is a single instruction: there, finishing the stamp costs less than a branch misprediction */
    if (!LANES_CHOOSE_AT_ONCE && !lanes_any(seen))
        return;
    if (sample->marks) {
        lanes a = small_value(small, l, 1, from_x, from_y, thin), b = small_value(small, l, 2, from_x, from_y, thin);
        lanes_int marks;
        if (pen->mark != MARK_FIELD)
            marks = context_mark(a, b, pen->mark);
        else if (pen->ink->rich)
            marks = rich_mark(a, none + small->dx[1][l], none + small->dy[1][l], b, pen->ink);
        else
            marks = field_mark(a, b, pen->ink->last_row);
        stamp_put_ints(sample->marks + place, pitch, two, lanes_choose_int(seen, marks, stamp_ints(sample->marks + place, pitch, two)));
    }
    stamp_put_floats(sample->depth + place, pitch, two, lanes_choose(seen, here, depth));
    if (sample->ids)
        stamp_put_ints(sample->ids + place, pitch, two,
                       lanes_choose_int(seen, (lanes_int){ 0 } + (int32_t)soft_id(tile, face),
                                        stamp_ints(sample->ids + place, pitch, two)));
}

/* Draws a face stamp by stamp (blocks of pixels drawn as a unit). Stamps stay within the tile, because other threads draw outside. The last
   stamps of a row or column may therefore overlap earlier ones, which is harmless: drawing a pixel twice has no effect. */
SOFT_INLINE void draw_small(const struct small_pen *pen, const struct soft_face *face, int l, bool two)
{
    int width = two ? LANES / 2 : LANES, height = two ? 2 : 1;
    int last_left = pen->tile->rect.right + 1 - width, last_top = pen->tile->rect.bottom + 1 - height;
    for (int y = face->top; y <= face->bottom; y += height) {
        int top = y < last_top ? y : last_top;
        for (int x = face->left; x <= face->right; x += width) {
            int left = x < last_left ? x : last_left;
            if (pen->small->thin[l])
                draw_stamp(pen, face, l, left, top, two, true);
            else
                draw_stamp(pen, face, l, left, top, two, false);
        }
    }
}

struct kinds {          /* classes of faces by size; bit l of a mask: face l is in the class */
    uint32_t one, four; /* one: at most 4 x 2 pixels; four: larger, but at most 4 x 4 */
    /* two: larger faces that need fewer stamps (blocks of pixels drawn as a unit) of two rows (4 x 2) than of one row (8 x 1).
       low: faces one pixel high that are in none of the other classes */
    uint32_t two, low;
};

SOFT_INLINE struct kinds kinds_of(const struct soft_tile *tile, const struct eight_faces *eight, int count)
{
    if (tile->rect.bottom <= tile->rect.top)
        return (struct kinds){ 0, 0, 0, 0 };
    lanes_int two = ((eight->width >> 2) + 1) * ((eight->height >> 1) + 1), rows = ((eight->width >> 3) + 1) * (eight->height + 1);
    lanes_int narrow = eight->width < 4, fewer = two < rows;
    uint32_t all = (1u << count) - 1, one = lanes_bits(two == 1) & all, four = lanes_bits(narrow & (eight->height < 4)) & all & ~one;
    return (struct kinds){
        .one = one,
        .four = four,
        .two = lanes_bits(fewer) & all & ~(one | four),
        .low = lanes_bits(~fewer & (eight->height == 0)) & all & ~(one | four),
    };
}

#endif
