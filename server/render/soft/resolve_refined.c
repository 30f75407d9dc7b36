/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One band of a refined frame: from samples to what each pixel shows. Triangles that share an edge are one surface: a pixel that shows no
   other is shaded once. */
#include <string.h>

#include "base/mem.h"
#include "render/soft/section_colors.h"
#include "render/soft/refined_impl.h"

struct group { /* samples of a pixel that show one surface */
    uint32_t id;
    float x, y; /* sums of where they are */
    uint8_t share;
};

struct mixed { /* a pixel with several surfaces: its items in the row */
    int column;
    uint8_t sky, cap, field_count, surface_count;
    uint32_t first_field, first_surface;
};

struct row { /* of pixels; all arrays hold SAMPLES for each */
    struct item *field, *surfaces;
    int *field_columns, *surface_columns; /* of pixels that show nothing else; -1: of a mixed one */
    struct mixed *mixed;
    uint8_t *sky;  /* per pixel: some of it is seen */
    uint8_t *caps; /* per pixel: all samples show one */
    size_t field_count, surface_count, mixed_count;
    bool any_sky, any_cap;
    uint32_t *triangles, *weights, *colors, *sky_colors;
    uint8_t *rows;
    void *memory;
};

static bool row_init(struct row *row, int pitch_px)
{
    size_t pixels = (size_t)pitch_px, most = pixels * SAMPLES;
    size_t bytes = most * (2 * sizeof(struct item) + 2 * sizeof(int) + 3 * sizeof(uint32_t) + 1) +
                   pixels * (sizeof(struct mixed) + 2 + sizeof(uint32_t)) + 64;
    *row = (struct row){ .memory = mem_try_array(bytes, 1) };
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
    TAKE(sky_colors, pixels);
    TAKE(rows, most);
    TAKE(sky, pixels);
    TAKE(caps, pixels);
#undef TAKE
    return true;
}

static bool share_edge(const struct soft *soft, uint32_t a, uint32_t b)
{
    const uint32_t *p = refined_triangle(soft, a)->vertices, *q = refined_triangle(soft, b)->vertices;
    int shared = 0;
    for (int i = 0; i < 3; i++)
        shared += p[i] == q[0] || p[i] == q[1] || p[i] == q[2];
    return shared >= 2 && (a >> ID_BITS == b >> ID_BITS || !((p[0] | p[1] | p[2]) & EXTRA_VERTEX));
}

static int group_samples(const struct soft *soft, const struct samples *samples, size_t at, struct group groups[SAMPLES])
{
    int count = 0;
    for (int s = 0; s < SAMPLES; s++) {
        uint32_t id = samples->ids[s][at];
        int g = 0;
        if (id == ID_NOTHING || id == ID_CAP)
            continue;
        while (g < count && groups[g].id != id && !share_edge(soft, groups[g].id, id))
            g++;
        if (g == count)
            groups[count++] = (struct group){ .id = id };
        groups[g].x += refined_samples[s][0];
        groups[g].y += refined_samples[s][1];
        groups[g].share++;
    }
    return count;
}

static void add_item(const struct refined *refined, struct row *row, const struct item *item, int column)
{
    const struct soft_triangle *triangle = refined_triangle(refined->soft, item->id);
    const struct refined_draw *draw = &refined->draws[triangle->mark & ~MARK_BACK];
    bool inside = draw->cut && triangle->mark & MARK_BACK;
    if (draw->field && !inside) {
        row->field_columns[row->field_count] = column;
        row->field[row->field_count++] = *item;
    } else {
        row->surface_columns[row->surface_count] = column;
        row->surfaces[row->surface_count++] = *item;
    }
}

static void add_mixed(const struct refined *refined, struct row *row, const struct samples *samples, size_t at, int column, int y)
{
    struct group groups[SAMPLES];
    int count = group_samples(refined->soft, samples, at, groups), covered = 0;
    struct mixed *mixed = &row->mixed[row->mixed_count++];
    *mixed = (struct mixed){ .column = column, .first_field = (uint32_t)row->field_count, .first_surface = (uint32_t)row->surface_count };
    for (int g = 0; g < count; g++) {
        float over = 1.0f / (float)groups[g].share;
        float at_x = (float)column + 0.5f + groups[g].x * over, at_y = (float)y + 0.5f + groups[g].y * over;
        struct item item = { groups[g].id, at_x, at_y, groups[g].share };
        covered += groups[g].share;
        if (count == 1 && covered == SAMPLES) { /* one surface after all */
            row->mixed_count--;
            add_item(refined, row, &item, column);
            return;
        }
        add_item(refined, row, &item, -1);
    }
    mixed->field_count = (uint8_t)(row->field_count - mixed->first_field);
    mixed->surface_count = (uint8_t)(row->surface_count - mixed->first_surface);
    for (int s = 0; s < SAMPLES; s++)
        mixed->cap += samples->ids[s][at] == ID_CAP;
    mixed->sky = (uint8_t)(SAMPLES - covered - mixed->cap);
    row->sky[column] = mixed->sky > 0;
    row->any_sky |= mixed->sky > 0;
}

static void sort_row(const struct refined *refined, struct row *row, const struct samples *samples, size_t start, int y)
{
    row->field_count = row->surface_count = row->mixed_count = 0;
    row->any_sky = row->any_cap = false;
    memset(row->sky, 0, (size_t)refined->soft->pitch_px);
    memset(row->caps, 0, (size_t)refined->soft->pitch_px);
    for (int column = 0; column < refined->soft->width_px; column++) {
        size_t at = start + (size_t)column;
        uint32_t first = samples->ids[0][at];
        bool alike = first == samples->ids[1][at] && first == samples->ids[2][at] && first == samples->ids[3][at];
        if (!alike) {
            add_mixed(refined, row, samples, at, column, y);
        } else if (first == ID_CAP) {
            row->caps[column] = 1;
            row->any_cap = true;
        } else if (first == ID_NOTHING) {
            row->sky[column] = 1;
            row->any_sky = true;
        } else {
            add_item(refined, row, &(struct item){ first, (float)column + 0.5f, (float)y + 0.5f, SAMPLES }, column);
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
    return (uint32_t)cap_color((lanes){ 0 } + ((float)column + 0.5f), (float)y + 0.5f, refined->soft->block.scale[3])[0];
}

static uint32_t keep_mixed(const struct refined *refined, struct visibility_band *band, const struct row *row, const struct mixed *from,
                           int y)
{
    struct visibility_mixed mixed = {
        .part_count = from->field_count,
        .first_part = (uint32_t)band->part_count,
        .x = (uint16_t)from->column,
        .row = (uint16_t)(y % REFINED_ROWS),
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
    for (uint32_t i = from->first_field; i < from->first_field + from->field_count; i++)
        band->parts[band->part_count++] = (struct visibility_part){ row->triangles[i], row->weights[i], row->rows[i], row->field[i].share };
    mem_grow(&band->mixed, &band->mixed_capacity, band->mixed_count + 1, sizeof(*band->mixed));
    band->mixed[band->mixed_count] = mixed;
    return VISIBILITY_MIXED | (uint32_t)band->mixed_count++;
}

static void keep_row(const struct refined *refined, struct visibility_band *band, const struct row *row, int y)
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
    }
    for (size_t i = 0; i < row->mixed_count; i++)
        surfaces[row->mixed[i].column] = keep_mixed(refined, band, row, &row->mixed[i], y);
}

static void shade_rows(const struct refined *refined, int number, const struct samples *samples, struct row *row)
{
    const struct soft *soft = refined->soft;
    struct visibility_band *band = &refined->buffer->bands[number];
    int top = number * REFINED_ROWS, end = top + REFINED_ROWS < soft->height_px ? top + REFINED_ROWS : soft->height_px;
    for (int y = top; y < end; y++) {
        size_t start = (size_t)(y - top) * (size_t)soft->pitch_px;
        struct shaded_items shaded = { row->triangles, row->weights, row->rows };
        sort_row(refined, row, samples, start, y);
        refined_shade_field(refined, band, row->field, row->field_count, &shaded);
        refined_shade_surfaces(refined, row->surfaces, row->surface_count, row->colors);
        if (row->any_sky)
            refined_shade_sky(refined, y, row->sky, row->sky_colors);
        keep_row(refined, band, row, y);
        memcpy(soft->depth + (size_t)y * (size_t)soft->pitch_px, samples->depth[0] + start, (size_t)soft->pitch_px * sizeof(float));
    }
}

bool refined_shade_band(const struct refined *refined, int number)
{
    size_t pixels = REFINED_ROWS * (size_t)refined->soft->pitch_px;
    struct samples samples;
    struct row row;
    float *memory = mem_try_array(pixels, SAMPLES * (sizeof(float) + sizeof(uint32_t)));
    bool good = row_init(&row, refined->soft->pitch_px) && memory;
    if (good) {
        for (int s = 0; s < SAMPLES; s++) {
            samples.depth[s] = memory + (size_t)s * pixels;
            samples.ids[s] = (uint32_t *)(memory + (size_t)(SAMPLES + s) * pixels);
        }
        refined_raster_band(refined, number, &samples);
        shade_rows(refined, number, &samples, &row);
    }
    mem_free(memory);
    mem_free(row.memory);
    return good;
}
