/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plant as it stands: every asset in its place, with its sensors. Immutable once made. Thread: any. */
#ifndef SCENE_SCENE_H
#define SCENE_SCENE_H
#include <stdbool.h>
#include <stddef.h>

#include "plant/plant.h"
#include "scene/asset.h"
#include "scene/camera.h"

struct scene_sensor {
    int tag;              /* index in plant->tags */
    int column;           /* index in the asset file's sensors */
    double position_m[3]; /* plant frame, as configured */
    double surface_m[3];  /* plant frame, on the surface */
    double surface_distance_m;
};

struct scene_asset {
    const struct plant_asset *plant;
    struct asset *file;                      /* instances share one */
    double placement[16];                    /* plant from file positions (origin_m taken in), column-major */
    double bounds_min_m[3], bounds_max_m[3]; /* plant frame, axis-aligned */
    struct scene_sensor *sensors;            /* of every group, in the order of the tag list */
    size_t sensor_count;
    bool stray;    /* some of it is far from the main part (scene/main_part.h) */
    double stray_at_m[3], stray_away_m; /* its farthest corner, and the distance to the main part; 0: none */
    char *missing; /* why it could not be prepared: it has no sensors, and nothing of it is seen; NULL: it is there */
    int front;     /* where faces of two assets coincide, the greater one is seen: scene/coincident.h */
};

struct scene {
    const struct plant *plant;
    char *folder;               /* of the prepared files; NULL: it was made here */
    struct scene_asset *assets; /* by index in plant->assets */
    size_t asset_count;
    double bounds_min_m[3], bounds_max_m[3]; /* of the main part: scene/main_part.h */
    double whole_min_m[3], whole_max_m[3];   /* of everything; equal: as the bounds */
    struct scene_outside {
        size_t triangles; /* outside the main part */
        int assets;       /* that they belong to */
        double away_m;    /* how far the farthest is from it */
    } outside;
    double (*extremes_m)[3]; /* outermost places of what a view of the whole has to hold: scene/extremes.h */
    size_t extreme_count;    /* 0: not known */
};

/* Chooses the box that a camera's near and far planes have to hold: that of everything, unless a stray piece is so far away that the near
   plane would cut the main part; then the main part's. */
void scene_depth_box(const struct scene *scene, const double eye_m[3], double min_m[3], double max_m[3]);
/* Returns whether the placement mirrors: the winding of triangles is turned round. */
bool scene_asset_mirrored(const struct scene_asset *asset);

#endif
