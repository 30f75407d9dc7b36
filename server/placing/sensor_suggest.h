/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where more sensors would show the most: places one after the other, each of which takes away as much as one can of what the sensors of a
   group do not see. The measure is, over the surface, the mean of ln(h / h0) / ln(1 / 0.05), cut at 1: h is the smallest hot spot that is
   seen there (show: blind), h0 the one seen at a sensor; so 0 is a sensor everywhere, and 1 is that not even a hot spot as hot as the
   group's whole range would be seen. Taking the best each time reaches at least 63 % of what the best set of that number would (Nemhauser,
   Wolsey & Fisher, 1978), as far as the places that are tried go. Thread: one; it waits for workers. */
#ifndef PLACING_SENSOR_SUGGEST_H
#define PLACING_SENSOR_SUGGEST_H
#include "base/log/log.h"
#include "base/workers.h"
#include "scene/scene.h"

struct suggest_query {
    struct log *log;
    struct workers *workers;
    const struct scene *scene;
    const char *folder; /* of the prepared files */
    int group, asset;   /* asset -1: wherever the group has sensors whose place is known */
    size_t count;
};

struct suggestion {
    int asset;
    double at_m[3];                     /* plant frame, on the surface */
    double before, after;               /* the measure, over all assets asked for */
    double unseen_before, unseen_after; /* share of the area where not even a hot spot as hot as the range is seen */
};

/* Writes up to query->count suggestions to out and returns their number: fewer where nothing is left to gain. Returns 0 if no asset has
   sensors of the group whose place is known, or after a failure that was logged. */
size_t sensor_suggest(const struct suggest_query *query, struct suggestion *out);

#endif
