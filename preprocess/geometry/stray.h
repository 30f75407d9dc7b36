/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names the pieces of an asset that lie far from its main part. Thread: any. */
#ifndef PREPROCESS_GEOMETRY_STRAY_H
#define PREPROCESS_GEOMETRY_STRAY_H
#include "preprocess/geometry/geometry.h"

#define STRAY_TEXT_BYTES 240

/* Writes which node has pieces outside the main part of the asset (gap_split.h), where in the asset frame and how far away, for the
   report; "" if there are none. A vertex that only triangles without area use is named where it lies farther away than the main part is
   large. model and params: those that the geometry was cut with. */
void stray_text(const struct geometry *geometry, const struct gltf_model *model, const struct geometry_params *params,
                char text[STRAY_TEXT_BYTES]);

#endif
