/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Describes how two plants differ, in words: tags, assets, groups and sources that were added, removed or changed. Pure. Call from
   any thread. */
#ifndef PLANT_PLANT_DIFF_H
#define PLANT_PLANT_DIFF_H
#include "plant/plant.h"

struct plant_diff { /* zero-initialise */
    /* texts, one for each difference, such as "tag TT-101: HH 90 > 95" (limit HH changed from 90 to 95) or "tag TT-101: HH none
       > 95"; at most PLANT_DIFF_LINES. more: number of differences beyond that */
    char **lines;
    size_t count, capacity, more;
};
enum { PLANT_DIFF_LINES = 200 };
/* Appends a line for each difference between the two plants to out->lines. */
void plant_diff(const struct plant *before, const struct plant *after, struct plant_diff *out);
void plant_diff_finish(struct plant_diff *diff);
/* Sets kept[i] to whether tag i of the plant `after` gets its values in the same way as the tag of that name in the plant `before`:
   from the same source and address, with the same encoding, scaling and unit, or by the same expression; if it is derived, the tags in
   its expression must do so as well. If kept[i] is false, an old reading must not be shown for the tag. */
void plant_kept_signals(const struct plant *before, const struct plant *after, bool *kept);
/* Returns the name (static) of a changed setting that a running daemon cannot apply without a restart; NULL: none. */
const char *plant_needs_restart(const struct plant *before, const struct plant *after);

#endif
