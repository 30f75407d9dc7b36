/* SPDX-License-Identifier: GPL-3.0-or-later */
/* G of the linear form: what each usable sensor weighs at each vertex, for one set of parameters and one set of usable sensors.
   Nothing in it depends on readings, so instances of one asset and sessions with equal parameters share it. The columns of G may be kept
   or made anew for each sum; the sums are bit for bit the same. Thread: one, but weights_prepare and weights_add may run on
   different vertices at once. */
#ifndef FIELD_WEIGHTS_H
#define FIELD_WEIGHTS_H
#include "field/params.h"
#include "field/influence_fill.h"
#include "field/kernels.h"
#include "field/layout.h"

enum sensor_use {
    SENSOR_LOST, /* takes no part; its place has no data */
    SENSOR_USED,
    SENSOR_NO_LIMITS, /* takes no part, but its place is known to be well measured */
    SENSOR_ASIDE      /* takes no part, as if it were not there: another stands for the asset */
};

/* How the nearest sensors stand to a vertex. */
enum place {
    PLACE_GOOD,     /* the nearest configured sensor is usable and within reach */
    PLACE_LOST,     /* it is not usable; another one is within reach */
    PLACE_NOBODY,   /* no usable sensor within reach */
    PLACE_NO_LIMITS /* the nearest one within reach is SENSOR_NO_LIMITS */
};

enum weights_known { KNOWN_NEAR = 1, KNOWN_TOP = 2, KNOWN_TOTAL = 4 }; /* near_m and place; top; total */

struct weights_key { /* what G depends on, as bytes */
    void *bytes;
    size_t count;
    uint64_t hash;
};

enum { WEIGHTS_ERRING = 9 }; /* 2^-8 is a step of colour */

struct weights {
    struct weights_key key;
    const struct field_layout *layout;
    enum interpolation interpolation;
    enum distance_mode distance;
    float power, reach_m, radius_m, steps_per_m; /* steps: of `lacking` */
    bool alike;                                  /* all members have one strength */
    float *strength, *decay;                     /* by sensor of the layout */
    uint8_t *configured;                         /* by sensor of the layout: may take part, were it good; more than 1: SENSOR_NO_LIMITS */
    uint8_t *takes_part;                         /* by sensor of the layout: it is used */
    uint32_t *members;                           /* used sensors of the layout; a column's number is its place here. Prepared: all */
    size_t member_count;
    float *near_m, *top;         /* by vertex: distance of the nearest usable sensor; scale (kernels.h) */
    float *total;                /* by vertex: the weights' sum */
    uint8_t *place;              /* by vertex: enum place */
    uint8_t *lost;               /* by vertex: how far nearer the nearest lost sensor is than near_m, as weights_lacking */
    uint8_t *known;              /* by block: bits of enum weights_known, what is filled of the four above */
    const float *prepared;       /* [member][vertex]: columns from the asset's influence file; NULL: made from distances */
    struct influence_fill *fill; /* prepared, and some sensor is lost; else NULL */
    double *ones;                /* prepared, by sensor: what 1 of all used ones makes of each; else NULL */
    float decay_m;               /* fin; gp: 1/k of its kernel */
    const float *deviations;     /* gp, by vertex: how far the field may err while all sensors are used; else NULL */
    const float *priors;         /* gp, by vertex: how far it would without any */
    float deviation;             /* gp: that of the prior */
    float *errors;               /* by vertex: linear interpolation error of the triangles around it (drawn_error.h); NULL: not measured */
    float largest_error;         /* the largest of them */
    float erring[WEIGHTS_ERRING]; /* [b]: share of a level's surface whose error is at least 2^-b; of the level that has most.
                                     Prepared: share of the vertices */
    uint64_t measured_levels;    /* levels of detail that are in them, by bits */
    unsigned errors_version;     /* counts their changes */
    float *beyond_m;             /* fin, gp, by vertex: how far beyond the rim of what sensors know; else NULL */
    float *columns; /* [block][member][KERNEL_BLOCK] of the first kept_blocks, or NULL; of others they are made anew each time */
    uint8_t *kept;  /* [block][member]: its column is filled; beside columns */
    size_t kept_blocks;
    int users;           /* states that hold it */
    uint64_t used, sums; /* tick of the last use; how often it was summed */
    struct weights *next;
};

/* Computes the key of everything that G depends on. usable: enum sensor_use by sensor of the layout. radius_m: R of Algorithm 1,
   resolved. */
void weights_key_init(struct weights_key *key, const struct field_layout *layout, const struct field_params *params, float radius_m,
                      const uint8_t *usable);
/* Frees the key. */
void weights_key_finish(struct weights_key *key);
/* Returns whether two keys are equal. */
bool weights_key_equal(const struct weights_key *a, const struct weights_key *b);

/* Creates the weights of this key, which it takes over. Nothing is computed yet. Returns NULL if out of memory. The caller destroys it. */
struct weights *weights_create(const struct field_layout *layout, const struct field_params *params, float radius_m, const uint8_t *usable,
                               struct weights_key *key);
/* Copies the arrays that are the same in `from`, which has been summed: most are while a parameter is dragged. */
void weights_copy_known(struct weights *weights, const struct weights *from);
/* Frees the weights. &NULL is fine; leaves NULL. */
void weights_destroy(struct weights **weights);
/* Returns the bytes that weights for this layout take, without columns. */
size_t weights_bytes(const struct field_layout *layout);
/* Returns the bytes that all columns would take, cached or not. */
size_t weights_column_bytes(const struct weights *weights);
/* Returns the bytes of the columns that are cached. */
size_t weights_kept_bytes(const struct weights *weights);
/* Starts caching columns as they are computed: of the first vertices, as many as fit into `bytes`. Only where none are cached yet. Returns
   weights_kept_bytes(); 0 if none fit or memory runs out. */
size_t weights_keep(struct weights *weights, size_t bytes);
/* Frees the cached columns. */
void weights_drop_columns(struct weights *weights);

/* Encodes a distance beyond the rim of the data (negative: within it), in metres, as struct scalar's `lacking`. */
uint8_t weights_lacking(const struct weights *weights, float beyond_m);
/* Returns a vertex's byte for struct scalar's `lacking`; filled: a lost sensor leaves no hole. The vertex must be prepared. */
uint8_t weights_lacking_at(const struct weights *weights, size_t vertex, bool filled);
/* Computes what is still missing of near_m, top and place for a block of vertices (begin: a multiple of KERNEL_BLOCK; count <=
   KERNEL_BLOCK). Thread: any, on different blocks. */
void weights_prepare(struct weights *weights, size_t begin, size_t count);

/* gp: writes the standard deviation at vertices of one block, exact for the sensors that are used but for the samples that it was measured
   by while preparing. Takes (lost * lost) steps for each vertex. Thread: any. */
void weights_deviations(const struct weights *weights, size_t begin, size_t count, float *out);

/* Which columns to add, by what factors. */
struct weights_terms {
    const uint32_t *members;
    const double *factors;
    const uint8_t *marked; /* by place in this list: counts in sums->marked too */
    size_t count;
};
/* Sums of one block, which are added to. */
struct weights_sums {
    double *values;         /* sum of factor times column */
    double *total, *marked; /* sum of weights: all of the list, those marked; NULL: not asked for (marked only beside total) */
};
/* Adds the terms' columns to the sums of a prepared block, computing those that are not cached, and caching them where columns are cached.
   Thread: any, on different blocks. */
void weights_add(struct weights *weights, size_t begin, size_t count, const struct weights_terms *terms, const struct weights_sums *sums);
/* Returns a cached column of a block. */
const float *weights_column(const struct weights *weights, size_t begin, uint32_t member);
/* Returns whether all columns of a block are cached. */
bool weights_has_columns(const struct weights *weights, size_t begin);
/* Returns whether everything of a block is known, so that summing only reads it (except for Algorithm 1 with Uncertain sensors). */
bool weights_is_complete(const struct weights *weights, size_t begin);

#endif
