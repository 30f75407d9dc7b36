/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The frustum of the sun's shadow map: the smallest one around the assets that cast shadows. Pure; any thread. */
#ifndef RENDER_SUN_FRAME_H
#define RENDER_SUN_FRAME_H
#include "render/gl/gpu_scene.h"

struct sun_frame {
    double clip_from_plant[16]; /* matrix from the plant to the clip space of the shadow map; depth is 1 nearest to the sun, 0 farthest */
    double width_m, depth_m;    /* width_m: length of the frustum's longer side; depth_m: its length along the light's direction */
};

/* Fits the frustum around the shown assets. towards: direction to the sun. margin: space added on every side, as a fraction of the
   width. */
void sun_frame_fit(struct sun_frame *frame, const struct gpu_scene *gpu_scene, const double towards[3], const struct visibility *shown,
                   double margin);

#endif
