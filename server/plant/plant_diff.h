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
/* Returns true if a tag of the plant `before` and a tag of the plant `after` get their values in the same way: from the same source
   and address, with the same encoding, scaling and unit, or by the same expression. Otherwise, an old reading must not be shown
   for the new tag. */
bool plant_same_signal(const struct plant *before, const struct plant_tag *a, const struct plant *after, const struct plant_tag *b);
/* Sets kept[i] to whether tag i of the plant `after` gets its values in the same way as the tag of that name in the plant `before`
   (plant_same_signal()) and, if it is derived, whether the tags in its expression do so as well. */
void plant_kept_signals(const struct plant *before, const struct plant *after, bool *kept);
/* Returns the name (static) of a changed setting that a running daemon cannot apply without a restart; NULL: none. */
const char *plant_needs_restart(const struct plant *before, const struct plant *after);

#endif
