/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resolves one band (group of pixel rows) of a refined frame: determines from its four samples which surfaces each pixel shows,
   and shades them. Triangles that share an edge count as one surface; a pixel that shows a single surface is shaded once.
   Blended triangles are shaded one by one and composited per sample. */
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "render/soft/kernels.h"
#include "render/soft/refined_impl.h"
#include "render/soft/section_colors.h"

struct sample_group { /* the samples of one pixel that show the same surface */
    const struct soft_triangle *triangle;
    float x, y; /* sums of the sample positions */
    int count;
    uint16_t share;
};

enum { SAMPLE_SHARE = VISIBILITY_SHARES / SAMPLES };

struct mixed { /* a pixel that shows several surfaces, and the range of its items (surfaces to shade) in the row's array */
    int column;
    uint8_t field_count, surface_count;
    uint16_t sky, cap; /* area of the pixel that shows sky, and area that shows section caps; 0..VISIBILITY_SHARES */
    /* sum of the colours (blue, green, red) of blended triangles in the pixel, each weighted by the area that its triangle
       covers */
    uint16_t over[3];
    uint32_t first_field, first_surface;
};

struct refined_row { /* a row of pixels; the arrays of items (surfaces to shade) have room for SAMPLES items per pixel */
    struct refined_item *field, *surfaces;
    /* [item]: column of the pixel to which the item (surface to shade) belongs; -1: the pixel shows several surfaces, and its
       colour is computed after all its items are shaded */
    int *field_columns, *surface_columns;
    struct mixed *mixed;
    uint8_t *sky;  /* by column: 1 if the pixel shows some of the sky, else 0 */
    uint8_t *caps; /* by column: 1 if all samples of the pixel show a section cap, else 0 */
    size_t field_count, surface_count, mixed_count;
    bool any_sky, any_cap;
    uint32_t *triangles, *weights, *colors, *sky_colors;
    uint8_t *rows;
    struct visibility_gloss *gloss;
    void *memory;
};

static bool row_init(struct refined_row *row, int pitch_px)
{
    size_t pixels = (size_t)pitch_px, most = pixels * SAMPLES;
    size_t bytes = most * (2 * sizeof(struct refined_item) + 2 * sizeof(int) + 3 * sizeof(uint32_t) + sizeof(*row->gloss) + 1) +
                   pixels * (sizeof(struct mixed) + 2 + sizeof(uint32_t)) + 64;
    *row = (struct refined_row){ .memory = mem_try_array(bytes, 1) };
    uint8_t *at = row->memory;
    if (!at)
        return false;
#define TAKE(member, count) (row->member = (void *)at, at += (count) * sizeof(*row->member))
    TAKE(field, most);
    TAKE(surfaces, most);
    TAKE(mixed, pixels);
    TAKE(field_columns, most);
    TAKE(surface_columns, most);
    TAKE(triangles, most);
    TAKE(weights, most);
    TAKE(colors, most);
    TAKE(gloss, most);
    TAKE(sky_colors, pixels);
    TAKE(rows, most);
    TAKE(sky, pixels);
    TAKE(caps, pixels);
#undef TAKE
    return true;
}

/* --- triangles ----------------------------------------------------------------------------------------------------------------- */

enum { RECENT_TRIANGLES = 512 };
struct recent { /* cache of triangles by id, since neighbouring pixels mostly show the same triangles */
    const struct refined *refined;
    uint32_t mesh; /* index of the mesh of the last triangle looked up, which is tried first */
    struct soft_triangle triangles[RECENT_TRIANGLES];
};

static const struct soft_triangle *triangle_of(struct recent *recent, uint32_t id)
{
    struct soft_triangle *triangle = &recent->triangles[(id ^ id >> 9) % RECENT_TRIANGLES];
    if (triangle->id != id) {
        triangle->mesh = recent->mesh;
        raster_find_triangle(&recent->refined->raster, id, triangle);
        recent->mesh = triangle->mesh;
    }
    return triangle;
}

static bool share_edge(const struct soft_triangle *a, const struct soft_triangle *b)
{
    const uint32_t *p = a->vertices, *q = b->vertices;
    int shared = 0;
    for (int i = 0; i < 3; i++)
        shared += p[i] == q[0] || p[i] == q[1] || p[i] == q[2];
    return a->mesh == b->mesh && shared >= 2;
}

/* Groups the samples of a pixel by the surface that they show. under: by sample: area of the pixel that the sample represents,
   less where blended triangles cover it. triangles: receives one triangle of each group. Returns the number of groups. */
static int group_samples(struct recent *recent, const struct soft_sample samples[SAMPLES], size_t at, const uint16_t under[SAMPLES],
                         struct soft_triangle triangles[SAMPLES], struct sample_group groups[SAMPLES])
{
    int count = 0;
    for (int s = 0; s < SAMPLES; s++) {
        uint32_t id = samples[s].ids[at];
        int g = 0;
        if (id == ID_NOTHING || id == ID_CAP)
            continue;
        const struct soft_triangle *triangle = triangle_of(recent, id);
        while (g < count && groups[g].triangle->id != id && !share_edge(groups[g].triangle, triangle))
            g++;
        if (g == count) {
            triangles[count] = *triangle;
            groups[count] = (struct sample_group){ .triangle = &triangles[count] };
            count++;
        }
        groups[g].x += samples[s].x;
        groups[g].y += samples[s].y;
        groups[g].count++;
        groups[g].share = (uint16_t)(groups[g].share + under[s]);
    }
    return count;
}

/* --- what is blended ----------------------------------------------------------------------------------------------------------- */

struct layers {                      /* blended triangles of a band */
    struct soft_fragments fragments; /* sorted by pixel, nearest first */
    struct refined_item *items;      /* items (surfaces to shade) of blended triangles: one per triangle and pixel */
    uint32_t *colors;
    float *alphas;
    size_t count, item_capacity, color_capacity, alpha_capacity;
};

static int by_triangle(const void *a, const void *b)
{
    const struct soft_fragment *x = a, *y = b;
    return x->pixel != y->pixel ? (x->pixel > y->pixel) - (x->pixel < y->pixel) : (x->id > y->id) - (x->id < y->id);
}

static int by_depth(const void *a, const void *b)
{
    const struct soft_fragment *x = a, *y = b;
    if (x->pixel != y->pixel)
        return x->pixel > y->pixel ? 1 : -1;
    return x->depth != y->depth ? (x->depth < y->depth ? 1 : -1) : (x->layer > y->layer) - (x->layer < y->layer);
}

/* Shades the blended triangles. Then replaces the depth of the surfaces behind them with their own depth, so that blended
   triangles also hide feature edges of those surfaces. */
static void shade_layers(struct recent *recent, struct layers *layers, int top, const struct soft_sample samples[SAMPLES])
{
    const struct refined *refined = recent->refined;
    size_t pitch = (size_t)refined->raster.pitch_px, count = layers->fragments.count;
    struct soft_fragment *fragments = layers->fragments.at;
    qsort(fragments, count, sizeof(*fragments), by_triangle);
    for (size_t i = 0, end; i < count; i = end) {
        float x = 0, y = 0;
        for (end = i; end < count && by_triangle(&fragments[i], &fragments[end]) == 0; end++) {
            const struct soft_sample *sample = &samples[fragments[end].sample];
            x += sample->x;
            y += sample->y;
            fragments[end].layer = (uint32_t)layers->count;
            if (fragments[end].sample == 0 && fragments[end].depth > sample->depth[fragments[end].pixel])
                sample->depth[fragments[end].pixel] = fragments[end].depth;
        }
        float over = 1.0f / (float)(end - i);
        mem_grow(&layers->items, &layers->item_capacity, layers->count + 1, sizeof(*layers->items));
        layers->items[layers->count++] = (struct refined_item){ .triangle = *triangle_of(recent, fragments[i].id),
                                                                .x = (float)(fragments[i].pixel % pitch) + 0.5f + x * over,
                                                                .y = (float)((size_t)top + fragments[i].pixel / pitch) + 0.5f + y * over };
    }
    mem_grow(&layers->colors, &layers->color_capacity, layers->count, sizeof(*layers->colors));
    mem_grow(&layers->alphas, &layers->alpha_capacity, layers->count, sizeof(*layers->alphas));
    refined->raster.soft->kernels->shade_surfaces(refined, layers->items, layers->count, layers->colors, layers->alphas);
    qsort(fragments, count, sizeof(*fragments), by_depth);
}

static void layers_finish(struct layers *layers)
{
    mem_free(layers->fragments.at);
    mem_free(layers->items);
    mem_free(layers->colors);
    mem_free(layers->alphas);
}

/* Composites the blended fragments of one pixel. over: receives the sum of their colours times coverage. under: receives, by
   sample, the area through which the surface behind stays visible (0..VISIBILITY_SHARES / SAMPLES). */
static void blend(const struct layers *layers, size_t first, size_t end, uint16_t over[3], uint16_t under[SAMPLES])
{
    float left[SAMPLES] = { 1, 1, 1, 1 }, sum[3] = { 0 }, gone = 0;
    int shares = VISIBILITY_SHARES;
    for (size_t i = first; i < end; i++) {
        const struct soft_fragment *fragment = &layers->fragments.at[i];
        float part = layers->alphas[fragment->layer] * left[fragment->sample];
        left[fragment->sample] -= part;
        gone += part;
        for (int c = 0; c < 3; c++)
            sum[c] += part * (float)(layers->colors[fragment->layer] >> (8 * c) & 0xff);
    }
    for (int s = 0; s < SAMPLES; s++) {
        under[s] = (uint16_t)(left[s] * SAMPLE_SHARE + 0.5f);
        shares -= under[s];
    }
    for (int c = 0; c < 3 && gone > 0; c++)
        over[c] = (uint16_t)(sum[c] * ((float)shares / gone));
}

/* --- rows ------------------------------------------------------------------------------------------------------------------------ */

static void add_item(const struct refined *refined, struct refined_row *row, const struct refined_item *item, int column)
{
    const struct soft_mesh *mesh = &refined->raster.meshes[item->triangle.mesh];
    if (mesh->has_field && !(item->triangle.id & ID_BACK)) {
        row->field_columns[row->field_count] = column;
        row->field[row->field_count++] = *item;
    } else {
        row->surface_columns[row->surface_count] = column;
        row->surfaces[row->surface_count++] = *item;
    }
}

/* A pixel that shows several surfaces, with the transparent triangles in front. */
struct mixed_pixel {
    size_t at; /* index of the pixel in the arrays of samples */
    int column, y;
    size_t first, end; /* range of the blended (transparent) fragments that cover the pixel */
};

/* Adds a pixel that shows several surfaces, and its items (surfaces to shade), to the row. */
static void add_mixed(struct recent *recent, struct refined_row *row, const struct soft_sample samples[SAMPLES],
                      const struct layers *layers, const struct mixed_pixel *pixel)
{
    const size_t at = pixel->at;
    const int column = pixel->column, y = pixel->y;
    struct soft_triangle triangles[SAMPLES];
    struct sample_group groups[SAMPLES];
    uint16_t under[SAMPLES] = { SAMPLE_SHARE, SAMPLE_SHARE, SAMPLE_SHARE, SAMPLE_SHARE };
    struct mixed *mixed = &row->mixed[row->mixed_count++];
    *mixed = (struct mixed){ .column = column, .first_field = (uint32_t)row->field_count, .first_surface = (uint32_t)row->surface_count };
    if (pixel->end > pixel->first)
        blend(layers, pixel->first, pixel->end, mixed->over, under);
    int count = group_samples(recent, samples, at, under, triangles, groups);
    for (int g = 0; g < count; g++) {
        float over = 1.0f / (float)groups[g].count;
        float at_x = (float)column + 0.5f + groups[g].x * over, at_y = (float)y + 0.5f + groups[g].y * over;
        struct refined_item item = { *groups[g].triangle, at_x, at_y, groups[g].share };
        /* this surface alone covers the whole pixel, so the pixel does not count as one with several surfaces */
        if (item.share == VISIBILITY_SHARES) {
            row->mixed_count--;
            add_item(recent->refined, row, &item, column);
            return;
        }
        add_item(recent->refined, row, &item, -1);
    }
    mixed->field_count = (uint8_t)(row->field_count - mixed->first_field);
    mixed->surface_count = (uint8_t)(row->surface_count - mixed->first_surface);
    for (int s = 0; s < SAMPLES; s++) {
        mixed->cap = (uint16_t)(mixed->cap + (samples[s].ids[at] == ID_CAP ? under[s] : 0));
        mixed->sky = (uint16_t)(mixed->sky + (samples[s].ids[at] == ID_NOTHING ? under[s] : 0));
    }
    row->sky[column] = mixed->sky > 0;
    row->any_sky |= mixed->sky > 0;
}

/* Sorts the pixels of a row by content: a single surface, several surfaces, sky or section cap. layered: index of the first blended
   fragment of the row; on return, index of the first fragment after the row. */
static void sort_row(struct recent *recent, struct refined_row *row, const struct soft_sample samples[SAMPLES], size_t start, int y,
                     const struct layers *layers, size_t *layered)
{
    const struct raster *raster = &recent->refined->raster;
    row->field_count = row->surface_count = row->mixed_count = 0;
    row->any_sky = row->any_cap = false;
    memset(row->sky, 0, (size_t)raster->pitch_px);
    memset(row->caps, 0, (size_t)raster->pitch_px);
    for (int column = 0; column < raster->width_px; column++) {
        size_t at = start + (size_t)column;
        uint32_t first = samples[0].ids[at];
        size_t over = *layered;
        while (*layered < layers->fragments.count && layers->fragments.at[*layered].pixel == at)
            ++*layered;
        bool alike = first == samples[1].ids[at] && first == samples[2].ids[at] && first == samples[3].ids[at];
        if (!alike || *layered > over) {
            add_mixed(recent, row, samples, layers, &(struct mixed_pixel){ at, column, y, over, *layered });
        } else if (first == ID_CAP) {
            row->caps[column] = 1;
            row->any_cap = true;
        } else if (first == ID_NOTHING) {
            row->sky[column] = 1;
            row->any_sky = true;
        } else {
            struct refined_item item = { *triangle_of(recent, first), (float)column + 0.5f, (float)y + 0.5f, VISIBILITY_SHARES };
            add_item(recent->refined, row, &item, column);
        }
    }
}

static void add_color(struct visibility_mixed *mixed, uint32_t color, unsigned share)
{
    mixed->blue_red += (color & 0xff00ff) * share;
    mixed->green = (uint16_t)(mixed->green + (color >> 8 & 0xff) * share);
}

static uint32_t cap_at(const struct refined *refined, int column, int y)
{
    return (uint32_t)cap_color((lanes){ 0 } + ((float)column + 0.5f), (float)y + 0.5f, refined->raster.block.scale[3])[0];
}

static uint32_t keep_mixed(const struct refined *refined, struct visibility_band *band, const struct refined_row *row,
                           const struct mixed *from, int y)
{
    struct visibility_mixed mixed = {
        .part_count = from->field_count,
        .first_part = (uint32_t)band->part_count,
        .x = (uint16_t)from->column,
        .row = (uint16_t)(y % REFINED_ROWS),
        .blue_red = from->over[0] | (uint32_t)from->over[2] << 16,
        .green = from->over[1],
    };
    if (from->sky)
        add_color(&mixed, row->sky_colors[from->column], from->sky);
    if (from->cap)
        add_color(&mixed, cap_at(refined, from->column, y), from->cap);
    for (uint32_t i = from->first_surface; i < from->first_surface + from->surface_count; i++)
        add_color(&mixed, row->colors[i], row->surfaces[i].share);
    if (mixed.part_count == 0)
        return VISIBILITY_FIXED | ((mixed.blue_red + VISIBILITY_SHARES / 2 * 0x10001u) / VISIBILITY_SHARES & 0xff00ff) |
               (uint32_t)(mixed.green + VISIBILITY_SHARES / 2) / VISIBILITY_SHARES << 8;
    mem_grow(&band->parts, &band->part_capacity, band->part_count + mixed.part_count, sizeof(*band->parts));
    if (refined->buffer->gloss) {
        mem_grow(&band->gloss, &band->gloss_capacity, band->part_count + mixed.part_count, sizeof(*band->gloss));
        memcpy(band->gloss + band->part_count, row->gloss + from->first_field, mixed.part_count * sizeof(*band->gloss));
    }
    for (uint32_t i = from->first_field; i < from->first_field + from->field_count; i++)
        band->parts[band->part_count++] = (struct visibility_part){ row->triangles[i], row->weights[i], row->rows[i], row->field[i].share };
    mem_grow(&band->mixed, &band->mixed_capacity, band->mixed_count + 1, sizeof(*band->mixed));
    band->mixed[band->mixed_count] = mixed;
    return VISIBILITY_MIXED | (uint32_t)band->mixed_count++;
}

static void keep_row(const struct refined *refined, struct visibility_band *band, const struct refined_row *row, int y)
{
    struct visibility_buffer *buffer = refined->buffer;
    size_t start = (size_t)y * (size_t)buffer->width_px;
    uint32_t *surfaces = buffer->surfaces + start;
    for (int column = 0; column < buffer->width_px && row->any_sky; column++)
        if (row->sky[column])
            surfaces[column] = VISIBILITY_FIXED | row->sky_colors[column];
    for (int column = 0; column < buffer->width_px && row->any_cap; column++)
        if (row->caps[column])
            surfaces[column] = VISIBILITY_FIXED | cap_at(refined, column, y);
    for (size_t i = 0; i < row->surface_count; i++)
        if (row->surface_columns[i] >= 0)
            surfaces[row->surface_columns[i]] = VISIBILITY_FIXED | row->colors[i];
    for (size_t i = 0; i < row->field_count; i++) {
        int column = row->field_columns[i];
        if (column < 0)
            continue;
        surfaces[column] = row->triangles[i];
        buffer->weights[start + (size_t)column] = row->weights[i];
        buffer->rows[start + (size_t)column] = row->rows[i];
        if (buffer->gloss)
            buffer->gloss[start + (size_t)column] = row->gloss[i];
    }
    for (size_t i = 0; i < row->mixed_count; i++)
        surfaces[row->mixed[i].column] = keep_mixed(refined, band, row, &row->mixed[i], y);
}

void refined_keep_place(const struct refined *refined, struct visibility_band *band, const struct refined_item *item, float w1, float w2,
                        const struct shaded_items *out, size_t at)
{
    const struct soft_mesh *mesh = &refined->raster.meshes[item->triangle.mesh];
    const uint32_t *v = item->triangle.vertices, first = mesh->first_vertex;
    size_t before = band->triangle_count;
    out->triangles[at] = visibility_add_triangle(band, (uint32_t[3]){ first + v[0], first + v[1], first + v[2] });
    out->weights[at] = (uint32_t)(w1 * 65535 + 0.5f) | (uint32_t)(w2 * 65535 + 0.5f) << 16;
    if (refined->buffer->lined && band->triangle_count > before) {
        double weights[3][3];
        soft_weights(mesh, v, weights);
        visibility_add_slopes(band, weights);
    }
}

static void shade_rows(struct recent *recent, int number, const struct soft_sample samples[SAMPLES], struct refined_row *row,
                       const struct layers *layers)
{
    size_t layered = 0;
    const struct refined *refined = recent->refined;
    const struct raster *raster = &refined->raster;
    const struct soft_kernels *kernels = raster->soft->kernels;
    struct visibility_band *band = &refined->buffer->bands[number];
    int top = number * REFINED_ROWS, end = top + REFINED_ROWS < raster->height_px ? top + REFINED_ROWS : raster->height_px;
    for (int y = top; y < end; y++) {
        size_t start = (size_t)(y - top) * (size_t)raster->pitch_px;
        struct shaded_items shaded = { row->triangles, row->weights, row->rows, row->gloss };
        sort_row(recent, row, samples, start, y, layers, &layered);
        (refined->buffer->gloss ? kernels->shade_gloss : kernels->shade_field)(refined, band, row->field, row->field_count, &shaded);
        kernels->shade_surfaces(refined, row->surfaces, row->surface_count, row->colors, NULL);
        if (row->any_sky)
            kernels->shade_sky(refined, y, row->sky, row->sky_colors);
        keep_row(refined, band, row, y);
        memcpy(raster->depth + (size_t)y * (size_t)raster->pitch_px, samples[0].depth + start, (size_t)raster->pitch_px * sizeof(float));
    }
}

bool refined_shade_band(const struct refined *refined, int number)
{
    size_t pixels = REFINED_ROWS * (size_t)refined->raster.pitch_px;
    struct soft_sample samples[SAMPLES];
    struct refined_row row;
    struct layers layers = { 0 };
    float *memory = mem_try_array(pixels, SAMPLES * (sizeof(float) + sizeof(uint32_t)));
    struct recent *recent = mem_new(sizeof(*recent));
    bool good = row_init(&row, refined->raster.pitch_px) && memory;
    recent->refined = refined;
    for (int i = 0; i < RECENT_TRIANGLES; i++)
        recent->triangles[i].id = ID_NOTHING;
    for (int s = 0; s < SAMPLES && good; s++)
        samples[s] = (struct soft_sample){ .depth = memory + (size_t)s * pixels,
                                           .ids = (uint32_t *)(memory + (size_t)(SAMPLES + s) * pixels),
                                           .x = refined_samples[s][0],
                                           .y = refined_samples[s][1] };
    if (good) {
        refined_raster_band(refined, number, samples, &layers.fragments);
        if (layers.fragments.count > 0)
            shade_layers(recent, &layers, number * REFINED_ROWS, samples);
        shade_rows(recent, number, samples, &row, &layers);
    }
    layers_finish(&layers);
    mem_free(recent);
    mem_free(memory);
    mem_free(row.memory);
    return good;
}
