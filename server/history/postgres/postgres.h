/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends recorded history to PostgreSQL, on a thread of its own. It sends the points in the outboxes of the monthly history
   files in batches, each point once. While the server is unreachable, points stay in the outboxes, up to a limit. Neither the
   historian nor live pictures wait for it. */
#ifndef HISTORY_POSTGRES_POSTGRES_H
#define HISTORY_POSTGRES_POSTGRES_H
#include "base/log/log.h"
#include "base/metrics/counters.h"
#include "plant/plant.h"

enum { POSTGRES_SPANS = 16 };
/* A time span in which another daemon was the leader and this machine recorded nothing. Its points must be read from the
   database once the other daemon has sent them: at the monotonic time at_ns or later. */
struct postgres_span {
    int64_t from_us, to_us, at_ns;
};
struct postgres_owed { /* the time spans whose points must still be read from the database */
    struct postgres_span spans[POSTGRES_SPANS];
    size_t span_count;
    /* The span from the end of the former leader's recording to the start of this leader's. It is kept so that it can be read
       again (postgres_fill_again()). to_us 0: this daemon is not the leader. */
    struct postgres_span led;
};

struct postgres_params {
    struct log *log;
    struct counters *counters;
    const struct plant *plant; /* must outlive the struct postgres */
    const char *folder;        /* folder of the monthly history files */
    /* true: until postgres_lead() is called, another daemon writes to the database, and this one only sends points left by an
       earlier run */
    bool stands_by;
    /* time spans whose points must still be read from the database, as returned by postgres_stop() of the previous instance for
       this folder; copied; NULL: none */
    const struct postgres_owed *owed;
};

struct postgres;
/* Starts the sending thread. Call it before anything is recorded in the folder. Returns NULL if the thread cannot be started (logged). */
struct postgres *postgres_start(const struct postgres_params *params);
/* Adds to the metric that counts points deleted by retention before they were sent. Call from any thread. */
void postgres_count_lost(struct postgres *postgres, int64_t points);
/* Makes this daemon the only writer to the database, for points from to_us on. from_us: time of the last sample that this
   daemon received from the former leader. Points that the former leader sent to the database after from_us are read from there
   as in postgres_fill(). from_us 0: no sample was received; each tag's recording by the former leader then ends at its last
   point in the database. Call from any thread. */
void postgres_lead(struct postgres *postgres, int64_t from_us, int64_t to_us);
/* Once more reads the span just before this daemon became the leader from the database, because the former leader may have sent
   more points for that time. Call from any thread. */
void postgres_fill_again(struct postgres *postgres);
/* For a standby: tells it that the leader has sent the database all points recorded until age_ns ago. Call from any thread. */
void postgres_sent_elsewhere(struct postgres *postgres, int64_t age_ns);
/* Returns the age in nanoseconds of the newest time T such that all points recorded before T are in the database; INT64_MAX: T
   is unknown. Call from any thread. */
int64_t postgres_sent_age_ns(struct postgres *postgres);
/* Replaces a gap in the files with the points that another daemon recorded between two times, once that daemon has sent them to
   the database. from_us 0: from the last point in the files. Call from any thread. */
void postgres_fill(struct postgres *postgres, int64_t from_us, int64_t to_us);
/* Sends the points that still wait for the database, for at most two seconds, then ends the PostgreSQL thread. *owed receives
   the time spans whose points must still be read from the database; owed may be NULL. Sets *postgres to NULL. If *postgres is
   NULL already, does nothing and leaves *owed unchanged. */
void postgres_stop(struct postgres **postgres, struct postgres_owed *owed);

#endif
