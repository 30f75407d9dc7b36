/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records all samples of the store in the history files, on a thread of its own. It writes once a second, so that a crash loses
   at most the last second. Neither the store nor live pictures wait for it. Rows that cannot be written (disk full or
   read-only) are kept in memory up to a limit and written later. */
#ifndef HISTORY_HISTORIAN_H
#define HISTORY_HISTORIAN_H
#include "base/log/log.h"
#include "base/metrics/counters.h"
#include "history/postgres/postgres.h"
#include "plant/plant.h"
#include "value/store.h"

struct historian_params {
    struct log *log;
    struct counters *counters;
    const struct plant *plant;
    struct store *store; /* store whose samples are recorded; must outlive the historian */
    const char *folder;  /* folder of the history files; created if it is missing */
    /* true: until historian_lead() is called, samples come from the leading daemon (historian_mirror()) instead of the store */
    bool stands_by;
    /* true: this historian continues the recording of one that ended with historian_end(), so no gap between the two is
       recorded */
    bool follows;
    /* time spans whose points must still be read from PostgreSQL, as returned by historian_end(); copied; NULL: none */
    const struct postgres_owed *owed;
    size_t max_waiting; /* maximum number of rows kept in memory while the disk cannot be written; 0: the default, 4 million */
};

struct historian;
/* Starts recording. Returns NULL if the thread cannot be started (logged). */
struct historian *historian_start(const struct historian_params *params);
/* Call this on a standby once it has connected to the leading daemon. Points that the leader recorded earlier and that this
   machine lacks are then read from PostgreSQL. */
void historian_follow(struct historian *historian);
/* Records samples that the leading daemon has recorded, in its order. Call it only while this daemon is a standby. Call from one
   thread only. */
void historian_mirror(struct historian *historian, const struct sample_event *samples, size_t count);
/* Ends the recording of the leading daemon's samples (mirroring), because this daemon becomes the leader: from now on it
   records the samples of its own store. Values between the last sample of the former leader and now are recorded as unknown. */
void historian_lead(struct historian *historian);
/* Call this on the leader when a standby connects. The standby may be the former leader, and may have sent its remaining points
   to PostgreSQL in the meantime; these points are then read from there. */
void historian_on_standby(struct historian *historian);
/* For a standby: tells it that the leader has sent PostgreSQL all points recorded until age_ns ago. The standby then deletes
   these points from its own outbox instead of sending them. */
void historian_sent_elsewhere(struct historian *historian, int64_t age_ns);
/* Returns the age in nanoseconds of the newest time T such that all points recorded before T are in PostgreSQL; INT64_MAX: unknown, or
   no database is configured. */
int64_t historian_sent_age_ns(struct historian *historian);
/* Returns why readings cannot be recorded at the moment, as -errno (base/files/database.h); 0: they are recorded. Call from any thread. */
int historian_error(struct historian *historian);
/* On a reload of the plant: writes pending points and ends the historian, so that the reloaded plant's historian (`next`: that
   plant) can continue. Tags that `next` lacks have no value from now on. *owed receives the time spans whose points must still
   be read from PostgreSQL. Sets *historian to NULL. */
void historian_end(struct historian **historian, const struct plant *next, struct postgres_owed *owed);
/* Writes pending points and ends the historian. Accepts a pointer to NULL; sets *historian to NULL. */
void historian_stop(struct historian **historian);

#endif
