/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A table of numbers of triangles by keys of points: eight bytes each, as they lie in the file. */
#include "preprocess/spots.h"

#include <string.h>

#include "base/mem.h"
#include "preprocess/folder.h"
#include "surface/trimesh.h"

#define MAGIC "PLCSPOTS"
#define TRI_BITS 24 /* one more than the triangle's number; the key's lower bits before it, its higher ones say where it stands */
#define NOWHERE ((1u << TRI_BITS) - 1)
#define FULL 0.85
#define WORTH 0.5 /* of what is asked for is known, or it is written anew */

void spots_open(struct spots *spots, const char *folder, uint64_t key)
{
    char *path = folder_path(folder, key, FOLDER_SPOTS);
    *spots = (struct spots){ 0 };
    pthread_mutex_init(&spots->lock, NULL);
    if (kept_open(&spots->file, path, MAGIC, key)) {
        spots->known = (const uint64_t *)(const void *)spots->file.bytes;
        spots->slot_count = spots->file.count / sizeof(*spots->known);
    }
    mem_free(path);
}

void spots_close(struct spots *spots)
{
    kept_close(&spots->file);
    mem_free(spots->asked);
    pthread_mutex_destroy(&spots->lock);
    *spots = (struct spots){ 0 };
}

/* Where the key stands in the table, or would. */
static size_t slot_of(const uint64_t *table, size_t count, uint64_t key)
{
    size_t slot = (size_t)((key >> 32) * count >> 32);
    for (size_t tries = 0; tries < count && table[slot] && table[slot] >> TRI_BITS != key << TRI_BITS >> TRI_BITS; tries++)
        slot = slot + 1 < count ? slot + 1 : 0;
    return slot;
}

bool spots_find(const struct spots *spots, uint64_t key, uint32_t *tri)
{
    uint64_t found = spots->slot_count ? spots->known[slot_of(spots->known, spots->slot_count, key)] : 0;
    if (!found || found >> TRI_BITS != key << TRI_BITS >> TRI_BITS)
        return false;
    *tri = (found & NOWHERE) == NOWHERE ? TRIMESH_NONE : (uint32_t)(found & NOWHERE) - 1;
    return true;
}

void spots_note(struct spots *spots, struct spots_notes *notes, uint64_t key, uint32_t tri, bool known)
{
    if (notes->count == SPOTS_NOTES)
        spots_hand_over(spots, notes);
    notes->at[notes->count++] = (struct spots_asked){ key, tri };
    notes->missed += !known;
}

void spots_hand_over(struct spots *spots, struct spots_notes *notes)
{
    if (notes->count == 0)
        return;
    pthread_mutex_lock(&spots->lock);
    mem_grow(&spots->asked, &spots->asked_capacity, spots->asked_count + notes->count, sizeof(*spots->asked));
    memcpy(spots->asked + spots->asked_count, notes->at, notes->count * sizeof(*notes->at));
    spots->asked_count += notes->count;
    spots->missed_count += notes->missed;
    pthread_mutex_unlock(&spots->lock);
    notes->count = notes->missed = 0;
}

void spots_write(const struct spots *spots, const char *folder, uint64_t key)
{
    const size_t count = 16 + (size_t)((double)spots->asked_count / FULL);
    if ((double)spots->missed_count <= (1 - WORTH) * (double)spots->asked_count)
        return;
    uint64_t *table = mem_array(count, sizeof(*table));
    for (size_t i = 0; i < spots->asked_count; i++) {
        const struct spots_asked *asked = &spots->asked[i];
        if (asked->tri != TRIMESH_NONE && asked->tri >= NOWHERE - 1)
            continue;
        table[slot_of(table, count, asked->key)] = asked->key << TRI_BITS | (asked->tri == TRIMESH_NONE ? NOWHERE : asked->tri + 1);
    }
    char *path = folder_path(folder, key, FOLDER_SPOTS);
    kept_write(path, MAGIC, key, table, count * sizeof(*table));
    mem_free(path);
    mem_free(table);
}
