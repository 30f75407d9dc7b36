/* SPDX-License-Identifier: GPL-3.0-or-later */
/* G of the linear form: what each usable sensor weighs at each vertex, for one set of parameters and one set of usable sensors.
   Nothing in it depends on readings, so instances of one asset and sessions with equal parameters share it. The columns of G may be kept
   or made anew for each sum; the sums are bit for bit the same. Thread: one, but weights_prepare and weights_add may run on
   different vertices at once. */
#ifndef FIELD_WEIGHTS_H
#define FIELD_WEIGHTS_H
#include "field/params.h"
#include "field/kernels.h"
#include "field/layout.h"

enum sensor_use {
    SENSOR_LOST, /* takes no part; its place has no data */
    SENSOR_USED,
    SENSOR_NO_LIMITS /* takes no part, but its place is known to be well measured */
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

struct weights {
    struct weights_key key;
    const struct layout *layout;
    enum interpolation interpolation;
    enum distance_mode distance;
    float power, reach_m, radius_m, steps_per_m; /* steps: of `lacking` */
    bool alike;                                  /* all members have one strength */
    float *strength, *decay;                     /* by sensor of the layout */
    uint8_t *configured;                         /* by sensor of the layout: may take part, were it good; more than 1: SENSOR_NO_LIMITS */
    uint32_t *members;                           /* usable sensors of the layout; a column's number is its place here */
    size_t member_count;
    float *near_m, *top; /* by vertex: distance of the nearest usable sensor; scale (kernels.h) */
    float *total;        /* by vertex: the weights' sum */
    uint8_t *place;      /* by vertex: enum place */
    uint8_t *lost;       /* by vertex: how far nearer the nearest lost sensor is than near_m, as weights_lacking */
    uint8_t *known;      /* by block: bits of enum weights_known, what is filled of the four above */
    float *columns;      /* [block][member][KERNEL_BLOCK] of the first kept_blocks, or NULL; of others they are made anew each time */
    uint8_t *kept;       /* [block][member]: its column is filled; beside columns */
    size_t kept_blocks;
    int users;           /* states that hold it */
    uint64_t used, sums; /* tick of the last use; how often it was summed */
    struct weights *next;
};

/* usable: enum sensor_use, by sensor of the layout. radius_m: R of `paper`, already resolved. */
void weights_key_init(struct weights_key *key, const struct layout *layout, const struct field_params *params, float radius_m,
                      const uint8_t *usable);
void weights_key_finish(struct weights_key *key);
bool weights_key_equal(const struct weights_key *a, const struct weights_key *b);

/* Takes over the key. NULL: out of memory. Nothing is computed yet, but what can be taken over from others is by weights_copy_known. */
struct weights *weights_create(const struct layout *layout, const struct field_params *params, float radius_m, const uint8_t *usable,
                               struct weights_key *key);
/* Copies what is the same in `from`, which has been summed: while a parameter is dragged most of it is. */
void weights_copy_known(struct weights *weights, const struct weights *from);
void weights_destroy(struct weights **weights); /* &NULL is fine; leaves NULL */
size_t weights_bytes(const struct layout *layout);
size_t weights_column_bytes(const struct weights *weights); /* of all columns, kept or not */
size_t weights_kept_bytes(const struct weights *weights);   /* of those that are kept */
/* From now on as many columns as fit into so many bytes, of the first vertices, are kept as they are made. Only where none are. Returns
   weights_kept_bytes; 0: none fit, or out of memory. */
size_t weights_keep(struct weights *weights, size_t bytes);
void weights_drop_columns(struct weights *weights);

/* Metres beyond the rim of the data, negative within it, as struct scalar's `lacking`. */
uint8_t weights_lacking(const struct weights *weights, float beyond_m);
/* Fills what is not known of near_m, top and place of a block (begin: a multiple of KERNEL_BLOCK; count <= KERNEL_BLOCK). */
void weights_prepare(struct weights *weights, size_t begin, size_t count);

struct weights_terms { /* which members, by what factor */
    const uint32_t *members;
    const double *factors;
    const uint8_t *marked; /* by place in this list: counts in sums->marked too */
    size_t count;
};
struct weights_sums {       /* of one block; added to */
    double *values;         /* sum of factor times column */
    double *total, *marked; /* sum of weights: all of the list, those marked; NULL: not asked for (marked only beside total) */
};
/* Adds the terms at a block that is prepared. Fills the columns of those members, where columns are kept. */
void weights_add(struct weights *weights, size_t begin, size_t count, const struct weights_terms *terms, const struct weights_sums *sums);
/* One that is there. */
const float *weights_column(const struct weights *weights, size_t begin, uint32_t member);
/* Whether all columns of a block are there, so that they need only be added. */
bool weights_has_columns(const struct weights *weights, size_t begin);
/* And all else: its sums only read (but for those of `paper` where some sensor is Uncertain). */
bool weights_is_complete(const struct weights *weights, size_t begin);

#endif
