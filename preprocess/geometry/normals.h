/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Normals for triangles that come without. */
#ifndef PREPROCESS_GEOMETRY_NORMALS_H
#define PREPROCESS_GEOMETRY_NORMALS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* One normal per corner: the faces around it weighted by their angle, as far as they turn away by less than the crease angle (40 degrees).
   Triangles without area get (0, 0, 1). False: out of memory. */
bool normals_compute(const float (*positions)[3], size_t vertex_count, const uint32_t *indices, size_t index_count,
                     float (*corner_normals)[3]);

#endif
