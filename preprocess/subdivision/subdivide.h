/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Adaptive subdivision: splits triangles where linear interpolation of the field (readings interpolated between sensors) would
 * be wrong, and inserts a vertex at each sensor. The finest level shows the field within SUBDIV_ERROR for any readings
 * (linear_error.h). A coarser level, whose surface is up to error_m off, is drawn only where error_m is less than a pixel.
 * Within SUBDIV_ERROR, it shows the field of a point at most about two thirds of error_m away. Within three times SUBDIV_ERROR,
 * it shows that of the point itself. Its surface is unchanged, except that edges in flat regions may be flipped. An edge that a
 * finer level also has and need not split is not measured again. Edges up to an eighth of the model's tolerance (in coarser
 * levels: up to their error) are not split. Edges up to eight tolerances or errors long are not split either if their error
 * comes from a jump of the geodesic distance between unconnected surfaces: no split fixes a jump. Interior triangles (hidden
 * inside another part, in coarser levels with an allowance for their error) and degenerate slivers are ignored. The largest
 * errors are fixed first, and the number of triangles is limited: the finest level may grow to three times its triangles or by
 * 100,000, the larger limit. A coarser level is dropped if it would need more than 0.95 of the next finer level's triangles.
 * The limit is half the triangles if the finest level reached its limit, or with 128 sensors or more, whose distances take up
 * most of a file. Remaining errors are counted by reason (level.left). */
#ifndef PREPROCESS_SUBDIVISION_SUBDIVIDE_H
#define PREPROCESS_SUBDIVISION_SUBDIVIDE_H
#include "preprocess/levels/levels.h"
#include "preprocess/subdivision/distance_rows.h"
#include "preprocess/subdivision/subdiv_cache.h"
#include "preprocess/subdivision/sample_cache.h"
#include "preprocess/subdivision/linear_error.h"
#include "surface/surface.h"

#define SUBDIV_ERROR (1 / 255.0) /* allowed interpolation error as a share of the value range: one step of an 8-bit colour scale */

struct subdiv_input {
    struct linear_error *linear; /* error measure; subdivide_levels() calls linear_error_set_radius() */
    const struct surface *surface;
    const struct surface_field *field; /* distances from the sensors */
    /* the asset's sensors; subdivide_levels() sets the member nearest_vertex of each to the vertex that it inserts at the
       sensor in the finest level */
    struct asset_sensor *sensors;
    struct workers *workers;           /* worker threads; may be NULL */
    struct subdiv_cache *cache;        /* cache of measured errors from earlier runs; zeroed or NULL: nothing is cached */
    struct sample_cache *sample_cache; /* cache of projected sample points; may be NULL */
    /* called for each finished level; may be NULL. The level's content is then final, but its address in `levels` is not. */
    void (*level_done)(void *arg, const struct level *level);
    void *arg;
};

/* Subdivides all levels and computes the distances of all vertices into *distances, which the caller frees. New vertices follow
 * the geometry's own. The faces at an edge are all split at the same vertex, so that a watertight level stays watertight.
 * Levels that would need too many triangles are dropped. Returns false if out of memory, with *distances empty. */
bool subdivide_levels(struct levels *levels, struct geometry *geometry, const struct subdiv_input *input, struct distance_rows *distances);

#endif
