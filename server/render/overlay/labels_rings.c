/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Places labels of alarm rings: each alarm ring (the circle around the marker of a tag in alarm) gets its own label or shares a call-out,
   one label for several near rings. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "render/overlay/labels_impl.h"

/* CLOSE: distance in units (pixels at 1280x720) below which alarm rings share a call-out (one label); STILL_CLOSE: the same for rings that
   shared a call-out in the previous frame */
static const double CLOSE = 26, STILL_CLOSE = 34;
static const double APART = 8;     /* least distance between two labels of rings, in units */
static const double GROWTH = 1.25; /* factor by which CLOSE and STILL_CLOSE grow, repeatedly, until at most MAX_GROUPS labels remain */
/* maximum number of labels; more alarm rings than this count as a flood, in which rings of one asset share a call-out */
enum { MAX_GROUPS = 24 };
/* Further positions for the label of a group of alarm rings, if none directly around the group is free: a grid around its
   centre, tried nearest first. STEP_X, STEP_Y: spacing in units (pixels at 1280x720); STEPS: number of steps to each side. */
enum { STEP_X = 24, STEP_Y = 15, STEPS = 60, SIDE = 2 * STEPS + 1, OFFSETS = SIDE * SIDE, NOWHERE = -2 };

struct offset {
    int x, y, squared, index;
};

struct ring_group {         /* rings that share a label */
    struct label_item item; /* the group as one label item. x, y: centre of its rings; width, height: size of its label */
    double across, down;    /* half the width and height of the rectangle that encloses the centres of the group's alarm rings */
    int *members;           /* indices of the group's items (markers), most important first; points into rings.members */
    size_t count;
    struct label_box box;
    /* mate: index of the group with which this one is to be merged, because its label found no free position; LABEL_NONE: the
       label has a position */
    int slot, mate;
};

struct rings {
    struct label_layout *layout;
    const int *order;
    size_t count, group_count;
    /* size in pixels of one unit for CLOSE and STILL_CLOSE; it is enlarged step by step (GROWTH) until at most MAX_GROUPS
       labels remain */
    double least;
    struct ring_group *groups;
    /* [ring, in the order of `order`]: position in pixels at which the ring counts when near rings are grouped: its own, or in
       a flood of alarms the centre of its asset's rings */
    double (*anchors)[2];
    int *members;           /* indices of the items (markers) of all groups of alarm rings, group after group */
    struct offset *offsets; /* sorted by distance */
};

static int by_distance(const void *a, const void *b)
{
    const struct offset *i = a, *k = b;
    return i->squared != k->squared ? (i->squared > k->squared) - (i->squared < k->squared) : i->index - k->index;
}

static struct offset *make_offsets(void)
{
    struct offset *offsets = mem_array(OFFSETS, sizeof(*offsets));
    for (int i = 0; i < OFFSETS; i++) {
        int x = (i % SIDE - STEPS) * STEP_X, y = (i / SIDE - STEPS) * STEP_Y;
        offsets[i] = (struct offset){ x, y, x * x + y * y, i };
    }
    qsort(offsets, OFFSETS, sizeof(*offsets), by_distance);
    return offsets;
}

/* --- who belongs together ---------------------------------------------------------------------------------------------------- */

static const struct label_item *ring_at(const struct rings *rings, size_t i)
{
    return &rings->layout->items[rings->order[i]];
}

/* Returns the index in `groups` of the group that contains an alarm ring. i: index in `order`. */
static int *group_of(const struct rings *rings, size_t i)
{
    return &rings->layout->group_of[rings->order[i]];
}

/* Sets the position that represents each alarm ring when rings are grouped: its own, or in a flood the centre of all rings of its
   equipment, so that they share a call-out. */
static void set_anchors(const struct rings *rings)
{
    for (size_t i = 0; i < rings->count; i++) {
        const struct label_item *one = ring_at(rings, i);
        double left = one->x, right = one->x, top = one->y, bottom = one->y;
        for (size_t k = 0; k < rings->count && rings->count > MAX_GROUPS && one->asset != LABEL_NONE; k++) {
            const struct label_item *other = ring_at(rings, k);
            if (other->asset != one->asset)
                continue;
            left = fmin(left, other->x);
            right = fmax(right, other->x);
            top = fmin(top, other->y);
            bottom = fmax(bottom, other->y);
        }
        rings->anchors[i][0] = (left + right) / 2;
        rings->anchors[i][1] = (top + bottom) / 2;
    }
}

static bool are_close(const struct rings *rings, size_t i, size_t k)
{
    const struct label_item *a = ring_at(rings, i), *b = ring_at(rings, k);
    bool did = a->callout != LABEL_NONE && a->callout == b->callout;
    double least = (did ? STILL_CLOSE : CLOSE) * rings->least;
    double dx = rings->anchors[i][0] - rings->anchors[k][0], dy = rings->anchors[i][1] - rings->anchors[k][1];
    return dx * dx + dy * dy < least * least;
}

static int root_of(int *first, int i)
{
    while (first[i] != i)
        i = first[i] = first[first[i]];
    return i;
}

static void join(int *first, int i, int k)
{
    int a = root_of(first, i), b = root_of(first, k);
    first[a > b ? a : b] = a < b ? a : b;
}

/* Groups alarm rings that are close to each other. first: union-find forest; by ring: index of its parent. Returns the number of groups. */
static size_t join_close(const struct rings *rings, int *first)
{
    size_t groups = 0;
    for (size_t i = 0; i < rings->count; i++) {
        first[i] = (int)i;
        for (size_t k = 0; k < i; k++)
            if (are_close(rings, i, k))
                join(first, (int)i, (int)k);
    }
    for (size_t i = 0; i < rings->count; i++)
        groups += first[i] == (int)i;
    return groups;
}

/* Computes centre and size of a group of alarm rings, and the slot (candidate position) that its label had in the previous frame. */
static void measure(struct rings *rings, struct ring_group *group)
{
    const struct label_area *area = rings->layout->area;
    const struct label_item *items = rings->layout->items, *one = &items[group->members[0]];
    double left = INFINITY, right = -INFINITY, top = INFINITY, bottom = -INFINITY, size[2] = { one->width, one->height };
    group->item.held = LABEL_NONE;
    for (size_t i = group->count; i-- > 0;) {
        const struct label_item *item = &items[group->members[i]];
        left = fmin(left, item->x);
        right = fmax(right, item->x);
        top = fmin(top, item->y);
        bottom = fmax(bottom, item->y);
        /* ignores the label's previous slot (candidate position) if the label was then of another kind: of a single ring instead of a
           call-out, or the reverse */
        if ((item->callout == LABEL_NONE) == (group->count == 1))
            group->item.held = item->held;
    }
    if (group->count > 1)
        area->measure(area->arg, group->members, group->count, size);
    group->item.x = (left + right) / 2;
    group->item.y = (top + bottom) / 2;
    group->item.width = size[0];
    group->item.height = size[1];
    group->item.ring = true;
    group->across = (right - left) / 2;
    group->down = (bottom - top) / 2;
}

/* Makes one group from each set of alarm rings that share a label. first: union-find forest from join_close(), indexed like `order`. */
static void make_groups(struct rings *rings, int *first)
{
    int *next = rings->members;
    rings->group_count = 0;
    for (size_t i = 0; i < rings->count; i++) {
        int root = root_of(first, (int)i), index = root == (int)i ? (int)rings->group_count++ : *group_of(rings, (size_t)root);
        if (root == (int)i)
            rings->groups[index] = (struct ring_group){ .count = 0 };
        *group_of(rings, i) = index;
        rings->groups[index].count++;
    }
    for (size_t i = 0; i < rings->group_count; i++) {
        rings->groups[i].members = next;
        next += rings->groups[i].count;
        rings->groups[i].count = 0;
    }
    for (size_t i = 0; i < rings->count; i++) {
        struct ring_group *group = &rings->groups[*group_of(rings, i)];
        group->members[group->count++] = rings->order[i];
    }
    for (size_t i = 0; i < rings->group_count; i++)
        measure(rings, &rings->groups[i]);
}

/* --- positions of labels ----------------------------------------------------------------------------------------------------- */

static struct label_box box_at(const struct rings *rings, const struct ring_group *group, int slot)
{
    const struct label_item *item = &group->item;
    double unit = rings->layout->area->unit;
    if (slot < LABEL_SLOTS)
        return layout_box(item, slot, unit, group->across, group->down);
    const struct offset *offset = &rings->offsets[slot - LABEL_SLOTS];
    return (struct label_box){ item->x + offset->x * unit - item->width / 2, item->y + offset->y * unit - item->height / 2, item->width,
                               item->height };
}

/* Returns whether a label in this slot (candidate position) is at most LABEL_FARTHEST away from one of its group's alarm rings. */
static bool is_near(const struct rings *rings, const struct ring_group *group, int slot)
{
    struct label_box box = box_at(rings, group, slot);
    const struct label_item *items = rings->layout->items;
    double farthest = LABEL_FARTHEST * rings->layout->area->unit;
    /* For most slots, the distance from the rectangle around all rings answers the question. */
    bool near = layout_distance(&group->item, &box, group->across, group->down) <= farthest, found = false;
    for (size_t i = 0; i < group->count && near && !found; i++)
        found = layout_distance(&items[group->members[i]], &box, 0, 0) <= farthest;
    return found;
}

/* Returns whether the label of a group of alarm rings, with `more` pixels of free space around, fits in this slot (candidate position
   around the group). The label keeps a distance of APART from the labels of earlier groups. */
static bool is_free(const struct rings *rings, const struct ring_group *group, int slot, double more, enum label_over over)
{
    struct label_box box = box_at(rings, group, slot), grown = layout_grow(&box, more);
    struct label_box wide = layout_grow(&box, more + APART * rings->layout->area->unit);
    int owner = slot < LABEL_SLOTS && group->count == 1 ? group->members[0] : LABEL_NONE - 1;
    int index = (int)(group - rings->groups);
    if (rings->group_count > 1 && !is_near(rings, group, slot))
        return false;
    if (!layout_is_inside(rings->layout, &box) || !layout_is_free(rings->layout, &grown, owner, index, over))
        return false;
    for (const struct ring_group *other = rings->groups; other < group; other++)
        if (other->slot != NOWHERE && layout_meets(&wide, &other->box))
            return false;
    return true;
}

static int find_slot(const struct rings *rings, const struct ring_group *group)
{
    int held = group->item.held;
    double clearance = LABEL_CLEARANCE * rings->layout->area->unit;
    bool is_known = held >= 0 && held < LABEL_SLOTS + OFFSETS;
    if (is_known && is_near(rings, group, held) && is_free(rings, group, held, 0, OVER_MARKS))
        return held;
    for (int i = 0; i < 2 * LABEL_SLOTS; i++)
        if (is_free(rings, group, i % LABEL_SLOTS, clearance, i < LABEL_SLOTS ? OVER_NOTHING : OVER_MARKS))
            return i % LABEL_SLOTS;
    for (int slot = LABEL_SLOTS; slot < LABEL_SLOTS + OFFSETS; slot++)
        if (is_free(rings, group, slot, clearance, OVER_MARKS))
            return slot;
    return NOWHERE;
}

static double squared(double x)
{
    return x * x;
}

static int nearest_to(const struct rings *rings, int index)
{
    const struct ring_group *a = &rings->groups[index];
    double least = INFINITY;
    int nearest = -1;
    for (int i = 0; i < (int)rings->group_count; i++) {
        const struct ring_group *b = &rings->groups[i];
        double apart = squared(fmax(0, fabs(a->item.x - b->item.x) - a->across - b->across)) +
                       squared(fmax(0, fabs(a->item.y - b->item.y) - a->down - b->down));
        if (i != index && apart < least) {
            least = apart;
            nearest = i;
        }
    }
    return nearest;
}

/* Places one label for each group of alarm rings. Returns false if a label found no room; its group's `mate` is then the group with which
   to merge. */
static bool place_groups(struct rings *rings)
{
    bool all = true;
    for (size_t i = 0; i < rings->group_count; i++) {
        struct ring_group *group = &rings->groups[i];
        group->slot = find_slot(rings, group);
        if (group->slot != NOWHERE)
            group->box = box_at(rings, group, group->slot);
        else if (rings->group_count == 1) /* there is no other group to merge with */
            group->slot = layout_cover_least(rings->layout, &group->item, &group->box);
        group->mate = group->slot == NOWHERE ? nearest_to(rings, (int)i) : LABEL_NONE;
        all = all && group->slot != NOWHERE;
    }
    return all;
}

void layout_place_rings(struct label_layout *layout, const int *order, size_t count)
{
    struct rings rings = { .layout = layout, .order = order, .count = count };
    int *first = mem_array(count, sizeof(*first));
    rings.groups = mem_array(count, sizeof(*rings.groups));
    rings.anchors = mem_array(count, sizeof(*rings.anchors));
    rings.members = mem_array(count, sizeof(*rings.members));
    rings.offsets = count ? make_offsets() : NULL;
    set_anchors(&rings);
    for (rings.least = layout->area->unit; join_close(&rings, first) > MAX_GROUPS; rings.least *= GROWTH) {
    }
    make_groups(&rings, first);
    while (count && !place_groups(&rings)) {
        for (size_t i = 0; i < count; i++) {
            int mate = rings.groups[*group_of(&rings, i)].mate;
            for (size_t k = 0; k < count && mate != LABEL_NONE; k++)
                if (*group_of(&rings, k) == mate) {
                    join(first, (int)i, (int)k);
                    mate = LABEL_NONE;
                }
        }
        make_groups(&rings, first);
    }
    for (size_t i = 0; i < rings.group_count; i++)
        layout_set(layout, rings.groups[i].members, rings.groups[i].count, &rings.groups[i].box, rings.groups[i].slot);
    mem_free(rings.groups);
    mem_free(rings.anchors);
    mem_free(rings.members);
    mem_free(rings.offsets);
    mem_free(first);
}
