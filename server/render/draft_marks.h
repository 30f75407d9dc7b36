/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marks of pixels (render/draft_impl.h), eight at a time. Private to draft*.c. */
#ifndef RENDER_DRAFT_MARKS_H
#define RENDER_DRAFT_MARKS_H
#include "render/draft_impl.h"
#include "render/draft_simd.h"

struct ink {
    int32_t last_row; /* of the palette */
    float pattern_px;
};

DRAFT_INLINE lanes_int whole_within(lanes x, int32_t high)
{
    lanes_int whole = lanes_whole(x), highs = (lanes_int){ 0 } + high;
    whole = lanes_choose_int(whole > 0, whole, (lanes_int){ 0 });
    return lanes_choose_int(whole < highs, whole, highs);
}

DRAFT_INLINE lanes_int field_mark(lanes column, lanes row, int32_t last_row)
{
    return (whole_within(row, last_row) * PALETTE_COLUMNS + whole_within(column, PALETTE_PLACES + 1)) | (int32_t)MARK_FIELD;
}

DRAFT_INLINE lanes_int context_mark(lanes ambient, lanes sun, uint32_t mark)
{
    lanes_int a = lanes_whole(ambient + 0.5f), s = lanes_whole(sun + 0.5f);
    return a << 8 | s | (int32_t)mark;
}

/* Diagonal stripes, as hatch in shaders/field.glsl: -1 on the dark ones. */
DRAFT_INLINE lanes_int hatch(lanes x, float y, float pattern_px)
{
    lanes at = (x + y) * (1 / (pattern_px * 1.4142f));
    lanes phase = at - __builtin_convertvector(lanes_whole(at), lanes) - 0.5f;
    return (phase < -0.25f) | (phase > 0.25f);
}

/* Dots in rows, every second one moved by half, as stipple there. */
DRAFT_INLINE lanes_int stipple(lanes x, float y, float pattern_px)
{
    float row = y * (1 / pattern_px);
    float down = row - (float)(int)row - 0.5f, moved = (int)row % 2 ? 0.5f : 0;
    lanes cell = x * (1 / pattern_px) + moved;
    lanes across = cell - __builtin_convertvector(lanes_whole(cell), lanes) - 0.5f;
    return across * across + down * down < 0.26f * 0.26f;
}

/* Corners differ in their flags, or say that there is no data or that it is uncertain. */
DRAFT_INLINE lanes_int pattern_marks(lanes_int marks, lanes_int no_data, lanes_int uncertain, lanes row, lanes x, float y,
                                      const struct ink *ink)
{
    lanes_int r = whole_within(row, ink->last_row) * PALETTE_COLUMNS + (int32_t)MARK_FIELD + PALETTE_PATTERNS;
    lanes_int dark = hatch(x, y, ink->pattern_px), dots = stipple(x, y, ink->pattern_px);
    marks = lanes_choose_int(uncertain & dots, r + PATTERN_STIPPLE, marks);
    return lanes_choose_int(no_data, lanes_choose_int(dark, r + PATTERN_HATCH_DARK, r + PATTERN_HATCH_LIGHT), marks);
}

#endif
