/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends recorded history to PostgreSQL, on a thread of its own: what the outboxes of the months have, in batches, once. While the server is
   away the points stay there, up to a limit. Neither the historian nor live pictures wait for it. */
#ifndef HISTORY_POSTGRES_POSTGRES_H
#define HISTORY_POSTGRES_POSTGRES_H
#include "base/log/log.h"
#include "base/metrics/counters.h"
#include "plant/plant.h"

enum { POSTGRES_SPANS = 16 };
/* When another daemon led: what it recorded is to be read, if it was sent at at_ns (monotonic) or later. */
struct postgres_span {
    int64_t from_us, to_us, at_ns;
};
struct postgres_owed { /* what is still to be read */
    struct postgres_span spans[POSTGRES_SPANS];
    size_t span_count;
    struct postgres_span led; /* the time before this daemon led; to_us 0: it did not begin to */
};

struct postgres_params {
    struct log *log;
    struct counters *counters;
    const struct plant *plant; /* outlives it */
    const char *folder;        /* of the months */
    bool stands_by;            /* another daemon writes there, until postgres_lead(): only what is left of an earlier run is sent */
    const struct postgres_owed *owed; /* by the one before, of the same folder; read by the call. NULL: nothing */
    /* Called from its thread when points of the past have been put into the files (of a machine that had none). */
    void (*restored)(void *arg);
    void *arg;
};

struct postgres;
/* Starts before anything is recorded in the folder. Returns NULL if there is no thread (logged). */
struct postgres *postgres_start(const struct postgres_params *params);
/* Counts points that were deleted from the files before they were sent. Thread: any. */
void postgres_count_lost(struct postgres *postgres, int64_t points);
/* This daemon writes there from to_us on. What led before was followed until from_us, 0: it was not, so that its lines end where it ended.
   What it recorded later is filled in, as below. Any thread. */
void postgres_lead(struct postgres *postgres, int64_t from_us, int64_t to_us);
/* Likewise once more: there may be more of it now. Any thread. */
void postgres_fill_again(struct postgres *postgres);
/* While it stands by: the other has sent all that was recorded so long ago. Any thread. */
void postgres_sent_elsewhere(struct postgres *postgres, int64_t age_ns);
/* Returns how long ago all that had been recorded was sent; INT64_MAX: never yet. Any thread. */
int64_t postgres_sent_age_ns(struct postgres *postgres);
/* Has the points between two times, that another daemon recorded, put into the files in place of the gap that is there: once that one has
   sent them. from_us 0: since the last point in the files. Any thread. */
void postgres_fill(struct postgres *postgres, int64_t from_us, int64_t to_us);
/* Sends what is pending, for two seconds at most, and ends. owed: becomes what was still to be read; NULL: nobody wants it. &NULL is fine,
   and leaves *owed; leaves NULL. */
void postgres_stop(struct postgres **postgres, struct postgres_owed *owed);

#endif
