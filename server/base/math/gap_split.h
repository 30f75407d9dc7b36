/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tells the main part of a model or plant from stray pieces, such as a vertex left at the origin of survey coordinates.
   Rule: a gap is an interval along one axis without any corner of a triangle. Pieces behind a gap are stray if all pieces left out have at
   most 2 % of the area and the gap is at least as long as the main part is large, or if the gap is at least 100 times as long, whatever
   their area. A triangle that crosses such a gap is stray, too. The main part is the side of larger area.
   A plain "what 98 % of the area covers" would crop flare stacks, pipe racks and tanks at the edge of a plant, which have less than 2 % of
   the area but stand next to the rest. It would also keep a stray box that has a third of the area of a small model 7,000 km away.
   Thread: any. */
#ifndef BASE_MATH_GAP_SPLIT_H
#define BASE_MATH_GAP_SPLIT_H
#include <stddef.h>
#include <stdint.h>

#include "base/math/extent.h"

struct gap_tri {
    double at[3][3], area_m2;
    uint32_t owner; /* for the caller */
};

/* Moves triangles of the main part to the front. Returns how many they are; *main receives their extent. */
size_t gap_split(struct gap_tri *tris, size_t count, struct extent *main);

#endif
