/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of an outbox, shared by outbox.c and outbox_json.c. Private to them. */
#ifndef NOTIFY_OUTBOX_IMPL_H
#define NOTIFY_OUTBOX_IMPL_H
#include "notify/outbox.h"

struct episode { /* an episode: the time during which an alarm needs attention; removed some time after it has ended */
    char *name;
    int tag;
    enum alarm_kind kind;
    int priority;
    enum alarm_status status;
    double value, limit;
    int64_t raised_us; /* UTC microseconds at which the alarm was raised, as of the last call of outbox_put() */
    int64_t began_us;
    int64_t ended_us;            /* UTC microseconds at which the alarm no longer needed attention; 0: it still needs attention */
    int64_t cleared_us;          /* UTC microseconds at which operators stopped seeing the alarm as active; 0: they still do */
    int64_t told_us;             /* UTC microseconds of the newest notification; 0: no notification since the alarm was last acknowledged */
    uint32_t rules;              /* bit mask of the notification rules that applied to the alarm when the episode began */
    uint32_t told;               /* bit mask of the recipients that were notified of the alarm */
    uint8_t steps[NOTIFY_RULES]; /* by notification rule: number of escalation steps carried out for this alarm */
    bool aside;                  /* true: the alarm is shelved, suppressed or out of service, so nobody is notified */
    /* true: outbox_put() was called for the alarm since the daemon started; false: the episode is known only from the saved state */
    bool seen;
};

struct queued_item {
    struct outbox_item said;
    int episode; /* index of the alarm's episode (time during which the alarm needs attention); -1: the episode was removed */
};

struct queue {
    struct queued_item *at;
    size_t count, capacity;
};

struct recipient_box { /* messages of alarms to one recipient, and the alarms queued for its next message */
    struct queue waiting;
    struct outbox_item *batch; /* alarms of the message that is being sent to the recipient, or is sent again after a failure */
    size_t batch_count;
    char id[OUTBOX_ID_BYTES];
    int64_t batch_us;
    int64_t since_us; /* UTC microseconds at which the oldest queued alarm was queued */
    int64_t sent_us;  /* UTC microseconds of the last successful delivery; 0: never */
    int64_t retry_us;
    int last_priority; /* most urgent alarm priority in the last message to the recipient */
    int attempts;
    int64_t left_out; /* number of alarms since the last message that were not queued, because the queue was full */
    bool changed;     /* only if the recipient is Alertmanager: true: alarms have changed since the last message */
};

struct outbox {
    const struct plant *plant;
    struct episode *episodes;
    size_t count, capacity;
    /* by tag and alarm kind: 1 + index in `episodes` of the alarm's episode (time during which the alarm needs attention); 0:
       the alarm has none */
    int *by_alarm;
    struct recipient_box *boxes; /* by recipient: its queue */
    size_t items;                /* number of queued alarms of all recipients */
    int64_t lost, made;
    bool dirty;
};

/* Returns the index in outbox->episodes of an alarm's episode (time during which the alarm needs attention), or -1. */
int outbox_find(const struct outbox *outbox, const char *name, int tag, enum alarm_kind kind);
struct episode *outbox_add_episode(struct outbox *outbox, const char *name, int tag, enum alarm_kind kind);

#endif
