/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides which recipients are notified of which alarms, and when: rules, several alarms in one message, pauses, escalation,
   retries. No input or output: time is an argument, UTC in microseconds. The caller passes alarms in their present states, so
   an alarm that came and went between two calls is missed. Call from one thread at a time. */
#ifndef NOTIFY_OUTBOX_H
#define NOTIFY_OUTBOX_H
#include <jansson.h>

#include "alarm/alarms.h"
#include "plant/sections/notification.h"

enum { OUTBOX_ITEMS = 5000 /* maximum number of queued alarms, of all recipients together */, OUTBOX_ID_BYTES = 40 };
enum { OUTBOX_SHORT = 50 }; /* number of alarms that stay in a message that was refused, see outbox_failed() */
/* minimum time in microseconds between two notifications of an alarm that is raised repeatedly without being acknowledged */
#define OUTBOX_REPEAT_US (600 * INT64_C(1000000))
#define OUTBOX_KEEP_US (86400 * INT64_C(1000000)) /* age at which a message that could not be delivered is dropped, in microseconds */
/* interval in microseconds after which all active alarms are sent to Alertmanager again */
#define OUTBOX_REFRESH_US (60 * INT64_C(1000000))
/* time in microseconds after which Alertmanager drops an alarm, unless the alarm is sent again before (each message says so) */
#define OUTBOX_ALERT_US (300 * INT64_C(1000000))

struct outbox_item { /* one alarm in a message */
    char *name;      /* name of the tag or device that has the alarm */
    int tag;         /* index of the tag; -1: the alarm is that of a device */
    enum alarm_kind kind;
    int priority, step; /* step: index of the rule's escalation step that sends the alarm; 0: the first notification */
    enum alarm_status status;
    double value, limit; /* value for which the alarm was raised, and the limit that it violated; NaN: none */
    /* UTC microseconds. ended_us: when the alarm returned to normal or was acknowledged; 0: the alarm still needs attention */
    int64_t raised_us, ended_us;
};

struct outbox_message {
    char id[OUTBOX_ID_BYTES];        /* id of the message; stays the same when sending is repeated */
    const struct outbox_item *items; /* alarms, most urgent first */
    size_t count;
    int64_t left_out; /* number of further alarms that did not fit into the message */
    int64_t made_us;
    bool is_test; /* true: the message only tests the way to the recipient, see test_messages.h */
};

struct outbox;
/* Creates an outbox for the recipients of `plant`, which must have a `notify`. The plant must outlive the outbox. Never returns NULL. */
struct outbox *outbox_create(const struct plant *plant);
void outbox_destroy(struct outbox **outbox); /* Frees the outbox and sets *outbox to NULL; accepts a pointer to NULL. */

/* Processes the present state of an alarm. restored: true: the state was read from the journal after a restart; the alarm is
   then sent only if it needs attention. */
void outbox_put(struct outbox *outbox, const struct alarm *alarm, bool restored, int64_t now_us);
/* Call it after a restart, once outbox_put() was called for every alarm that is not normal. Ends all other alarms of the saved
   state: while the daemon did not run, they returned to normal or their limits were removed. */
void outbox_end_unseen(struct outbox *outbox, int64_t now_us);
/* Does what is due at now_us: escalates alarms and drops old messages. */
void outbox_tick(struct outbox *outbox, int64_t now_us);

/* If a message is due for a recipient, writes it to *out and returns true. *out is valid until the next call for this outbox,
   its items until outbox_sent(). Call outbox_sent() or outbox_failed() with the result before the next call. */
bool outbox_next(struct outbox *outbox, int recipient, int64_t now_us, struct outbox_message *out);
void outbox_sent(struct outbox *outbox, int recipient, int64_t now_us);

enum outbox_failure {
    OUTBOX_RETRIED,   /* the alarms are sent again after a pause */
    OUTBOX_SHORTENED, /* the OUTBOX_SHORT most urgent alarms are due again at once with a new id; the others are dropped */
    OUTBOX_DROPPED    /* all alarms of the message are dropped */
};
/* is_refused: the recipient's server refuses the message in this form, so that sending it again is useless. Such a message is
   shortened, or dropped if it has no more than OUTBOX_SHORT alarms; dropped alarms count as lost. A message to Alertmanager is always
   retried, because it must contain all active alarms. */
enum outbox_failure outbox_failed(struct outbox *outbox, int recipient, bool is_refused, int64_t now_us);

struct outbox_counts {
    int64_t waiting; /* number of alarms that wait to be sent to this recipient */
    /* number of notifications lost since the start, of all recipients: the queue was full, or the message was too old or refused */
    int64_t lost;
};
struct outbox_counts outbox_counts(const struct outbox *outbox, int recipient);
bool outbox_rests(const struct outbox *outbox); /* Returns true if no message can become due before outbox_put() is called. */
bool outbox_is_changed(struct outbox *outbox);  /* Returns true if the state has changed since the last call and must be saved. */

/* --- outbox_json.c: saving the state across a restart --- */
json_t *outbox_save(const struct outbox *outbox);
/* Restores a state that outbox_save() returned, in which names identify alarms, rules and recipients. Drops entries that the
   plant no longer has. Returns false if `saved` has the wrong format. */
bool outbox_restore(struct outbox *outbox, const json_t *saved);

#endif
