/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where on the surface the points lie that splitting looks at, for the next time: KEY.spots beside the asset files. No sensor has a part in
   that, and finding it is half of the work. Safe to delete; one that is no good counts as none. It holds what was asked the last time that
   it was written, which is when it knew less than half of that. */
#ifndef PREPROCESS_SUBDIVISION_SAMPLE_CACHE_H
#define PREPROCESS_SUBDIVISION_SAMPLE_CACHE_H
#include <pthread.h>

#include "base/cache_file.h"

struct sample_cache {
    struct cache_file file;
    const uint64_t *known; /* in the file; NULL: none */
    size_t slot_count;
    pthread_mutex_t lock;
    /* --- below: under lock */
    struct sample_cache_asked *asked;
    size_t asked_count, asked_capacity, missed_count;
};

#define SAMPLE_CACHE_NOTES 128
struct sample_cache_notes { /* of one thread, zeroed at first */
    struct sample_cache_asked {
        uint64_t key;
        uint32_t tri;
    } at[SAMPLE_CACHE_NOTES];
    size_t count, missed;
};

void sample_cache_open(struct sample_cache *sample_cache, const char *folder, uint64_t key);
void sample_cache_close(struct sample_cache *sample_cache);
/* If it is worth it. What cannot be written is not kept. */
void sample_cache_write(const struct sample_cache *sample_cache, const char *folder, uint64_t key);

/* The triangle that a point was found on; TRIMESH_NONE: nowhere. Key: a hash of all that this depends on, but for the surface. False: it is
   not known. Thread: any. */
bool sample_cache_find(const struct sample_cache *sample_cache, uint64_t key, uint32_t *tri);
/* What was asked for, whether it was known, and whether not. Notes are handed over now and then; in the end, by sample_cache_hand_over. */
void sample_cache_note(struct sample_cache *sample_cache, struct sample_cache_notes *notes, uint64_t key, uint32_t tri, bool known);
void sample_cache_hand_over(struct sample_cache *sample_cache, struct sample_cache_notes *notes);

#endif
