/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The matrix G: the weight of each usable sensor at each vertex of an asset, for one set of parameters and one set of usable
   sensors (field.h). G does not depend on readings, so instances of one asset and sessions with equal parameters share it.
   Columns of G may be cached or recomputed for each sum, with bit-identical results. Call from one thread only, but
   weights_prepare() and weights_add() may run in parallel on different blocks. */
#ifndef FIELD_WEIGHTS_H
#define FIELD_WEIGHTS_H
#include "field/params.h"
#include "field/influence_fill.h"
#include "field/kernels.h"
#include "field/layout.h"

enum sensor_use {
    SENSOR_LOST, /* the sensor is configured but not usable, so there is no data around it */
    SENSOR_USED,
    SENSOR_NO_LIMITS, /* the sensor is good, but its tag has no limits: the area around it counts as measured but has no value to show */
    /* the sensor is ignored: all sensor positions on the asset are assumed, and another sensor gives the asset's value */
    SENSOR_ASIDE
};

/* Whether a vertex has data, depending on the sensor nearest to it. */
enum place {
    PLACE_GOOD,     /* the nearest configured sensor is usable and within reach */
    PLACE_LOST,     /* the nearest configured sensor is lost (not usable), but another sensor is within reach */
    PLACE_NOBODY,   /* no usable sensor within reach */
    PLACE_NO_LIMITS /* the nearest sensor within reach is good, but its tag has no alarm limits (SENSOR_NO_LIMITS) */
};

/* bits for the arrays of struct weights that are filled for a block of vertices. KNOWN_NEAR: near_m and place; KNOWN_TOP: top;
   KNOWN_TOTAL: total */
enum weights_known { KNOWN_NEAR = 1, KNOWN_TOP = 2, KNOWN_TOTAL = 4 };

struct weights_key { /* key of cached weights: the bytes of everything on which the sensors' weights at the vertices depend */
    void *bytes;
    size_t count;
    uint64_t hash;
};

/* element of weights->errors of a triangle that shows data where the field has none */
#define WEIGHTS_SHOWS_NO_DATA INFINITY
#define STEP_OF_COLOR (1 / 255.0f) /* errors below a step of the 8-bit colour scale are not seen */

enum { WEIGHTS_ERRING = 9 }; /* number of error thresholds for which area or vertices are counted: 1, 1/2, 1/4 ... 1/256 of the
                                range; the last is about one colour step */

struct weights {
    struct weights_key key;
    const struct field_layout *layout;
    enum interpolation interpolation;
    enum distance_mode distance;
    /* steps_per_m: number of steps of struct scalar's `lacking` (encoded distance from the border of the data) per metre */
    float power, reach_m, radius_m, steps_per_m;
    bool alike;                                  /* true: all members (sensors in the sum) have the same strength */
    float *strength, *decay;                     /* [sensor of the layout] */
    /* [sensor of the layout]: 1: it would contribute if its quality were good; 0: it would not; greater than 1: SENSOR_NO_LIMITS */
    uint8_t *configured;
    uint8_t *takes_part; /* [sensor of the group on the asset]: 1 if its reading is used, else 0 */
    /* members of the sum, in the order of the columns: the used sensors of the layout; for interpolations with weights prepared
       by plantcast-prep all sensors */
    uint32_t *members;
    size_t member_count;
    /* [vertex]: near_m: distance in metres of the nearest usable sensor; top: scale that keeps weights from overflowing
       (kernels.h) */
    float *near_m, *top;
    float *total;                /* [vertex]: sum of its weights */
    uint8_t *place;              /* by vertex: enum place */
    /* [vertex]: by how much the nearest lost sensor (one without a usable reading) is nearer than the nearest usable one,
       encoded by encode_lacking() in weights.c */
    uint8_t *lost;
    uint8_t *known; /* [block]: which of its arrays near_m, place, top and total are filled (bits of enum weights_known) */
    const float *prepared;       /* [member][vertex]: prepared weights from the asset's influence file; NULL: weights are computed from
                                    distances */
    /* for prepared interpolations: factorised matrix from which lost sensors (those without a usable reading) get values,
       influence_fill.h; NULL: no sensor is lost */
    struct influence_fill *fill;
    /* [sensor], for prepared interpolations: 1 for a used sensor; for a lost one the value that the interpolation predicts if
       all used sensors read 1. NULL: the interpolation is not prepared */
    double *ones;
    /* metres. For interpolation fin (values fall towards ambient like the temperature along a cooling fin): the decay length,
       over which a sensor's share of the value falls by a factor of e. For gp (Gaussian process): the correlation range /
       sqrt(8) */
    float decay_m;
    /* [vertex], for interpolation gp (Gaussian process): standard deviation of the field if all sensors have usable readings;
       else NULL */
    const float *deviations;
    const float *priors;     /* [vertex], for interpolation gp (Gaussian process): standard deviation of the field without any sensor */
    /* for interpolation gp (Gaussian process): standard deviation of the field before any reading is known (the prior) */
    float deviation;
    /* [vertex]: largest error of linear interpolation within the adjacent triangles, or WEIGHTS_SHOWS_NO_DATA; unit and method in
       drawn_error.h; NULL: not measured */
    float *errors;
    /* [vertex], for prepared interpolations: the errors that plantcast-prep stored, without the marks of the border that
       drawn_error_measure() adds to `errors`; NULL: none, or the interpolation is not prepared */
    const float *prepared_errors;
    float *interpolation_errors; /* `errors` without the part due to errors of distances; NULL: `errors` has no such part */
    /* [vertex]: 1: a triangle at the vertex shows SHOW_BLIND with a larger error than drawn_error_mark() accepts; NULL: not measured */
    uint8_t *blind_marks;
    /* true: memory ran out while errors were measured, so every value may have any error */
    bool errors_unknown;
    float largest_error; /* largest element of `errors`; those that were measured count as at most 1; 1 if errors_unknown */
    /* erring[b]: fraction of the surface (for prepared interpolations: of the vertices) whose interpolation error is at least
       2^-b; the largest over all measured levels of detail */
    float erring[WEIGHTS_ERRING];
    /* bit masks of the levels of detail whose errors are included in `errors`: measured_levels: errors of distances, and at the border
       of a limited reach; sampled_levels: errors of interpolation and at ridges, too, which are not measured where preparation left
       none */
    uint64_t measured_levels, sampled_levels;
    unsigned errors_version;  /* counts the changes of `errors`, so that users can tell that it changed */
    /* [vertex], for interpolations fin and gp: distance in metres by which the vertex is beyond the border of the area with
       data (negative: inside); else NULL */
    float *beyond_m;
    float *columns; /* cached weights of the first kept_blocks blocks, [block][member][KERNEL_BLOCK], or NULL; those of other blocks
                       are recomputed for each sum */
    uint8_t *kept;  /* [block][member]: 1 if the member's cached weights in that block are filled */
    size_t kept_blocks;
    int users;           /* number of computed fields (struct field_state) that use these weights */
    /* used: number of the field's calls (tick, field_impl.h) at the last use; sums: number of times that the weights were
       summed */
    uint64_t used, sums;
    struct weights *next;
};

/* Computes the key, the bytes of everything on which G depends. usable: [sensor of the layout], enum sensor_use. radius_m:
   radius R of Algorithm 1 in metres, never 0. */
void weights_key_init(struct weights_key *key, const struct field_layout *layout, const struct field_params *params, float radius_m,
                      const uint8_t *usable);
/* Frees the key. */
void weights_key_finish(struct weights_key *key);
bool weights_key_equal(const struct weights_key *a, const struct weights_key *b);

/* Creates the weights for this key and takes ownership of the key. Nothing is computed yet. Returns NULL when out of memory.
   The caller destroys the weights. */
struct weights *weights_create(const struct field_layout *layout, const struct field_params *params, float radius_m, const uint8_t *usable,
                               struct weights_key *key);
/* Creates weights that only tell which points of a layout the sensors reach, even if the interpolation is prepared: weights_prepare() fills
   near_m, place and lost from the reach and the lost sensors. The other border of fin and gp (beyond_m) is known at vertices only.
   Returns NULL when out of memory. The caller destroys the weights. */
struct weights *weights_create_border(const struct field_layout *layout, const struct field_params *params, const uint8_t *usable);
/* Copies from other weights those computed arrays that are the same for both sets of parameters. While a user drags one
   parameter, these are most of the arrays. */
void weights_copy_known(struct weights *weights, const struct weights *from);
/* Frees the weights. Accepts a pointer to NULL; sets the pointer to NULL. */
void weights_destroy(struct weights **weights);
/* Returns the size in bytes of the weights for this layout (sensors of a group on an asset), without cached columns (each
   sensor's weights at all vertices). */
size_t weights_bytes(const struct field_layout *layout);
/* Returns the size in bytes of the columns (each sensor's weights) of all vertices, cached or not. */
size_t weights_column_bytes(const struct weights *weights);
/* Returns the size in bytes of the cached columns of G (a column is one sensor's weights at all vertices). */
size_t weights_kept_bytes(const struct weights *weights);
/* Starts caching columns as they are computed: as many as fit into `bytes`, from the first vertices on. Call only while none
   are cached. Returns weights_kept_bytes(), or 0 if no column fits or memory runs out. */
size_t weights_keep(struct weights *weights, size_t bytes);
/* Frees the cached columns. */
void weights_drop_columns(struct weights *weights);

/* Returns how far a vertex is beyond the border of the data, encoded as struct scalar's `lacking`. filled: areas around lost
   sensors (those without a usable reading) count as having data. Call weights_prepare() for the vertex's block first. */
uint8_t weights_lacking_at(const struct weights *weights, size_t vertex, bool filled);
/* Returns the largest error at a vertex that was measured, relative to the spread of the readings (drawn_error.h); WEIGHTS_SHOWS_NO_DATA if
   memory ran out while errors were measured. */
float weights_error_at(const struct weights *weights, size_t vertex);
/* Returns true if pictures interpolate SHOW_BLIND between vertices, so that weights->blind_marks must be measured. */
bool weights_interpolates_blind(const struct weights *weights);
/* Returns true if SHOW_BLIND may be drawn with too large an error at a vertex: it was measured there, or could not be measured. */
bool weights_blind_off(const struct weights *weights, size_t vertex);
/* Computes those of the arrays near_m, top and place that a block of vertices lacks (begin: a multiple of KERNEL_BLOCK; count
   <= KERNEL_BLOCK). Call from any thread; different threads need different blocks. */
void weights_prepare(struct weights *weights, size_t begin, size_t count);

/* For interpolation gp: writes the standard deviation at vertices of one block, exact for the used sensors except for the
   sampling done in preparation. Takes (lost * lost) steps per vertex. Call from any thread. */
void weights_deviations(const struct weights *weights, size_t begin, size_t count, float *out);

/* List of columns of G (a column is one sensor's weights at a block of vertices) for weights_add(), each with a factor. */
struct weights_terms {
    const uint32_t *members;
    const double *factors;
    /* [element of the list]: 1: the sensor's reading is Uncertain, so its weights are also summed in sums->marked; 0: they are
       not */
    const uint8_t *marked;
    size_t count;
};
/* Sums over sensors for each vertex of one block of KERNEL_BLOCK vertices, to which weights_add() adds. */
struct weights_sums {
    double *values; /* sum of factor times column */
    /* total: sum of the weights of all columns in the list; marked: sum over the marked columns. NULL: not needed (marked
       requires total) */
    double *total, *marked;
};
/* Adds columns of G, multiplied by their factors, to the sums of a prepared block. Computes columns that are not cached, and
   caches them if caching is on. Call from any thread; different threads need different blocks. */
void weights_add(struct weights *weights, size_t begin, size_t count, const struct weights_terms *terms, const struct weights_sums *sums);
/* Returns the cached weights of one sensor at a block of vertices. */
const float *weights_column(const struct weights *weights, size_t begin, uint32_t member);
/* Returns true if the weights of all sensors in a block are cached. */
bool weights_has_columns(const struct weights *weights, size_t begin);
/* Returns true if all arrays and columns (each sensor's weights) of a block are filled, so that weights_add() only reads them.
   With the interpolation `paper` (Algorithm 1 of Kim & Suh), weights of Uncertain sensors are never cached. */
bool weights_is_complete(const struct weights *weights, size_t begin);

#endif
