/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses which of several overlapping sensor markers are drawn. A hashed grid of the markers chosen so far avoids comparing each marker
   with all others. */
#include "render/overlay/crowd.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "base/mem.h"

enum { MAX_NEIGHBOURS = 6 };
static const double NEIGHBOUR_UNITS = 30, HELD_FACTOR = 0.8;

struct item_buckets {
    const struct crowd_item *items;
    double cell;
    /* Hash table of chosen markers by grid cell. heads: for each bucket, index of the marker added last; next: for each marker,
       index of the marker added to its bucket before it; -1: none */
    int *heads, *next;
    size_t mask;
};

static int by_importance(const void *a, const void *b, void *arg)
{
    const struct crowd_item *items = arg;
    int i = *(const int *)a, k = *(const int *)b;
    if (items[i].occluded != items[k].occluded)
        return items[i].occluded ? 1 : -1;
    if (items[i].held != items[k].held)
        return items[i].held ? -1 : 1;
    if (items[i].depth_m != items[k].depth_m)
        return items[i].depth_m < items[k].depth_m ? -1 : 1;
    return i < k ? -1 : 1;
}

static double cell_of(const struct item_buckets *crowd, double at)
{
    return floor(at / crowd->cell);
}

static size_t bucket(const struct item_buckets *crowd, double column, double row)
{
    return ((uint64_t)(int64_t)column * 73856093u ^ (uint64_t)(int64_t)row * 19349663u) & crowd->mask;
}

static void put(struct item_buckets *crowd, int index)
{
    const struct crowd_item *item = &crowd->items[index];
    int *head = &crowd->heads[bucket(crowd, cell_of(crowd, item->x), cell_of(crowd, item->y))];
    crowd->next[index] = *head;
    *head = index;
}

/* Counts the chosen markers in one grid cell whose squared distance from `item` is less than `least`; stops at MAX_NEIGHBOURS. */
static int count_cell(const struct item_buckets *crowd, double column, double row, const struct crowd_item *item, double least)
{
    int count = 0;
    for (int i = crowd->heads[bucket(crowd, column, row)]; i >= 0 && count < MAX_NEIGHBOURS; i = crowd->next[i]) {
        const struct crowd_item *other = &crowd->items[i];
        double x = other->x - item->x, y = other->y - item->y;
        /* compares the grid cell, too, because several grid cells may share a bucket of the hash table */
        bool is_here = cell_of(crowd, other->x) == column && cell_of(crowd, other->y) == row;
        count += is_here && x * x + y * y < least;
    }
    return count;
}

static bool is_crowded(const struct item_buckets *crowd, const struct crowd_item *item)
{
    double near = crowd->cell * (item->held ? HELD_FACTOR : 1), column = cell_of(crowd, item->x), row = cell_of(crowd, item->y);
    int count = 0;
    for (int i = -1; i <= 1; i++)
        for (int k = -1; k <= 1 && count < MAX_NEIGHBOURS; k++)
            count += count_cell(crowd, column + i, row + k, item, near * near);
    return count >= MAX_NEIGHBOURS;
}

void crowd_thin(const struct crowd_item *items, size_t count, double unit, bool *drawn)
{
    struct item_buckets crowd = { .items = items, .cell = NEIGHBOUR_UNITS * unit, .mask = 63 };
    int *order = mem_array(count, sizeof(*order));
    size_t others = 0;
    while (crowd.mask < count)
        crowd.mask = 2 * crowd.mask + 1;
    crowd.heads = mem_array(crowd.mask + 1, sizeof(*crowd.heads));
    crowd.next = mem_array(count, sizeof(*crowd.next));
    for (size_t i = 0; i <= crowd.mask; i++)
        crowd.heads[i] = -1;
    for (size_t i = 0; i < count; i++) {
        drawn[i] = items[i].kept;
        if (items[i].kept)
            put(&crowd, (int)i);
        else
            order[others++] = (int)i;
    }
    qsort_r(order, others, sizeof(*order), by_importance, (void *)items);
    for (size_t i = 0; i < others; i++)
        if (!is_crowded(&crowd, &items[order[i]])) {
            drawn[order[i]] = true;
            put(&crowd, order[i]);
        }
    mem_free(order);
    mem_free(crowd.heads);
    mem_free(crowd.next);
}
