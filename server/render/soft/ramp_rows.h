/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Deduplicates colour ramps (ramps.h): materials that look equal share a row. Pure. */
#ifndef RENDER_SOFT_RAMP_ROWS_H
#define RENDER_SOFT_RAMP_ROWS_H
#include <stddef.h>
#include <stdint.h>

/* Moves the distinct rows of `count` materials, each of `steps` colours, to the front of `muted` (greyed colours) and `own`
   (the materials' own colours). Writes the index of each material's row. If more than `most` rows (at least 8) remain, rows
   with nearly equal brightest colours are merged, comparing as many bits as possible. Returns the number of rows. */
size_t ramp_rows_pack(uint32_t *muted, uint32_t *own, size_t count, size_t steps, size_t most, uint32_t *row_of_material);

#endif
