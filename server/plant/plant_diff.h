/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Describes in words how two plants differ: tags, assets, groups and sources that were added, removed or changed. Pure. Thread: any. */
#ifndef PLANT_PLANT_DIFF_H
#define PLANT_PLANT_DIFF_H
#include "plant/plant.h"

struct plant_diff { /* zero-initialise */
    char **lines;   /* "tag TT-101: HH 90 > 95"; at most PLANT_DIFF_LINES; more: how many were left out */
    size_t count, capacity, more;
};
enum { PLANT_DIFF_LINES = 200 };
/* Appends a line for each difference. */
void plant_diff(const struct plant *before, const struct plant *after, struct plant_diff *out);
void plant_diff_finish(struct plant_diff *diff);
/* Returns what of the new plant a running daemon cannot take over without a restart (static); NULL: nothing. */
const char *plant_needs_restart(const struct plant *before, const struct plant *after);

#endif
