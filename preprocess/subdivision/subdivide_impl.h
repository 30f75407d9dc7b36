/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of adaptive subdivision (subdiv*.c). */
#ifndef PREPROCESS_SUBDIVISION_SUBDIVIDE_IMPL_H
#define PREPROCESS_SUBDIVISION_SUBDIVIDE_IMPL_H
#include <math.h>

#include "preprocess/subdivision/subdiv_mesh.h"
#include "preprocess/subdivision/subdivide.h"

/* error limit at the sampled points; the reserve of a tenth is for larger errors between these points */
#define SUBDIV_AIM (0.9 * SUBDIV_ERROR)

struct subdiv {
    const struct subdiv_input *in;
    struct subdiv_mesh mesh;
    const uint32_t *model;      /* vertex indices of the original model's triangles (the finest level before subdivision) */
    size_t sensors, samples;    /* array strides per position: sensor count, and count of numbers in a sample (linear_error.h) */
    float *geodesic_m, *interp; /* [position][sensor] distances in metres; [position][sample] weights, or NULL if too large */
    struct interp_norm *norms;  /* [position][norm] */
    size_t geodesic_capacity, share_capacity, norm_capacity, norm_count; /* norm_count: normalisations per position */
    uint32_t *part;                                                      /* by position: its connected component */
    struct subdiv_face {
        double normal[3]; /* not normalised */
        uint32_t part;
    } * faces; /* normals and components, by triangle of the original model */
    size_t part_capacity;
    double size_m;
    /* State of the current level: */
    uint32_t level; /* index of the level */
    bool finest;
    double on_surface_m; /* a point farther than this from the surface is hidden inside another part */
    double error_m, shortest_m, slack_m;
    double jump_m;    /* length in metres; where a distance jumps, shorter edges are not split */
    bool finest_full; /* the finest level reached its triangle limit */
    bool full;        /* the level has almost reached, or would certainly reach, its triangle limit */
    /* count of sampled blocks of triangles while a sample of the level is processed; 0: the whole level is */
    size_t sample_blocks;
    double sample_of; /* number of the level's triangles per triangle of the sample */
    /* triangle limit of the level; first_count: triangles of the level before vertices were inserted at sensors */
    size_t most_tris, first_count;
};

/* Writes the point at fraction t between a and b. */
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
/* Returns whether an edge of this length is too short to split. */
static inline bool subdiv_is_short(const struct subdiv *subdiv, double length_m)
{
    return length_m < 2 * subdiv->shortest_m;
}

/* Runs body(arg, begin, end) over [0, count) on all cores, in ranges of about `grain`; on the calling thread if there are no workers. */
void subdiv_parallel(const struct subdiv *subdiv, size_t count, size_t grain, void (*body)(void *arg, size_t begin, size_t end), void *arg);

/* --- measuring (subdiv_measure.c) --- */

/* The measured error of one edge or triangle. */
struct subdiv_finding {
    uint32_t number;
    float error, share; /* share: the best fraction at which to split the edge */
    float barred;       /* error, as a share of the range, that no split may fix */
    bool jumps;
    bool is_cached;   /* the finding was taken from the last run's cache, not measured */
    float doubt, off; /* see subdiv_cache.h */
    uint64_t key;     /* cache key */
};

/* Writes the connected component of each position to subdiv->part. Returns false if out of memory. */
bool subdiv_find_parts(struct subdiv *subdiv);
/* Sets the connected component of a new position. */
void subdiv_add_place(struct subdiv *subdiv, uint32_t place, uint32_t part);
/* Computes the weights at positions from `first` on. With `edges` (the edge that each position is on) computes their distances first. */
void subdiv_measure_places(struct subdiv *subdiv, uint32_t first, const uint32_t *edges, size_t count);
/* Measures edges and stores the results at the edges themselves. */
void subdiv_measure_new_edges(struct subdiv *subdiv, struct subdiv_finding *findings, size_t count);
/* Measures the interpolation error inside triangles. */
void subdiv_measure_insides(struct subdiv *subdiv, struct subdiv_finding *findings, size_t count);

/* --- levels that would grow too large (subdiv_bound.c) --- */

/* Returns whether a coarser level, or the level that the current sample represents, will certainly need more triangles than allowed.
 * Estimated from the measured errors, before the splits are made. */
bool subdiv_will_exceed_bound(const struct subdiv *subdiv);
/* Copies some of a level's triangles, in blocks of a few neighbours, into *sample, which the caller frees (level_finish()). Returns the
 * number of blocks. */
size_t subdiv_take_sample(struct level *sample, const struct level *level);

/* --- cache (subdiv_cache.c) --- */

/* Returns the cache key of a finding about the edge or triangle with these corners, or 0 if it is not cached. Thread: any. */
uint64_t subdiv_cache_key(const struct subdiv *subdiv, const uint32_t *corners, size_t count);
/* Looks up the last run's finding with this key, if it still holds. *next: guess of its index, initially 0; updated for the next call.
 * Returns false if it is unknown or may no longer hold. Thread: any. */
bool subdiv_cache_find(const struct subdiv *subdiv, uint64_t key, const uint32_t *corners, size_t count, uint32_t *next,
                       struct subdiv_finding *finding);
/* Records a finding, with its key, for the next run. */
void subdiv_cache_add(struct subdiv *subdiv, const struct subdiv_finding *finding);

/* --- edge flips (subdiv_flip.c) --- */

/* Flips edges between two triangles with an error above `limit`, if the error along the other diagonal is smaller and the surface stays
 * about in place. */
void subdiv_flip_edges(struct subdiv *subdiv, double limit);

/* --- sensors (subdiv_sensors.c) --- */

/* Inserts a vertex at each sensor. error_m: largest distance of the level's surface from the finest level's. */
void subdiv_place_sensors(struct subdiv *subdiv, double error_m);

#endif
