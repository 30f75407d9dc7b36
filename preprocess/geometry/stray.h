/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reports pieces of an asset that lie far from its main part, often by mistake in the CAD model. Call from any thread. */
#ifndef PREPROCESS_GEOMETRY_STRAY_H
#define PREPROCESS_GEOMETRY_STRAY_H
#include "preprocess/geometry/geometry.h"

#define STRAY_TEXT_BYTES 240

/* Writes a text for the report about pieces outside the asset's main part (base/math/gap_split.h): their node, position in the
 * asset frame and distance; "" if there are none. A vertex used only by triangles without area is reported only if it is
 * farther away than the size of the main part. Pass the model and params that the geometry was cut with. */
void stray_text(const struct geometry *geometry, const struct gltf_model *model, const struct geometry_params *params,
                char text[STRAY_TEXT_BYTES]);

#endif
