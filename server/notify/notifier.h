/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tells people and programs outside of alarms, as the plant file's `notify` says. Its thread is woken when an
   alarm changes, keeps what is to be sent in notify.json beside the history, and delivers it; nothing else waits for it. Thread: one. */
#ifndef NOTIFY_NOTIFIER_H
#define NOTIFY_NOTIFIER_H
#include "alarm/alarm_service.h"

#define NOTIFIER_FILE "notify.json"

struct notifier_params {
    struct log *log;
    struct counters *counters;
    const struct plant *plant;      /* with a `notify` */
    struct alarm_service *alarm_service; /* plant and alarm service must outlive the notifier */
    const char *folder;             /* of the file; made by the journal */
    void (*kept)(void *arg);        /* called by its thread when what is in the file changed; NULL: nobody asks */
    void *kept_arg;
};

struct notifier;
/* Returns the number of the last change of what is kept in the file; increases. Any thread. */
uint64_t notifier_number(struct notifier *notifier);
/* Returns what is kept in the file; mem_free. Any thread. */
char *notifier_kept(struct notifier *notifier);
/* Puts what another daemon's notifier keeps into the file, for the one that starts here next. Returns 0 or -errno. */
int notifier_put_kept(const char *folder, const char *text);
/* Returns NULL if it cannot be started (logged). */
struct notifier *notifier_start(const struct notifier_params *params);
/* Cuts off what is being sent, which is sent again after the next start, and waits until the file is written. &NULL is fine; leaves
   NULL. */
void notifier_stop(struct notifier **notifier);

#endif
