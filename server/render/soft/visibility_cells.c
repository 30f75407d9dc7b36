/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the cells (squares of pixels) that show fields of many sensors in stored visibility buffers. Also finds the bounding
   boxes of the surface points that each cell shows (pixel_lists.h). */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "render/soft/visibility_buffer_impl.h"

struct cell_search {
    const struct visibility_buffer *buffer;
    struct visibility_band *band;
    /* index in band->cells of the first cell (square of pixels) at this column and row. If several meshes are visible there,
       each has a cell, one after the other */
    size_t first;
    uint16_t column, row;
};

static struct pixel_cell *cell_of(const struct cell_search *search, uint32_t mesh)
{
    struct visibility_band *band = search->band;
    for (size_t i = band->cell_count; i-- > search->first;)
        if (band->cells[i].mesh == mesh)
            return &band->cells[i];
    mem_grow(&band->cells, &band->cell_capacity, band->cell_count + 1, sizeof(*band->cells));
    struct pixel_cell *cell = &band->cells[band->cell_count++];
    const float least = -INFINITY, most = INFINITY;
    *cell = (struct pixel_cell){ { most, most, most }, { least, least, least }, search->column, search->row, mesh };
    return cell;
}

static void include_place(const struct cell_search *search, uint32_t triangle, uint32_t weights)
{
    const struct visibility_band *band = search->band;
    int mesh = (int)band->corners[triangle][3] - 1;
    if (mesh < 0 || search->buffer->meshes[mesh].pixels.count <= PIXEL_FEW)
        return;
    struct pixel_cell *cell = cell_of(search, (uint32_t)mesh);
    const struct visibility_place *place = &band->places[triangle];
    float w1 = (float)(weights & 0xffff) * WEIGHT, w2 = (float)(weights >> 16) * WEIGHT;
    for (int c = 0; c < 3; c++) {
        float at = place->first[c] + (w1 * place->second[c] + w2 * place->third[c]);
        cell->low[c] = at < cell->low[c] ? at : cell->low[c];
        cell->high[c] = at > cell->high[c] ? at : cell->high[c];
    }
}

static void include_pixel(const struct cell_search *search, size_t pixel)
{
    const struct visibility_buffer *buffer = search->buffer;
    const struct visibility_band *band = search->band;
    uint32_t surface = buffer->surfaces[pixel];
    if (surface & VISIBILITY_FIXED)
        return;
    if (!(surface & VISIBILITY_MIXED)) {
        include_place(search, surface, buffer->weights[pixel]);
        return;
    }
    const struct visibility_mixed *mixed = &band->mixed[surface & ~VISIBILITY_MIXED];
    for (uint32_t i = mixed->first_part; i < mixed->first_part + mixed->part_count; i++)
        include_place(search, band->parts[i].triangle, band->parts[i].weights);
}

static int by_mesh(const void *a, const void *b)
{
    const struct pixel_cell *x = a, *y = b;
    if (x->mesh != y->mesh)
        return x->mesh < y->mesh ? -1 : 1;
    return (int)pixel_cells_order(x->column, x->row) - (int)pixel_cells_order(y->column, y->row);
}

static void find_in_cell(struct cell_search *search, int top, int end)
{
    const struct visibility_buffer *buffer = search->buffer;
    int left = search->column * CELL_PX, right = left + CELL_PX < buffer->width_px ? left + CELL_PX : buffer->width_px;
    search->first = search->band->cell_count;
    for (int y = top + search->row * CELL_PX; y < top + (search->row + 1) * CELL_PX && y < end; y++)
        for (int x = left; x < right; x++)
            include_pixel(search, (size_t)y * (size_t)buffer->width_px + (size_t)x);
}

void visibility_find_cells(const struct visibility_buffer *buffer, int number)
{
    struct cell_search search = { buffer, &buffer->bands[number], 0, 0, 0 };
    struct visibility_band *band = search.band;
    int top = number * buffer->band_rows, end = top + buffer->band_rows < buffer->height_px ? top + buffer->band_rows : buffer->height_px;
    band->cell_count = 0;
    for (int square = 0; square * SQUARE_CELLS * CELL_PX < buffer->width_px; square++) {
        size_t first = band->cell_count;
        for (uint32_t i = 0; i < SQUARE_CELLS * SQUARE_CELLS; i++) {
            uint32_t column, row;
            pixel_cell_from_order(i, &column, &row);
            search.column = (uint16_t)(square * SQUARE_CELLS + (int)column);
            search.row = (uint16_t)row;
            if (top + (int)row * CELL_PX < end)
                find_in_cell(&search, top, end);
        }
        if (band->cell_count > first + 1)
            qsort(band->cells + first, band->cell_count - first, sizeof(*band->cells), by_mesh);
    }
}
