/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Closes hair gaps in the drawn mesh: gaps of a fraction of a millimetre that CAD exports leave between faces and through which
 * the background would be visible. Call from any thread. */
#ifndef PREPROCESS_GEOMETRY_GAPS_H
#define PREPROCESS_GEOMETRY_GAPS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* width of the widest gap that is closed, relative to the diagonal of the asset's main part, which leaves out pieces far from
   the rest (base/math/gap_split.h) */
#define GAPS_OF_SIZE 3e-4
#define GAPS_MOST_M 0.002 /* width of the widest gap that is closed, in metres; the smaller of both limits applies */

/* Closes gaps up to GAPS_OF_SIZE and GAPS_MOST_M: moves the vertices on one side to the open edges on the other side. Two open
 * edges thus become one shared edge. Gaps whose faces overlap stay open. Vertices at the same position move together.
 * tolerance_m: further limit on the gap width; 0: none. Adds the number of moved positions to *closed. Returns false if out of
 * memory. */
bool gaps_close(float (*positions_m)[3], size_t vertex_count, const uint32_t *indices, size_t index_count, double tolerance_m,
                uint32_t *closed);

#endif
