/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where on the surface the points lie that splitting looks at, for the next time: KEY.spots beside the asset files. No sensor has a part in
   that, and finding it is half of the work. Safe to delete; one that is no good counts as none. It holds what was asked the last time that
   it was written, which is when it knew less than half of that. */
#ifndef PREPROCESS_SPOTS_H
#define PREPROCESS_SPOTS_H
#include <pthread.h>

#include "base/kept.h"

struct spots {
    struct kept file;
    const uint64_t *known; /* in the file; NULL: none */
    size_t slot_count;
    pthread_mutex_t lock;
    /* --- below: under lock */
    struct spots_asked *asked;
    size_t asked_count, asked_capacity, missed_count;
};

#define SPOTS_NOTES 128
struct spots_notes { /* of one thread, zeroed at first */
    struct spots_asked {
        uint64_t key;
        uint32_t tri;
    } at[SPOTS_NOTES];
    size_t count, missed;
};

void spots_open(struct spots *spots, const char *folder, uint64_t key);
void spots_close(struct spots *spots);
/* If it is worth it. What cannot be written is not kept. */
void spots_write(const struct spots *spots, const char *folder, uint64_t key);

/* The triangle that a point was found on; TRIMESH_NONE: nowhere. Key: a hash of all that this depends on, but for the surface. False: it is
   not known. Thread: any. */
bool spots_find(const struct spots *spots, uint64_t key, uint32_t *tri);
/* What was asked for, whether it was known, and whether not. Notes are handed over now and then; in the end, by spots_hand_over. */
void spots_note(struct spots *spots, struct spots_notes *notes, uint64_t key, uint32_t tri, bool known);
void spots_hand_over(struct spots *spots, struct spots_notes *notes);

#endif
