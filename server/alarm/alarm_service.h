/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The alarm service of a running plant. Its thread evaluates the store's samples ten times a second, writes changes to the
   journal, and sets the alarm of each tag in the store. Only alarm_service_halt() blocks on the disk. Call from any thread. */
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
    struct store *store; /* store of the newest samples; must outlive the service, like the plant */
    const struct plant_clock *clock; /* clock of the readings */
    const char *folder;  /* folder of the journal; NULL: no journal, so alarm states are lost when the daemon ends */
    double keep_days;
    /* true: alarm states come from a core (alarm_service_mirror()), not from samples. No alarm is evaluated, and tags in the
       store get no alarms */
    bool mirrors;
    struct alarm_service *before; /* after a reload: halted service of the old plant, whose alarm states are copied; NULL: none */
    void (*notify)(void *arg);    /* called when an alarm has changed, by the service's thread or in alarm_service_act(); may be NULL */
    void *notify_arg;
};

struct alarm_service;
/* Starts the service. Returns NULL if its thread cannot start (logged). */
struct alarm_service *alarm_service_start(const struct alarm_service_params *params);
/* Ends the thread and waits until the journal is on disk. Afterwards alarms do not change but can still be queried. Journal
   rows that cannot be written are lost (logged). The caller frees the service with alarm_service_stop(). */
void alarm_service_halt(struct alarm_service *service);
/* Writes pending rows to the journal, ends the thread and frees the service. Accepts a pointer to NULL; sets *service to NULL. */
void alarm_service_stop(struct alarm_service **service);

/* Sets the only listener for changes; NULL: none. The service's thread or alarm_service_act() calls changed(arg) under a lock
   after alarms have changed, so the callback must only wake another thread. */
void alarm_service_listen(struct alarm_service *service, void (*changed)(void *arg), void *arg);
/* Returns the number of alarm changes so far. */
uint64_t alarm_service_number(const struct alarm_service *service);
/* Calls each() under the lock, newest change first, for every alarm that changed after alarm_service_number() was `since`;
   since 0: for every alarm that is not normal. Returns the current alarm_service_number(). */
uint64_t alarm_service_changes(struct alarm_service *service, uint64_t since, void (*each)(void *arg, const struct alarm *alarm),
                               void *arg);
/* Carries out an operator's action: acknowledge, shelve and so on. name: name of the tag; for a LINK alarm, name of the device.
   Returns the reason for a refusal, or REFUSAL_NONE. */
enum refusal_code alarm_service_act(struct alarm_service *service, const char *name, enum alarm_kind kind, const struct alarm_act *act);
/* This function and the next two tell whether the alarm changes made between alarm_service_begin() and alarm_service_end() are
   in the journal on disk (base/files/settling.h). Without a journal they count as on disk. Changes that are not on disk have
   taken effect, but would be lost if the daemon were killed. */
struct settling_ticket alarm_service_begin(struct alarm_service *service);
void alarm_service_end(struct alarm_service *service, struct settling_ticket *ticket);
int alarm_service_settled(struct alarm_service *service, const struct settling_ticket *ticket);
/* Returns 0 if the journal was usable at the last attempt to read or write it, or if there is none; otherwise -errno. */
int alarm_service_journal_error(struct alarm_service *service);
/* For a service that mirrors a core: sets alarms, found by name and kind, to the core's states, in the order of `list`. whole:
   all alarms that are not in `list` become normal. Returns NULL, or an error message (static text) if nothing was changed. */
const char *alarm_service_mirror(struct alarm_service *service, const struct alarm *list, size_t count, bool whole);
/* Calls each() under the lock, oldest first, for the journal rows with a row number greater than `since`. Only the newest MAX_ROWS rows
   are in memory. Returns the number of the newest row. */
uint64_t alarm_service_rows(struct alarm_service *service, uint64_t since, void (*each)(void *arg, const struct journal_entry *row),
                            void *arg);
/* On a standby: adds the journal row of an alarm change, as sent by the core, to this daemon's own journal unless the journal
   has it already. Call it before alarm_service_mirror() takes the resulting states. */
void alarm_service_mirror_row(struct alarm_service *service, const struct journal_entry *row);
/* Ends the mirroring (copying) of the core's alarm states, because this daemon becomes the leader: from now on the service
   evaluates samples, starting with the copied states. */
void alarm_service_lead(struct alarm_service *service);
/* Counts alarms by state. */
void alarm_service_counts(struct alarm_service *service, struct alarm_counts *out);

#endif
