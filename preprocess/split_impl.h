/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the splitting share. */
#ifndef PREPROCESS_SPLIT_IMPL_H
#define PREPROCESS_SPLIT_IMPL_H
#include "preprocess/cutmesh.h"
#include "preprocess/split.h"

#define SPLIT_AIM (0.9 * SPLIT_ERROR) /* errs the field less at the points looked at, it does by less than SPLIT_ERROR in between */

struct split {
    const struct split_input *in;
    struct cutmesh mesh;
    const uint32_t *model;      /* the finest level's triangles before any is cut: the model's */
    size_t sensors, samples;    /* samples: of each place */
    float *geodesic_m, *shares; /* [place][sensor]; [place][sample], or NULL: too many */
    struct shares_norm *norms;  /* [place][norm] */
    size_t geodesic_capacity, share_capacity, norm_capacity, norm_count; /* norm_count: of each place */
    uint32_t *part; /* of each place: what hangs together by edges */
    struct split_face {
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
    double jump_m; /* where a distance jumps, shorter edges are not cut */
    bool full;                     /* it may hardly grow any more */
    size_t sample_blocks; /* while a sample of the level is in hand: blocks of it; else 0 */
    double sample_of;     /* triangles of the level for each of the sample's */
    size_t most_tris, first_count; /* first_count: before sensors were placed */
};

void split_mix(const float a[3], const float b[3], double t, float out[3]);
double split_length(const float a[3], const float b[3]);
const float *split_position(const struct split *split, uint32_t vertex);
bool split_is_short(const struct split *split, double length_m); /* too short to be cut: a piece may not be so short */

/* Over [0, count) on all cores, in pieces of about `grain`. */
void split_for_all(const struct split *split, size_t count, size_t grain, void (*body)(void *arg, size_t begin, size_t end), void *arg);

/* --- measuring (split_measure.c) --- */

struct split_finding { /* about one edge or one triangle */
    uint32_t number;
    float error, share; /* share: where the edge is best cut */
    float barred;       /* the error that cutting may not mend */
    bool jumps;
    bool kept;        /* it is of the last time */
    float doubt, off; /* split_kept.h */
};

bool split_find_parts(struct split *split); /* false: out of memory */
void split_add_place(struct split *split, uint32_t place, uint32_t part);
/* Shares at places from `first` on; before that, with `edges`, the distances there too: at which edge each lies. */
void split_measure_places(struct split *split, uint32_t first, const uint32_t *edges, size_t count);
/* Of edges. Errors below `enough` need not be exact, and tell no share. */
void split_measure_edges(struct split *split, struct split_finding *findings, size_t count, double enough);
/* And notes them at the edges. */
void split_measure_new_edges(struct split *split, struct split_finding *findings, size_t count);
/* Of triangles, at their middles. */
void split_measure_insides(struct split *split, struct split_finding *findings, size_t count);

/* --- levels that are no use (split_bound.c) --- */

/* A coarser level, or what its sample stands for, that is sure to come to its bound: this is best known before it is cut that far. */
bool split_comes_to_bound(const struct split *split);
/* Some of a level's triangles, a few neighbours at a time; to be finished. Returns how many such blocks there are. */
size_t split_take_sample(struct level *sample, const struct level *level);

/* --- keeping (split_kept.c) --- */

/* About an edge or a triangle, by its corners. *next: a guess where it is, 0 at first; then one for what is asked for next. False: it is
   not known, or may no longer hold. */
bool split_recall(const struct split *split, const uint32_t *corners, size_t count, uint32_t *next, struct split_finding *finding);
void split_remember(struct split *split, const uint32_t *corners, size_t count, const struct split_finding *finding);

/* --- turning (split_turn.c) --- */

/* Has edges that err by more than the limit run between the other corners of their triangles, if the field errs less there and the surface
   stays about where it is. */
void split_turn_edges(struct split *split, double limit);

/* --- sensors (split_sensors.c) --- */

/* A vertex where each sensor stands. */
void split_place_sensors(struct split *split, double error_m);

#endif
