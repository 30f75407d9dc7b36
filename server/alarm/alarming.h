/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The alarms of a running plant: a thread that hears the store, ten times a second; the store is told what to show. Who is asked or
   asks never waits for the disk. Thread: any. */
#ifndef ALARM_ALARMING_H
#define ALARM_ALARMING_H
#include "alarm/alarms.h"
#include "base/counters.h"
#include "base/log.h"

struct alarming_params {
    struct log *log;
    struct counters *counters;
    const struct plant *plant;
    struct store *store;  /* both outlive it */
    const char *folder;   /* of the journal; NULL: there is none, and nothing outlives the daemon */
    double keep_days;
    struct alarming *before; /* of the plant as it was, whose alarms are taken over: halted. NULL: none */
    void (*notify)(void *arg); /* when something changed; on the thread, or that of alarming_act. NULL: nobody */
    void *notify_arg;
};

struct alarming;
struct alarming *alarming_start(const struct alarming_params *params); /* NULL: no thread; logged */
void alarming_halt(struct alarming *alarming); /* hears nothing more, and changes nothing; can still be asked */
void alarming_stop(struct alarming **alarming);                       /* writes what there is; &NULL is fine; leaves NULL */

uint64_t alarming_number(const struct alarming *alarming); /* of the last change of any alarm */
/* Under the lock: those that changed after `since`, the newest first; since 0: all that are not normal. Returns alarming_number. */
uint64_t alarming_changes(struct alarming *alarming, uint64_t since, void (*each)(void *arg, const struct alarm *alarm), void *arg);
/* name: of a tag, or for ALARM_LINK of a device. NULL: it was done; else why not (static). */
const char *alarming_act(struct alarming *alarming, const char *name, enum alarm_kind kind, const struct alarm_act *act);
void alarming_counts(struct alarming *alarming, struct alarm_counts *out);

#endif
