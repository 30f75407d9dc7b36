/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The field of one asset for one set of parameters: its scalars, and the readings from which they were computed. Call from one
   thread at a time. */
#ifndef FIELD_STATE_H
#define FIELD_STATE_H
#include "base/workers.h"
#include "field/scalars.h"
#include "field/weights.h"
#include "value/snapshot.h"

struct update; /* defined in update.h */

struct state_input { /* contribution of one sensor to the sums from which the field (interpolated values) is computed */
    /* the sensor's reading in engineering units; for the interpolation `paper` (Algorithm 1 of Kim & Suh) scaled to 0..1 over
       the range of the group */
    double value;
    uint8_t usable, uncertain; /* usable: enum sensor_use */
};

struct field_state {
    struct field_params params;
    struct field_layout *layout;
    struct weights *weights; /* counted in weights->users */
    struct scalars scalars;  /* scalars.version 0: nothing computed yet */
    struct scalar *at;
    /* [vertex]: numerator of the vertex's value, a sum over all sensors; NULL: not stored, because few sensors are summed again
       as quickly */
    double *sums;
    size_t room;             /* number of vertices for which `at` (scalars) and `sums` have room */
    double error_limit;      /* error above which a vertex is marked uncertain; compared with weights->errors; initially 0 */
    unsigned errors_version; /* value of weights->errors_version when vertices were last marked uncertain */
    /* factor that converts an element of weights->errors, which has no unit, to the error of a value in the drawn picture */
    double error_scale;
    /* number of updates so far that only added changes of readings to the sums; once rounding errors have accumulated, the sums
       are computed in full again */
    unsigned added;
    /* [sensor of the layout]. now: readings from the newest snapshot; shown: readings from which the scalars (values at the
       vertices) were computed */
    struct state_input *now, *shown;
    uint8_t *usable; /* [sensor of the group on the asset]: whether the sensor's reading in `now` is used (enum sensor_use) */
    /* memory for the lists of sensors to sum (struct weights_terms). Element 0: sensors whose input changed; element 1: all sensors */
    struct state_list {
        uint32_t *members;
        double *factors;
        uint8_t *marked;
    } lists[2];
    struct update *update; /* update in progress; NULL: none */
    size_t wanted;         /* number of vertices, from the first of the asset file on, that callers requested since the last update */
    uint64_t used;
    struct field_state *next;
};

/* Creates a state (computed field of an asset) without room for vertices (state_grow()); never returns NULL. Copies params; the
   layout must outlive the state. The caller destroys it. */
struct field_state *state_create(int asset, struct field_layout *layout, const struct field_params *params);
/* Frees the state. Accepts a pointer to NULL; sets the pointer to NULL. */
void state_destroy(struct field_state **state);
size_t state_bytes(const struct field_state *state);
/* Returns by how many bytes the state's memory would grow with room for the first `count` vertices. */
size_t state_more_bytes(const struct field_state *state, size_t count);
/* Allocates memory for the first `count` vertices; assets far from the camera need few. Returns false when out of memory, with nothing
   changed. */
bool state_grow(struct field_state *state, size_t count);

/* Reads the sensors' readings from a snapshot into state->now, state->usable and the ages. baseline: snapshot to subtract, for
   views of differences; NULL: the baseline is unknown. */
void state_read(struct field_state *state, const struct snapshot *snapshot, const struct snapshot *baseline);
/* For interpolations with weights prepared by plantcast-prep: replaces the values of sensors without a usable reading in
   state->now by those that follow from the other sensors. The state's weights must be for the qualities in state->now. */
void state_fill(struct field_state *state);
/* Returns true if state->weights must be replaced, because they were computed for another set of usable sensors than that in
   state->now. */
bool state_needs_weights(const struct field_state *state);
/* Returns true if the state's scalars are out of date: they were computed from inputs that differ from state->now. */
bool state_is_behind(const struct field_state *state);
/* For views of distances (SHOW_DISTANCE), instead of state_read() and an update: fills the scalars once with each vertex's
   distance from one sensor of the layout. */
void state_measure(struct field_state *state, size_t sensor, uint64_t *versions);

#endif
