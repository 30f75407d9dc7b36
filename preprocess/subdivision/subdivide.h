/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cuts triangles where the field is not straight enough along an edge, and puts a vertex where each sensor stands.

   The finest level shows the field to SUBDIV_ERROR, whatever the readings are (straight.h). A coarser one, whose surface is up to error_m
   off, shows it to SUBDIV_ERROR at a place no farther away than two thirds of that or so, and to three times SUBDIV_ERROR where it is: it is
   only drawn where error_m is less than a pixel. Its surface stays as it is but that edges in flat places may be turned to run the other
   way between two triangles. An edge that a finer level has too, and need not cut, is not looked at.
   Pieces no longer than an eighth of the model's tolerance or, in coarser levels, than their error are not cut; nor, up to eight tolerances
   or errors long, for the field on distances along the surface ones where those jump because the surface does not hang together there: no
   cut mends a jump, cuts only close in on it. What is hidden deep inside another part does not count (a coarser level's surface may stand
   out of one that hides it by less than its error), nor do triangles that have no width; of what stands out of it, what is seen does.
   A level may not grow for ever, so errors are cut in the order of their size: the finest level to three times its triangles or by 100,000,
   whichever is more. A coarser one that would need more than three quarters of the next finer one's triangles is given up.
   What is left is told by its reason (level.left). */
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

/* Levels may be fewer afterwards. New vertices come after the geometry's; both faces at an edge are cut at the same vertex, so a level
   without cracks stays without. distances: of all vertices, to be finished by the caller. False: out of memory, and there are none. */
bool subdivide_levels(struct levels *levels, struct geometry *geometry, const struct subdiv_input *input, struct distance_rows *distances);

#endif
