/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows into columns, a block at a time that fits into a core's own memory. */
#include "preprocess/rows.h"

#include "base/mem.h"
#include "surface/trimesh.h"

#define LINE 16u  /* floats */
#define BLOCK 64u /* vertices */

void rows_finish(struct rows *rows)
{
    mem_free(rows->distances_m);
    mem_free(rows->place_of);
    *rows = (struct rows){ 0 };
}

void rows_renumber(struct rows *rows, const uint32_t *new_of, uint32_t kept)
{
    uint32_t *place_of = mem_array(kept, sizeof(*place_of));
    for (uint32_t v = 0; v < rows->vertex_count; v++)
        if (new_of[v] != TRIMESH_NONE)
            place_of[new_of[v]] = rows->place_of[v];
    mem_free(rows->place_of);
    rows->place_of = place_of;
    rows->vertex_count = kept;
}

struct turn {
    const struct rows *rows;
    float *columns;
};

static void turn_blocks(void *arg, size_t begin, size_t end)
{
    const struct turn *turn = arg;
    const struct rows *rows = turn->rows;
    const size_t count = rows->vertex_count, sensors = rows->sensor_count;
    for (size_t first = begin * BLOCK; first < end * BLOCK && first < count; first += BLOCK) {
        size_t last = first + BLOCK < count ? first + BLOCK : count;
        for (size_t line = 0; line < sensors; line += LINE) {
            size_t width = line + LINE < sensors ? LINE : sensors - line;
            for (size_t v = first; v < last; v++) {
                const float *row = rows->distances_m + rows->place_of[v] * sensors + line;
                for (size_t s = 0; s < width; s++)
                    turn->columns[(line + s) * count + v] = row[s];
            }
        }
    }
}

void rows_turn(const struct rows *rows, struct workers *workers, float *columns)
{
    struct turn turn = { rows, columns };
    size_t blocks = (rows->vertex_count + BLOCK - 1) / BLOCK;
    if (workers)
        workers_for(workers, blocks, 16, turn_blocks, &turn);
    else
        turn_blocks(&turn, 0, blocks);
}
