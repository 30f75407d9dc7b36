/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From triangles and light to colours. */
#include "render/recolor.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "render/draft/draft_impl.h"
#include "render/draft/draft_simd.h"

enum { VERTICES_AT_ONCE = 8192 };
typedef uint8_t octets __attribute__((vector_size(4)));
static const quad RIM_DARK_BGR = { 41, 23, 13 }, INK_BGR = { 0.14f * 255, 0.10f * 255, 0.08f * 255 };
static const float MOST_INK = 0.5f; /* as shaders/edges.frag */

struct recolor *recolor_create(int width_px, int height_px, int band_rows)
{
    struct recolor *recolor = mem_new(sizeof(*recolor));
    size_t pixels = (size_t)width_px * (size_t)height_px;
    *recolor = (struct recolor){ .width_px = width_px, .height_px = height_px, .band_rows = band_rows };
    recolor->band_count = (height_px + band_rows - 1) / band_rows;
    recolor->surfaces = mem_try_array(pixels, sizeof(*recolor->surfaces));
    recolor->weights = mem_try_array(pixels, sizeof(*recolor->weights));
    recolor->rows = mem_try_array(pixels, sizeof(*recolor->rows));
    recolor->ink = mem_try_array(pixels, sizeof(*recolor->ink));
    recolor->bands = mem_array((size_t)recolor->band_count, sizeof(*recolor->bands));
    if (!recolor->surfaces || !recolor->weights || !recolor->rows || !recolor->ink)
        recolor_destroy(&recolor);
    return recolor;
}

void recolor_destroy(struct recolor **recolor_ptr)
{
    struct recolor *recolor = *recolor_ptr;
    if (!recolor)
        return;
    for (int i = 0; i < recolor->band_count; i++) {
        mem_free(recolor->bands[i].triangles);
        mem_free(recolor->bands[i].corners);
        mem_free(recolor->bands[i].parts);
        mem_free(recolor->bands[i].mixed);
    }
    mem_free(recolor->bands);
    mem_free(recolor->meshes);
    mem_free(recolor->surfaces);
    mem_free(recolor->weights);
    mem_free(recolor->rows);
    mem_free(recolor->ink);
    mem_free(recolor->carried);
    mem_free(recolor->plain);
    mem_free(recolor->flags);
    mem_free(recolor->markers);
    mem_free(recolor);
    *recolor_ptr = NULL;
}

size_t recolor_bytes(const struct recolor *recolor)
{
    size_t pixels = (size_t)recolor->width_px * (size_t)recolor->height_px;
    size_t bytes = pixels * (sizeof(*recolor->surfaces) + sizeof(*recolor->weights) + 2) + recolor->vertex_count * 9;
    for (int i = 0; i < recolor->band_count; i++) {
        const struct recolor_band *band = &recolor->bands[i];
        bytes += band->triangle_capacity * (sizeof(*band->triangles) + sizeof(*band->corners)) +
                 band->part_capacity * sizeof(*band->parts) + band->mixed_capacity * sizeof(*band->mixed);
    }
    return bytes;
}

uint32_t recolor_triangle(struct recolor_band *band, const uint32_t vertices[3])
{
    if (band->triangle_count > 0 && !memcmp(band->triangles[band->triangle_count - 1], vertices, sizeof(*band->triangles)))
        return (uint32_t)band->triangle_count - 1;
    mem_grow(&band->triangles, &band->triangle_capacity, band->triangle_count + 1, sizeof(*band->triangles));
    memcpy(band->triangles[band->triangle_count], vertices, sizeof(*band->triangles));
    return (uint32_t)band->triangle_count++;
}

void recolor_add_mesh(struct recolor *recolor, const struct recolor_mesh *mesh)
{
    mem_grow(&recolor->meshes, &recolor->mesh_capacity, recolor->mesh_count + 1, sizeof(*recolor->meshes));
    recolor->meshes[recolor->mesh_count++] = *mesh;
}

bool recolor_make_vertices(struct recolor *recolor, size_t count)
{
    recolor->vertex_count = count;
    recolor->carried = mem_try_array(count, sizeof(*recolor->carried));
    recolor->plain = mem_try_array(count, sizeof(*recolor->plain));
    recolor->flags = mem_try_array(count, sizeof(*recolor->flags));
    return recolor->carried && recolor->plain && recolor->flags;
}

/* --- vertices ---------------------------------------------------------------------------------------------------------------- */

static inline float clamped(float x, float low, float high)
{
    return x < low ? low : x > high ? high : x;
}

static const float SLACK = 1e-5f, COLUMNS_OF_RANGE = PALETTE_PLACES / (1 + 2 * 1e-5f);

/* As carry_field in draft_place.c. x: the value, or log2 of it. */
static inline float column_of(float x, const float *scale)
{
    const float farthest = 1e6f;
    float place = (x - scale[0]) * scale[1];
    return clamped(place * COLUMNS_OF_RANGE + (1 + SLACK * COLUMNS_OF_RANGE), -farthest, farthest);
}

static bool is_log(const float *scale)
{
    return scale[2] > 0.5f;
}

static float carried_of(const struct scalar *scalar, const float *scale)
{
    return is_log(scale) ? scalar->value : column_of(scalar->value, scale);
}

struct reading_job {
    struct recolor *recolor;
    const struct scalar *scalars; /* NULL: no data anywhere */
    const float *scale;
    uint32_t first_vertex;
};

static void read_vertices(void *arg, size_t begin, size_t end)
{
    const struct reading_job *job = arg;
    struct recolor *recolor = job->recolor;
    for (size_t v = begin; v < end; v++) {
        size_t at = job->first_vertex + v;
        recolor->flags[at] = (uint16_t)(job->scalars ? draft_flags(&job->scalars[v]) : DRAFT_NOTHING_KNOWN);
        recolor->plain[at] = job->scalars ? carried_of(&job->scalars[v], job->scale) : 0;
        recolor->carried[at] = recolor->flags[at] & DRAFT_PATTERNS ? NAN : recolor->plain[at];
    }
}

static void read_corners(void *arg, size_t begin, size_t end)
{
    struct recolor *recolor = arg;
    for (size_t b = begin; b < end; b++) {
        struct recolor_band *band = &recolor->bands[b];
        mem_grow(&band->corners, &band->corner_capacity, band->triangle_count, sizeof(*band->corners));
        for (size_t t = 0; t < band->triangle_count; t++) {
            const uint32_t *v = band->triangles[t];
            float first = recolor->carried[v[0]];
            memcpy(band->corners[t], (float[4]){ first, recolor->carried[v[1]] - first, recolor->carried[v[2]] - first, 0 },
                   sizeof(*band->corners));
        }
    }
}

void recolor_read(struct recolor *recolor, const struct picture *picture, struct workers *workers)
{
    struct frame_block block;
    frame_block_fill(&block, picture);
    bool same_scale = !memcmp(recolor->scale, block.scale, sizeof(recolor->scale)), changed = false;
    memcpy(recolor->scale, block.scale, sizeof(recolor->scale));
    for (size_t m = 0; m < recolor->mesh_count; m++) {
        struct recolor_mesh *mesh = &recolor->meshes[m];
        const struct fields_entry *field = picture->fields[mesh->asset];
        struct reading_job job = { recolor, field->shown, block.scale, mesh->first_vertex };
        if (mesh->read && same_scale && mesh->content == field->content && field->shown)
            continue;
        workers_for(workers, mesh->vertex_count, VERTICES_AT_ONCE, read_vertices, &job);
        mesh->read = true;
        mesh->content = field->content;
        changed = true;
    }
    if (changed)
        workers_for(workers, (size_t)recolor->band_count, 4, read_corners, recolor);
}

/* --- pixels ------------------------------------------------------------------------------------------------------------------ */

struct coloring {
    const struct recolor *recolor;
    const uint32_t *palette;
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
    return (int)clamped(carried, 0, PALETTE_PLACES + 1);
}

/* Where a corner has flags. */
static uint32_t flagged_color(const struct coloring *coloring, const uint32_t vertices[3], uint32_t weights, uint8_t row, float x, float y)
{
    const struct recolor *recolor = coloring->recolor;
    const uint32_t *colors = coloring->palette + row * PALETTE_COLUMNS;
    float w1 = (float)(weights & 0xffff) * WEIGHT, w2 = (float)(weights >> 16) * WEIGHT, w[3] = { 1 - w1 - w2, w1, w2 };
    float carried = 0, none = 0, little = 0;
    for (int i = 0; i < 3; i++) {
        carried += w[i] * recolor->plain[vertices[i]];
        none += w[i] * draft_lacking(recolor->flags[vertices[i]]);
        little += w[i] * draft_uncertain(recolor->flags[vertices[i]]);
    }
    if (none > 0.5f)
        return mix(colors[PALETTE_PATTERNS + PATTERN_HATCH_LIGHT], colors[PALETTE_PATTERNS + PATTERN_HATCH_DARK],
                   clamped(hatch(x, y, coloring->pattern_px), 0, 1));
    uint32_t color = colors[column_at(coloring, carried)];
    if (little <= 0.5f)
        return color;
    return mix(color, colors[PALETTE_PATTERNS + PATTERN_STIPPLE], clamped(stipple(x, y, coloring->pattern_px), 0, 1));
}

static inline uint32_t field_color(const struct coloring *coloring, const struct recolor_band *band, uint32_t triangle, uint32_t weights,
                                   uint8_t row, int x, int y)
{
    const float *corners = band->corners[triangle];
    float w1 = (float)(weights & 0xffff) * WEIGHT, w2 = (float)(weights >> 16) * WEIGHT;
    float carried = corners[0] + w1 * corners[1] + w2 * corners[2];
    if (carried != carried)
        return flagged_color(coloring, band->triangles[triangle], weights, row, (float)x + 0.5f, (float)y + 0.5f);
    return coloring->palette[row * PALETTE_COLUMNS + column_at(coloring, carried)];
}

static inline uint32_t mixed_color(const struct coloring *coloring, const struct recolor_band *band, uint32_t number, int x, int y)
{
    const struct recolor_mixed *mixed = &band->mixed[number];
    uint32_t blue_red = mixed->blue_red + RECOLOR_SHARES / 2 * 0x10001u, green = mixed->green + RECOLOR_SHARES / 2; /* both at once */
    for (uint32_t i = 0; i < mixed->part_count; i++) {
        const struct recolor_part *part = &band->parts[mixed->first_part + i];
        uint32_t color = field_color(coloring, band, part->triangle, part->weights, part->row, x, y);
        blue_red += part->share * (color & 0xff00ff);
        green += part->share * (color >> 8 & 0xff);
    }
    return (blue_red / RECOLOR_SHARES & 0xff00ff) | (green / RECOLOR_SHARES & 0xff) << 8;
}

static inline uint32_t inked(uint32_t color, uint8_t ink)
{
    octets was_bytes;
    memcpy(&was_bytes, &color, sizeof(color));
    quad was = __builtin_convertvector(was_bytes, quad), now = was + (INK_BGR - was) * (MOST_INK / RECOLOR_INK) * (float)ink;
    if (ink == RECOLOR_RIM_DARK)
        now = RIM_DARK_BGR;
    if (ink == RECOLOR_RIM_LIGHT)
        now = 0.1f * was + 229.5f;
    was_bytes = __builtin_convertvector(__builtin_convertvector(now + 0.5f, quad_int), octets);
    memcpy(&color, &was_bytes, sizeof(color));
    return color;
}

DRAFT_INLINE uint32_t color_at(const struct coloring *coloring, const struct recolor_band *band, size_t at, int x, int y)
{
    const struct recolor *recolor = coloring->recolor;
    uint32_t surface = recolor->surfaces[at], color = surface;
    if (!(surface & (RECOLOR_FIXED | RECOLOR_MIXED)))
        color = field_color(coloring, band, surface, recolor->weights[at], recolor->rows[at], x, y);
    else if (!(surface & RECOLOR_FIXED))
        color = mixed_color(coloring, band, surface & ~RECOLOR_MIXED, x, y);
    return recolor->ink[at] ? inked(color, recolor->ink[at]) : color;
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

/* A bit for each byte that is not 0, the lowest first. */
DRAFT_INLINE uint32_t bits_of_bytes(uint64_t x)
{
    uint64_t low = 0x7f7f7f7f7f7f7f7f, tops = ((x & low) + low) | x;
    return (uint32_t)((tops >> 7 & 0x0101010101010101) * 0x0102040810204080 >> 56);
}

/* Eight pixels in a row. */
DRAFT_INLINE void color_lanes(const struct coloring *coloring, const struct recolor_band *band, size_t at, int x, int y, uint32_t *out)
{
    const struct recolor *recolor = coloring->recolor;
    lanes_int surfaces = *(const lanes_int *)(recolor->surfaces + at), other = (surfaces & (int32_t)(RECOLOR_FIXED | RECOLOR_MIXED)) != 0;
    uint64_t inks, rows;
    uint32_t left = 0; /* a bit for each pixel that is not simple */
    memcpy(&inks, recolor->ink + at, sizeof(inks));
    memcpy(&rows, recolor->rows + at, sizeof(rows));
    lanes_int colors = surfaces;
    if (lanes_any(~other)) {
        lanes carried = carried_by(band, surfaces & ~other, *(const lanes_int *)(recolor->weights + at));
        lanes_int known = carried == carried;
        left = lanes_bits(~known & ~other);
        carried = lanes_choose(known, carried, (lanes){ 0 });
        if (coloring->log)
            carried = columns_of_logs(carried, recolor->scale);
        lanes_int columns = lanes_whole(lanes_clamp(carried, 0, PALETTE_PLACES + 1));
        for (int i = 0; i < LANES; i++)
            colors[i] = (int32_t)coloring->palette[(rows >> (8 * i) & 0xff) * PALETTE_COLUMNS + (uint32_t)columns[i]];
        colors = lanes_choose_int(other, surfaces, colors);
    }
    *(lanes_int *)out = colors | (int32_t)0xff000000;
    left |= lanes_bits(other & ~(surfaces >> 31));
    for (left |= bits_of_bytes(inks); left; left &= left - 1) {
        int i = __builtin_ctz(left);
        out[i] = color_at(coloring, band, at + (size_t)i, x + i, y) | 0xff000000;
    }
}

DRAFT_KERNEL static void color_band(const struct coloring *coloring, int number)
{
    const struct recolor *recolor = coloring->recolor;
    const struct recolor_band *band = &recolor->bands[number];
    int end = (number + 1) * recolor->band_rows < recolor->height_px ? (number + 1) * recolor->band_rows : recolor->height_px;
    for (int y = number * recolor->band_rows; y < end; y++) {
        size_t start = (size_t)y * (size_t)recolor->width_px;
        uint32_t *out = (uint32_t *)(void *)(coloring->frame->bgrx + (size_t)y * (size_t)coloring->frame->stride_bytes);
        int x = 0;
        for (; x + LANES <= recolor->width_px; x += LANES)
            color_lanes(coloring, band, start + (size_t)x, x, y, out + x);
        for (; x < recolor->width_px; x++)
            out[x] = color_at(coloring, band, start + (size_t)x, x, y) | 0xff000000;
    }
}

static void color_bands(void *arg, size_t begin, size_t end)
{
    const struct coloring *coloring = arg;
    for (size_t band = begin; band < end; band++)
        color_band(coloring, (int)(coloring->first_band + band));
}

void recolor_draw(const struct recolor *recolor, const uint32_t *palette, float pattern_px, struct workers *workers, int first, int count,
                  struct frame *frame)
{
    struct coloring coloring = { recolor, palette, pattern_px, is_log(recolor->scale), frame, (size_t)first };
    workers_for(workers, (size_t)count, 2, color_bands, &coloring);
}
