/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Groups for tags: by unit and, where that does not say it, by the letters of ISA-5.1; ranges from scaled limits. Thread: one. */
#ifndef PREPROCESS_MATCH_QUANTITIES_H
#define PREPROCESS_MATCH_QUANTITIES_H
#include "plant/plant.h"
#include "preprocess/match/matcher.h"

struct quantity { /* a group, as it is or as it will be */
    char *id, *name, *unit;
    bool is_new;        /* else the plant file has it */
    double low, high;   /* of the scaled limits of its tags, in its unit; low > high: none has any */
    size_t tags, blank; /* that are in it; those of them without a unit */
};

struct quantities { /* zero-initialise */
    struct quantity *at;
    size_t count, capacity;
    int *of_tag; /* by tag: index, or -1 */
};

/* Puts each matched tag that measures something into a group: one of the plant's whose unit fits, or a new one. The placeholder that
 * `plantcast import` writes (unused is its id, or NULL) does not count. */
void quantities_find(struct quantities *quantities, const struct plant *plant, const char *unused, const struct tag_export *list,
                     const struct match *matches);
void quantities_finish(struct quantities *quantities);

#endif
