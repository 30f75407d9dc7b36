/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the splitting share. */
#ifndef PREPROCESS_SUBDIVISION_SUBDIVIDE_IMPL_H
#define PREPROCESS_SUBDIVISION_SUBDIVIDE_IMPL_H
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
    bool full;                     /* it may hardly grow any more */
    size_t sample_blocks;          /* while a sample of the level is in hand: blocks of it; else 0 */
    double sample_of;              /* triangles of the level for each of the sample's */
    size_t most_tris, first_count; /* first_count: before sensors were placed */
};

void subdiv_mix(const float a[3], const float b[3], double t, float out[3]);
double subdiv_length(const float a[3], const float b[3]);
const float *subdiv_position(const struct subdiv *subdiv, uint32_t vertex);
bool subdiv_is_short(const struct subdiv *subdiv, double length_m); /* too short to be cut: a piece may not be so short */

/* Over [0, count) on all cores, in pieces of about `grain`. */
void subdiv_parallel(const struct subdiv *subdiv, size_t count, size_t grain, void (*body)(void *arg, size_t begin, size_t end), void *arg);

/* --- measuring (split_measure.c) --- */

struct subdiv_finding { /* about one edge or one triangle */
    uint32_t number;
    float error, share; /* share: where the edge is best cut */
    float barred;       /* the error that cutting may not mend */
    bool jumps;
    bool is_cached;   /* it is of the last time */
    float doubt, off; /* split_kept.h */
};

bool subdiv_find_parts(struct subdiv *subdiv); /* false: out of memory */
void subdiv_add_place(struct subdiv *subdiv, uint32_t place, uint32_t part);
/* Shares at places from `first` on; before that, with `edges`, the distances there too: at which edge each lies. */
void subdiv_measure_places(struct subdiv *subdiv, uint32_t first, const uint32_t *edges, size_t count);
/* Of edges. Errors below `enough` need not be exact, and tell no share. */
void subdiv_measure_edges(struct subdiv *subdiv, struct subdiv_finding *findings, size_t count, double enough);
/* And notes them at the edges. */
void subdiv_measure_new_edges(struct subdiv *subdiv, struct subdiv_finding *findings, size_t count);
/* Of triangles, at their middles. */
void subdiv_measure_insides(struct subdiv *subdiv, struct subdiv_finding *findings, size_t count);

/* --- levels that are no use (split_bound.c) --- */

/* A coarser level, or what its sample stands for, that is sure to come to its bound: this is best known before it is cut that far. */
bool subdiv_will_exceed_bound(const struct subdiv *subdiv);
/* Some of a level's triangles, a few neighbours at a time; to be finished. Returns how many such blocks there are. */
size_t subdiv_take_sample(struct level *sample, const struct level *level);

/* --- keeping (split_kept.c) --- */

/* About an edge or a triangle, by its corners. *next: a guess where it is, 0 at first; then one for what is asked for next. False: it is
   not known, or may no longer hold. */
bool subdiv_cache_find(const struct subdiv *subdiv, const uint32_t *corners, size_t count, uint32_t *next, struct subdiv_finding *finding);
void subdiv_cache_add(struct subdiv *subdiv, const uint32_t *corners, size_t count, const struct subdiv_finding *finding);

/* --- turning (split_turn.c) --- */

/* Has edges that err by more than the limit run between the other corners of their triangles, if the field errs less there and the surface
   stays about where it is. */
void subdiv_flip_edges(struct subdiv *subdiv, double limit);

/* --- sensors (split_sensors.c) --- */

/* A vertex where each sensor stands. */
void subdiv_place_sensors(struct subdiv *subdiv, double error_m);

#endif
