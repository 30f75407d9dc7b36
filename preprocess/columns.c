/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Slots of equal size in a file: a place, a checksum and a column in each. */
#include "preprocess/columns.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "base/mem.h"
#include "preprocess/file_io.h"
#include "preprocess/folder.h"

struct slot { /* the column follows */
    double place_m[3];
    uint64_t checksum; /* XXH3-64 of the column, with key and place; torn or foreign slots have another */
};

static size_t slot_bytes(const struct columns *columns)
{
    return sizeof(struct slot) + columns->length * sizeof(float);
}

static off_t slot_at(const struct columns *columns, size_t slot)
{
    return (off_t)(slot * slot_bytes(columns));
}

static uint64_t checksum_of(const struct columns *columns, size_t place, const float *distances_m)
{
    uint64_t seed = XXH3_64bits_withSeed(columns->places_m[place], sizeof(columns->places_m[place]), columns->key);
    return XXH3_64bits_withSeed(distances_m, columns->length * sizeof(*distances_m), seed);
}

/* Which place each slot belongs to; the others get the free slots, and then new ones. */
static void deal_slots(struct columns *columns)
{
    struct stat st;
    size_t there = fstat(columns->fd, &st) == 0 ? (size_t)st.st_size / slot_bytes(columns) : 0, next = 0;
    char *taken = mem_array(there, 1);
    for (size_t i = 0; i < there; i++) {
        struct slot slot;
        if (!file_read(columns->fd, &slot, sizeof(slot), slot_at(columns, i)))
            continue;
        for (size_t p = 0; p < columns->count && !taken[i]; p++)
            if (columns->slots[p] == SIZE_MAX && memcmp(slot.place_m, columns->places_m[p], sizeof(slot.place_m)) == 0) {
                columns->slots[p] = i;
                taken[i] = 1;
            }
    }
    for (size_t p = 0; p < columns->count; p++) {
        if (columns->slots[p] != SIZE_MAX)
            continue;
        while (next < there && taken[next])
            next++;
        columns->slots[p] = next++;
    }
    mem_free(taken);
}

void columns_open(struct columns *columns, const char *folder, uint64_t key, size_t length, const double (*places_m)[3], size_t count)
{
    char *path = folder_path(folder, key, FOLDER_COLUMNS);
    *columns = (struct columns){ .key = key, .length = length, .places_m = places_m, .count = count };
    columns->fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    columns->may_write = columns->fd >= 0;
    columns->slots = mem_array(count, sizeof(*columns->slots));
    for (size_t p = 0; p < count; p++)
        columns->slots[p] = SIZE_MAX;
    deal_slots(columns); /* of a file that cannot be opened: none is there */
    mem_free(path);
}

void columns_close(struct columns *columns)
{
    if (!columns->slots)
        return;
    if (columns->fd >= 0)
        close(columns->fd);
    mem_free(columns->slots);
    *columns = (struct columns){ 0 };
}

static bool fetch(void *arg, size_t source, float *distances_m)
{
    struct columns *columns = arg;
    struct slot slot;
    off_t at = slot_at(columns, columns->slots[source]);
    bool good = file_read(columns->fd, &slot, sizeof(slot), at) &&
                memcmp(slot.place_m, columns->places_m[source], sizeof(slot.place_m)) == 0 &&
                file_read(columns->fd, distances_m, columns->length * sizeof(*distances_m), at + (off_t)sizeof(slot)) &&
                slot.checksum == checksum_of(columns, source, distances_m);
    columns->kept += good;
    return good;
}

static void keep(void *arg, size_t source, const float *distances_m)
{
    struct columns *columns = arg;
    struct slot slot = { .checksum = checksum_of(columns, source, distances_m) };
    off_t at = slot_at(columns, columns->slots[source]);
    memcpy(slot.place_m, columns->places_m[source], sizeof(slot.place_m));
    if (!columns->may_write || !file_write(columns->fd, &slot, sizeof(slot), at) ||
        !file_write(columns->fd, distances_m, columns->length * sizeof(*distances_m), at + (off_t)sizeof(slot)))
        columns->may_write = false; /* what is there of it has another checksum */
}

struct surface_columns columns_of_surface(struct columns *columns)
{
    return (struct surface_columns){ fetch, keep, columns };
}
