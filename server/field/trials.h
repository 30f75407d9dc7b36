/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trials: sets of sensor positions that a user is trying out, each with an id by which views refer to it. A set is immutable;
   each step of dragging a sensor creates a new one. Ids are never reused. Call from any thread. */
#ifndef FIELD_TRIALS_H
#define FIELD_TRIALS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TRIAL_SENSORS = 64 };

/* Geodesic distances of every vertex from a trial position; reference-counted. */
struct trial_reach;
/* Creates a reference-counted object from distance_m and takes ownership of that array (mem_free). Returns one reference. */
struct trial_reach *trial_reach_create(float *distance_m);
/* Drops a reference. Accepts a pointer to NULL; sets the pointer to NULL. */
void trial_reach_unref(struct trial_reach **reach);

struct trial_sensor {
    int tag, asset;     /* index of the moved sensor's tag, and index of the only asset that the sensor is on in this trial */
    float surface_m[3]; /* trial position of the sensor in metres, in the coordinates of the asset file */
    double place_m[3];  /* trial position of the sensor in metres, in plant coordinates */
    uint32_t vertex;    /* vertex nearest to the position */
    /* geodesic distances from the trial position; NULL: not known yet, straight-line distances are used meanwhile */
    struct trial_reach *reach;
    uint32_t number; /* unique number of this position and its distances, set by trials_put(); distinguishes cached
                                  weights of different positions */
};

struct trial {
    uint32_t id;
    size_t count;
    struct trial_sensor sensors[TRIAL_SENSORS];
};
/* Returns the trial's position for this tag; NULL if the trial does not move the tag, or is NULL. */
const struct trial_sensor *trial_find(const struct trial *trial, int tag);
/* Returns the geodesic distance in metres from the sensor's trial position to each vertex of the asset; NULL while it is being
   computed. Owned by sensor->reach. */
const float *trial_distances(const struct trial_sensor *sensor);

struct trials;
/* Creates an empty registry of trials. The caller destroys it. */
struct trials *trials_create(void);
/* Frees the registry. Accepts a pointer to NULL; sets the pointer to NULL. */
void trials_destroy(struct trials **trials);
/* Adds a trial of 1..TRIAL_SENSORS sensors. Copies the sensors and takes a reference to the distances (`reach`) of each.
   Returns the trial's id, never 0. */
uint32_t trials_put(struct trials *trials, const struct trial_sensor *sensors, size_t count);
enum { TRIALS_KEPT = 16 };
/* Marks a trial as dropped: its user no longer needs it. The newest TRIALS_KEPT dropped trials stay, because frames in progress
   may use them. id 0 is a no-op. */
void trials_drop(struct trials *trials, uint32_t id);
/* Returns true if the trial exists and its user still needs it (trials_drop() was not called). */
bool trials_live(struct trials *trials, uint32_t id);
/* Returns the trial (set of sensor positions that a user tries out) with this id, which stays valid until trials_give(); NULL:
   there is none. */
const struct trial *trials_take(struct trials *trials, uint32_t id);
/* Ends the caller's use of a trial from trials_take(), which may be freed afterwards. Accepts a pointer to NULL; sets the
   pointer to NULL. */
void trials_give(struct trials *trials, const struct trial **trial);

#endif
