/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far off the levels of detail of a picture may be. The finest level shows the field to a step of colour; a coarser one shows it as
   true as its surface lies, so that at some pixels it is some steps off. So pictures with room for more triangles are drawn truer than what
   is seen of shapes would need. Thread: any. */
#ifndef RENDER_PLAN_LOD_SELECTION_H
#define RENDER_PLAN_LOD_SELECTION_H
#include "render/frame_context.h"

/* In pixels; 0: the finest level of everything. The same for all tiles of a picture; it depends on the camera and on what is in sight only,
   so that equal views are equal pictures. */
double lod_error_px(const struct frame_context *context);
/* The coarsest level of an asset that errs by no more than that; 0: the finest. */
const struct model_level *lod_level(const struct frame_context *context, int asset, double error_px);

#endif
