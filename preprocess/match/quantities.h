/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Assigns tags to groups by unit and, if the unit is ambiguous, by their ISA-5.1 letters. Derives value ranges from the tags'
   scaled limits (lowest and highest measurable values). Call from one thread only. */
#ifndef PREPROCESS_MATCH_QUANTITIES_H
#define PREPROCESS_MATCH_QUANTITIES_H
#include "plant/plant.h"
#include "preprocess/match/matcher.h"

struct quantity { /* a group of tags: an existing one, or one to add to the plant file */
    char *id, *name, *unit;
    bool is_new;        /* true: the group will be added to the plant file; false: the plant file already has the group */
    /* lowest and highest scaled limit (measurable value) of the group's tags, in the group's unit; low > high: none */
    double low, high;
    size_t tags, blank; /* tags: number of tags in the group; blank: number of tags without a unit */
};

struct quantities { /* zero-initialise */
    struct quantity *at;
    size_t count, capacity;
    int *of_tag; /* by tag: index of its group, which determines what the tag measures; -1: none */
};

/* Assigns each matched tag that measures something to a group: an existing one with a compatible unit, or a new one. unused: id
 * of a group to ignore, because it is only the placeholder of `plantcast import`; NULL: none. */
void quantities_find(struct quantities *quantities, const struct plant *plant, const char *unused, const struct tag_export *list,
                     const struct match *matches);
void quantities_finish(struct quantities *quantities);

#endif
