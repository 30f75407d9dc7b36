/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes marks (32-bit contents of pixels, described in render/soft/soft_impl.h) of eight pixels at a time. Private to soft/. */
#ifndef RENDER_SOFT_PIXEL_MARKS_H
#define RENDER_SOFT_PIXEL_MARKS_H
#include "render/soft/soft_impl.h"
#include "render/soft/lanes.h"

struct mark_ink {
    int32_t last_row; /* index of the last row of the colour map; rows are brightness steps */
    float pattern_px;
    /* true: the pixels' colour codes (marks) need the slower code path, because there are isolines or the scale is logarithmic */
    bool rich;
    bool log;
    float low, over;    /* on a logarithmic scale, the position of a value, 0..1, is (log2(value) - low) * over */
    float line_px;      /* width of isolines in pixels; 0: there are no isolines */
    const float *lines; /* table by position on the scale: nearest position that has an isoline; owned by struct raster */
};

SOFT_INLINE struct mark_ink ink_of(const struct raster *raster)
{
    const struct frame_uniforms *block = &raster->block;
    return (struct mark_ink){
        .last_row = (int32_t)block->shade[2],
        .pattern_px = block->scale[3],
        .rich = block->lines[0] > 0 || block->scale[2] > 0.5f,
        .log = block->scale[2] > 0.5f,
        .low = block->scale[0],
        .over = block->scale[1],
        .line_px = block->lines[0],
        .lines = raster->lines,
    };
}

SOFT_INLINE lanes_int whole_within(lanes x, int32_t high)
{
    lanes_int whole = lanes_whole(x), highs = (lanes_int){ 0 } + high;
    whole = lanes_choose_int(whole > 0, whole, (lanes_int){ 0 });
    return lanes_choose_int(whole < highs, whole, highs);
}

SOFT_INLINE lanes_int field_mark(lanes column, lanes row, int32_t last_row)
{
    return (whole_within(row, last_row) * COLORMAP_COLUMNS + whole_within(column, COLORMAP_PLACES + 1)) | (int32_t)MARK_FIELD;
}

SOFT_INLINE lanes_int context_mark(lanes ambient, lanes sun, uint32_t mark)
{
    lanes_int a = lanes_whole(ambient + 0.5f), s = lanes_whole(sun + 0.5f);
    return a << 8 | s | (int32_t)mark;
}

/* Diagonal stripes: pattern for no data, like hatch() in shaders/field.glsl. Returns -1 in dark stripes, else 0. */
SOFT_INLINE lanes_int hatch(lanes x, float y, float pattern_px)
{
    lanes at = (x + y) * (1 / (pattern_px * (float)HATCH_SLANT));
    lanes phase = at - __builtin_convertvector(lanes_whole(at), lanes) - 0.5f;
    return (phase < (float)-HATCH_EDGE) | (phase > (float)HATCH_EDGE);
}

/* Dots in rows, every other row shifted by half a cell: pattern for uncertain values, like stipple() in shaders/field.glsl.
   Returns -1 in dots, else 0. */
SOFT_INLINE lanes_int stipple(lanes x, float y, float pattern_px)
{
    float row = y * (1 / pattern_px);
    float down = row - (float)(int)row - 0.5f, moved = (int)row % 2 ? 0.5f : 0;
    lanes cell = x * (1 / pattern_px) + moved;
    lanes across = cell - __builtin_convertvector(lanes_whole(cell), lanes) - 0.5f;
    return across * across + down * down < (float)STIPPLE_RADIUS * (float)STIPPLE_RADIUS;
}

/* Computes the marks (colour codes, soft_impl.h) of eight pixels of a field with isolines or a logarithmic scale, without
   patterns, like field_color() in shaders/field.glsl. value_x, value_y: change of the value per pixel. */
SOFT_INLINE lanes_int rich_mark(lanes value, lanes value_x, lanes value_y, lanes row, const struct mark_ink *ink)
{
    const float slack = 1e-5f, columns = COLORMAP_PLACES / (1 + 2 * slack), first = 1 + slack * columns, farthest = 1e6f;
    lanes none = { 0 }, slope = lanes_root(value_x * value_x + value_y * value_y), place;
    if (ink->log) {
        lanes_int counts = value > 1e-30f;
        place = (lanes_log2(value) - ink->low) * ink->over;
        slope = lanes_choose(counts, slope * (ink->over * 1.44269504f) / lanes_choose(counts, value, none + 1.0f), none);
        value = lanes_clamp(place * columns + first, -farthest, farthest);
    } else {
        place = (value - first) * (1 / columns);
        slope *= 1 / columns;
    }
    lanes_int marks = field_mark(value, row, ink->last_row);
    if (!(ink->line_px > 0))
        return marks;
    lanes_int at = whole_within(lanes_clamp(value - 1.0f, 0, COLORMAP_PLACES - 1), COLORMAP_PLACES - 1), steep = slope > 1e-7f;
    lanes away;
    for (int l = 0; l < LANES; l++)
        away[l] = __builtin_fabsf(place[l] - ink->lines[at[l]]);
    lanes part = 0.5f * ink->line_px + 0.5f - away / lanes_choose(steep, slope, none + 1.0f);
    part = lanes_choose(steep, lanes_clamp(part, 0, 1), none);
    return marks | lanes_whole(part * MARK_LINE_WHOLE + 0.5f) << MARK_LINE;
}

/* Horizontal lines, widely spaced: pattern of tags without alarm limits, like rule() in shaders/field.glsl. Returns whether the
   row y is on a line. */
SOFT_INLINE bool rule(float y, float pattern_px)
{
    float at = y * (1 / pattern_px), phase = at - (float)(int)at - 0.5f;
    return phase < (float)-RULE_EDGE || phase > (float)RULE_EDGE;
}

struct eight_patterns { /* masks: those of eight pixels that show each pattern */
    lanes_int no_data, uncertain, no_limits;
};

/* Replaces the marks (colour codes) of those among eight pixels that show a pattern. Called for faces whose corners have
   different flags, or a flag that shows a pattern. */
SOFT_INLINE lanes_int pattern_marks(lanes_int marks, const struct eight_patterns *patterns, lanes row, lanes x, float y,
                                    const struct mark_ink *ink)
{
    lanes_int r = whole_within(row, ink->last_row) * COLORMAP_COLUMNS + (int32_t)MARK_FIELD + COLORMAP_PATTERNS;
    lanes_int dark = hatch(x, y, ink->pattern_px), dots = stipple(x, y, ink->pattern_px);
    lanes_int lines = marks & MARK_LINE_WHOLE << MARK_LINE;
    marks = lanes_choose_int(patterns->uncertain & dots, (r + PATTERN_STIPPLE) | lines, marks);
    marks = lanes_choose_int(patterns->no_limits, r + (rule(y, ink->pattern_px) ? PATTERN_PLAIN_DARK : PATTERN_PLAIN_LIGHT), marks);
    return lanes_choose_int(patterns->no_data, lanes_choose_int(dark, r + PATTERN_HATCH_DARK, r + PATTERN_HATCH_LIGHT), marks);
}

#endif
