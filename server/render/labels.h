/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which labels are shown beside their markers, and where: the rule of protocol/LABELS.md. Pure; in pixels. */
#ifndef RENDER_LABELS_H
#define RENDER_LABELS_H
#include <stdbool.h>
#include <stddef.h>

struct box {
    double x, y, width, height;
};

enum { LABEL_NONE = -1, LABEL_SLOTS = 16, LABEL_FIRST_FAR = 8, LABEL_MOST_BAD = 12 };
enum label_rank { LABEL_NOT_WANTED = -1, LABEL_PLAIN, LABEL_DOUBTFUL, LABEL_BAD, LABEL_BEYOND, LABEL_RANKS };

struct label_item {             /* every marker in sight */
    double x, y, width, height; /* of the marker; of its label */
    double depth_m;
    enum label_rank rank;
    int held;  /* its slot in the picture before, or LABEL_NONE */
    bool ring; /* of alarm colours around it */
};
struct label_area {
    struct box box;
    double unit;
    const struct box *blocked;
    size_t blocked_count;
};

/* slots: by item; LABEL_NONE: no label. */
void labels_place(const struct label_item *items, size_t count, const struct label_area *area, int *slots);
struct box label_box(const struct label_item *item, int slot, double unit);

#endif
