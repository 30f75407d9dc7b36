/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declarations shared by the files of adaptive subdivision (subdiv*.c). */
#ifndef PREPROCESS_SUBDIVISION_SUBDIVIDE_IMPL_H
#define PREPROCESS_SUBDIVISION_SUBDIVIDE_IMPL_H
#include <math.h>

#include "preprocess/subdivision/subdiv_mesh.h"
#include "preprocess/subdivision/subdivide.h"

/* limit of the interpolation error at the sampled points; a tenth below SUBDIV_ERROR, because errors between these points may be larger */
#define SUBDIV_AIM (0.9 * SUBDIV_ERROR)

struct subdiv {
    const struct subdiv_input *in;
    struct subdiv_mesh mesh;
    const uint32_t *model; /* vertex indices of the original model's triangles (the finest level before subdivision) */
    /* numbers per position: in geodesic_m (one per sensor), and in `interp` (one sample, linear_error.h) */
    size_t sensors, samples;
    /* [position][sensor]: distance along the surface in metres; [position][sample]: weights; NULL: they would take too much memory */
    float *geodesic_m, *interp;
    /* [position][norm]: normalisations of the sensors' weights */
    struct interp_norm *norms;
    size_t geodesic_capacity, share_capacity, norm_capacity, norm_count; /* norm_count: number of normalisations per position */
    uint32_t *part;                                                      /* by position: its connected component */
    struct subdiv_face {
        double normal[3]; /* normal of the triangle, not normalised */
        uint32_t part;
    } * faces; /* by triangle of the original model: normal and connected component */
    size_t part_capacity;
    double size_m;
    /* State of the current level: */
    uint32_t level; /* index of the level of detail being subdivided */
    bool finest;
    double on_surface_m; /* distance in metres from the surface beyond which a point counts as hidden inside another part */
    double error_m, shortest_m, slack_m;
    double jump_m;    /* length in metres below which an edge is not split where the distance along the surface jumps */
    bool finest_full; /* true: the finest level of detail has as many triangles as its limit allows */
    /* true: the current level of detail has almost as many triangles as its limit allows, or would certainly exceed it */
    bool full;
    /* number of triangle blocks in the current sample (subdiv_take_sample()); 0: the whole level of detail is processed */
    size_t sample_blocks;
    double sample_of; /* number of the level's triangles per triangle of the sample */
    /* most_tris: the level's triangle limit; first_count: number of its triangles before vertices were inserted at sensors */
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

/* --- measuring (subdiv_measure.c) --- */

/* The measured interpolation error of one edge or triangle. */
struct subdiv_finding {
    uint32_t number;
    float error, share; /* share: fraction at which splitting the edge leaves the smallest error */
    float barred;       /* interpolation error that splitting cannot fix, as a share of the range */
    bool jumps;
    bool is_cached;   /* true: the error comes from the last run's cache and was not measured again */
    float doubt, off; /* doubt: weight of the sensors changed since the measurement; off: by how much the error may be wrong */
    uint64_t key;     /* the finding's key in the cache of measured errors */
};

/* Writes the connected component of each vertex position to subdiv->part. Returns false if out of memory. */
bool subdiv_find_parts(struct subdiv *subdiv);
/* Sets the connected component of a position added by a split. */
void subdiv_add_place(struct subdiv *subdiv, uint32_t place, uint32_t part);
/* Computes the samples (linear_error.h) at the positions from index `first` on. edges: by position, the edge that it is on, from
 * which its distances are computed first; NULL: the distances are known. */
void subdiv_measure_places(struct subdiv *subdiv, uint32_t first, const uint32_t *edges, size_t count);
/* Measures the interpolation error of edges and stores the results in mesh.cuts (struct subdiv_edge). */
void subdiv_measure_new_edges(struct subdiv *subdiv, struct subdiv_finding *findings, size_t count);
/* Measures the interpolation error inside triangles. */
void subdiv_measure_insides(struct subdiv *subdiv, struct subdiv_finding *findings, size_t count);

/* --- prediction of levels that would grow too large (subdiv_bound.c) --- */

/* Returns whether a coarser level of detail, or the level represented by the current sample, will certainly need more triangles
 * than allowed. Estimates this from the measured errors before the splits are made. */
bool subdiv_will_exceed_bound(const struct subdiv *subdiv);
/* Copies some of a level's triangles to *sample, in blocks of a few consecutive triangles. The caller frees *sample with
 * level_finish(). Returns the number of blocks. */
size_t subdiv_take_sample(struct level *sample, const struct level *level);

/* --- cache (subdiv_cache.c) --- */

/* Returns the cache key for the measured error of the edge or triangle with these corners, or 0 if it is not cached. Call from any
   thread. */
uint64_t subdiv_cache_key(const struct subdiv *subdiv, const uint32_t *corners, size_t count);
/* Looks up the last run's finding (measured error) with this key, if it is still valid despite changed sensors. *next: guess of
 * its index, initially 0; updated for the next call. Returns false if the key is unknown or the finding may be out of date.
 * Call from any thread. */
bool subdiv_cache_find(const struct subdiv *subdiv, uint64_t key, const uint32_t *corners, size_t count, uint32_t *next,
                       struct subdiv_finding *finding);
/* Records a finding (measured error) for the next run, under finding->key. */
void subdiv_cache_add(struct subdiv *subdiv, const struct subdiv_finding *finding);

/* --- edge flips (subdiv_flip.c) --- */

/* Flips edges with an error above `limit` between two triangles if the error along the other diagonal is smaller. The surface
 * may move by at most a small share of the level's error_m. */
void subdiv_flip_edges(struct subdiv *subdiv, double limit);

/* --- sensors (subdiv_sensors.c) --- */

/* Inserts a vertex at each sensor into the current level of detail. error_m: largest distance of the level's surface from the
 * finest level's, metres. */
void subdiv_place_sensors(struct subdiv *subdiv, double error_m);

#endif
