/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Culling of triangle clusters for a frame or one tile of a frame: those outside the frustum, and those all of whose triangles
   face away (normal cone). Uses no GL. */
#ifndef RENDER_PLAN_CULLING_H
#define RENDER_PLAN_CULLING_H
#include "render/plan/view_constants.h"

struct culling { /* frustum planes and eye position, in the coordinates of one asset's file */
    float planes[6][4];
    float eye_m[3];
    bool cones; /* true: the asset's triangles are wound consistently, so back faces are recognised and normal cones may be used */
};

void culling_init(struct culling *culling, const struct view_constants *constants, const struct scene_asset *asset);
bool culling_sees(const struct culling *culling, const struct asset_cluster *cluster, bool double_sided);

#endif
