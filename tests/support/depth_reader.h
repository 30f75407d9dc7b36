/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads depth grids as described in PROTOCOL.md, without using the server's code. */
#ifndef TESTS_SUPPORT_DEPTH_READER_H
#define TESTS_SUPPORT_DEPTH_READER_H
#include "render/depth_grid.h"

struct depth_read {
    struct wire_depth wire;
    uint16_t *near, *far; /* by cell: codes of its near and its far depth; equal: the whole cell has one depth; 0: background */
    /* by cell: its mask, one byte per pixel, row by row, tells which pixels have which of the two depths; NULL: the cell has
       one depth */
    uint8_t **masks;
};

/* Decodes a depth grid. Returns false if its payload violates PROTOCOL.md. Call depth_read_finish() in both cases. */
bool depth_read_init(struct depth_read *read, const struct depth_grid *grid);
void depth_read_finish(struct depth_read *read);
/* Converts a depth code above 0 to 1/z in perspective views, or to z in orthographic ones. */
double depth_read_value(const struct depth_read *read, int code);

#endif
