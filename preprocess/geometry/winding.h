/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds triangles whose winding contradicts that of their neighbours, which would look like holes from outside, and reverses them. Thread:
 * any. */
#ifndef PREPROCESS_GEOMETRY_WINDING_H
#define PREPROCESS_GEOMETRY_WINDING_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Connects triangles across edges shared by exactly two triangles. In each connected group, turns the triangles of one orientation if they
 * have at most a quarter of the group's area. Skips one-sided surfaces such as a Moebius strip. Swaps corners in `indices` and adds the
 * number of turned triangles to *turned. Returns false if out of memory. */
bool winding_mend(const float (*positions)[3], size_t vertex_count, uint32_t *indices, size_t index_count, uint32_t *turned);

#endif
