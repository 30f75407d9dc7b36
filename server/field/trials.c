/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Registry of trials: sets of sensor positions that users are trying out (trials.h). */
#include "field/trials.h"

#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

#include "base/mem.h"

struct trial_reach {
    _Atomic int refs;
    float *distance_m;
};

struct kept_trial {
    struct trial trial; /* first member, so that pointers to struct trial and struct kept_trial can be cast to each other */
    int users;
    bool dropped;
    struct kept_trial *next;
};

struct trials {
    pthread_mutex_t lock;
    /* --- below: under lock */
    struct kept_trial *kept; /* newest first */
    uint32_t newest, newest_sensor;
};

struct trial_reach *trial_reach_create(float *distance_m)
{
    struct trial_reach *reach = mem_new(sizeof(*reach));
    reach->distance_m = distance_m;
    atomic_init(&reach->refs, 1);
    return reach;
}

static struct trial_reach *reach_ref(struct trial_reach *reach)
{
    if (reach)
        atomic_fetch_add(&reach->refs, 1);
    return reach;
}

void trial_reach_unref(struct trial_reach **pointer)
{
    struct trial_reach *reach = *pointer;
    *pointer = NULL;
    if (!reach || atomic_fetch_sub(&reach->refs, 1) > 1)
        return;
    mem_free(reach->distance_m);
    mem_free(reach);
}

const struct trial_sensor *trial_find(const struct trial *trial, int tag)
{
    for (size_t i = 0; trial && i < trial->count; i++)
        if (trial->sensors[i].tag == tag)
            return &trial->sensors[i];
    return NULL;
}

const float *trial_distances(const struct trial_sensor *sensor)
{
    return sensor->reach ? sensor->reach->distance_m : NULL;
}

struct trials *trials_create(void)
{
    struct trials *trials = mem_new(sizeof(*trials));
    pthread_mutex_init(&trials->lock, NULL);
    return trials;
}

static void kept_destroy(struct kept_trial *kept)
{
    for (size_t i = 0; i < kept->trial.count; i++)
        trial_reach_unref(&kept->trial.sensors[i].reach);
    mem_free(kept);
}

void trials_destroy(struct trials **pointer)
{
    struct trials *trials = *pointer;
    if (!trials)
        return;
    for (struct kept_trial *kept = trials->kept, *next; kept; kept = next) {
        next = kept->next;
        kept_destroy(kept);
    }
    pthread_mutex_destroy(&trials->lock);
    mem_free(trials);
    *pointer = NULL;
}

/* Frees dropped trials (sets of sensor positions that nobody uses any more), except the newest TRIALS_KEPT and those that a
   caller still holds (trials_take()). Call with the lock held. */
static void sweep(struct trials *trials)
{
    int dropped = 0;
    for (struct kept_trial **at = &trials->kept; *at;) {
        struct kept_trial *kept = *at;
        dropped += kept->dropped;
        if (kept->dropped && dropped > TRIALS_KEPT && kept->users == 0) {
            *at = kept->next;
            kept_destroy(kept);
        } else {
            at = &kept->next;
        }
    }
}

uint32_t trials_put(struct trials *trials, const struct trial_sensor *sensors, size_t count)
{
    struct kept_trial *kept = mem_new(sizeof(*kept));
    kept->trial.count = count < TRIAL_SENSORS ? count : TRIAL_SENSORS;
    memcpy(kept->trial.sensors, sensors, kept->trial.count * sizeof(*sensors));
    pthread_mutex_lock(&trials->lock);
    for (size_t i = 0; i < kept->trial.count; i++) {
        reach_ref(kept->trial.sensors[i].reach);
        kept->trial.sensors[i].number = ++trials->newest_sensor;
    }
    uint32_t id = kept->trial.id = ++trials->newest;
    kept->next = trials->kept;
    trials->kept = kept;
    sweep(trials);
    pthread_mutex_unlock(&trials->lock);
    return id;
}

/* Returns the trial (set of sensor positions that a user tries out) with this id, or NULL. The caller holds the lock. */
static struct kept_trial *find(const struct trials *trials, uint32_t id)
{
    struct kept_trial *kept = trials->kept;
    while (kept && kept->trial.id != id)
        kept = kept->next;
    return kept;
}

void trials_drop(struct trials *trials, uint32_t id)
{
    pthread_mutex_lock(&trials->lock);
    struct kept_trial *kept = find(trials, id);
    if (kept)
        kept->dropped = true;
    sweep(trials);
    pthread_mutex_unlock(&trials->lock);
}

bool trials_live(struct trials *trials, uint32_t id)
{
    pthread_mutex_lock(&trials->lock);
    const struct kept_trial *kept = find(trials, id);
    bool live = kept && !kept->dropped;
    pthread_mutex_unlock(&trials->lock);
    return live;
}

const struct trial *trials_take(struct trials *trials, uint32_t id)
{
    pthread_mutex_lock(&trials->lock);
    struct kept_trial *kept = find(trials, id);
    if (kept)
        kept->users++;
    pthread_mutex_unlock(&trials->lock);
    return kept ? &kept->trial : NULL;
}

void trials_give(struct trials *trials, const struct trial **trial)
{
    if (!*trial)
        return;
    pthread_mutex_lock(&trials->lock);
    struct kept_trial *kept = find(trials, (*trial)->id);
    kept->users--;
    sweep(trials);
    pthread_mutex_unlock(&trials->lock);
    *trial = NULL;
}
