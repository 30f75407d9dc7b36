/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Separates the main part of a model or plant from stray pieces, such as a vertex left at the origin of survey coordinates.
   Rule: a gap is an interval along one axis that contains no corner of a triangle. The main part is the side of the gap with
   the larger area. Pieces on the other side are stray if the gap is at least as long as the main part, provided that all stray
   pieces together have at most 2 % of the area. If the gap is at least 100 times as long as the main part, they are stray
   whatever their area. A triangle that crosses such a gap is stray too. But if the crossing triangles have more than 2 % of the
   area and end at several places on the far side, they are kept: such a long pipe belongs to the pieces that it connects. A
   simpler rule, the box of 98 % of the area, would crop flare stacks, pipe racks and tanks at the edge of a plant. They have
   less than 2 % of the area but stand next to the rest. It would also keep a stray box 7,000 km away that has a third of the
   area of a small model. Call from any thread. */
#ifndef BASE_MATH_GAP_SPLIT_H
#define BASE_MATH_GAP_SPLIT_H
#include <stddef.h>
#include <stdint.h>

#include "base/math/extent.h"

struct gap_tri {
    double at[3][3], area_m2;
    uint32_t owner; /* for the caller's use */
};

/* Moves the triangles of the main part to the front of the array. Returns their number; *main receives their extent. */
size_t gap_split(struct gap_tri *tris, size_t count, struct extent *main);

/* Converts an indexed mesh (3 indices per triangle) to an array of triangles; their `owner` is the triangle's index in the
   mesh. The caller frees the array (mem_free). */
struct gap_tri *gap_tris(const float (*positions_m)[3], const uint32_t *indices, size_t triangle_count);
/* Returns the diagonal of the main part of an indexed mesh. Tolerances and spacings are fractions of this diagonal, so that a stray vertex
   does not change them. */
double gap_main_size(const float (*positions_m)[3], const uint32_t *indices, size_t triangle_count);

#endif
