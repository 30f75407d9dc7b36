/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Adaptive subdivision: cuts triangles where linear interpolation of the field would err, and puts a vertex where each sensor stands.

   The finest level shows the field to SUBDIV_ERROR, whatever the readings are (linear_error.h). A coarser level, whose surface is up to
   error_m off, shows it to SUBDIV_ERROR at a point no farther away than about two thirds of that, and to three times SUBDIV_ERROR in place:
   it is only drawn where error_m is less than a pixel. Its surface stays as it is, except that edges in flat regions may be flipped. An
   edge that a finer level has too, and need not cut, is not measured again.

   Edges no longer than an eighth of the model's tolerance (in coarser levels: than their error) are not cut; nor are, up to eight
   tolerances or errors long, those whose error comes from a jump of the geodesic distance where the surface does not hang together: no cut
   mends a jump. Interior triangles (hidden inside another part, in coarser levels with an allowance for their error) and slivers without
   width do not count.

   The largest errors are cut first, and the number of triangles is bounded: the finest level grows to three times its triangles or by
   100,000, whichever is more; a coarser one that would need more than 0.95 of the next finer one's triangles is given up, and with 128
   sensors or more, whose distances take most of a file, or where the finest level reached its bound, one of more than
   half. What is left is counted by its reason (level.left). */
#ifndef PREPROCESS_SUBDIVISION_SUBDIVIDE_H
#define PREPROCESS_SUBDIVISION_SUBDIVIDE_H
#include "preprocess/levels/levels.h"
#include "preprocess/subdivision/distance_rows.h"
#include "preprocess/subdivision/subdiv_cache.h"
#include "preprocess/subdivision/sample_cache.h"
#include "preprocess/subdivision/linear_error.h"
#include "surface/surface.h"

#define SUBDIV_ERROR (1 / 255.0) /* of the range: a step of colour */

struct subdiv_input {
    struct linear_error *linear; /* its radii are set here */
    const struct surface *surface;
    const struct surface_field *field; /* of the sensors */
    struct asset_sensor *sensors;      /* nearest_vertex becomes the sensor's own vertex of the finest level */
    struct workers *workers;           /* or NULL */
    struct subdiv_cache *cache;        /* from one time to the next; a zeroed one, or NULL: nothing is */
    struct sample_cache *sample_cache; /* or NULL */
    /* Or NULL. Of a level that will not be changed any more; where it begins in `levels` may. */
    void (*level_done)(void *arg, const struct level *level);
    void *arg;
};

/* Subdivides all levels and computes the distances of all vertices into *distances, which the caller finishes. New vertices come after the
   geometry's own; both faces at an edge are cut at the same vertex, so a watertight level stays watertight. Levels that would need too many
   triangles are dropped. Returns false if out of memory, and then there are no distances. */
bool subdivide_levels(struct levels *levels, struct geometry *geometry, const struct subdiv_input *input, struct distance_rows *distances);

#endif
