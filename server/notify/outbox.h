/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides which recipients are notified of which alarms, and when: rules, gathering, pauses, escalation, retries. Pure: time is an
   argument, UTC in microseconds. The caller passes alarms in their current states, so only an alarm that came and went between two calls
   is missed. Thread: one at a time. */
#ifndef NOTIFY_OUTBOX_H
#define NOTIFY_OUTBOX_H
#include <jansson.h>

#include "alarm/alarms.h"
#include "plant/sections/notification.h"

enum { OUTBOX_ITEMS = 5000 /* maximum number of queued alarms of all recipients together */, OUTBOX_ID_BYTES = 40 };
#define OUTBOX_REPEAT_US (600 * INT64_C(1000000)) /* minimum time between two notifications of an alarm that cleared by itself */
#define OUTBOX_KEEP_US (86400 * INT64_C(1000000)) /* age after which an undeliverable message is dropped */
#define OUTBOX_REFRESH_US (60 * INT64_C(1000000)) /* interval at which Alertmanager is sent the active alarms */
#define OUTBOX_ALERT_US (300 * INT64_C(1000000))  /* time after which Alertmanager drops an alarm that is not repeated */

struct outbox_item { /* one alarm in a message */
    char *name;      /* name of the tag or device */
    int tag;         /* index of the tag; -1: a device */
    enum alarm_kind kind;
    int priority, step; /* step: 0: first notification; 1 and up: index of the escalation step */
    enum alarm_status status;
    double value, limit;         /* NaN: none */
    int64_t raised_us, ended_us; /* UTC microseconds; ended_us: when the alarm returned to normal or was acknowledged; 0: still active */
};

struct outbox_message {
    char id[OUTBOX_ID_BYTES];        /* message id; the same for each attempt */
    const struct outbox_item *items; /* alarms, most urgent first */
    size_t count;
    int64_t left_out; /* number of further alarms that did not fit */
    int64_t made_us;
};

struct outbox;
/* Creates an outbox; `plant`, which must have a `notify`, must outlive it. Never returns NULL. */
struct outbox *outbox_create(const struct plant *plant);
void outbox_destroy(struct outbox **outbox); /* Frees the outbox. &NULL is fine; leaves NULL. */

/* Processes the current state of an alarm. restored: the state is from the journal after a restart; an alarm that needs no action is then
   not notified. */
void outbox_put(struct outbox *outbox, const struct alarm *alarm, bool restored, int64_t now_us);
/* Ends the alarms that were restored and for which outbox_put() was not called since: they returned to normal, or lost their limits, while
   the daemon was down. Call it once all alarms that are not normal have been put. */
void outbox_end_unseen(struct outbox *outbox, int64_t now_us);
/* Does what is due at that time: escalates alarms and drops old messages. */
void outbox_tick(struct outbox *outbox, int64_t now_us);

/* Returns whether a message is due for a recipient, and sets *out, which is valid until the next call for this outbox; its items are
   valid until outbox_sent(). Call outbox_sent() or outbox_failed() before calling this again. */
bool outbox_next(struct outbox *outbox, int recipient, int64_t now_us, struct outbox_message *out);
void outbox_sent(struct outbox *outbox, int recipient, int64_t now_us);
void outbox_failed(struct outbox *outbox, int recipient, int64_t now_us);

struct outbox_counts {
    int64_t waiting; /* queued alarms for one recipient */
    int64_t lost;    /* alarms lost for all recipients since the start: queue full, or dropped */
};
struct outbox_counts outbox_counts(const struct outbox *outbox, int recipient);
bool outbox_rests(const struct outbox *outbox); /* Returns whether no notification can become due until outbox_put() is called. */
bool outbox_is_changed(struct outbox *outbox);  /* Returns whether the state to be saved has changed since the last call. */

/* --- outbox_json.c: saving the state across a restart --- */
json_t *outbox_save(const struct outbox *outbox);
/* Restores a saved state by names; entries that the plant no longer has are dropped. Returns false if `saved` is not from outbox_save(). */
bool outbox_restore(struct outbox *outbox, const json_t *saved);

#endif
