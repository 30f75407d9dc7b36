/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values that follow from a view's camera: matrices and frustum planes. Plain data. Call from any thread. */
#ifndef RENDER_PLAN_VIEW_CONSTANTS_H
#define RENDER_PLAN_VIEW_CONSTANTS_H
#include "render/view.h"
#include "scene/scene.h"

struct view_constants { /* matrices and planes of a view. Eye space has the axes of the plant frame and its origin at the camera */
    double eye_m[3];
    double clip_from_eye[16]; /* matrix from eye space to clip space; clip depth is 1 at the near plane and 0 at the far plane */
    double clip_from_plant[16];
    double pixel_per_radian;
    double pixel_per_metre; /* orthographic cameras; 0: perspective */
    double back[3];         /* orthographic view: unit vector towards the viewer; perspective view: zero */
    /* orthographic view: distance from the near to the far plane, divided by camera_parallel_m() (the viewing distance of an equivalent
       perspective camera); perspective view: 0 */
    double depth_scale;
    double planes[6][4]; /* planes of the view frustum in the plant frame; their normals point inward */
};

/* Computes all constants for a view of the scene. Near and far planes enclose the scene's bounds. */
void view_constants_init(struct view_constants *constants, const struct view *view, const struct scene *scene);
/* Narrows the frustum planes to a rectangle of the frame; the matrices stay unchanged. low, high: corners of the rectangle in normalised
   device coordinates (-1 to 1). */
void view_constants_narrow(struct view_constants *constants, const double low[2], const double high[2]);
/* Returns whether the asset's bounding box intersects the view frustum. */
bool view_constants_sees(const struct view_constants *constants, const struct scene_asset *asset);
/* Shifts an asset's clip-space matrix towards the viewer where its faces coincide with another asset's (scene/coincident.h). */
void view_constants_bring_forward(const struct view_constants *constants, const struct scene_asset *asset, double clip_from_file[16]);

#endif
