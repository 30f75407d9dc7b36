/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses which labels are shown beside their markers, and where, by the rule of protocol/LABELS.md. Pure; all lengths in pixels. */
#ifndef RENDER_OVERLAY_LABELS_H
#define RENDER_OVERLAY_LABELS_H
#include <stdbool.h>
#include <stddef.h>

struct label_box {
    double x, y, width, height;
};

enum { LABEL_NONE = -1, LABEL_SLOTS = 16, LABEL_FIRST_FAR = 8, LABEL_MOST_BAD = 12 };
enum label_rank { LABEL_NOT_WANTED = -1, LABEL_PLAIN, LABEL_DOUBTFUL, LABEL_BAD, LABEL_BEYOND };

struct label_item {             /* one per visible marker */
    double x, y, width, height; /* centre of the marker; size of its label */
    double depth_m;
    enum label_rank rank;
    int held;    /* slot of its label in the picture before, or LABEL_NONE */
    bool ring;   /* has an alarm ring: only of rank LABEL_BEYOND */
    int callout; /* the call-out it was in in the picture before, or LABEL_NONE */
};
struct label_area {
    struct label_box box;
    double unit;
    const struct label_box *blocked;
    size_t blocked_count;
    void (*measure)(void *arg, const int *members, size_t count, double size[2]); /* gives the size of the call-out for these items */
    void *arg;
};
struct label_place {
    struct label_box box;
    int slot;    /* LABEL_NONE: no label */
    int callout; /* index of the item that leads its call-out; LABEL_NONE: a label of its own */
};

/* Sets places[i] for items[i]. */
void labels_place(const struct label_item *items, size_t count, const struct label_area *area, struct label_place *places);

#endif
