/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of label placement in one frame, shared by label_layout.c, labels.c and labels_rings.c. */
#ifndef RENDER_OVERLAY_LABELS_IMPL_H
#define RENDER_OVERLAY_LABELS_IMPL_H
#include "render/overlay/labels.h"

/* slot of a call-out that may cover anything; the next slots are the positions of layout_cover_least(), row by row */
enum { LABEL_FORCED = 1000000 };
#define LABEL_RING_UNITS 13.0 /* least distance of a label from the centre of its own alarm ring, in units (pixels at 1280x720) */
#define LABEL_HELD_FACTOR 0.8 /* factor on depths and distances of labels that were in the previous frame, so that they tend to stay */
#define LABEL_CLEARANCE 3.0 /* free space required around a label that was not in the previous frame, in units (pixels at 1280x720) */

/* Which occupied boxes a label may cover; each value includes the previous ones. Each box is stored with the smallest value that allows a
   label to cover it. */
enum label_over {
    OVER_NOTHING,
    OVER_MARKS, /* markers without an alarm ring */
    OVER_RINGS, /* all markers, also those with an alarm ring (a circle around the marker of a tag in alarm) */
    OVER_ALL
};

struct cell_entry {
    struct label_box box;
    int owner, next;
    enum label_over kind;
};

struct label_layout {
    const struct label_item *items;
    size_t item_count;
    const struct label_area *area;
    struct label_place *places;
    int columns, rows, *heads; /* grid over the frame. heads: by grid cell, index of the cell's first occupied box; -1: the cell has none */
    struct cell_entry *entries;
    size_t entry_count, entry_capacity;
    /* by item: index of the group of alarm rings that share the item's label; LABEL_NONE: not in a group */
    int *group_of;
    int *labelled; /* indices of items (markers) that have a label */
    int labelled_count;
    double used;
};

/* Marks the blocked areas and the markers as occupied; no label is placed yet. */
void layout_init(struct label_layout *layout, const struct label_item *items, size_t count, const struct label_area *area,
                 struct label_place *places);
/* Returns the box of an item's label in a slot (candidate position around the marker). across, down: half the width and height of the group
   of markers around item->x, item->y; 0 for a single marker. */
struct label_box layout_box(const struct label_item *item, int slot, double unit, double across, double down);
/* Returns the distance in pixels of a label from the centre of an item's marker, or from a group of markers around this centre. across,
   down: half the width and height of the group; 0 for a single marker. */
double layout_distance(const struct label_item *item, const struct label_box *box, double across, double down);
/* Returns whether a box lies within the area of the frame in which labels may be placed. */
bool layout_is_inside(const struct label_layout *layout, const struct label_box *box);
/* Returns the box with `more` pixels added on each side. */
struct label_box layout_grow(const struct label_box *box, double more);
/* Returns whether two boxes overlap. Boxes that only share an edge do not. */
bool layout_meets(const struct label_box *a, const struct label_box *b);
/* Returns whether a box overlaps no occupied box, and is far enough from alarm rings. Ignored are the boxes of `owner`, and boxes that
   `over` allows a label to cover. The box may come closer to the rings of `group` than to others; LABEL_NONE: the box has no group. */
bool layout_is_free(const struct label_layout *layout, const struct label_box *box, int owner, int group, enum label_over over);
/* Places one label for these items (markers) in `box` and marks the box as occupied; more than one item makes the label a call-out (one
   label for several alarm rings). slot: the label's position relative to the marker, as an index of the candidate positions; stored, so
   that the next frame tries it first. */
void layout_set(struct label_layout *layout, const int *members, size_t count, const struct label_box *box, int slot);
/* Finds the position of a call-out for all alarm rings at which it covers the fewest rings, and none if there is such a position. If every
   position overlaps a blocked box, the call-out lies over its rings. group: centre and size of the call-out, and its slot in the previous
   frame. Writes the call-out's box and returns its slot. */
int layout_cover_least(const struct label_layout *layout, const struct label_item *group, struct label_box *box);
/* Gives every item with an alarm ring a label of its own or adds it to a call-out, a label shared by several rings. order: indices of the
   items, most important first. */
void layout_place_rings(struct label_layout *layout, const int *order, size_t count);

#endif
