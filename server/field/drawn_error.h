/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Error of the drawn field: how far values interpolated between a triangle's corners may be from the field inside it. With
   geodesic distances, errors of the distances count, too: for high powers of shepard, and in triangles where paths from two sides
   meet (at ridges). Preparation subdivides triangles until the error is below one colour step for the plant file's parameters. But
   it may reach its limit of triangles, and a view may use other parameters. So the error is measured for the parameters in use.
   Call from one thread only. */
#ifndef FIELD_DRAWN_ERROR_H
#define FIELD_DRAWN_ERROR_H
#include "base/workers.h"
#include "field/weights.h"

/* Measures, unless already known, how far values interpolated within triangles are from the field. Covers the triangles of the
   level of detail that uses the first `vertices` vertices, and merges the result into weights->errors: for each vertex, the
   largest error of the adjacent triangles. The unit is the spread of the readings for shepard, and the largest reading for
   paper. params and usable are those of weights_create(). in_range: the readings differ by no more than preparation assumed.
   Does nothing if each pixel evaluates the field (plant/exact.h), or if preparation left no error for these parameters, all sensors
   are used and their reach is unlimited. Prepared weights are linear within triangles by definition, so only the border that
   the reach and lost sensors make is measured. Sets weights->errors_unknown when out of memory. */
void drawn_error_measure(struct weights *weights, const struct field_params *params, const uint8_t *usable, size_t vertices, bool in_range,
                         struct workers *workers);
/* A value that depends on the distance to the nearest used sensor alone: SHOW_BLIND and SHOW_DISTANCE. */
struct drawn_near {
    const struct plant_group *group; /* SHOW_BLIND: group of the sensors; NULL: SHOW_DISTANCE */
    float largest_m;                 /* SHOW_DISTANCE: largest distance on the asset, in metres */
};
/* Sets marks[v] to 1 for the corners v of each triangle, on all levels of detail, within which such a value is drawn more than a
   colour step off (SHOW_BLIND: a tenth of the colour scale) if it is interpolated between the corners. Other elements stay. params
   and usable are those of weights_create(). Marks all vertices when out of memory. */
void drawn_error_mark(struct weights *weights, const struct field_params *params, const uint8_t *usable, const struct drawn_near *near,
                      uint8_t *marks, struct workers *workers);
/* Returns the largest change of a value due to errors of distances along the surface, as a multiple of the weighted mean of
   |reading - value|. Returns 0 if these errors change no value noticeably, or if the distances are exact. */
double drawn_error_of_distances(const struct weights *weights);

#endif
