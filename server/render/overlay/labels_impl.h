/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is taken of one picture while its labels are placed: shared by labels.c and labels_rings.c. */
#ifndef RENDER_OVERLAY_LABELS_IMPL_H
#define RENDER_OVERLAY_LABELS_IMPL_H
#include "render/overlay/labels.h"

#define LABEL_CLEARANCE 3.0 /* units of room around a label that was not there before */

enum label_over { /* what a label may lie over; likewise what something is */
                  OVER_NOTHING,
                  OVER_MARKS, /* without a ring */
                  OVER_RINGS, /* and these */
                  OVER_ALL
};

struct cell_entry {
    struct box box;
    int owner, next;
    enum label_over kind;
};

struct layout { /* of one picture */
    const struct label_item *items;
    const struct label_area *area;
    struct label_place *places;
    int columns, rows, *heads; /* a grid of what is taken */
    struct cell_entry *entries;
    size_t entry_count, entry_capacity;
    int *labelled; /* items whose labels stand */
    int labelled_count;
    double used;
};

/* Where a label lies whose markers reach so far from the middle between them, item->x and item->y. */
struct box layout_box(const struct label_item *item, int slot, double unit, double across, double down);
bool layout_is_inside(const struct layout *layout, const struct box *box);
/* Over nothing but what is the owner's and what it may lie over. */
bool layout_is_free(const struct layout *layout, const struct box *box, int owner, enum label_over over);
/* A label of these items, which are in a call-out where there are several. */
void layout_set(struct layout *layout, const int *members, size_t count, const struct box *box, int slot);
/* Every one of them, in order of importance, gets a label, or is in a call-out. */
void layout_place_rings(struct layout *layout, const int *order, size_t count);

#endif
