/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Triangles that nobody sees from outside: those inside another, closed part. */
#ifndef SURFACE_HIDDEN_H
#define SURFACE_HIDDEN_H
#include "base/workers.h"
#include "surface/trimesh.h"

/* closed[part]: its open edges are short against its size. parts: how many there are (part[tri] < parts). */
void hidden_closed_parts(const struct trimesh *mesh, const uint32_t *part, size_t parts, char *closed);

/* hidden[tri] = 1 where the middle of the triangle is inside a closed part other than its own: rays into five directions meet that part an
   odd number of times, which needs no orientation of its faces. solid, solid_part: the parts as they were before they were cut up.
   Triangles that lie on the other part's surface (within tolerance_m) are not inside. workers may be NULL. */
void hidden_find(const struct trimesh *mesh, const uint32_t *part, const struct trimesh *solid, const uint32_t *solid_part, size_t parts,
                 const char *closed, double tolerance_m, struct workers *workers, char *hidden);

#endif
