/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plant with all its assets at their positions, and their sensors. Immutable once made. Call from any thread. */
#ifndef SCENE_SCENE_H
#define SCENE_SCENE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "plant/plant.h"
#include "scene/asset.h"
#include "scene/camera.h"

struct scene_sensor {
    int tag;              /* index of the sensor's tag in plant->tags */
    int column;           /* index of the sensor among the sensors of the asset file */
    double position_m[3]; /* position of the sensor as configured, in the plant frame */
    double surface_m[3];  /* nearest point on the asset's surface, in the plant frame */
    double surface_distance_m;
};

struct scene_asset {
    const struct plant_asset *plant;
    struct asset *file;                      /* prepared file, shared by all assets that use the same file */
    double placement[16];                    /* matrix from file coordinates to the plant frame (includes origin_m), column-major */
    double bounds_min_m[3], bounds_max_m[3]; /* axis-aligned bounding box in the plant frame */
    struct scene_sensor *sensors;            /* sensors of all groups on this asset, in the order of the tag list */
    size_t sensor_count;
    bool stray; /* true if a piece of the asset is far from the main part (scene/main_part.h) */
    /* stray_at_m: position of the asset's farthest corner outside the main part; stray_away_m: its distance from the main part,
       0: no corner is outside */
    double stray_at_m[3], stray_away_m;
    /* reason why the asset could not be prepared; it then has no sensors and is invisible; NULL: it was prepared */
    char *missing;
    int front; /* rank where faces of two assets coincide: the asset with the higher rank is visible (scene/coincident.h) */
};

struct scene {
    const struct plant *plant;
    char *folder;               /* folder of the prepared files; NULL: the scene was made in memory */
    /* hash of the model files of all assets, with all files that affect the pictures, when they were prepared. Nodes that show
       the same models have equal hashes */
    uint64_t models_hash;
    struct scene_asset *assets; /* assets of the plant, by index in plant->assets */
    size_t asset_count;
    double bounds_min_m[3], bounds_max_m[3]; /* bounding box of the main part (scene/main_part.h), in the plant frame */
    /* bounding box of all assets including stray pieces (scene/main_part.h), in the plant frame; whole_min_m equal to
       whole_max_m: the same box as bounds_min_m, bounds_max_m */
    double whole_min_m[3], whole_max_m[3];
    struct scene_outside {
        size_t triangles; /* number of triangles outside the plant's main part (scene/main_part.h) */
        int assets;       /* number of assets that have triangles outside the plant's main part */
        double away_m;    /* distance in metres of the farthest triangle from the plant's main part */
    } outside;
    double (*extremes_m)[3]; /* outermost points, which a view of the whole plant must contain (scene/extremes.h) */
    size_t extreme_count;    /* number of points in extremes_m; 0: the outermost points are not known */
};

/* Chooses the box that the camera's near and far planes must enclose: normally the box of everything. If a stray piece (far
   from the rest of the plant) would move the near plane so far that it cuts into the plant's main part, chooses the main part's
   box instead. */
void scene_depth_box(const struct scene *scene, const double eye_m[3], double min_m[3], double max_m[3]);
/* Returns whether the asset's placement mirrors it and so reverses the winding of its triangles. */
bool scene_asset_mirrored(const struct scene_asset *asset);

#endif
