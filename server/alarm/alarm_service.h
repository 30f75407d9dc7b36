/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The alarm service of a running plant. Its thread evaluates the samples of the store ten times a second, writes the journal, and sets the
   alarm of each tag in the store. No call waits for the disk but alarm_service_halt(). Thread: any. */
#ifndef ALARM_ALARM_SERVICE_H
#define ALARM_ALARM_SERVICE_H
#include "alarm/alarms.h"
#include "alarm/journal_file.h"
#include "base/log/log.h"
#include "base/metrics/counters.h"
#include "base/refusal.h"

struct alarm_service_params {
    struct log *log;
    struct counters *counters;
    const struct plant *plant;
    struct store *store;  /* plant and store must outlive the service */
    const char *folder;   /* of the journal; NULL: no journal, states are lost when the daemon ends */
    double keep_days;
    bool mirrors;         /* states come from a core (alarm_service_mirror), and not from samples: nothing is evaluated, nothing kept */
    struct alarm_service *before; /* the halted service of the plant before a reload, whose alarm states are taken over; NULL: none */
    void (*notify)(void *arg); /* called when an alarm changed, by the thread or within alarm_service_act(); may be NULL */
    void *notify_arg;
};

struct alarm_service;
/* Starts the service. Returns NULL if there is no thread (logged). */
struct alarm_service *alarm_service_start(const struct alarm_service_params *params);
/* Ends the thread and waits until it has ended and the journal is written; this call does wait for the disk. Alarms do not change any more,
   but can still be queried. Journal rows that cannot be written are lost (logged). alarm_service_stop() frees the service. */
void alarm_service_halt(struct alarm_service *service);
/* Writes what is pending to the journal, ends the thread and frees the service. &NULL is fine; leaves NULL. */
void alarm_service_stop(struct alarm_service **service);

/* Has changed(arg) called after alarms changed, by the service's thread or within alarm_service_act(), under a lock: it must only wake
   somebody. One at a time; NULL: nobody. */
void alarm_service_listen(struct alarm_service *service, void (*changed)(void *arg), void *arg);
/* Returns the number of the last change of any alarm; it increases with each change. */
uint64_t alarm_service_number(const struct alarm_service *service);
/* Calls each, under the lock, for every alarm that changed after the change `since`, newest first; since 0: for every alarm that is not
   normal. Returns alarm_service_number(). */
uint64_t alarm_service_changes(struct alarm_service *service, uint64_t since, void (*each)(void *arg, const struct alarm *alarm),
                               void *arg);
/* Does what an operator asks for: acknowledges, shelves and so on. name: of a tag, or for ALARM_LINK of a device. Returns why it
   was refused, or REFUSAL_NONE. */
enum refusal_code alarm_service_act(struct alarm_service *service, const char *name, enum alarm_kind kind, const struct alarm_act *act);
/* Tell whether changes of alarms between begin and end are in the journal on disk (base/files/settling.h). Without a journal they are. What
   is not is in force, but lost if the daemon is killed now. */
struct settling_ticket alarm_service_begin(struct alarm_service *service);
void alarm_service_end(struct alarm_service *service, struct settling_ticket *ticket);
int alarm_service_settled(struct alarm_service *service, const struct settling_ticket *ticket);
/* Takes the states of alarms as a core has them, by name and kind, in that order; whole: all others are normal. For a service that mirrors.
   Returns NULL, or why it cannot (static); then nothing changed. */
const char *alarm_service_mirror(struct alarm_service *service, const struct alarm *list, size_t count, bool whole);
/* Returns when the newest change was that the journal of a standby has; 0: it has none. Thread: that of alarm_service_mirror_row(). */
int64_t alarm_service_journal_utc_ns(const struct alarm_service *service);
/* Calls each, under the lock, for the changes of alarms after the one of that number and after a time, oldest first, as far as they are
   remembered (some thousands). Returns the number of the last one. */
uint64_t alarm_service_rows(struct alarm_service *service, uint64_t since, int64_t after_utc_ns,
                            void (*each)(void *arg, const struct journal_entry *row), void *arg);
/* Writes a change of an alarm that a core made into the journal, before alarm_service_mirror() takes the states after it. */
void alarm_service_mirror_row(struct alarm_service *service, const struct journal_entry *row);
/* A service that mirrors evaluates samples itself from now on, and goes on with the states that it was told. */
void alarm_service_lead(struct alarm_service *service);
/* Counts alarms by state. */
void alarm_service_counts(struct alarm_service *service, struct alarm_counts *out);

#endif
