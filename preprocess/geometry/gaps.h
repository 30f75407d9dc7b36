/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Closes hair gaps in what is drawn: faces that exports leave a fraction of a millimetre apart, so that pixels of what is behind show
   between them. Thread: any. */
#ifndef PREPROCESS_GEOMETRY_GAPS_H
#define PREPROCESS_GEOMETRY_GAPS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define GAPS_OF_SIZE 3e-4   /* of the diagonal of the box around it all: no wider gap is a hair gap, */
#define GAPS_MOST_M 0.002   /* nor one that is wider than that */

/* Moves vertices at open edges to others at open edges across a gap that is no wider than that, unless their faces lie on each other: then
   what were two edges has both faces. All vertices at one place are moved together. tolerance_m: no wider gap is closed, either; 0: there
   is no such limit. Adds the number of places moved to *closed. Returns false if out of memory. */
bool gaps_close(float (*positions_m)[3], size_t vertex_count, const uint32_t *indices, size_t index_count, double tolerance_m,
                uint32_t *closed);

#endif
