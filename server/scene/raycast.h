/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The first surface along a ray, as far as it is drawn: on the finest level, without what is hidden, a ghost or cut away, and without
   the backs of one-sided surfaces; where a cut goes through closed bodies (scene/closed_bodies.h), the plane that closes them.
   Clusters of the
   asset file are passed over whole. Thread: any. */
#ifndef SCENE_RAYCAST_H
#define SCENE_RAYCAST_H
#include "scene/scene.h"
#include "scene/visibility.h"

struct ray {
    double origin[3], direction[3]; /* plant frame; a place is origin + t direction */
    double low, high;               /* of t */
    double parallel_m;              /* as camera_parallel_m */
};

struct raycast_hit {
    int asset; /* -1: nothing there; then nothing else is set */
    double t;
    uint32_t corners[3]; /* vertices of the asset file */
    double weights[3];   /* of the corners; together 1; all 0 where a plane closes a body */
    bool inside;         /* of something cut open: the inner side of a surface, or the plane that closes a body */
    double normal[3];    /* plant frame, unit length, towards the ray's origin */
};

/* Through a place of the picture: x and y from -1 to 1, right and up. t is metres along the view. */
void ray_init(struct ray *ray, const struct camera *camera, double aspect, double x, double y);
void raycast(const struct scene *scene, const struct visibility *visibility, const struct ray *ray, struct raycast_hit *hit);

#endif
