/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sensors of one group on one asset, and the distances of every vertex from them. Thread: one. */
#ifndef FIELD_LAYOUT_H
#define FIELD_LAYOUT_H
#include "base/workers.h"
#include "field/trials.h"
#include "plant/plant.h"
#include "scene/scene.h"

struct layout_sensor {
    int tag;               /* in plant->tags */
    uint32_t column;       /* in the asset file's sensors; of one that is tried out: its own number, beyond them */
    float surface_m[3];    /* as the file's positions */
    uint32_t vertex;       /* the nearest one */
    bool tried;            /* its distances along the surface are not in the file, but */
    const float *tried_m;  /* these, of each vertex; NULL: not known yet */
    const float *heat_m;   /* of each vertex by the heat method; NULL: not prepared */
    float strength, decay; /* as configured, >= 0 */
};

/* Points inside triangles of the file. */
struct layout_points {
    float (*positions_m)[3];
    uint32_t (*corners)[3]; /* vertices of the file */
    float (*parts)[3];      /* barycentric coordinates */
    float (*away_m)[3];     /* distances from the corners */
};

/* Places a point in a triangle of the file: sets all that `points` has of it. */
void layout_set_point(const struct asset_view *file, const struct layout_points *points, size_t point, const uint32_t corners[3],
                      const float parts[3]);

struct field_layout {
    const struct asset *file;
    const struct plant_group *group;
    uint32_t number;              /* of the group in the plant */
    const struct plant_tag *tags; /* of the plant */
    struct layout_sensor *sensors;
    size_t sensor_count, vertex_count;
    const struct layout_points *points; /* the places that distances are asked for; NULL: the file's vertices */
    bool assumed;       /* the places of all of them are: one of them stands for the whole asset, evenly (field.h) */
    float largest_m[DISTANCES]; /* by distance_mode; 0: not looked for yet */
    uint32_t trial;     /* of which some of the places are; 0: none */
};

/* Builds the layout of a group's sensors on an asset; trial: sensors that are tried out elsewhere (NULL: none). Both scene and trial must
   outlive it. Returns NULL if no sensor of the group is there. */
struct field_layout *layout_create(const struct scene *scene, int asset, int group, const struct trial *trial);
/* Returns whether the trial adds, removes or moves sensors of the group on the asset. */
bool layout_is_touched(const struct scene *scene, int asset, int group, const struct trial *trial);
/* Frees the layout. &NULL is fine; leaves NULL. */
void layout_destroy(struct field_layout **layout);
/* Returns a sensor's distances along the surface by this way of finding them, of each vertex, those of the asset file where they were not
   prepared (sensors that are tried out). NULL: straight ones, or not known yet, or in the asset file. */
const float *layout_along(const struct layout_sensor *sensor, enum distance_mode mode);
/* Returns whether its distances by this way are those of its column in the asset file. */
bool layout_is_in_file(const struct layout_sensor *sensor, enum distance_mode mode);
/* Returns the distances of `count` vertices from `begin` on from one sensor: a pointer to them, or to scratch, which receives them. They
   must be of one block of KERNEL_BLOCK vertices. With layout->points: of these points; along the surface as the corners' distances give it
   in a flat triangle that is reached from one side.
   Straight-line ones start at the sensor's point on the surface, so that both kinds are 0 there; they stand in for geodesic ones that are
   not known yet. */
const float *layout_distances(const struct field_layout *layout, enum distance_mode mode, size_t sensor, size_t begin, size_t count,
                              float *scratch);
/* Returns the largest finite distance of any vertex from any of the sensors, computed once; 1 where all are 0 or infinite. */
float layout_largest(struct field_layout *layout, enum distance_mode mode, struct workers *workers);

#endif
