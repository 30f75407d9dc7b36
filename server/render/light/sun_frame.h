/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the sun's map shows: as little around what throws shadows as it can. Any thread. */
#ifndef RENDER_SUN_FRAME_H
#define RENDER_SUN_FRAME_H
#include "render/gl/gpu_scene.h"

struct sun_frame {
    double clip_from_plant[16]; /* depth 1 nearest to the sun, 0 farthest */
    double width_m, depth_m;    /* of the larger side; along the light */
};

/* margin: around it, as a part of its width. */
void sun_frame_fit(struct sun_frame *frame, const struct gpu_scene *gpu_scene, const double towards[3], const struct visibility *shown,
                   double margin);

#endif
