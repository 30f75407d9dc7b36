/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes vertex normals for triangles without normals. Call from any thread. */
#ifndef PREPROCESS_GEOMETRY_NORMALS_H
#define PREPROCESS_GEOMETRY_NORMALS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Writes one unit normal per triangle corner: the angle-weighted mean normal of the faces at the corner's position. Only faces
 * within the crease angle (40 degrees) of the corner's own face count. Triangles without area get (0, 0, 1). Returns false if
 * out of memory. */
bool normals_compute(const float (*positions)[3], size_t vertex_count, const uint32_t *indices, size_t index_count,
                     float (*corner_normals)[3]);

#endif
