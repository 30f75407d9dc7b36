/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Simplifies one part of an asset edge by edge, those first that move the surface least, and knows at each step how far it has moved.
   Thread: any, each its own. */
#ifndef PREPROCESS_LEVELS_BOUNDED_H
#define PREPROCESS_LEVELS_BOUNDED_H
#include "preprocess/levels/levels_impl.h"

struct bounded;

/* Takes a part's triangles (welds, three each), and the surface that they stand for: `places`, welds of it that are looked at, and its
   hierarchy, which outlives this. welds too. */
struct bounded *bounded_create(const struct welds *welds, const uint32_t *corners, size_t count, const uint32_t *places, size_t place_count,
                               const struct bvh *first);
/* Frees it. &NULL is fine; leaves NULL. */
void bounded_destroy(struct bounded **bounded);
/* Collapses edges as long as no place is farther than error_m from the triangles, nor they from the surface, as far as is looked: about,
   not certainly. Open borders and seams stay within half of that. Ask for growing errors. */
void bounded_simplify(struct bounded *bounded, double error_m);
/* How many triangles there are now. */
size_t bounded_count(const struct bounded *bounded);
/* Writes their welds, three each. */
void bounded_read(const struct bounded *bounded, uint32_t *corners);

#endif
