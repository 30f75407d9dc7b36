/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What differs between two plants, in words: which tags, assets, groups and sources came, went or changed. Pure. Thread: any. */
#ifndef PLANT_PLANT_DIFF_H
#define PLANT_PLANT_DIFF_H
#include "plant/plant.h"

struct plant_diff { /* zero-initialise */
    char **lines;   /* "tag TT-101: HH 90 > 95"; at most PLANT_DIFF_LINES, then how many more */
    size_t count, capacity, more;
};
enum { PLANT_DIFF_LINES = 200 };
void plant_diff(const struct plant *before, const struct plant *after, struct plant_diff *out);
void plant_diff_finish(struct plant_diff *diff);
/* What of a new plant a running daemon cannot take over; static. NULL: nothing. */
const char *plant_needs_restart(const struct plant *before, const struct plant *after);

#endif
