/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast-prep distances`: one sensor's distances as a table. */
#ifndef PREPROCESS_REPORT_DISTANCES_H
#define PREPROCESS_REPORT_DISTANCES_H
#include "preprocess/pipeline/prepare.h"

/* CSV x,y,z,geodesic_m,euclidean_m at the vertices of a prepared asset, plant frame, both distances from the sensor's place on the
   surface; `inf` where no way leads. False: said in diag. */
bool distances_print(const struct prepare *prepare, const char *folder, int asset, int tag, FILE *out, struct diag *diag);

#endif
