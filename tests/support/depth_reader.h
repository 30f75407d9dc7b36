/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads depth grids as described in PROTOCOL.md, without using the server's code. */
#ifndef TESTS_SUPPORT_DEPTH_READER_H
#define TESTS_SUPPORT_DEPTH_READER_H
#include "render/depth_grid.h"

struct depth_read {
    struct wire_depth wire;
    uint16_t *near, *far; /* codes of each cell's depths; equal: the cell is not divided; 0: background */
    uint8_t **masks;      /* by cell: one byte per bit of its mask, row by row; NULL: the cell is not divided */
};

/* Returns false if the payload is not as described. Call depth_read_finish() in both cases. */
bool depth_read_init(struct depth_read *read, const struct depth_grid *grid);
void depth_read_finish(struct depth_read *read);
/* Returns 1/z (perspective) or z (orthographic) of a code above 0. */
double depth_read_value(const struct depth_read *read, int code);

#endif
