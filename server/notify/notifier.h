/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends alarms to users and external programs, as configured by the plant file's `notify`. Its thread wakes when an alarm
   changes, stores pending messages in notify.json in the history folder, and sends them; no other thread waits for it. Call
   from one thread only. */
#ifndef NOTIFY_NOTIFIER_H
#define NOTIFY_NOTIFIER_H
#include "alarm/alarm_service.h"

#define NOTIFIER_FILE "notify.json"

struct notifier_params {
    struct log *log;
    struct counters *counters;
    const struct plant *plant; /* plant whose plant file must have the key `notify`; plant and alarm service must outlive the notifier */
    /* alarm service whose alarms are sent to recipients */
    struct alarm_service *alarm_service;
    const char *folder;      /* existing folder in which notify.json is stored; the alarm journal creates the folder */
    void (*kept)(void *arg); /* called by the notifier's thread after the content of notify.json has changed; NULL: not wanted */
    void *kept_arg;
};

struct notifier;
/* Returns a sequence number that increases with each change of the content of notify.json. Call from any thread. */
uint64_t notifier_number(struct notifier *notifier);
/* Returns the content of notify.json (pending messages); free with mem_free(). Call from any thread. */
char *notifier_kept(struct notifier *notifier);
/* Stores the leading daemon's notify.json as this daemon's file, for the notifier that starts when this daemon becomes the
   leader. Returns 0 or -errno. */
int notifier_put_kept(const char *folder, const char *text);
/* Starts a notifier. Returns NULL if it cannot be started (logged). */
struct notifier *notifier_start(const struct notifier_params *params);
/* Aborts messages that are being sent, and waits for notify.json to be written. The aborted messages are sent after the next start. */
void notifier_halt(struct notifier *notifier);
/* Halts and frees the notifier. Accepts a pointer to NULL; sets *notifier to NULL. */
void notifier_stop(struct notifier **notifier);

#endif
