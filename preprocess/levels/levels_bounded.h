/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Simplifies one part (connected component) of an asset by edge collapses, starting with those that move the surface least, and
 * tracks how far the surface has moved. Call from any thread, each with its own object. */
#ifndef PREPROCESS_LEVELS_BOUNDED_H
#define PREPROCESS_LEVELS_BOUNDED_H
#include "preprocess/levels/levels_impl.h"

struct bounded;

/* Creates a simplifier for a part's triangles, each given by three welds (groups of equal vertices). places: welds of the
 * original surface whose distance from the simplified surface is checked. first: bounding volume hierarchy of the original
 * surface's triangles. `first` and `welds` must outlive the object. */
struct bounded *bounded_create(const struct welds *welds, const uint32_t *corners, size_t count, const uint32_t *places, size_t place_count,
                               const struct bvh *first);
/* Frees the simplifier and sets *bounded to NULL. *bounded may be NULL. */
void bounded_destroy(struct bounded **bounded);
/* Collapses edges while the simplified and the original surface stay within error_m of each other; this is tested at sampled
 * points only, so it is an estimate, not a guarantee. Open borders and seams stay within half of error_m. Successive calls need
 * increasing errors. */
void bounded_simplify(struct bounded *bounded, double error_m);
/* Returns the current number of triangles. */
size_t bounded_count(const struct bounded *bounded);
/* Writes the welds (groups of equal vertices) at the corners of the current triangles, three per triangle. */
void bounded_read(const struct bounded *bounded, uint32_t *corners);

#endif
