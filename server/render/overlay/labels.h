/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which labels are shown beside their markers, and where: the rule of protocol/LABELS.md. Pure; in pixels. */
#ifndef RENDER_OVERLAY_LABELS_H
#define RENDER_OVERLAY_LABELS_H
#include <stdbool.h>
#include <stddef.h>

struct box {
    double x, y, width, height;
};

enum { LABEL_NONE = -1, LABEL_SLOTS = 16, LABEL_FIRST_FAR = 8, LABEL_MOST_BAD = 12 };
enum label_rank { LABEL_NOT_WANTED = -1, LABEL_PLAIN, LABEL_DOUBTFUL, LABEL_BAD, LABEL_BEYOND };

struct label_item {             /* every marker in sight */
    double x, y, width, height; /* of the marker; of its label */
    double depth_m;
    enum label_rank rank;
    int held;    /* its slot in the picture before, or LABEL_NONE */
    bool ring;   /* of alarm colours around it: those of rank LABEL_BEYOND */
    int callout; /* the one that it was in in the picture before, or LABEL_NONE */
};
struct label_area {
    struct box box;
    double unit;
    const struct box *blocked;
    size_t blocked_count;
    void (*measure)(void *arg, const int *members, size_t count, double size[2]); /* of the call-out of these items */
    void *arg;
};
struct label_place {
    struct box box;
    int slot;    /* LABEL_NONE: no label */
    int callout; /* the item that leads the call-out that it is in, or LABEL_NONE: a label of its own */
};

/* places: by item. */
void labels_place(const struct label_item *items, size_t count, const struct label_area *area, struct label_place *places);

#endif
