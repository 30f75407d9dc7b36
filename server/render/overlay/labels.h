/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses which markers get labels, and where the labels are placed, by the rule of protocol/LABELS.md. Pure; all lengths in pixels. */
#ifndef RENDER_OVERLAY_LABELS_H
#define RENDER_OVERLAY_LABELS_H
#include <stdbool.h>
#include <stddef.h>

struct label_box {
    double x, y, width, height;
};

enum { LABEL_NONE = -1, LABEL_SLOTS = 20, LABEL_FIRST_DIAGONAL = 8, LABEL_FIRST_FAR = 12, LABEL_MOST_BAD = 12 };
/* maximum number of leader lines of a call-out (a label shared by several alarm rings); if more rings are within LABEL_FARTHEST, only the
   nearest ring gets a line */
enum { LABEL_MOST_LEADS = 4 };
/* Largest distance between the label of alarm rings and the centre of its nearest ring, unless it is the frame's only label of rings. Also
   the longest leader line, unless all rings are farther away. In overlay units: 1 is a pixel at 1280x720. */
enum { LABEL_FARTHEST = 60 };
enum label_rank { LABEL_NOT_WANTED = -1, LABEL_PLAIN, LABEL_DOUBTFUL, LABEL_BAD, LABEL_BEYOND };

struct label_item {             /* one per visible marker */
    double x, y, width, height; /* x, y: centre of the marker; width, height: size of its label */
    double depth_m;
    enum label_rank rank;
    int held;    /* slot (candidate position around the marker) of its label in the previous frame, or LABEL_NONE */
    bool ring;   /* true: the marker has an alarm ring, so its label has the highest rank, LABEL_BEYOND */
    int callout; /* call-out (label shared by several alarm rings) that contained the item in the previous frame, or LABEL_NONE */
    /* index of the asset to which the marker's tag belongs; in a flood of alarms, all rings of an asset share a call-out.
       LABEL_NONE: none */
    int asset;
};
struct label_area {
    struct label_box box;
    double unit;
    const struct label_box *blocked;
    size_t blocked_count;
    /* callback that writes the width and height that a call-out (shared label) for these items would have */
    void (*measure)(void *arg, const int *members, size_t count, double size[2]);
    void *arg;
};
struct label_place {
    struct label_box box;
    int slot; /* LABEL_NONE: no label */
    /* index of the first item of the call-out (shared label) that contains this item; LABEL_NONE: the item has a label of its own */
    int callout;
};

/* Chooses the label positions of all markers: sets places[i] for items[i]. */
void labels_place(const struct label_item *items, size_t count, const struct label_area *area, struct label_place *places);

/* Returns whether a leader line connects item i with its label. places: from labels_place(). A call-out has leader lines to the rings near
   it, or only to the nearest if none or too many are near: more or longer lines would hide the plant. Rings that the call-out covers have
   none. */
bool labels_has_leader(const struct label_item *items, const struct label_place *places, size_t count, double unit, size_t i);

#endif
