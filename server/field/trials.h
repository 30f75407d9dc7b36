/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Places of sensors that somebody tries out: sets of them, each under a number that views name. What is in a set never changes; a sensor
   that is dragged makes another one. Numbers are never used again. Thread: any. */
#ifndef FIELD_TRIALS_H
#define FIELD_TRIALS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TRIAL_SENSORS = 64 };

struct trial_reach; /* distances along the surface, of every vertex; counted */
/* Takes distance_m (mem_free). */
struct trial_reach *trial_reach_create(float *distance_m);
void trial_reach_unref(struct trial_reach **reach); /* &NULL is fine; leaves NULL */

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
const struct trial_sensor *trial_find(const struct trial *trial, int tag); /* NULL: it is where the plant has it; so if trial is NULL */
const float *trial_distances(const struct trial_sensor *sensor);           /* along the surface; NULL: not known yet */

struct trials;
struct trials *trials_create(void);
void trials_destroy(struct trials **trials); /* &NULL is fine; leaves NULL */
/* Copies the sensors, with references of its own. The number, never 0. count: 1..TRIAL_SENSORS. */
uint32_t trials_put(struct trials *trials, const struct trial_sensor *sensors, size_t count);
/* Nobody will ask for it any more, but in pictures under way: the last TRIALS_KEPT of them stay for those. 0 is fine. */
enum { TRIALS_KEPT = 16 };
void trials_drop(struct trials *trials, uint32_t id);
bool trials_live(struct trials *trials, uint32_t id); /* it was not dropped */
/* Held until trials_give. NULL: there is none such (any more). */
const struct trial *trials_take(struct trials *trials, uint32_t id);
void trials_give(struct trials *trials, const struct trial **trial); /* &NULL is fine; leaves NULL */

#endif
