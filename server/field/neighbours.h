/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Predicted without it: what the other good sensors of a group say at each sensor's place (leave-one-out). By the first of these that is
   prepared for the group: gp, harmonic, fin, from the precision P of the prepared sensors, v_i - (P v)_i / P_ii (Dubrule, Cross validation
   of kriging in a unique neighborhood, 1983); else by shepard from distances along the surface. Takes (sensors * sensors) steps, and as
   many numbers are kept: of more than NEIGHBOURS_MOST sensors on an asset nothing is said. Thread: any that may read the scene. */
#ifndef FIELD_NEIGHBOURS_H
#define FIELD_NEIGHBOURS_H
#include "scene/scene.h"
#include "value/snapshot.h"

#define NEIGHBOURS_MOST 512

struct neighbour {
    int tag;
    enum interpolation by;
    double value;     /* its reading; NaN: it cannot be used now */
    double predicted; /* NaN: no other good sensor says anything about its place */
    double deviation; /* gp: by how much reading and prediction may differ, standard deviation; else NaN */
};

/* The sensors of one group on one asset, to be asked again and again with other values. */
struct neighbours;
/* Returns NULL if there are none whose places are known. The scene must outlive it; the caller destroys it. */
struct neighbours *neighbours_create(const struct scene *scene, int asset, int group);
void neighbours_destroy(struct neighbours **neighbours); /* &NULL is fine; leaves NULL */
size_t neighbours_count(const struct neighbours *neighbours);
/* Returns the tag of a sensor. */
int neighbours_tag(const struct neighbours *neighbours, size_t sensor);
/* Returns what is said where all sensors read it: `ambient` by fin; 0 by the others, which say so of any value. */
double neighbours_level(const struct neighbours *neighbours);
/* Says what the others say of each sensor. values: by sensor; NaN: it cannot be used. out: by sensor. */
void neighbours_predict(const struct neighbours *neighbours, const double *values, struct neighbour *out);

/* Lists the sensors nearest to one along the surface, the nearest first, without those that stand apart ([sensor]); not those that no way
   leads to. out: room for `most`. Returns their number. */
size_t neighbours_nearest(const struct neighbours *neighbours, size_t sensor, const bool *apart, size_t most, size_t *out);

/* The latest predictions for each asset and group; zero-initialise. The scene must outlive the cache. Thread: one. */
struct neighbours_cache {
    struct neighbours_kept {
        struct neighbours *of; /* NULL: the group has no sensor with a known position on the asset */
        struct neighbour *list; /* predictions by sensor, in the order of `of` */
        size_t count;
        int64_t taken_mono_ns, taken_utc_ns; /* the snapshot; 0: none yet */
    } * kept; /* [asset][group]; NULL: none yet */
    size_t count;
};
/* Returns the predictions from this snapshot, or from one at most NEIGHBOURS_FRESH_NS older, so that many callers cost one computation a
   second. Valid until the next call. The scene must be the same in all calls until neighbours_cache_finish(). */
#define NEIGHBOURS_FRESH_NS INT64_C(1000000000)
const struct neighbours_kept *neighbours_look(struct neighbours_cache *cache, const struct scene *scene, int asset, int group,
                                              const struct snapshot *snapshot);
/* Frees what is kept; leaves an empty cache. */
void neighbours_cache_finish(struct neighbours_cache *cache);
/* Returns by how many deviations a reading is off what the others say; where these are not known, of a twentieth of the group's range.
   NaN: not known. */
double neighbour_off(const struct plant *plant, const struct neighbour *neighbour);

#endif
