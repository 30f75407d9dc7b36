/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resolve: computes the colours of a visibility buffer's pixels from the newest field values. */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "render/soft/kernels.h"
#include "render/soft/resolve_pixels.h"
#include "render/soft/tones.h"
#include "render/soft/visibility_buffer_impl.h"

struct coloring {
    const struct visibility_buffer *buffer;
    const float *scale;
    struct resolve_paint paint;
    /* log: the colour scale is logarithmic; rich: the slower code path is needed, for isolines or a logarithmic scale */
    bool log, rich;
    struct frame *frame;
    /* lists of near sensors (pixel_lists.h) for the cells (squares of pixels) of the band of pixel rows that is being coloured */
    const struct band_lists *lists;
};

/* Returns the index of the cell (square of pixels) that contains a pixel, counted within the band (group of pixel rows). */
SOFT_INLINE int cell_at(const struct coloring *coloring, int x, int y)
{
    return x / CELL_PX + y % coloring->buffer->band_rows / CELL_PX * coloring->lists->columns;
}

static uint32_t mix(uint32_t a, uint32_t b, float part)
{
    uint32_t out = 0;
    for (int c = 0; c < 24; c += 8) {
        float from = (float)(a >> c & 0xff), to = (float)(b >> c & 0xff);
        out |= (uint32_t)(from + part * (to - from) + 0.5f) << c;
    }
    return out;
}

/* hatch(), stipple() and rule() return a pixel's coverage by dark stripes, by dots, and by horizontal lines, like the functions
   in shaders/field.glsl. The coverage exceeds 0.5 inside the pattern. */
static float hatch(float x, float y, float pattern_px)
{
    float phase = (x + y) / (pattern_px * (float)HATCH_SLANT);
    return (fabsf(phase - floorf(phase) - 0.5f) - (float)HATCH_EDGE) * pattern_px + 0.5f;
}

static float stipple(float x, float y, float pattern_px)
{
    float row = y / pattern_px, column = x / pattern_px + ((int)row % 2 ? 0.5f : 0);
    return ((float)STIPPLE_RADIUS - hypotf(column - floorf(column) - 0.5f, row - floorf(row) - 0.5f)) * pattern_px + 0.5f;
}

static float rule(float y, float pattern_px)
{
    float at = y / pattern_px;
    return (fabsf(at - floorf(at) - 0.5f) - (float)RULE_EDGE) * pattern_px + 0.5f;
}

/* --- isolines, as field_color() in shaders/field.glsl ---------------------------------------------------------------------------- */

static const float MIN_SLOPE = 1e-7f, MAX_LINE_COVERAGE = (float)ISOLINE_MOST;

/* Returns the change per pixel of the value's position on the colour scale (0..1). here: value at the pixel, as a colour map
   column or, on a logarithmic scale, as the field's value. by_x, by_y: change of that value per pixel. */
static float slope_of(const struct coloring *coloring, float by_x, float by_y, float here)
{
    float slope = hypotf(by_x, by_y);
    if (coloring->log)
        return here > 1e-30f ? slope * coloring->scale[1] * 1.44269504f / here : 0;
    return slope * (1 / COLUMNS_OF_RANGE);
}

/* Writes the change, per pixel in x and y, of the weights of a triangle's second and third corner. w1, w2: these weights at the
   point (x, y). */
static void weight_steps(const struct visibility_slopes *slopes, float w1, float w2, float x, float y, float steps[2][2])
{
    float over = 1 / (slopes->sum_x * x + slopes->sum_y * y + slopes->sum);
    steps[0][0] = (slopes->w1_x - w1 * slopes->sum_x) * over;
    steps[0][1] = (slopes->w1_y - w1 * slopes->sum_y) * over;
    steps[1][0] = (slopes->w2_x - w2 * slopes->sum_x) * over;
    steps[1][1] = (slopes->w2_y - w2 * slopes->sum_y) * over;
}

/* Returns a pixel's coverage by an isoline, 0..1. column: position on the scale as a column of the colour map, with fraction. slope: change
   of the position per pixel. */
static float line_part(const struct coloring *coloring, float column, float slope)
{
    float place = (column - (1 + SLACK * COLUMNS_OF_RANGE)) * (1 / COLUMNS_OF_RANGE);
    float nearest = coloring->paint.nearest[(int)clamped(column - 1, 0, COLORMAP_PLACES - 1)];
    return slope > MIN_SLOPE ? clamped(0.5f * coloring->paint.line_px + 0.5f - fabsf(place - nearest) / slope, 0, 1) : 0;
}

static uint32_t packed(double red, double green, double blue)
{
    return (uint32_t)(255 * red + 0.5) << 16 | (uint32_t)(255 * green + 0.5) << 8 | (uint32_t)(255 * blue + 0.5);
}

static uint32_t lined(uint32_t color, float part)
{
    float blue = (float)(color & 0xff), green = (float)(color >> 8 & 0xff), red = (float)(color >> 16 & 0xff);
    bool bright = (float)GREY_RED * red + (float)GREY_GREEN * green + (float)GREY_BLUE * blue > (float)ISOLINE_BRIGHT * 255;
    uint32_t line = bright ? packed(ISOLINE_DARK_RGB) : packed(ISOLINE_LIGHT, ISOLINE_LIGHT, ISOLINE_LIGHT);
    return mix(color, line, MAX_LINE_COVERAGE * part);
}

static inline float column_of_carried(const struct coloring *coloring, float carried)
{
    return coloring->log ? column_of(lanes_log2((lanes){ 0 } + carried)[0], coloring->scale) : carried;
}

struct shown_place { /* the field at one pixel */
    float carried, slope;
    bool no_data, uncertain, no_limits;
    uint8_t row;
    float x, y;
};

static uint32_t color_of_place(const struct coloring *coloring, const struct shown_place *place)
{
    const uint32_t *colors = coloring->paint.colormap + place->row * COLORMAP_COLUMNS;
    float x = place->x, y = place->y;
    if (place->no_data)
        return mix(colors[COLORMAP_PATTERNS + PATTERN_HATCH_LIGHT], colors[COLORMAP_PATTERNS + PATTERN_HATCH_DARK],
                   clamped(hatch(x, y, coloring->paint.pattern_px), 0, 1));
    if (coloring->rich && place->no_limits)
        return mix(colors[COLORMAP_PATTERNS + PATTERN_PLAIN_LIGHT], colors[COLORMAP_PATTERNS + PATTERN_PLAIN_DARK],
                   clamped(rule(y, coloring->paint.pattern_px), 0, 1));
    float column = column_of_carried(coloring, place->carried);
    uint32_t color = colors[(int)clamped(column, 0, COLORMAP_PLACES + 1)];
    if (place->uncertain)
        color = mix(color, colors[COLORMAP_PATTERNS + PATTERN_STIPPLE], clamped(stipple(x, y, coloring->paint.pattern_px), 0, 1));
    return coloring->paint.line_px > 0 ? lined(color, line_part(coloring, column, place->slope)) : color;
}

/* Interpolates the field at a point of a triangle from its corners. w: weights of the corners. steps: change of the weights per pixel, read
   only if there are isolines. */
static void interpolate_place(const struct coloring *coloring, const uint32_t vertices[3], const float w[3], float steps[2][2],
                              struct shown_place *out)
{
    const float *plain = coloring->buffer->plain;
    float none = 0, little = 0, free = 0, d1 = plain[vertices[1]] - plain[vertices[0]], d2 = plain[vertices[2]] - plain[vertices[0]];
    for (int i = 0; i < 3; i++) {
        uint32_t flags = coloring->buffer->flags[vertices[i]];
        out->carried += w[i] * plain[vertices[i]];
        none += w[i] * soft_lacking(flags);
        little += w[i] * soft_uncertain(flags);
        free += w[i] * soft_no_limits(flags);
    }
    out->no_data = none > 0.5f;
    out->uncertain = little > 0.5f;
    out->no_limits = free > 0.5f;
    out->slope = slope_of(coloring, d1 * steps[0][0] + d2 * steps[1][0], d1 * steps[0][1] + d2 * steps[1][1], out->carried);
}

/* Evaluates the field at one pixel from its sensors. Element 0 of the vectors is for the pixel itself. Elements 1 and 2 are for
   points one pixel farther in x and y, which give the slope. */
static void evaluate_place(const struct coloring *coloring, const struct visibility_band *band, uint32_t triangle, const float w[3],
                           float steps[2][2], int cell, struct shown_place *out)
{
    struct eight_places places;
    struct eight_values values;
    const lanes w1 = { w[1], w[1] + steps[0][0], w[1] + steps[0][1] }, w2 = { w[2], w[2] + steps[1][0], w[2] + steps[1][1] };
    places_of(band, (lanes_int){ 0 } + (int32_t)triangle, w1, w2, &places);
    places.meshes |= ~(lanes_int){ -1, -1, -1 };
    evaluate_places(coloring->buffer, coloring->lists, &places, places.at, (lanes_int){ 0 } + cell, &values);
    lanes carried = carried_of_values(coloring->scale, values.value);
    out->carried = carried[0];
    out->no_data = values.no_data[0];
    out->uncertain = values.uncertain[0];
    out->no_limits = values.no_limits[0];
    out->slope = slope_of(coloring, carried[1] - carried[0], carried[2] - carried[0], carried[0]);
}

/* Returns the colour of one pixel, by the slower code path. Needed if a corner of its triangle has flags (flags.h) or an
   isoline may cross the pixel. */
static uint32_t flagged_color(const struct coloring *coloring, const struct visibility_band *band, uint32_t triangle, uint32_t weights,
                              uint8_t row, float x, float y)
{
    float w1 = (float)(weights & 0xffff) * WEIGHT, w2 = (float)(weights >> 16) * WEIGHT, w[3] = { 1 - w1 - w2, w1, w2 };
    float steps[2][2] = { { 0 } };
    struct shown_place place = { .row = row, .x = x, .y = y };
    if (coloring->paint.line_px > 0)
        weight_steps(&band->slopes[triangle], w1, w2, x, y, steps);
    if (band->corners[triangle][3] > 0)
        evaluate_place(coloring, band, triangle, w, steps, cell_at(coloring, (int)x, (int)y), &place);
    else
        interpolate_place(coloring, band->triangles[triangle], w, steps, &place);
    return color_of_place(coloring, &place);
}

/* Transposes a 4 x 4 matrix given as rows, and writes its first three columns. */
SOFT_INLINE void transpose(const quad rows[4], quad columns[3])
{
    quad low = __builtin_shufflevector(rows[0], rows[1], 0, 4, 1, 5), high = __builtin_shufflevector(rows[2], rows[3], 0, 4, 1, 5);
    columns[0] = __builtin_shufflevector(low, high, 0, 1, 4, 5);
    columns[1] = __builtin_shufflevector(low, high, 2, 3, 6, 7);
    low = __builtin_shufflevector(rows[0], rows[1], 2, 6, 3, 7), high = __builtin_shufflevector(rows[2], rows[3], 2, 6, 3, 7);
    columns[2] = __builtin_shufflevector(low, high, 0, 1, 4, 5);
}

/* Eight pixels that show the field: the weights of their triangles' corners, and their interpolated values. Values are columns
   of the colour map or, on a logarithmic scale, field values. */
struct eight_shown {
    lanes w1, w2, carried;
    /* mask of pixels: -1: field_colors() may colour the pixel; 0: flagged_color() must, because the pixel or a corner of its
       triangle has a flag */
    lanes_int known;
    struct eight_places places; /* surface points of the eight pixels; fields evaluated from sensors are evaluated there */
};

/* Computes the field values of eight pixels: colour map columns or, on a logarithmic scale, field values. Works like
   field_color() in shaders/field.glsl. wanted: mask of pixels; others receive arbitrary values. cells: index, in the band of
   pixel rows, of the square of pixels that contains each pixel. */
SOFT_INLINE void carry(const struct coloring *coloring, const struct visibility_band *band, lanes_int triangles, lanes_int weights,
                       lanes_int wanted, lanes_int cells, struct eight_shown *out)
{
    quad columns[2][3];
    for (int half = 0; half < 2; half++) {
        quad rows[4];
        for (int i = 0; i < 4; i++)
            rows[i] = *(const quad *)band->corners[triangles[4 * half + i]];
        transpose(rows, columns[half]);
    }
    lanes of[3];
    for (int i = 0; i < 3; i++)
        of[i] = __builtin_shufflevector(columns[0][i], columns[1][i], 0, 1, 2, 3, 4, 5, 6, 7);
    out->w1 = __builtin_convertvector(weights & 0xffff, lanes) * WEIGHT;
    out->w2 = __builtin_convertvector((lanes_int)((lanes_uint)weights >> 16), lanes) * WEIGHT;
    out->carried = of[0] + out->w1 * of[1] + out->w2 * of[2];
    out->known = out->carried == out->carried;
    if (!coloring->buffer->evaluates)
        return;
    places_of(band, triangles, out->w1, out->w2, &out->places);
    out->places.meshes |= ~wanted;
    lanes_int evaluated = out->places.meshes >= 0;
    struct eight_values values;
    if (!lanes_any(evaluated))
        return;
    evaluate_places(coloring->buffer, coloring->lists, &out->places, out->places.at, cells, &values);
    out->carried = lanes_choose(evaluated, carried_of_values(coloring->scale, values.value), out->carried);
    out->known &= ~(values.no_data | values.uncertain | values.no_limits);
}

/* Converts eight values on a logarithmic colour scale to colour map columns. */
SOFT_INLINE lanes columns_of_logs(lanes values, const float *scale)
{
    return (lanes_log2(values) - scale[0]) * scale[1] * COLUMNS_OF_RANGE + (1 + SLACK * COLUMNS_OF_RANGE);
}

/* Returns a mask of eight pixels: set where an isoline may touch the pixel, judging by the field's change per pixel. */
SOFT_INLINE lanes_int may_be_lined(const struct coloring *coloring, const struct visibility_band *band, lanes_int triangles,
                                   const struct eight_shown *shown, lanes_int cells, int x, int y)
{
    float by[7][LANES], d1[LANES], d2[LANES];
    lanes carried = shown->carried, none = { 0 };
    for (int i = 0; i < LANES; i++) {
        const struct visibility_slopes *slopes = &band->slopes[triangles[i]];
        const float all[7] = { slopes->w1_x, slopes->w1_y, slopes->w2_x, slopes->w2_y, slopes->sum_x, slopes->sum_y, slopes->sum };
        for (int k = 0; k < 7; k++)
            by[k][i] = all[k];
        d1[i] = band->corners[triangles[i]][1];
        d2[i] = band->corners[triangles[i]][2];
    }
#define BY(k) (*(const lanes *)by[k])
    lanes over = 1.0f / (BY(4) * (LANES_IOTA + ((float)x + 0.5f)) + BY(5) * ((float)y + 0.5f) + BY(6));
    lanes w1_x = BY(0) - shown->w1 * BY(4), w1_y = BY(1) - shown->w1 * BY(5);
    lanes w2_x = BY(2) - shown->w2 * BY(4), w2_y = BY(3) - shown->w2 * BY(5);
#undef BY
    lanes by_x = (*(const lanes *)d1 * w1_x + *(const lanes *)d2 * w2_x) * over;
    lanes by_y = (*(const lanes *)d1 * w1_y + *(const lanes *)d2 * w2_y) * over;
    if (coloring->buffer->evaluates && lanes_any(shown->places.meshes >= 0)) {
        lanes_int evaluated = shown->places.meshes >= 0;
        const struct band_lists *lists = coloring->lists;
        const struct eight_places *places = &shown->places;
        lanes here_x = carried_change(coloring->buffer, lists, places, w1_x * over, w2_x * over, cells, carried);
        lanes here_y = carried_change(coloring->buffer, lists, places, w1_y * over, w2_y * over, cells, carried);
        by_x = lanes_choose(evaluated, here_x, by_x);
        by_y = lanes_choose(evaluated, here_y, by_y);
    }
    lanes slope = lanes_root(by_x * by_x + by_y * by_y), column = carried;
    if (coloring->log) {
        lanes_int counts = carried > 1e-30f;
        slope *= coloring->scale[1] * 1.44269504f;
        slope = lanes_choose(counts, slope / lanes_choose(counts, carried, none + 1.0f), none);
        column = columns_of_logs(carried, coloring->scale);
    } else {
        slope *= 1 / COLUMNS_OF_RANGE;
    }
    lanes place = (column - (1 + SLACK * COLUMNS_OF_RANGE)) * (1 / COLUMNS_OF_RANGE), nearest;
    lanes_int at = lanes_whole(lanes_clamp(lanes_choose(column == column, column, none) - 1.0f, 0, COLORMAP_PLACES - 1));
    nearest = lanes_look_up(coloring->paint.nearest, at);
    lanes away = lanes_most(place - nearest, nearest - place);
    return ~(away > slope * (0.5f * coloring->paint.line_px + 0.51f));
}

/* Returns the colours of eight pixels of the field; arbitrary where shown->known is 0. */
SOFT_INLINE lanes_int field_colors(const struct coloring *coloring, const struct eight_shown *shown, uint64_t rows)
{
    lanes_int colors;
    lanes carried = lanes_choose(shown->known, shown->carried, (lanes){ 0 });
    if (coloring->log)
        carried = columns_of_logs(carried, coloring->scale);
    lanes_int columns = lanes_whole(lanes_clamp(carried, 0, COLORMAP_PLACES + 1));
    for (int i = 0; i < LANES; i++)
        colors[i] = (int32_t)coloring->paint.colormap[(rows >> (8 * i) & 0xff) * COLORMAP_COLUMNS + (uint32_t)columns[i]];
    return colors;
}

/* --- pixels that show several surfaces ----------------------------------------------------------------------------------- */

/* 64-bit colour sums: blue from bit 0, red from bit 16, green from bit 32 */
typedef uint64_t sums __attribute__((vector_size(32), aligned(8)));

/* Colours of the next surfaces in pixels that show several surfaces. They are computed eight at a time before color_mixed()
   uses them, in the same order. */
enum { PARTS_AHEAD = 64 };
struct ahead {
    size_t first, end;
    /* true: none of the triangles of the surfaces first..end-1, whose colours are stored, has a flag at a corner, and the frame
       has no isolines */
    bool all_known;
    uint32_t known[PARTS_AHEAD];                          /* 0: a corner has flags */
    uint64_t colors[PARTS_AHEAD + VISIBILITY_MOST_PARTS]; /* colour times share */
};

static inline uint64_t spread(uint32_t color)
{
    return (color & 0xff00ff) | (uint64_t)(color >> 8 & 0xff) << 32;
}

/* Computes the colours of the next surfaces, up to PARTS_AHEAD, of pixels that show several surfaces, and stores them in
   *ahead. pixel: index in band->mixed of the first of these pixels. */
SOFT_INLINE void color_parts(const struct coloring *coloring, const struct visibility_band *band, size_t pixel, struct ahead *ahead)
{
    size_t first = band->mixed[pixel].first_part, left = band->part_count - first, count = left < PARTS_AHEAD ? left : PARTS_AHEAD;
    lanes_int all_known = { -1, -1, -1, -1, -1, -1, -1, -1 };
    for (size_t p = 0; p < count; p += LANES) {
        uint32_t triangles[LANES], weights[LANES], shares[LANES], colors[LANES];
        uint8_t rows[LANES];
        uint64_t all_rows;
        struct eight_shown shown;
        lanes_int of[2], cells, wanted;
        for (size_t i = 0; i < LANES; i++) {
            const struct visibility_part *part = &band->parts[p + i < count ? first + p + i : first];
            while (p + i < count && first + p + i >= (size_t)band->mixed[pixel].first_part + band->mixed[pixel].part_count)
                pixel++;
            cells[i] = cell_at(coloring, band->mixed[pixel].x, band->mixed[pixel].row);
            wanted[i] = p + i < count ? -1 : 0;
            triangles[i] = part->triangle;
            weights[i] = part->weights;
            rows[i] = part->row;
            shares[i] = part->share;
        }
        memcpy(&all_rows, rows, sizeof(all_rows));
        memcpy(&of[0], triangles, sizeof(of[0]));
        memcpy(&of[1], weights, sizeof(of[1]));
        carry(coloring, band, of[0], of[1], wanted, cells, &shown);
        of[0] = field_colors(coloring, &shown, all_rows);
        memcpy(colors, &of[0], sizeof(colors));
        memcpy(ahead->known + p, &shown.known, sizeof(shown.known));
        all_known &= shown.known;
        if (coloring->buffer->gloss) {
            struct visibility_gloss gloss[LANES];
            for (size_t i = 0; i < LANES; i++)
                gloss[i] = band->gloss[p + i < count ? first + p + i : first];
            of[0] = glossy_colors(coloring->buffer->tones, of[0], gloss);
            memcpy(colors, &of[0], sizeof(colors));
        }
        for (size_t i = 0; i < LANES; i++)
            ahead->colors[p + i] = spread(colors[i]) * shares[i];
    }
    ahead->first = first;
    ahead->end = first + count;
    ahead->all_known = !lanes_any(~all_known) && !(coloring->paint.line_px > 0);
}

/* Converts a field's colour to the colour of a glossy surface, using the light `gloss` that falls on the pixel. gloss NULL:
   returns the colour unchanged. */
SOFT_INLINE uint32_t glossed(const struct coloring *coloring, uint32_t color, const struct visibility_gloss *gloss)
{
    struct visibility_gloss all_of[LANES];
    for (int i = 0; i < LANES && gloss; i++)
        all_of[i] = *gloss;
    return gloss ? (uint32_t)glossy_colors(coloring->buffer->tones, (lanes_int){ 0 } + (int32_t)color, all_of)[0] : color;
}

static uint64_t flagged_sum(const struct coloring *coloring, const struct visibility_band *band, const struct visibility_mixed *mixed,
                            const struct ahead *ahead, float x, float y)
{
    uint64_t sum = 0;
    for (size_t i = mixed->first_part; i < (size_t)mixed->first_part + mixed->part_count; i++) {
        const struct visibility_part *part = &band->parts[i];
        if (ahead->known[i - ahead->first] && !(coloring->paint.line_px > 0))
            sum += ahead->colors[i - ahead->first];
        else
            sum += spread(glossed(coloring, flagged_color(coloring, band, part->triangle, part->weights, part->row, x, y),
                                  band->gloss ? &band->gloss[i] : NULL)) *
                   part->share;
    }
    return sum;
}

/* Colours the pixels that show several surfaces, and overwrites the arbitrary colours that color_lanes() gave these pixels. */
SOFT_INLINE void color_mixed(const struct coloring *coloring, const struct visibility_band *band, int top)
{
    static const sums wanted[] = { { 0 }, { -1ull }, { -1ull, -1ull }, { -1ull, -1ull, -1ull }, { -1ull, -1ull, -1ull, -1ull } };
    const uint64_t half = VISIBILITY_SHARES / 2 * 0x100010001ull;
    struct ahead ahead = { 0 };
    for (size_t m = 0; m < band->mixed_count; m++) {
        const struct visibility_mixed *mixed = &band->mixed[m];
        if (mixed->first_part < ahead.first || mixed->first_part + mixed->part_count > ahead.end)
            color_parts(coloring, band, m, &ahead);
        sums four = *(const sums *)(ahead.colors + (mixed->first_part - ahead.first)) & wanted[mixed->part_count];
        uint64_t sum = (four[0] + four[1]) + (four[2] + four[3]);
        if (!ahead.all_known)
            sum = flagged_sum(coloring, band, mixed, &ahead, (float)mixed->x + 0.5f, (float)(top + mixed->row) + 0.5f);
        sum = (sum + half + mixed->blue_red + ((uint64_t)mixed->green << 32)) / VISIBILITY_SHARES;
        uint32_t color = (uint32_t)(sum & 0xff00ff) | (uint32_t)(sum >> 24 & 0xff00);
        size_t row = (size_t)(top + mixed->row), pixel = row * (size_t)coloring->buffer->width_px + mixed->x;
        uint8_t *line = coloring->frame->bgrx + row * (size_t)coloring->frame->stride_bytes;
        bool ink = has_ink(coloring->buffer, pixel);
        ((uint32_t *)(void *)line)[mixed->x] = (ink ? inked(coloring->buffer, pixel, color) : color) | 0xff000000;
    }
}

/* --- pixels ------------------------------------------------------------------------------------------------------------------ */

/* Returns a bit mask of the nonzero bytes of x; the lowest byte gives bit 0. */
SOFT_INLINE uint32_t bits_of_bytes(uint64_t x)
{
    uint64_t low = 0x7f7f7f7f7f7f7f7f, tops = ((x & low) + low) | x;
    return (uint32_t)((tops >> 7 & 0x0101010101010101) * 0x0102040810204080 >> 56);
}

/* Returns the colours of eight pixels in a row. Pixels that show several surfaces get arbitrary colours, which the caller overwrites. */
SOFT_INLINE lanes_int color_lanes(const struct coloring *coloring, const struct visibility_band *band, size_t at, int x, int y)
{
    const struct visibility_buffer *buffer = coloring->buffer;
    lanes_int surfaces = *(const lanes_int *)(buffer->surfaces + at), field = (surfaces >> 30) == 0;
    struct eight_shown shown;
    if (!lanes_any(field))
        return surfaces;
    uint64_t inks, rows;
    memcpy(&inks, buffer->ink + at, sizeof(inks));
    if (buffer->veil) {
        uint64_t veils;
        memcpy(&veils, buffer->veil + at, sizeof(veils));
        inks |= veils;
    }
    memcpy(&rows, buffer->rows + at, sizeof(rows));
    lanes_int cells = ((LANES_IOTA_INT + x) >> CELL_SHIFT) + cell_at(coloring, 0, y);
    carry(coloring, band, surfaces & field, *(const lanes_int *)(buffer->weights + at), field, cells, &shown);
    lanes_int colors = field_colors(coloring, &shown, rows);
    if (coloring->paint.line_px > 0)
        shown.known &= ~may_be_lined(coloring, band, surfaces & field, &shown, cells, x, y);
    for (uint32_t left = lanes_bits(field & ~shown.known); left; left &= left - 1) {
        size_t i = (size_t)__builtin_ctz(left), pixel = at + i;
        colors[i] = (int32_t)flagged_color(coloring, band, buffer->surfaces[pixel], buffer->weights[pixel], buffer->rows[pixel],
                                           (float)(x + (int)i) + 0.5f, (float)y + 0.5f);
    }
    if (buffer->gloss)
        colors = glossy_colors(buffer->tones, colors, buffer->gloss + at);
    colors = lanes_choose_int(field, colors, surfaces);
    for (uint32_t left = lanes_bits(field) & bits_of_bytes(inks); left; left &= left - 1) {
        size_t i = (size_t)__builtin_ctz(left);
        colors[i] = (int32_t)inked(buffer, at + i, (uint32_t)colors[i]);
    }
    return colors;
}

/* Colours one band (group of pixel rows), eight pixels at a time. If the frame's width is not a multiple of eight, the last
   eight pixels of a row overlap the eight before. */
static void color_band(const struct coloring *coloring, int number)
{
    const struct visibility_buffer *buffer = coloring->buffer;
    const struct visibility_band *band = &buffer->bands[number];
    int top = number * buffer->band_rows, end = top + buffer->band_rows;
    end = end < buffer->height_px ? end : buffer->height_px;
    for (int y = top; y < end; y++) {
        size_t start = (size_t)y * (size_t)buffer->width_px;
        uint32_t *out = (uint32_t *)(void *)(coloring->frame->bgrx + (size_t)y * (size_t)coloring->frame->stride_bytes);
        for (int x = 0; x < buffer->width_px; x += LANES) {
            x = x + LANES <= buffer->width_px ? x : buffer->width_px - LANES;
            *(lanes_int *)(out + x) = color_lanes(coloring, band, start + (size_t)x, x, y) | (int32_t)0xff000000;
        }
    }
    color_mixed(coloring, band, top);
}

static void make_lists(const struct visibility_buffer *buffer, const struct visibility_band *band, struct band_lists *out)
{
    const float step = pixel_lists_step(buffer->scale);
    const size_t rows = (size_t)(buffer->band_rows + CELL_PX - 1) / CELL_PX;
    struct pixel_lists *lists = &out->lists;
    for (size_t i = 0, end; i < band->cell_count; i = end) {
        const struct pixel_cell *first = &band->cells[i];
        for (end = i + 1; end < band->cell_count && band->cells[end].mesh == first->mesh; end++)
            if (band->cells[end].column / SQUARE_CELLS != first->column / SQUARE_CELLS)
                break;
        pixel_lists_add(lists, &buffer->meshes[first->mesh].pixels, step, first, end - i);
    }
    pixel_lists_settle(lists);
    if (lists->count > 0)
        out->of_cells = mem_array(rows * (size_t)out->columns, sizeof(*out->of_cells));
    for (size_t i = 0; i < lists->count; i++) {
        struct pixel_list *list = &lists->lists[i];
        uint32_t *of_cell = &out->of_cells[list->row * (uint32_t)out->columns + list->column];
        list->next = *of_cell;
        *of_cell = (uint32_t)i + 1;
    }
}

void resolve_color_bands(void *arg, size_t begin, size_t end)
{
    const struct resolve_job *job = arg;
    const struct visibility_buffer *buffer = job->buffer;
    const bool log = is_log(buffer->scale);
    for (size_t i = begin; i < end; i++) {
        const size_t number = job->first + i;
        struct band_lists lists = { .columns = (buffer->width_px + CELL_PX - 1) / CELL_PX };
        struct coloring coloring = { buffer, buffer->scale, job->paint, log, log || job->paint.line_px > 0, job->frame, &lists };
        if (buffer->evaluates)
            make_lists(buffer, &buffer->bands[number], &lists);
        color_band(&coloring, (int)number);
        pixel_lists_finish(&lists.lists);
        mem_free(lists.of_cells);
    }
}
