/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which clusters of an asset's triangles a camera, or a tile of its picture, may show. No GL here. */
#ifndef RENDER_PLAN_CULLING_H
#define RENDER_PLAN_CULLING_H
#include "render/plan/view_constants.h"

struct culling { /* one asset, in the frame of its file */
    float planes[6][4];
    float eye_m[3];
    bool cones; /* winding tells what is turned away */
};

void culling_init(struct culling *culling, const struct view_constants *constants, const struct scene_asset *asset);
bool culling_sees(const struct culling *culling, const struct asset_cluster *cluster, bool double_sided);

#endif
