/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the adaptive subdivision (subdiv*.c). */
#ifndef PREPROCESS_SUBDIVISION_SUBDIVIDE_IMPL_H
#define PREPROCESS_SUBDIVISION_SUBDIVIDE_IMPL_H
#include <math.h>

#include "preprocess/subdivision/subdiv_mesh.h"
#include "preprocess/subdivision/subdivide.h"

#define SUBDIV_AIM (0.9 * SUBDIV_ERROR) /* errs the field less at the points looked at, it does by less than SUBDIV_ERROR in between */

struct subdiv {
    const struct subdiv_input *in;
    struct subdiv_mesh mesh;
    const uint32_t *model;                                               /* the finest level's triangles before any is cut: the model's */
    size_t sensors, samples;                                             /* samples: of each place */
    float *geodesic_m, *interp;                                          /* [place][sensor]; [place][sample], or NULL: too many */
    struct interp_norm *norms;                                           /* [place][norm] */
    size_t geodesic_capacity, share_capacity, norm_capacity, norm_count; /* norm_count: of each place */
    uint32_t *part;                                                      /* of each place: what hangs together by edges */
    struct subdiv_face {
        double normal[3]; /* of no certain length */
        uint32_t part;
    } * faces; /* of the model's triangles */
    size_t part_capacity;
    double size_m;
    /* of the level in hand: */
    uint32_t level; /* its number */
    bool finest;
    double on_surface_m; /* what is farther from the surface is hidden inside another part */
    double error_m, shortest_m, slack_m;
    double jump_m;                 /* where a distance jumps, shorter edges are not cut */
    bool finest_full;              /* the finest level ran out of triangles */
    bool full;                     /* it may hardly grow any more */
    size_t sample_blocks;          /* while a sample of the level is in hand: blocks of it; else 0 */
    double sample_of;              /* triangles of the level for each of the sample's */
    size_t most_tris, first_count; /* first_count: before sensors were placed */
};

/* Writes the point at fraction t of the way from a to b. */
static inline void subdiv_mix(const float a[3], const float b[3], double t, float out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (float)((double)a[i] + t * ((double)b[i] - (double)a[i]));
}
/* Returns the distance between two points. */
static inline double subdiv_length(const float a[3], const float b[3])
{
    double x = (double)b[0] - (double)a[0], y = (double)b[1] - (double)a[1], z = (double)b[2] - (double)a[2];
    return sqrt(x * x + y * y + z * z);
}
/* Returns a vertex's position. */
static inline const float *subdiv_position(const struct subdiv *subdiv, uint32_t vertex)
{
    return subdiv->mesh.geometry->positions_m[vertex];
}
/* Returns whether an edge of this length is too short to be cut. */
static inline bool subdiv_is_short(const struct subdiv *subdiv, double length_m)
{
    return length_m < 2 * subdiv->shortest_m;
}

/* Runs body(arg, begin, end) over [0, count) on all cores, in ranges of about `grain`; on the calling thread if there are no workers. */
void subdiv_parallel(const struct subdiv *subdiv, size_t count, size_t grain, void (*body)(void *arg, size_t begin, size_t end), void *arg);

/* --- measuring (subdiv_measure.c) --- */

/* The measured error of one edge or one triangle. */
struct subdiv_finding {
    uint32_t number;
    float error, share; /* share: where the edge is best cut */
    float barred;       /* the error that cutting may not mend */
    bool jumps;
    bool is_cached;   /* it is of the last time */
    float doubt, off; /* subdiv_cache.h */
    uint64_t key;     /* likewise */
};

/* Assigns each position the part (connected component by edges) that it belongs to. Returns false if out of memory. */
bool subdiv_find_parts(struct subdiv *subdiv);
/* Assigns a new position its part. */
void subdiv_add_place(struct subdiv *subdiv, uint32_t place, uint32_t part);
/* Computes the weights at positions from `first` on; with `edges` (the edge that each lies on), first their distances too. */
void subdiv_measure_places(struct subdiv *subdiv, uint32_t first, const uint32_t *edges, size_t count);
/* Measures edges and stores the findings at the edges themselves. */
void subdiv_measure_new_edges(struct subdiv *subdiv, struct subdiv_finding *findings, size_t count);
/* Measures the interpolation error of triangles at their centres. */
void subdiv_measure_insides(struct subdiv *subdiv, struct subdiv_finding *findings, size_t count);

/* --- levels that are no use (subdiv_bound.c) --- */

/* Returns whether a coarser level, or the level that its sample stands for, is certain to need more triangles than it may have. Known
   before the cuts are made. */
bool subdiv_will_exceed_bound(const struct subdiv *subdiv);
/* Copies some of a level's triangles, a few neighbours at a time, into *sample, which the caller finishes (level_finish()). Returns how
   many such blocks there are. */
size_t subdiv_take_sample(struct level *sample, const struct level *level);

/* --- keeping (subdiv_cache.c) --- */

/* Returns the key by which a finding about an edge or triangle with these corners is kept; 0 where none is. Thread: any. */
uint64_t subdiv_cache_key(const struct subdiv *subdiv, const uint32_t *corners, size_t count);
/* Looks up the finding of the last run with that key, if it still holds. *next: a guess of where it is stored, 0 at first; updated for the
   next call. Returns false if it is not known, or may no longer hold. Thread: any. */
bool subdiv_cache_find(const struct subdiv *subdiv, uint64_t key, const uint32_t *corners, size_t count, uint32_t *next,
                       struct subdiv_finding *finding);
/* Records a finding, with its key, for the next run. */
void subdiv_cache_add(struct subdiv *subdiv, const struct subdiv_finding *finding);

/* --- turning (subdiv_flip.c) --- */

/* Flips edges between two triangles whose error exceeds `limit`, where the field errs less along the other diagonal and the surface stays
   about in place. */
void subdiv_flip_edges(struct subdiv *subdiv, double limit);

/* --- sensors (subdiv_sensors.c) --- */

/* Inserts a vertex where each sensor stands. error_m: how far the level's surface may be off. */
void subdiv_place_sensors(struct subdiv *subdiv, double error_m);

#endif
