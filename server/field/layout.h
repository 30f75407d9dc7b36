/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sensors of one group on one asset, and their distances from all vertices. Call from one thread only. */
#ifndef FIELD_LAYOUT_H
#define FIELD_LAYOUT_H
#include "base/workers.h"
#include "field/trials.h"
#include "plant/plant.h"
#include "scene/scene.h"

struct layout_sensor {
    int tag;               /* index in plant->tags */
    /* index of the sensor in the asset file; sensors on trial that the file lacks have the indices after those of the file's
       sensors */
    uint32_t column;
    float surface_m[3];    /* position of the sensor in metres, in the coordinates of the asset file */
    uint32_t vertex;       /* index of the asset file's vertex that is nearest to the sensor */
    /* true: a user is trying out the sensor's position, so its geodesic distances are in tried_m instead of the file */
    bool tried;
    const float *tried_m;  /* [vertex]: geodesic distance in metres from the position that a user is trying out; NULL: not computed yet */
    /* by vertex: distance from the sensor in metres along the surface, computed by the heat method; NULL: plantcast-prep has
       not computed heat distances for this group */
    const float *heat_m;
    float strength, decay; /* as configured, >= 0 */
};

/* Points at which distances from the sensors are wanted, each inside a triangle of the asset file. */
struct layout_points {
    float (*positions_m)[3];
    uint32_t (*corners)[3]; /* [point]: indices of the vertices at the three corners of the triangle that contains the point */
    float (*parts)[3];      /* [point]: barycentric coordinates of the point in its triangle */
    float (*away_m)[3];     /* [point]: straight-line distances in metres from the point to the three corners of its triangle */
};

/* Stores one point in element `point` of every array of `points`: the triangle's corners, the barycentric coordinates `parts`,
   the position, and the straight-line distances to the corners. file: the asset file with the vertices. */
void layout_set_point(const struct asset_view *file, const struct layout_points *points, size_t point, const uint32_t corners[3],
                      const float parts[3]);

struct field_layout {
    const struct asset *file;
    const struct plant_group *group;
    uint32_t number;              /* index of the group of sensors in the plant's groups */
    const struct plant_tag *tags; /* the plant's tags */
    struct layout_sensor *sensors;
    size_t sensor_count, vertex_count;
    const struct layout_points *points; /* points whose distances are wanted; NULL: the vertices of the asset file */
    bool assumed; /* true: all sensor positions are assumed, so one sensor gives the value of the whole asset (field.h) */
    float largest_m[DISTANCES]; /* [enum distance_mode]: largest distance in metres between a vertex and a sensor; 0: not computed yet */
    /* id of the trial, a set of positions that a user tries out, that moved some of these sensors (field/trials.h); 0: none */
    uint32_t trial;
};

/* A layout for one point of the surface instead of the asset's vertices. Its pointers lead into the struct itself, so it must
   not be copied or moved. */
struct layout_point {
    float position_m[1][3], parts[1][3], away_m[1][3];
    uint32_t corners[1][3];
    struct layout_points points;
    struct field_layout layout;
};

/* Creates the layout of a group's sensors on an asset. trial: moved sensors; NULL: none. Scene and trial must outlive the
   layout. Returns NULL if no sensor of the group is on the asset. */
struct field_layout *layout_create(const struct scene *scene, int asset, int group, const struct trial *trial);
/* Removes the sensors that have no effect on the field: with the interpolation shepard, those of strength 0. */
void layout_remove_ineffective(struct field_layout *layout, enum interpolation interpolation);
/* Returns true if the trial (set of sensor positions that a user tries out) adds, removes or moves a sensor of this group on
   this asset. */
bool layout_is_touched(const struct scene *scene, int asset, int group, const struct trial *trial);
/* Frees the layout (the sensors of a group on an asset, and their distances). Accepts a pointer to NULL; sets the pointer to
   NULL. */
void layout_destroy(struct field_layout **layout);
/* Returns each vertex's geodesic distance from a sensor, in this mode (along triangles or by the heat method). If that mode was
   not prepared (trial sensors), returns the distances of the other geodesic mode. NULL: the mode is straight-line, or the
   distances are in the asset file or not known yet. */
const float *layout_along(const struct layout_sensor *sensor, enum distance_mode mode);
/* Returns true if renderers evaluate the sum over the sensors at each pixel, rather than interpolate between vertices (plant/exact.h). */
bool layout_is_exact(const struct field_layout *layout, enum interpolation interpolation, enum distance_mode mode);
/* Returns true if the sensor's distances are read from the asset file, false if they are in memory or computed as straight
   lines. mode: geodesic, straight-line or heat-method distances. */
bool layout_is_in_file(const struct layout_sensor *sensor, enum distance_mode mode);
/* Returns the distances from one sensor to `count` vertices, from vertex `begin` on: a pointer to them, or to `scratch`, which
   receives them. The vertices must be in one block of KERNEL_BLOCK vertices (kernels.h). If layout->points is set, returns the
   distances of these points instead. A point's geodesic distance (along the surface) follows from those of the three corners of
   its triangle, as if the path from the sensor entered the triangle at one side. Straight-line distances start at the sensor's
   surface point, so that both kinds are 0 there; they replace geodesic distances that are not known yet. */
const float *layout_distances(const struct field_layout *layout, enum distance_mode mode, size_t sensor, size_t begin, size_t count,
                              float *scratch);
/* Initialises the layout for one point, given by its triangle's corners and its barycentric coordinates there. `layout`, whose
   sensors the point uses, must outlive it. Nothing needs freeing. */
void layout_point_init(struct layout_point *point, const struct field_layout *layout, const uint32_t corners[3], const float parts[3]);
/* Returns the largest finite distance between a vertex of the asset and a sensor, computed once; 1 if all are 0 or infinite, so
   that callers can divide by it. */
float layout_largest(struct field_layout *layout, enum distance_mode mode, struct workers *workers);

#endif
