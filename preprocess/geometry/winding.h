/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Turns triangles that are wound against those around them (flipped faces): seen from outside they would be holes. Thread: any. */
#ifndef PREPROCESS_GEOMETRY_WINDING_H
#define PREPROCESS_GEOMETRY_WINDING_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Among triangles that hang together by edges with two of them, turns those that face the one way if they have at most a quarter of the
   area. Leaves alone what has only one side, as a Moebius strip. Swaps corners in `indices`, and adds the number of triangles turned to
   *turned. Returns false if out of memory. */
bool winding_mend(const float (*positions)[3], size_t vertex_count, uint32_t *indices, size_t index_count, uint32_t *turned);

#endif
