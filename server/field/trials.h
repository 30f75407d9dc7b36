/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trials: sets of sensor positions that somebody tries out, each under a number that views refer to. A set is immutable; a sensor that is
   dragged makes a new one. Numbers are never used again. Thread: any. */
#ifndef FIELD_TRIALS_H
#define FIELD_TRIALS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TRIAL_SENSORS = 64 };

/* Geodesic distances of every vertex from a trial position; reference-counted. */
struct trial_reach;
/* Wraps distance_m, which it takes over (mem_free). Returns one reference. */
struct trial_reach *trial_reach_create(float *distance_m);
/* Drops a reference. &NULL is fine; leaves NULL. */
void trial_reach_unref(struct trial_reach **reach);

struct trial_sensor {
    int tag, asset;            /* it stands on this asset, and nowhere else */
    float surface_m[3];        /* as the asset file's positions */
    double place_m[3];         /* the same in the plant frame */
    uint32_t vertex;           /* the nearest one */
    struct trial_reach *reach; /* NULL: not known yet; straight distances stand in for them */
    uint32_t number;           /* of this place with these distances: no other has it. Set by trials_put */
};

struct trial {
    uint32_t id;
    size_t count;
    struct trial_sensor sensors[TRIAL_SENSORS];
};
/* Returns the trial's position of this tag; NULL if it moves the tag not, or if trial is NULL. */
const struct trial_sensor *trial_find(const struct trial *trial, int tag);
/* Returns the geodesic distances of every vertex; NULL if they are not known yet. */
const float *trial_distances(const struct trial_sensor *sensor);

struct trials;
/* Creates an empty registry of trials. The caller destroys it. */
struct trials *trials_create(void);
/* Frees the registry. &NULL is fine; leaves NULL. */
void trials_destroy(struct trials **trials);
/* Adds a trial of 1..TRIAL_SENSORS sensors, copied, taking references of its own. Returns its number, never 0. */
uint32_t trials_put(struct trials *trials, const struct trial_sensor *sensors, size_t count);
/* Nobody will ask for it any more, but in pictures under way: the last TRIALS_KEPT of them stay for those. 0 is fine. */
enum { TRIALS_KEPT = 16 };
/* Marks a trial as no longer wanted; the last TRIALS_KEPT such stay for frames under way. 0 is fine. */
void trials_drop(struct trials *trials, uint32_t id);
/* Returns whether the trial exists and was not dropped. */
bool trials_live(struct trials *trials, uint32_t id);
/* Returns the trial, held until trials_give(); NULL if there is none. */
const struct trial *trials_take(struct trials *trials, uint32_t id);
/* Releases a trial. &NULL is fine; leaves NULL. */
void trials_give(struct trials *trials, const struct trial **trial);

#endif
