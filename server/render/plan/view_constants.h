/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A view's camera, ready to draw with: its matrices, and the planes of what it sees. Plain data. Thread: any. */
#ifndef RENDER_PLAN_VIEW_CONSTANTS_H
#define RENDER_PLAN_VIEW_CONSTANTS_H
#include "render/view.h"
#include "scene/scene.h"

struct view_constants { /* eye space: axes of the plant frame, origin at the camera */
    double eye_m[3];
    double clip_from_eye[16]; /* depth 1 near, 0 far */
    double clip_from_plant[16];
    double pixel_per_radian;
    double pixel_per_metre; /* orthographic; 0: perspective, and so below */
    double back[3];         /* towards the viewer */
    double depth_scale;     /* of depth, in units of what would be the distance in perspective */
    double planes[6][4];    /* of the frustum, inward, plant frame */
};

/* Sets all of it for that view of the scene, whose bounds the near and far planes hold. */
void view_constants_init(struct view_constants *constants, const struct view *view, const struct scene *scene);
/* Narrows the planes to a part of the frame and leaves the matrices as they are. Corners: -1 to 1 over the frame. */
void view_constants_narrow(struct view_constants *constants, const double low[2], const double high[2]);
/* Returns whether the asset's bounds reach into the planes. */
bool view_constants_sees(const struct view_constants *constants, const struct scene_asset *asset);
/* Moves an asset towards the viewer, in clip space, where its faces coincide with others' (scene/coincident.h). */
void view_constants_bring_forward(const struct view_constants *constants, const struct scene_asset *asset, double clip_from_file[16]);

#endif
