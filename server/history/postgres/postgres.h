/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends recorded history to PostgreSQL, on a thread of its own: the points in the outboxes of the months, in batches, once each. While
   the server is unreachable the points stay there, up to a limit. Neither the historian nor live pictures wait for it. */
#ifndef HISTORY_POSTGRES_POSTGRES_H
#define HISTORY_POSTGRES_POSTGRES_H
#include "base/log/log.h"
#include "base/metrics/counters.h"
#include "plant/plant.h"

enum { POSTGRES_SPANS = 16 };
/* A time when another daemon led: its points are to be read from the database, if they were sent there at at_ns (monotonic) or later. */
struct postgres_span {
    int64_t from_us, to_us, at_ns;
};
struct postgres_owed { /* spans that must still be read */
    struct postgres_span spans[POSTGRES_SPANS];
    size_t span_count;
    struct postgres_span led; /* the time before this daemon led; to_us 0: it has not become the leader */
};

struct postgres_params {
    struct log *log;
    struct counters *counters;
    const struct plant *plant; /* must outlive it */
    const char *folder;        /* folder of the months' files */
    bool stands_by; /* another daemon writes to the database, until postgres_lead(): only points left by an earlier run are sent */
    /* from postgres_stop() of the previous instance for the same folder, copied by the call; NULL: nothing */
    const struct postgres_owed *owed;
    /* Called from its thread after older points have been read into the files of a machine that lacked them. */
    void (*restored)(void *arg);
    void *arg;
};

struct postgres;
/* Starts the thread. Call it before anything is recorded in the folder. Returns NULL if the thread cannot be started (logged). */
struct postgres *postgres_start(const struct postgres_params *params);
/* Counts points that were deleted from the files before they were sent. Thread: any. */
void postgres_count_lost(struct postgres *postgres, int64_t points);
/* Makes this daemon the only writer from to_us on. from_us: time of the last sample mirrored from the former leader; 0: none, so its
   lines are ended at their last points. Its later points are read as by postgres_fill(). Any thread. */
void postgres_lead(struct postgres *postgres, int64_t from_us, int64_t to_us);
/* Reads the time before this daemon led once more, since the former leader may have sent more of it. Any thread. */
void postgres_fill_again(struct postgres *postgres);
/* For a standby: the leader has sent everything recorded until age_ns ago. Any thread. */
void postgres_sent_elsewhere(struct postgres *postgres, int64_t age_ns);
/* Returns the age in nanoseconds of the time until which all points are sent; INT64_MAX: never yet. Any thread. */
int64_t postgres_sent_age_ns(struct postgres *postgres);
/* Replaces a gap in the files by the points that another daemon recorded between two times, once that daemon has sent them. from_us 0:
   from the last point in the files. Any thread. */
void postgres_fill(struct postgres *postgres, int64_t from_us, int64_t to_us);
/* Sends pending points for at most two seconds, and ends. owed: receives the spans that must still be read; NULL: not wanted. &NULL is
   fine and leaves *owed unchanged; leaves NULL. */
void postgres_stop(struct postgres **postgres, struct postgres_owed *owed);

#endif
