/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides who is told of which alarms, and when: rules, gathering, pauses, escalation, retries. Pure: time is an argument, UTC in
   microseconds. Alarms are as the alarm service shows them now, so nothing is lost between two looks but an alarm that came and went.
   Thread: one at a time. */
#ifndef NOTIFY_OUTBOX_H
#define NOTIFY_OUTBOX_H
#include <jansson.h>

#include "alarm/alarms.h"
#include "plant/sections/notification.h"

enum { OUTBOX_ITEMS = 5000 /* that wait, of all recipients together */, OUTBOX_ID_BYTES = 40 };
#define OUTBOX_REPEAT_US (600 * INT64_C(1000000))   /* an alarm that cleared by itself is not told again sooner */
#define OUTBOX_KEEP_US (86400 * INT64_C(1000000))   /* a message that cannot be delivered for this long is given up */
#define OUTBOX_REFRESH_US (60 * INT64_C(1000000))   /* Alertmanager hears of standing alarms this often */
#define OUTBOX_ALERT_US (300 * INT64_C(1000000))    /* and forgets them after this long */

struct outbox_item { /* one alarm in a message */
    char *name;      /* of the tag or device */
    int tag;         /* -1: of a device */
    enum alarm_kind kind;
    int priority, step; /* step: 0, or which escalation */
    enum alarm_status status;
    double value, limit; /* NaN: none */
    int64_t raised_us, ended_us; /* ended: cause gone or acknowledged; 0: it stands */
};

struct outbox_message {
    char id[OUTBOX_ID_BYTES]; /* the same each time it is tried */
    const struct outbox_item *items; /* the most urgent first */
    size_t count;
    int64_t left_out;         /* more that there was no room for */
    int64_t made_us;
};

struct outbox;
/* plant, with its `notify`, must outlive it. Never returns NULL. */
struct outbox *outbox_create(const struct plant *plant);
void outbox_destroy(struct outbox **outbox); /* &NULL is fine; leaves NULL */

/* Takes an alarm as it is now. restored: it is as the journal had it, so that one that nobody needs to act on is not told. */
void outbox_put(struct outbox *outbox, const struct alarm *alarm, bool restored, int64_t now_us);
/* Ends the alarms that were restored and not put since: they returned to normal, or their limits went, while nobody looked. To be called
   once all that are not normal have been put. */
void outbox_end_unseen(struct outbox *outbox, int64_t now_us);
/* Lets time pass: escalation, and what is given up. */
void outbox_tick(struct outbox *outbox, int64_t now_us);

/* Returns whether there is something to send to a recipient now, and sets *out; it is valid until the next call for this outbox, the items
   until outbox_sent(). Not to be called again before outbox_sent() or outbox_failed(). */
bool outbox_next(struct outbox *outbox, int recipient, int64_t now_us, struct outbox_message *out);
void outbox_sent(struct outbox *outbox, int recipient, int64_t now_us);
void outbox_failed(struct outbox *outbox, int recipient, int64_t now_us);

struct outbox_counts {
    int64_t waiting; /* alarms to be sent to a recipient */
    int64_t lost;    /* of all recipients together, since the start: no room, or given up */
};
struct outbox_counts outbox_counts(const struct outbox *outbox, int recipient);
bool outbox_rests(const struct outbox *outbox);  /* returns whether nothing happens by itself until an alarm is put */
bool outbox_is_changed(struct outbox *outbox); /* returns whether there is something to save since the last call */

/* --- outbox_json.c: over a restart --- */
json_t *outbox_save(const struct outbox *outbox);
/* Takes over what was saved, by names: what is no longer in the plant is dropped. Returns false if the text is none of outbox_save(). */
bool outbox_restore(struct outbox *outbox, const json_t *saved);

#endif
