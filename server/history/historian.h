/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records all samples of the store, on a thread of its own. It writes once a second, so a crash loses at most the last second; neither the
   store nor live pictures wait for it. What cannot be written (disk full, read-only) stays in memory up to a limit and is written later. */
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
    struct store *store; /* must outlive the historian */
    const char *folder;  /* made where it is missing */
    bool stands_by;      /* it is told of samples by another daemon (historian_mirror), and not by the store, until historian_lead() */
    bool follows;        /* it continues for one that historian_end() ended: lines go on, and no gap is recorded */
    const struct postgres_owed *owed; /* likewise, by that one; read by the call. NULL: nothing */
};

struct historian;
/* Starts recording. Returns NULL if there is no thread (logged). */
struct historian *historian_start(const struct historian_params *params);
/* Another daemon's samples come from now on. What it recorded before, and is not known here, is read from the database. */
void historian_follow(struct historian *historian);
/* Records samples that another daemon recorded, in their order. Only while it stands by. Thread: one. */
void historian_mirror(struct historian *historian, const struct sample_event *samples, size_t count);
/* Records the store's samples from now on. Of the time since the last one that was mirrored nothing is known. */
void historian_lead(struct historian *historian);
/* The one that led before may be back, and have sent the database what was left: it is read from there. */
void historian_on_standby(struct historian *historian);
/* The leader has sent the database all that it had recorded so long ago: it need not be sent from here. */
void historian_sent_elsewhere(struct historian *historian, int64_t age_ns);
/* Returns how long ago all that was recorded until then had been sent to the database; INT64_MAX: never, or there is none. */
int64_t historian_sent_age_ns(struct historian *historian);
/* Writes what is pending and ends, so that the historian of the next plant can continue. Tags that are not in it have no value from now on.
   *owed becomes what was still to be read from the database. Leaves NULL. */
void historian_end(struct historian **historian, const struct plant *next, struct postgres_owed *owed);
/* Writes what is pending and ends. &NULL is fine; leaves NULL. */
void historian_stop(struct historian **historian);

#endif
