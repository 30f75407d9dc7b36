/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From what vertices carry to the colours of pixels. */
#include <math.h>
#include <string.h>

#include "render/recolor_impl.h"

struct coloring {
    const struct recolor *recolor;
    const uint32_t *colormap;
    float pattern_px;
    bool log;
    struct frame *frame;
    size_t first_band;
};

static const float WEIGHT = 1 / 65535.0f;

static uint32_t mix(uint32_t a, uint32_t b, float part)
{
    uint32_t out = 0;
    for (int c = 0; c < 24; c += 8) {
        float from = (float)(a >> c & 0xff), to = (float)(b >> c & 0xff);
        out |= (uint32_t)(from + part * (to - from) + 0.5f) << c;
    }
    return out;
}

/* As hatch and stipple in shaders/field.glsl; over 0.5 on the dark parts. */
static float hatch(float x, float y, float pattern_px)
{
    float phase = (x + y) / (pattern_px * 1.4142f);
    return (fabsf(phase - floorf(phase) - 0.5f) - 0.25f) * pattern_px + 0.5f;
}

static float stipple(float x, float y, float pattern_px)
{
    float row = y / pattern_px, column = x / pattern_px + ((int)row % 2 ? 0.5f : 0);
    return (0.26f - hypotf(column - floorf(column) - 0.5f, row - floorf(row) - 0.5f)) * pattern_px + 0.5f;
}

static inline int column_at(const struct coloring *coloring, float carried)
{
    if (coloring->log)
        carried = column_of(lanes_log2((lanes){ 0 } + carried)[0], coloring->recolor->scale);
    return (int)clamped(carried, 0, COLORMAP_PLACES + 1);
}

/* Where a corner has flags. */
static uint32_t flagged_color(const struct coloring *coloring, const uint32_t vertices[3], uint32_t weights, uint8_t row, float x, float y)
{
    const struct recolor *recolor = coloring->recolor;
    const uint32_t *colors = coloring->colormap + row * COLORMAP_COLUMNS;
    float w1 = (float)(weights & 0xffff) * WEIGHT, w2 = (float)(weights >> 16) * WEIGHT, w[3] = { 1 - w1 - w2, w1, w2 };
    float carried = 0, none = 0, little = 0;
    for (int i = 0; i < 3; i++) {
        carried += w[i] * recolor->plain[vertices[i]];
        none += w[i] * draft_lacking(recolor->flags[vertices[i]]);
        little += w[i] * draft_uncertain(recolor->flags[vertices[i]]);
    }
    if (none > 0.5f)
        return mix(colors[COLORMAP_PATTERNS + PATTERN_HATCH_LIGHT], colors[COLORMAP_PATTERNS + PATTERN_HATCH_DARK],
                   clamped(hatch(x, y, coloring->pattern_px), 0, 1));
    uint32_t color = colors[column_at(coloring, carried)];
    if (little <= 0.5f)
        return color;
    return mix(color, colors[COLORMAP_PATTERNS + PATTERN_STIPPLE], clamped(stipple(x, y, coloring->pattern_px), 0, 1));
}

/* Four rows of four, the first three columns of them. */
DRAFT_INLINE void turn(const quad rows[4], quad columns[3])
{
    quad low = __builtin_shufflevector(rows[0], rows[1], 0, 4, 1, 5), high = __builtin_shufflevector(rows[2], rows[3], 0, 4, 1, 5);
    columns[0] = __builtin_shufflevector(low, high, 0, 1, 4, 5);
    columns[1] = __builtin_shufflevector(low, high, 2, 3, 6, 7);
    low = __builtin_shufflevector(rows[0], rows[1], 2, 6, 3, 7), high = __builtin_shufflevector(rows[2], rows[3], 2, 6, 3, 7);
    columns[2] = __builtin_shufflevector(low, high, 0, 1, 4, 5);
}

/* What these pixels of the field carry, as field_color has it. */
DRAFT_INLINE lanes carried_by(const struct recolor_band *band, lanes_int triangles, lanes_int weights)
{
    quad columns[2][3];
    for (int half = 0; half < 2; half++) {
        quad rows[4];
        for (int i = 0; i < 4; i++)
            rows[i] = *(const quad *)band->corners[triangles[4 * half + i]];
        turn(rows, columns[half]);
    }
    lanes of[3];
    for (int i = 0; i < 3; i++)
        of[i] = __builtin_shufflevector(columns[0][i], columns[1][i], 0, 1, 2, 3, 4, 5, 6, 7);
    lanes w1 = __builtin_convertvector(weights & 0xffff, lanes) * WEIGHT;
    lanes w2 = __builtin_convertvector((lanes_int)((lanes_uint)weights >> 16), lanes) * WEIGHT;
    return of[0] + w1 * of[1] + w2 * of[2];
}

/* As column_of. */
DRAFT_INLINE lanes columns_of_logs(lanes values, const float *scale)
{
    return (lanes_log2(values) - scale[0]) * scale[1] * COLUMNS_OF_RANGE + (1 + SLACK * COLUMNS_OF_RANGE);
}

/* Colours of eight places of the field. known: false where a corner has flags. */
DRAFT_INLINE lanes_int field_colors(const struct coloring *coloring, const struct recolor_band *band, lanes_int triangles,
                                    lanes_int weights, uint64_t rows, lanes_int *known)
{
    lanes_int colors;
    lanes carried = carried_by(band, triangles, weights);
    *known = carried == carried;
    carried = lanes_choose(*known, carried, (lanes){ 0 });
    if (coloring->log)
        carried = columns_of_logs(carried, coloring->recolor->scale);
    lanes_int columns = lanes_whole(lanes_clamp(carried, 0, COLORMAP_PLACES + 1));
    for (int i = 0; i < LANES; i++)
        colors[i] = (int32_t)coloring->colormap[(rows >> (8 * i) & 0xff) * COLORMAP_COLUMNS + (uint32_t)columns[i]];
    return colors;
}

/* --- pixels of several surfaces ---------------------------------------------------------------------------------------------- */

typedef uint64_t sums __attribute__((vector_size(32), aligned(8))); /* blue and red from bit 0 and 16 on, green from bit 32 on */

/* Parts are coloured ahead, eight at a time: pixels need them in the order in which they lie. */
enum { PARTS_AHEAD = 64 };
struct ahead {
    size_t first, end;
    bool all_known;                                /* no corner has flags */
    uint32_t known[PARTS_AHEAD];                   /* 0: one has */
    uint64_t colors[PARTS_AHEAD + RECOLOR_SHARES]; /* times share */
};

static inline uint64_t spread(uint32_t color)
{
    return (color & 0xff00ff) | (uint64_t)(color >> 8 & 0xff) << 32;
}

DRAFT_INLINE void color_parts(const struct coloring *coloring, const struct recolor_band *band, size_t first, struct ahead *ahead)
{
    size_t left = band->part_count - first, count = left < PARTS_AHEAD ? left : PARTS_AHEAD;
    lanes_int all_known = { -1, -1, -1, -1, -1, -1, -1, -1 };
    for (size_t p = 0; p < count; p += LANES) {
        uint32_t triangles[LANES], weights[LANES], shares[LANES], colors[LANES];
        uint8_t rows[LANES];
        uint64_t all_rows;
        lanes_int known, of[2];
        for (size_t i = 0; i < LANES; i++) {
            const struct recolor_part *part = &band->parts[p + i < count ? first + p + i : first];
            triangles[i] = part->triangle;
            weights[i] = part->weights;
            rows[i] = part->row;
            shares[i] = part->share;
        }
        memcpy(&all_rows, rows, sizeof(all_rows));
        memcpy(&of[0], triangles, sizeof(of[0]));
        memcpy(&of[1], weights, sizeof(of[1]));
        of[0] = field_colors(coloring, band, of[0], of[1], all_rows, &known);
        memcpy(colors, &of[0], sizeof(colors));
        memcpy(ahead->known + p, &known, sizeof(known));
        all_known &= known;
        for (size_t i = 0; i < LANES; i++)
            ahead->colors[p + i] = spread(colors[i]) * shares[i];
    }
    ahead->first = first;
    ahead->end = first + count;
    ahead->all_known = !lanes_any(~all_known);
}

static uint64_t flagged_sum(const struct coloring *coloring, const struct recolor_band *band, const struct recolor_mixed *mixed,
                            const struct ahead *ahead, float x, float y)
{
    uint64_t sum = 0;
    for (size_t i = mixed->first_part; i < (size_t)mixed->first_part + mixed->part_count; i++) {
        const struct recolor_part *part = &band->parts[i];
        if (ahead->known[i - ahead->first])
            sum += ahead->colors[i - ahead->first];
        else
            sum += spread(flagged_color(coloring, band->triangles[part->triangle], part->weights, part->row, x, y)) * part->share;
    }
    return sum;
}

/* After all others: over what was written there. */
DRAFT_INLINE void color_mixed(const struct coloring *coloring, const struct recolor_band *band, int top)
{
    static const sums wanted[] = { { 0 }, { -1ull }, { -1ull, -1ull }, { -1ull, -1ull, -1ull }, { -1ull, -1ull, -1ull, -1ull } };
    const uint64_t half = RECOLOR_SHARES / 2 * 0x100010001ull;
    struct ahead ahead = { 0 };
    for (size_t m = 0; m < band->mixed_count; m++) {
        const struct recolor_mixed *mixed = &band->mixed[m];
        if (mixed->first_part < ahead.first || mixed->first_part + mixed->part_count > ahead.end)
            color_parts(coloring, band, mixed->first_part, &ahead);
        sums four = *(const sums *)(ahead.colors + (mixed->first_part - ahead.first)) & wanted[mixed->part_count];
        uint64_t sum = (four[0] + four[1]) + (four[2] + four[3]);
        if (!ahead.all_known)
            sum = flagged_sum(coloring, band, mixed, &ahead, (float)mixed->x + 0.5f, (float)(top + mixed->row) + 0.5f);
        sum = (sum + half + mixed->blue_red + ((uint64_t)mixed->green << 32)) / RECOLOR_SHARES;
        uint32_t color = (uint32_t)(sum & 0xff00ff) | (uint32_t)(sum >> 24 & 0xff00);
        size_t row = (size_t)(top + mixed->row);
        uint8_t *line = coloring->frame->bgrx + row * (size_t)coloring->frame->stride_bytes;
        uint8_t ink = coloring->recolor->ink[row * (size_t)coloring->recolor->width_px + mixed->x];
        ((uint32_t *)(void *)line)[mixed->x] = (ink ? inked(color, ink) : color) | 0xff000000;
    }
}

/* --- pixels ------------------------------------------------------------------------------------------------------------------ */

/* A bit for each byte that is not 0, the lowest first. */
DRAFT_INLINE uint32_t bits_of_bytes(uint64_t x)
{
    uint64_t low = 0x7f7f7f7f7f7f7f7f, tops = ((x & low) + low) | x;
    return (uint32_t)((tops >> 7 & 0x0101010101010101) * 0x0102040810204080 >> 56);
}

/* Eight pixels in a row; of those of several surfaces, anything. */
DRAFT_INLINE lanes_int color_lanes(const struct coloring *coloring, const struct recolor_band *band, size_t at, int x, int y)
{
    const struct recolor *recolor = coloring->recolor;
    lanes_int surfaces = *(const lanes_int *)(recolor->surfaces + at), field = (surfaces >> 30) == 0, known;
    if (!lanes_any(field))
        return surfaces;
    uint64_t inks, rows;
    memcpy(&inks, recolor->ink + at, sizeof(inks));
    memcpy(&rows, recolor->rows + at, sizeof(rows));
    lanes_int colors = field_colors(coloring, band, surfaces & field, *(const lanes_int *)(recolor->weights + at), rows, &known);
    colors = lanes_choose_int(field, colors, surfaces);
    for (uint32_t left = lanes_bits(field) & (lanes_bits(~known) | bits_of_bytes(inks)); left; left &= left - 1) {
        size_t i = (size_t)__builtin_ctz(left), pixel = at + i;
        uint32_t color = (uint32_t)colors[i];
        if (!known[i])
            color = flagged_color(coloring, band->triangles[recolor->surfaces[pixel]], recolor->weights[pixel], recolor->rows[pixel],
                                  (float)(x + (int)i) + 0.5f, (float)y + 0.5f);
        colors[i] = (int32_t)(recolor->ink[pixel] ? inked(color, recolor->ink[pixel]) : color);
    }
    return colors;
}

/* Rows that are no multiple of eight end with pixels of which some were there before. */
DRAFT_KERNEL static void color_band(const struct coloring *coloring, int number)
{
    const struct recolor *recolor = coloring->recolor;
    const struct recolor_band *band = &recolor->bands[number];
    int top = number * recolor->band_rows, end = top + recolor->band_rows;
    end = end < recolor->height_px ? end : recolor->height_px;
    for (int y = top; y < end; y++) {
        size_t start = (size_t)y * (size_t)recolor->width_px;
        uint32_t *out = (uint32_t *)(void *)(coloring->frame->bgrx + (size_t)y * (size_t)coloring->frame->stride_bytes);
        for (int x = 0; x < recolor->width_px; x += LANES) {
            x = x + LANES <= recolor->width_px ? x : recolor->width_px - LANES;
            *(lanes_int *)(out + x) = color_lanes(coloring, band, start + (size_t)x, x, y) | (int32_t)0xff000000;
        }
    }
    color_mixed(coloring, band, top);
}

static void color_bands(void *arg, size_t begin, size_t end)
{
    const struct coloring *coloring = arg;
    for (size_t band = begin; band < end; band++)
        color_band(coloring, (int)(coloring->first_band + band));
}

void recolor_draw(const struct recolor *recolor, const uint32_t *colormap, float pattern_px, struct workers *workers, int first, int count,
                  struct frame *frame)
{
    struct coloring coloring = { recolor, colormap, pattern_px, is_log(recolor->scale), frame, (size_t)first };
    workers_for(workers, (size_t)count, 2, color_bands, &coloring);
}
