/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Leave-one-out predictions: the value at each sensor's position as predicted by the other good sensors of its group. Uses the
 * first interpolation prepared for the group among gp, harmonic and fin, through the precision P of the prepared sensors: v_i -
 * (P v)_i / P_ii, with v the readings (Dubrule, Cross validation of kriging in a unique neighborhood, 1983); otherwise shepard
 * with geodesic distances. Time and memory grow with the square of the number of sensors, so there are no predictions on an
 * asset with more than NEIGHBOURS_MOST sensors. Call from any thread that may read the scene. */
#ifndef FIELD_NEIGHBOURS_H
#define FIELD_NEIGHBOURS_H
#include "scene/scene.h"
#include "value/snapshot.h"

#define NEIGHBOURS_MOST 512 /* drift.c and the pages state this number in words */

struct neighbour {
    int tag;
    enum interpolation by;
    double value;     /* present reading of the sensor; NaN: the reading is not usable */
    double predicted; /* value predicted from the other sensors; NaN: no other good sensor determines it */
    /* standard deviation of the difference between reading and prediction, if the interpolation is gp (Gaussian process); else
       NaN */
    double deviation;
};

/* The sensors of one group on one asset, for repeated predictions with different readings. */
struct neighbours;
/* Prepares predictions for a group on an asset. Returns NULL if no sensor has a known position. The scene must outlive the
   result, which the caller destroys. */
struct neighbours *neighbours_create(const struct scene *scene, int asset, int group);
void neighbours_destroy(struct neighbours **neighbours); /* frees the object and sets *neighbours to NULL; accepts a pointer to NULL */
size_t neighbours_count(const struct neighbours *neighbours);
/* Returns the index of a sensor's tag in the plant. */
int neighbours_tag(const struct neighbours *neighbours, size_t sensor);
/* Returns the level of the whole field that predictions preserve: if all sensors read this level, each prediction is this
   level, too. That is `ambient` for fin. The other interpolations preserve any level, so 0 is returned. */
double neighbours_level(const struct neighbours *neighbours);
/* Predicts each sensor from the others. values: [sensor]; NaN: not usable. out: [sensor]. */
void neighbours_predict(const struct neighbours *neighbours, const double *values, struct neighbour *out);

/* Lists the sensors nearest to a sensor along the surface, nearest first. Skips sensors whose element of `apart` is not 0, and
   sensors that no path along the surface reaches. out: receives at most `most` sensor indices. Returns their number. */
size_t neighbours_nearest(const struct neighbours *neighbours, size_t sensor, const bool *apart, size_t most, size_t *out);

/* A cache of the latest predictions by asset and group; zero-initialise. The scene must outlive the cache. Call from one thread only. */
struct neighbours_cache {
    struct neighbours_kept {
        /* the sensors of the group on the asset, prepared for predictions; NULL: no such sensor has a known position */
        struct neighbours *of;
        struct neighbour *list; /* predictions, one for each sensor of `of`, in the same order */
        size_t count;
        /* time, on both clocks, of the snapshot from which the predictions were made; 0: none were made yet */
        int64_t taken_mono_ns, taken_utc_ns;
    } * kept;                                /* [asset][group]; NULL: nothing cached yet */
    size_t count;
};
/* Returns the predictions from this snapshot, or from one at most NEIGHBOURS_FRESH_NS older, so that many callers cost only one
   computation a second. Valid until the next call. The scene must be the same in all calls until neighbours_cache_finish(). */
#define NEIGHBOURS_FRESH_NS INT64_C(1000000000)
const struct neighbours_kept *neighbours_look(struct neighbours_cache *cache, const struct scene *scene, int asset, int group,
                                              const struct snapshot *snapshot);
/* Frees the predictions in the cache; the empty cache can be used again. */
void neighbours_cache_finish(struct neighbours_cache *cache);
/* Returns the difference between reading and prediction, in standard deviations. If the deviation is unknown, a twentieth of
   the group's range serves as the unit. NaN: reading or prediction is unknown. */
double neighbour_off(const struct plant *plant, const struct neighbour *neighbour);

#endif
