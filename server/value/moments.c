/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A short list of counted snapshots. */
#include "value/moments.h"

#include <pthread.h>
#include <stdbool.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/mem.h"

struct entry { /* the moment comes first: it is what others hold */
    struct moment moment;
    int users;
    uint64_t used;
};

struct moments {
    pthread_mutex_t lock;
    /* --- below: under lock */
    struct entry **entries;
    size_t count, capacity;
    uint64_t uses;
};

struct moments *moments_create(void)
{
    struct moments *moments = mem_new(sizeof(*moments));
    pthread_mutex_init(&moments->lock, NULL);
    return moments;
}

static void entry_destroy(struct entry *entry)
{
    mem_free(entry->moment.snapshot.readings);
    mem_free(entry);
}

void moments_destroy(struct moments **moments_ptr)
{
    struct moments *moments = *moments_ptr;
    if (!moments)
        return;
    for (size_t i = 0; i < moments->count; i++)
        entry_destroy(moments->entries[i]);
    mem_free(moments->entries);
    pthread_mutex_destroy(&moments->lock);
    mem_free(moments);
    *moments_ptr = NULL;
}

/* Under lock. NULL: none. */
static struct entry *find(const struct moments *moments, int64_t at_us)
{
    for (size_t i = 0; i < moments->count; i++)
        if (moments->entries[i]->moment.at_us == at_us)
            return moments->entries[i];
    return NULL;
}

/* Under lock. The least that no other has that is held. */
static int free_slot(const struct moments *moments)
{
    for (int slot = 1;; slot++) {
        bool taken = false;
        for (size_t i = 0; i < moments->count && !taken; i++)
            taken = moments->entries[i]->users > 0 && moments->entries[i]->moment.slot == slot;
        if (!taken)
            return slot;
    }
}

/* Under lock. */
static void drop_spare(struct moments *moments)
{
    size_t spare = 0, oldest = 0;
    for (size_t i = 0; i < moments->count; i++) {
        const struct entry *entry = moments->entries[i];
        if (entry->users > 0)
            continue;
        if (spare++ == 0 || entry->used < moments->entries[oldest]->used)
            oldest = i;
    }
    if (spare <= MOMENTS_SPARE)
        return;
    entry_destroy(moments->entries[oldest]);
    moments->entries[oldest] = moments->entries[--moments->count];
}

static void number_changes(struct snapshot *snapshot)
{
    for (size_t i = 0; i < snapshot->count; i++) {
        struct reading *reading = &snapshot->readings[i];
        struct { double value; uint32_t quality, alarm; } what = { reading->value, reading->quality, 0 };
        what.alarm = (uint32_t)reading->alarm << 8 | reading->alarm_word;
        reading->changes = (uint32_t)XXH3_64bits(&what, sizeof(what));
    }
}

void moments_add(struct moments *moments, int64_t at_us, struct snapshot *snapshot)
{
    number_changes(snapshot);
    pthread_mutex_lock(&moments->lock);
    if (!find(moments, at_us)) {
        struct entry *entry = mem_new(sizeof(*entry));
        *entry = (struct entry){ .moment = { .snapshot = *snapshot, .at_us = at_us }, .used = ++moments->uses };
        *snapshot = (struct snapshot){ 0 };
        mem_grow(&moments->entries, &moments->capacity, moments->count + 1, sizeof(*moments->entries));
        moments->entries[moments->count++] = entry;
        drop_spare(moments);
    }
    pthread_mutex_unlock(&moments->lock);
}

const struct moment *moments_take(struct moments *moments, int64_t at_us)
{
    pthread_mutex_lock(&moments->lock);
    struct entry *entry = find(moments, at_us);
    if (entry) {
        if (entry->users == 0)
            entry->moment.slot = free_slot(moments);
        entry->users++;
        entry->used = ++moments->uses;
    }
    pthread_mutex_unlock(&moments->lock);
    return entry ? &entry->moment : NULL;
}

void moments_give(struct moments *moments, const struct moment **moment)
{
    if (!*moment)
        return;
    pthread_mutex_lock(&moments->lock);
    ((struct entry *)*moment)->users--;
    drop_spare(moments);
    pthread_mutex_unlock(&moments->lock);
    *moment = NULL;
}
