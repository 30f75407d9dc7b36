/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses which markers get a label, by rank, distance and free space. */
#include "render/overlay/labels_impl.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

enum { PASSES = 3 };
static const double SPACINGS[PASSES] = { 0.16, 0.08, 0 };
static const double MAX_COVERED_PART = 0.06;

static bool is_held(const struct label_item *item)
{
    return item->held != LABEL_NONE;
}

static double order_depth(const struct label_item *item)
{
    return item->depth_m * (is_held(item) ? LABEL_HELD_FACTOR : 1);
}

static int by_importance(const void *a, const void *b, void *arg)
{
    const struct label_item *items = arg;
    int i = *(const int *)a, k = *(const int *)b;
    double depth_i = order_depth(&items[i]), depth_k = order_depth(&items[k]);
    if (items[i].rank != items[k].rank)
        return items[i].rank > items[k].rank ? -1 : 1;
    if (depth_i != depth_k)
        return depth_i < depth_k ? -1 : 1;
    return i < k ? -1 : 1;
}

/* --- one label -------------------------------------------------------------------------------------------------------------- */

static struct label_box box_of(const struct label_item *item, int slot, double unit)
{
    return layout_box(item, slot, unit, 0, 0);
}

static bool fits(const struct label_layout *layout, int index, int slot)
{
    const struct label_item *item = &layout->items[index];
    struct label_box box = box_of(item, slot, layout->area->unit);
    double more = slot == item->held ? 0 : LABEL_CLEARANCE * layout->area->unit;
    struct label_box grown = layout_grow(&box, more);
    return layout_is_inside(layout, &box) && layout_is_free(layout, &grown, index, LABEL_NONE, OVER_NOTHING);
}

static void place(struct label_layout *layout, int index)
{
    const struct label_item *item = &layout->items[index];
    /* the slot (candidate position) that the label had in the previous frame is tried first, unless that label was a call-out (a label
       shared by several markers) */
    for (int n = is_held(item) && item->held < LABEL_SLOTS ? -1 : 0; n < LABEL_SLOTS; n++) {
        int slot = n < 0 ? item->held : n;
        if (!fits(layout, index, slot))
            continue;
        struct label_box box = box_of(item, slot, layout->area->unit);
        layout_set(layout, &index, 1, &box, slot);
        return;
    }
}

static bool is_apart(const struct label_layout *layout, const struct label_item *item, double least)
{
    for (int i = 0; i < layout->labelled_count; i++) {
        const struct label_item *other = &layout->items[layout->labelled[i]];
        if (hypot(other->x - item->x, other->y - item->y) < least)
            return false;
    }
    return true;
}

static void place_rank(struct label_layout *layout, const int *order, size_t count)
{
    const struct label_box *area = &layout->area->box;
    for (int pass = 0; pass < PASSES; pass++)
        for (size_t i = 0; i < count; i++) {
            const struct label_item *item = &layout->items[order[i]];
            bool room = item->rank >= LABEL_BAD || layout->used < MAX_COVERED_PART * area->width * area->height;
            double least = SPACINGS[pass] * area->width * (is_held(item) ? LABEL_HELD_FACTOR : 1);
            if (room && layout->places[order[i]].slot == LABEL_NONE && is_apart(layout, item, least))
                place(layout, order[i]);
        }
}

void labels_place(const struct label_item *items, size_t count, const struct label_area *area, struct label_place *places)
{
    struct label_layout layout;
    int *order = mem_array(count, sizeof(*order));
    size_t wanted = 0, rings = 0;
    layout_init(&layout, items, count, area, places);
    for (size_t i = 0; i < count; i++)
        if (items[i].rank != LABEL_NOT_WANTED)
            order[wanted++] = (int)i;
    qsort_r(order, wanted, sizeof(*order), by_importance, (void *)items);
    while (rings < wanted && items[order[rings]].rank == LABEL_BEYOND)
        rings++;
    layout_place_rings(&layout, order, rings);
    for (size_t begin = rings, end; begin < wanted; begin = end) {
        for (end = begin; end < wanted && items[order[end]].rank == items[order[begin]].rank;)
            end++;
        place_rank(&layout, order + begin, end - begin);
    }
    mem_free(layout.heads);
    mem_free(layout.entries);
    mem_free(layout.group_of);
    mem_free(layout.labelled);
    mem_free(order);
}

bool labels_has_leader(const struct label_item *items, const struct label_place *places, size_t count, double unit, size_t i)
{
    double nearest = INFINITY, farthest = LABEL_FARTHEST * unit, covered = LABEL_RING_UNITS * unit;
    int near = 0;
    if (places[i].callout == LABEL_NONE)
        return places[i].slot >= LABEL_FIRST_FAR;
    for (size_t k = 0; k < count; k++)
        if (places[k].callout == places[i].callout) {
            double distance = layout_distance(&items[k], &places[k].box, 0, 0);
            if (distance < covered)
                continue;
            nearest = fmin(nearest, distance);
            near += distance <= farthest;
        }
    double distance = layout_distance(&items[i], &places[i].box, 0, 0);
    return distance >= covered && distance <= (near > LABEL_MOST_LEADS ? nearest : fmax(nearest, farthest));
}
