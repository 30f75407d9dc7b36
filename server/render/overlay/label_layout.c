/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records in a grid which areas of a frame labels, markers and blocked boxes occupy, so that label placement can query free space fast. */
#include "render/overlay/labels_impl.h"

#include <math.h>

#include "base/mem.h"

static const double MARK_UNITS = 5, NEAR_GAP = 8, DIAGONAL_GAP = 6, FAR_GAP = 22, CELL_UNITS = 96;
/* distance of labels from the centres of alarm rings that are not their own: 10 units from the outer edge of the widest ring */
static const double OTHER_RING_UNITS = 25.5;

static int clamp(double value, int count)
{
    return value < 0 ? 0 : value >= count ? count - 1 : (int)value;
}

/* Finds the grid cells that a box covers: first and last column, first and last row. */
static void cells_of(const struct label_layout *layout, const struct label_box *box, int range[4])
{
    double cell = CELL_UNITS * layout->area->unit, x = box->x - layout->area->box.x, y = box->y - layout->area->box.y;
    range[0] = clamp(x / cell, layout->columns);
    range[1] = clamp((x + box->width) / cell, layout->columns);
    range[2] = clamp(y / cell, layout->rows);
    range[3] = clamp((y + box->height) / cell, layout->rows);
}

static void take(struct label_layout *layout, const struct label_box *box, int owner, enum label_over kind)
{
    int range[4];
    cells_of(layout, box, range);
    for (int column = range[0]; column <= range[1]; column++)
        for (int row = range[2]; row <= range[3]; row++) {
            int *head = &layout->heads[row * layout->columns + column];
            mem_grow(&layout->entries, &layout->entry_capacity, layout->entry_count + 1, sizeof(*layout->entries));
            layout->entries[layout->entry_count] = (struct cell_entry){ .box = *box, .owner = owner, .next = *head, .kind = kind };
            *head = (int)layout->entry_count++;
        }
}

struct label_box layout_grow(const struct label_box *box, double more)
{
    return (struct label_box){ box->x - more, box->y - more, box->width + 2 * more, box->height + 2 * more };
}

bool layout_meets(const struct label_box *a, const struct label_box *b)
{
    return a->x < b->x + b->width && b->x < a->x + a->width && a->y < b->y + b->height && b->y < a->y + a->height;
}

/* Returns whether a box comes too close to an item's alarm ring. group: group of rings to which the box belongs. */
static bool meets_ring(const struct label_layout *layout, const struct label_box *box, int item, int group)
{
    bool own = group != LABEL_NONE && layout->group_of[item] == group;
    return layout_distance(&layout->items[item], box, 0, 0) < (own ? LABEL_RING_UNITS : OTHER_RING_UNITS) * layout->area->unit;
}

bool layout_is_free(const struct label_layout *layout, const struct label_box *box, int owner, int group, enum label_over over)
{
    int range[4];
    cells_of(layout, box, range);
    for (int column = range[0]; column <= range[1]; column++)
        for (int row = range[2]; row <= range[3]; row++)
            for (int i = layout->heads[row * layout->columns + column]; i >= 0; i = layout->entries[i].next) {
                const struct cell_entry *entry = &layout->entries[i];
                bool counts = entry->owner != owner && entry->kind > over;
                if (counts && layout_meets(box, &entry->box) && (entry->kind != OVER_RINGS || meets_ring(layout, box, entry->owner, group)))
                    return false;
            }
    return true;
}

struct label_box layout_box(const struct label_item *item, int slot, double unit, double across, double down)
{
    static const double places[LABEL_SLOTS][2] = { { 1, -0.5 }, { -1, -0.5 }, { 1, -1.3 },  { 1, 0.3 }, { -1, -1.3 },
                                                   { -1, 0.3 }, { 0, -1.9 },  { 0, 0.9 },   { 1, -1 },  { -1, -1 },
                                                   { 1, 0 },    { -1, 0 },    { 1, -2 },    { -1, -2 }, { 1, 1 },
                                                   { -1, 1 },   { 1, -3.2 },  { -1, -3.2 }, { 1, 2.2 }, { -1, 2.2 } };
    bool diagonal = slot >= LABEL_FIRST_DIAGONAL && slot < LABEL_FIRST_FAR;
    double side = places[slot][0], gap = (diagonal ? DIAGONAL_GAP : slot < LABEL_FIRST_FAR ? NEAR_GAP : FAR_GAP) * unit;
    double above = places[slot][1] < -0.5 ? -1 : places[slot][1] > -0.5 ? 1 : 0;
    double more = item->ring ? (LABEL_RING_UNITS - MARK_UNITS) * unit : 0;
    double beside = across + gap + more;
    double x = side > 0 ? item->x + beside : side < 0 ? item->x - beside - item->width : item->x - item->width / 2;
    double rise = above * (more + down + (diagonal ? gap : 0));
    double y = item->y + places[slot][1] * item->height + (side == 0 || diagonal ? rise : 0);
    return (struct label_box){ x, y, item->width, item->height };
}

double layout_distance(const struct label_item *item, const struct label_box *box, double across, double down)
{
    return hypot(fmax(0, fmax(box->x - item->x, item->x - box->x - box->width) - across),
                 fmax(0, fmax(box->y - item->y, item->y - box->y - box->height) - down));
}

bool layout_is_inside(const struct label_layout *layout, const struct label_box *box)
{
    const struct label_box *area = &layout->area->box;
    return box->x >= area->x && box->y >= area->y && box->x + box->width <= area->x + area->width &&
           box->y + box->height <= area->y + area->height;
}

void layout_set(struct label_layout *layout, const int *members, size_t count, const struct label_box *box, int slot)
{
    take(layout, box, members[0], OVER_ALL);
    for (size_t i = 0; i < count; i++) {
        layout->places[members[i]] = (struct label_place){ *box, slot, count > 1 ? members[0] : LABEL_NONE };
        layout->labelled[layout->labelled_count++] = members[i];
    }
    layout->used += box->width * box->height;
}

void layout_init(struct label_layout *layout, const struct label_item *items, size_t count, const struct label_area *area,
                 struct label_place *places)
{
    double cell = CELL_UNITS * area->unit;
    *layout = (struct label_layout){ .items = items, .item_count = count, .area = area, .places = places };
    layout->columns = (int)(area->box.width / cell) + 1;
    layout->rows = (int)(area->box.height / cell) + 1;
    layout->heads = mem_array((size_t)layout->columns * (size_t)layout->rows, sizeof(*layout->heads));
    layout->group_of = mem_array(count, sizeof(*layout->group_of));
    layout->labelled = mem_array(count, sizeof(*layout->labelled));
    for (int i = 0; i < layout->columns * layout->rows; i++)
        layout->heads[i] = -1;
    for (size_t i = 0; i < area->blocked_count; i++)
        take(layout, &area->blocked[i], -1, OVER_ALL);
    for (size_t i = 0; i < count; i++) {
        double radius = (items[i].ring ? OTHER_RING_UNITS : MARK_UNITS) * area->unit;
        struct label_box mark = { items[i].x - radius, items[i].y - radius, 2 * radius, 2 * radius };
        take(layout, &mark, (int)i, items[i].ring ? OVER_RINGS : OVER_MARKS);
        layout->group_of[i] = LABEL_NONE;
        places[i] = (struct label_place){ .slot = LABEL_NONE, .callout = LABEL_NONE };
    }
}
