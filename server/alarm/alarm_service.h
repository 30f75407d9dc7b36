/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The alarms of a running plant: a thread that hears the store, ten times a second; the store is told what to show. Who is asked or
   asks never waits for the disk. Thread: any. */
#ifndef ALARM_ALARM_SERVICE_H
#define ALARM_ALARM_SERVICE_H
#include "alarm/alarms.h"
#include "base/counters.h"
#include "base/log.h"

struct alarm_service_params {
    struct log *log;
    struct counters *counters;
    const struct plant *plant;
    struct store *store; /* both outlive it */
    const char *folder;  /* of the journal; NULL: there is none, and nothing outlives the daemon */
    double keep_days;
    struct alarm_service *before; /* of the plant as it was, whose alarms are taken over: halted. NULL: none */
    void (*notify)(void *arg);    /* when something changed; on the thread, or that of alarm_service_act. NULL: nobody */
    void *notify_arg;
};

struct alarm_service;
struct alarm_service *alarm_service_start(const struct alarm_service_params *params); /* NULL: no thread; logged */
void alarm_service_halt(struct alarm_service *service);  /* hears nothing more, and changes nothing; can still be asked */
void alarm_service_stop(struct alarm_service **service); /* writes what there is; &NULL is fine; leaves NULL */

uint64_t alarm_service_number(const struct alarm_service *service); /* of the last change of any alarm */
/* Under the lock: those that changed after `since`, the newest first; since 0: all that are not normal. Returns alarm_service_number. */
uint64_t alarm_service_changes(struct alarm_service *service, uint64_t since, void (*each)(void *arg, const struct alarm *alarm),
                               void *arg);
/* name: of a tag, or for ALARM_LINK of a device. NULL: it was done; else why not (static). */
const char *alarm_service_act(struct alarm_service *service, const char *name, enum alarm_kind kind, const struct alarm_act *act);
void alarm_service_counts(struct alarm_service *service, struct alarm_counts *out);

#endif
