/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stores baselines (saved readings of all tags) with reference counts, so that a baseline can be replaced while it is read. */
#include "value/baselines.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"

/* The snapshot must be the first member: users hold a pointer to it, which is converted back to a pointer to this struct. */
struct baseline_copy {
    struct snapshot snapshot;
    int users; /* number of users, under `lock` */
};

struct baseline_slot {
    struct baseline what;
    struct baseline_copy *copy;
};

struct baselines {
    pthread_mutex_t lock;
    /* --- below: under lock */
    uint32_t last_id;
    struct baseline_slot slots[BASELINES_NAMED + BASELINES_UNNAMED]; /* in order of id */
    size_t count;
};

struct baselines *baselines_create(void)
{
    struct baselines *baselines = mem_new(sizeof(*baselines));
    pthread_mutex_init(&baselines->lock, NULL);
    return baselines;
}

static struct baseline_copy *copy_create(const struct snapshot *from)
{
    struct baseline_copy *copy = mem_new(sizeof(*copy));
    *copy = (struct baseline_copy){ .snapshot = *from, .users = 1 };
    copy->snapshot.readings = snapshot_copy_readings(from);
    return copy;
}

/* Drops one reference to a baseline's copy of the readings, and frees the copy with the last one. Call with the lock held. */
static void copy_unref(struct baseline_copy *copy)
{
    if (--copy->users > 0)
        return;
    mem_free(copy->snapshot.readings);
    mem_free(copy);
}

void baselines_destroy(struct baselines **baselines_ptr)
{
    struct baselines *baselines = *baselines_ptr;
    if (!baselines)
        return;
    for (size_t i = 0; i < baselines->count; i++)
        copy_unref(baselines->slots[i].copy);
    pthread_mutex_destroy(&baselines->lock);
    mem_free(baselines);
    *baselines_ptr = NULL;
}

/* Returns the baseline (saved readings of all tags) with this name, or NULL. Call with the lock held. */
static struct baseline_slot *find_name(struct baselines *baselines, const char *name)
{
    for (size_t i = 0; i < baselines->count; i++)
        if (baselines->slots[i].what.name[0] && !strcmp(baselines->slots[i].what.name, name))
            return &baselines->slots[i];
    return NULL;
}

/* Returns the baseline (saved readings of all tags) with this id, or NULL. Call with the lock held. */
static struct baseline_slot *find_id(struct baselines *baselines, uint32_t id)
{
    for (size_t i = 0; i < baselines->count; i++)
        if (baselines->slots[i].what.id == id)
            return &baselines->slots[i];
    return NULL;
}

/* Returns the number of named baselines (named true) or of unnamed ones (false). Call with the lock held. */
static size_t count_of(const struct baselines *baselines, bool named)
{
    size_t count = 0;
    for (size_t i = 0; i < baselines->count; i++)
        count += (baselines->slots[i].what.name[0] != 0) == named;
    return count;
}

/* Removes a baseline (saved readings of all tags) from the list. Call with the lock held. */
static void slot_remove(struct baselines *baselines, struct baseline_slot *slot)
{
    copy_unref(slot->copy);
    size_t after = (size_t)(&baselines->slots[baselines->count] - slot) - 1;
    memmove(slot, slot + 1, after * sizeof(*slot));
    baselines->count--;
}

/* Adds a baseline and returns its id. Call with the lock held; the array of slots must have room. */
static uint32_t slot_add(struct baselines *baselines, const char *name, const struct snapshot *snapshot)
{
    struct baseline_slot *slot = &baselines->slots[baselines->count++];
    *slot = (struct baseline_slot){ .what = { .id = ++baselines->last_id, .taken_utc_ns = snapshot->taken_utc_ns },
                                    .copy = copy_create(snapshot) };
    snprintf(slot->what.name, sizeof(slot->what.name), "%s", name);
    return slot->what.id;
}

uint32_t baselines_set(struct baselines *baselines, const char *name, const struct snapshot *snapshot)
{
    uint32_t id = 0;
    pthread_mutex_lock(&baselines->lock);
    struct baseline_slot *slot = find_name(baselines, name);
    if (slot) {
        copy_unref(slot->copy);
        slot->copy = copy_create(snapshot);
        slot->what.taken_utc_ns = snapshot->taken_utc_ns;
        id = slot->what.id;
    } else if (count_of(baselines, true) < BASELINES_NAMED) {
        id = slot_add(baselines, name, snapshot);
    }
    pthread_mutex_unlock(&baselines->lock);
    return id;
}

/* Returns the first unnamed baseline whose readings have the time taken_utc_ns (below 0: any time), or NULL. Call with the lock held. */
static struct baseline_slot *find_unnamed(struct baselines *baselines, int64_t taken_utc_ns)
{
    for (size_t i = 0; i < baselines->count; i++)
        if (!baselines->slots[i].what.name[0] && (taken_utc_ns < 0 || baselines->slots[i].what.taken_utc_ns == taken_utc_ns))
            return &baselines->slots[i];
    return NULL;
}

uint32_t baselines_keep(struct baselines *baselines, const struct snapshot *snapshot)
{
    pthread_mutex_lock(&baselines->lock);
    struct baseline_slot *slot = find_unnamed(baselines, snapshot->taken_utc_ns);
    if (!slot && count_of(baselines, false) == BASELINES_UNNAMED)
        slot_remove(baselines, find_unnamed(baselines, -1));
    uint32_t id = slot ? slot->what.id : slot_add(baselines, "", snapshot);
    pthread_mutex_unlock(&baselines->lock);
    return id;
}

void baselines_remove(struct baselines *baselines, const char *name)
{
    pthread_mutex_lock(&baselines->lock);
    struct baseline_slot *slot = find_name(baselines, name);
    if (slot)
        slot_remove(baselines, slot);
    pthread_mutex_unlock(&baselines->lock);
}

uint32_t baselines_find(struct baselines *baselines, const char *name)
{
    pthread_mutex_lock(&baselines->lock);
    const struct baseline_slot *slot = find_name(baselines, name);
    uint32_t id = slot ? slot->what.id : 0;
    pthread_mutex_unlock(&baselines->lock);
    return id;
}

bool baselines_may_set(struct baselines *baselines, const char *name)
{
    pthread_mutex_lock(&baselines->lock);
    bool may = find_name(baselines, name) || count_of(baselines, true) < BASELINES_NAMED;
    pthread_mutex_unlock(&baselines->lock);
    return may;
}

bool baselines_describe(struct baselines *baselines, uint32_t id, struct baseline *out)
{
    pthread_mutex_lock(&baselines->lock);
    const struct baseline_slot *slot = find_id(baselines, id);
    if (slot)
        *out = slot->what;
    pthread_mutex_unlock(&baselines->lock);
    return slot;
}

size_t baselines_list(struct baselines *baselines, struct baseline out[BASELINES_NAMED])
{
    size_t count = 0;
    pthread_mutex_lock(&baselines->lock);
    for (size_t i = 0; i < baselines->count; i++)
        if (baselines->slots[i].what.name[0])
            out[count++] = baselines->slots[i].what;
    pthread_mutex_unlock(&baselines->lock);
    return count;
}

const struct snapshot *baselines_take(struct baselines *baselines, uint32_t id)
{
    pthread_mutex_lock(&baselines->lock);
    struct baseline_slot *slot = find_id(baselines, id);
    if (slot)
        slot->copy->users++;
    const struct snapshot *snapshot = slot ? &slot->copy->snapshot : NULL;
    pthread_mutex_unlock(&baselines->lock);
    return snapshot;
}

void baselines_give(struct baselines *baselines, const struct snapshot **snapshot)
{
    if (!*snapshot)
        return;
    pthread_mutex_lock(&baselines->lock);
    copy_unref((struct baseline_copy *)*snapshot);
    pthread_mutex_unlock(&baselines->lock);
    *snapshot = NULL;
}
