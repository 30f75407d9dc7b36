/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends recorded history to PostgreSQL, on a thread of its own: what the outboxes of the months have, in batches, once. While the server is
   away the points stay there, up to a limit. Neither the historian nor live pictures wait for it. */
#ifndef HISTORY_POSTGRES_POSTGRES_H
#define HISTORY_POSTGRES_POSTGRES_H
#include "base/counters.h"
#include "base/log.h"
#include "plant/plant.h"

struct postgres_params {
    struct log *log;
    struct counters *counters;
    const struct plant *plant; /* outlives it */
    const char *folder;        /* of the months */
    /* Called from its thread when points of the past have been put into the files (of a machine that had none). */
    void (*restored)(void *arg);
    void *arg;
};

struct postgres;
/* Starts before anything is recorded in the folder. Returns NULL if there is no thread (logged). */
struct postgres *postgres_start(const struct postgres_params *params);
/* Counts points that were deleted from the files before they were sent. Thread: any. */
void postgres_count_lost(struct postgres *postgres, int64_t points);
/* Sends what is pending, for two seconds at most, and ends. &NULL is fine; leaves NULL. */
void postgres_stop(struct postgres **postgres);

#endif
