/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records what the store is told, each second: the last second is all that a crash can take. A thread of its own; the store and the
   live picture never wait for it. What cannot be written (disk full, read-only) is kept in memory up to a bound and written later. */
#ifndef HISTORY_HISTORIAN_H
#define HISTORY_HISTORIAN_H
#include "base/counters.h"
#include "base/log.h"
#include "plant/plant.h"
#include "value/store.h"

struct historian_params {
    struct log *log;
    struct counters *counters;
    const struct plant *plant;
    struct store *store; /* outlives it */
    const char *folder;  /* made where it is missing */
    bool follows;        /* upon one that was ended: lines go on, and no gap is noted */
};

struct historian;
struct historian *historian_start(const struct historian_params *params); /* NULL: no thread; logged */
/* Writes what there is and ends, for one of another plant to follow: tags that are not in it have no value from now on. Leaves NULL. */
void historian_end(struct historian **historian, const struct plant *next);
/* Writes what there is and ends. &NULL is fine; leaves NULL. */
void historian_stop(struct historian **historian);

#endif
