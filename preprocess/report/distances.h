/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast-prep distances`: prints one sensor's distances as a table. Call from one thread only. */
#ifndef PREPROCESS_REPORT_DISTANCES_H
#define PREPROCESS_REPORT_DISTANCES_H
#include "preprocess/pipeline/prepare.h"

/* Prints CSV x,y,z,geodesic_m,euclidean_m for the vertices of a prepared asset (plant frame). Distances are measured from the
 * sensor's point on the surface; `inf` if no path along the surface connects it to the vertex. Returns false with the reason in
 * diag. */
bool distances_print(const struct prepare *prepare, const char *folder, int asset, int tag, FILE *out, struct diag *diag);

#endif
