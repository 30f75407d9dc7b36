/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the first visible surface along a ray: on the finest level, ignoring hidden, ghosted and cut-away parts and back faces
   of one-sided surfaces. A ray that meets the cut through a closed body (scene/closed_bodies.h) hits the section plane. Skips
   clusters that the ray misses. Call from any thread. */
#ifndef SCENE_RAYCAST_H
#define SCENE_RAYCAST_H
#include "scene/scene.h"
#include "scene/visibility.h"

struct ray {
    double origin[3], direction[3]; /* ray in the plant frame; its points are origin + t direction */
    double low, high;               /* only surfaces where the ray's parameter t is between low and high are found */
    double parallel_m;              /* result of camera_parallel_m(); 0: perspective */
};

struct raycast_hit {
    int asset; /* asset that was hit; -1: no asset was hit, and the other members are not set */
    double t;
    uint32_t corners[3]; /* indices of the hit triangle's vertices in the asset file */
    double weights[3];   /* weights of the triangle's corners at the hit (barycentric, sum 1); all 0 if a section plane was hit */
    bool inside;         /* true: the ray hit the inner side of a cut-open surface, or a section plane */
    double normal[3];    /* unit normal of the surface at the hit, in the plant frame, on the side of the ray's origin */
};

/* Sets up the ray through a point of the picture: x and y from -1 to 1, to the right and up. The ray's parameter t counts metres along the
   view direction. */
void ray_init(struct ray *ray, const struct camera *camera, double aspect, double x, double y);
void raycast(const struct scene *scene, const struct visibility *visibility, const struct ray *ray, struct raycast_hit *hit);

#endif
