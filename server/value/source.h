/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where values come from: one thread per source, which writes to the store and to nothing else. */
#ifndef VALUE_SOURCE_H
#define VALUE_SOURCE_H
#include "base/counters.h"
#include "base/log.h"
#include "plant/plant.h"
#include "value/store.h"

struct source;

struct source_impl { /* one line in the table of source.c for each kind */
    const char *kind;
    struct source *(*start)(struct log *log, const struct plant *plant, int source, struct store *store, struct counters *counters);
    void (*stop)(struct source *source); /* ends the thread and frees */
};

struct source {
    const struct source_impl *impl;
};

/* NULL: logged (unknown kind, no thread). A device that does not answer is not a failure: it is tried for ever. */
struct source *source_start(struct log *log, const struct plant *plant, int source, struct store *store, struct counters *counters);
void source_stop(struct source **source); /* &NULL is fine; leaves NULL; returns within 2 s */

#endif
