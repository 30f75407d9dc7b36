/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of ramps (ramps.h) of many materials: materials that look the same share one. Pure. */
#ifndef RENDER_SOFT_RAMP_ROWS_H
#define RENDER_SOFT_RAMP_ROWS_H
#include <stddef.h>
#include <stdint.h>

/* Packs the rows of `count` materials, which have `steps` colours each, as context and in their own colours, to the front of `muted` and
   `own`, so that each is there once, and writes the row of each material. Where there are more than `most` (8 at least), those whose
   brightest colours are nearly equal share one too: equal in as many bits as can be. Returns how many rows there are. */
size_t ramp_rows_pack(uint32_t *muted, uint32_t *own, size_t count, size_t steps, size_t most, uint32_t *row_of_material);

#endif
