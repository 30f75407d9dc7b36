/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cache of the surface triangles that sample points were projected onto: KEY.spots in the folder of prepared files. Projections
 * do not depend on sensors and are half the work of subdivision. The file can be deleted at any time; a damaged file counts as
 * absent. It contains all lookups of the run that wrote it, and is rewritten if a run finds less than half of its lookups
 * there. */
#ifndef PREPROCESS_SUBDIVISION_SAMPLE_CACHE_H
#define PREPROCESS_SUBDIVISION_SAMPLE_CACHE_H
#include <pthread.h>

#include "base/files/cache_file.h"

struct sample_cache {
    struct cache_file file;
    const uint64_t *known; /* hash table in the opened file: triangle indices by key; NULL: there is no file */
    size_t slot_count;
    pthread_mutex_t lock;
    /* --- members below: protected by `lock` */
    struct sample_cache_asked *asked;
    size_t asked_count, asked_capacity, missed_count;
};

#define SAMPLE_CACHE_NOTES 128
struct sample_cache_notes { /* lookups recorded by one thread; zero-initialise */
    struct sample_cache_asked {
        uint64_t key;
        uint32_t tri;
    } at[SAMPLE_CACHE_NOTES];
    size_t count, missed;
};

/* Opens the cache of sample points with this key. A missing file gives an empty cache. Close with sample_cache_close(). */
void sample_cache_open(struct sample_cache *sample_cache, struct log *log, const char *folder, uint64_t key);
/* Closes the cache file and frees the recorded lookups. */
void sample_cache_close(struct sample_cache *sample_cache);
/* Writes this run's lookups to the cache file if too many were missing from it. Ignores errors: nothing is cached then. */
void sample_cache_write(const struct sample_cache *sample_cache, const char *folder, uint64_t key);

/* Looks up the surface triangle that a sample point projects onto; *tri is TRIMESH_NONE if there is none. key: a hash of
 * everything that the projection depends on, except the surface. Returns false if the lookup is not cached. Call from any
 * thread. */
bool sample_cache_find(const struct sample_cache *sample_cache, uint64_t key, uint32_t *tri);
/* Records a lookup of a sample point in the calling thread's notes: its key, the triangle, and whether the cache had it. Moves
 * full notes to the cache. Call from any thread, one at a time per notes object. */
void sample_cache_note(struct sample_cache *sample_cache, struct sample_cache_notes *notes, uint64_t key, uint32_t tri, bool known);
/* Moves a thread's notes into the cache, for sample_cache_write(). Call from any thread. */
void sample_cache_hand_over(struct sample_cache *sample_cache, struct sample_cache_notes *notes);

#endif
