/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plant with all its assets at their positions, and their sensors. Immutable once made. Thread: any. */
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
    struct asset *file;                      /* prepared file, shared by all instances of the asset */
    double placement[16];                    /* matrix from file coordinates to the plant frame (includes origin_m), column-major */
    double bounds_min_m[3], bounds_max_m[3]; /* plant frame, axis-aligned */
    struct scene_sensor *sensors;            /* sensors of all groups, in the order of the tag list */
    size_t sensor_count;
    bool stray;                         /* true if a piece of the asset is far from the main part (scene/main_part.h) */
    double stray_at_m[3], stray_away_m; /* farthest corner, and its distance to the main part; 0: none */
    char *missing;                      /* why it could not be prepared: it then has no sensors and is invisible; NULL: prepared */
    int front; /* rank where faces of two assets coincide: the asset with the higher value is visible (scene/coincident.h) */
};

struct scene {
    const struct plant *plant;
    char *folder;               /* folder of the prepared files; NULL: the scene was made in memory */
    struct scene_asset *assets; /* by index in plant->assets */
    size_t asset_count;
    double bounds_min_m[3], bounds_max_m[3]; /* of the main part: scene/main_part.h */
    double whole_min_m[3], whole_max_m[3];   /* box of everything; min equal to max: the same as the bounds */
    struct scene_outside {
        size_t triangles; /* outside the main part */
        int assets;       /* assets with such triangles */
        double away_m;    /* distance of the farthest from the main part */
    } outside;
    double (*extremes_m)[3]; /* outermost points that a view of the whole plant has to contain (scene/extremes.h) */
    size_t extreme_count;    /* 0: unknown */
};

/* Chooses the box that near and far planes have to enclose: that of everything, unless a stray piece is so far away that the near plane
   would cut into the main part; then the main part's. */
void scene_depth_box(const struct scene *scene, const double eye_m[3], double min_m[3], double max_m[3]);
/* Returns whether the asset's placement mirrors it, which reverses the winding of triangles. */
bool scene_asset_mirrored(const struct scene_asset *asset);

#endif
