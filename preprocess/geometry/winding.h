/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds and reverses triangles whose winding contradicts that of their neighbours: from outside, they would look like holes.
 * Call from any thread. */
#ifndef PREPROCESS_GEOMETRY_WINDING_H
#define PREPROCESS_GEOMETRY_WINDING_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Groups triangles connected across edges that exactly two triangles share. In each group, reverses the triangles of the
 * minority orientation if they cover at most a quarter of the group's area. Skips one-sided surfaces such as a Moebius strip.
 * Swaps corners in `indices` and adds the number of reversed triangles to *turned. Returns false if out of memory. */
bool winding_mend(const float (*positions)[3], size_t vertex_count, uint32_t *indices, size_t index_count, uint32_t *turned);

#endif
