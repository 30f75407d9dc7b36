/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records all samples of the store, on a thread of its own. It writes once a second, so a crash loses at most the last second; neither the
   store nor live pictures wait for it. What cannot be written (disk full, read-only) stays in memory up to a limit and is written later. */
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
    struct store *store; /* must outlive the historian */
    const char *folder;  /* made where it is missing */
    bool follows;        /* it continues for one that historian_end() ended: lines go on, and no gap is recorded */
};

struct historian;
/* Starts recording. Returns NULL if there is no thread (logged). */
struct historian *historian_start(const struct historian_params *params);
/* Writes what is pending and ends, so that the historian of the next plant can continue. Tags that are not in it have no value from now on.
   Leaves NULL. */
void historian_end(struct historian **historian, const struct plant *next);
/* Writes what is pending and ends. &NULL is fine; leaves NULL. */
void historian_stop(struct historian **historian);

#endif
