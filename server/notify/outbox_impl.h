/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by outbox.c and outbox_json.c. Private to them. */
#ifndef NOTIFY_OUTBOX_IMPL_H
#define NOTIFY_OUTBOX_IMPL_H
#include "notify/outbox.h"

struct episode { /* episode of one alarm: begins when the alarm needs attention; removed some time after it no longer does */
    char *name;
    int tag;
    enum alarm_kind kind;
    int priority;
    enum alarm_status status;
    double value, limit;
    int64_t raised_us; /* start of the alarm, as of the last call of outbox_put() */
    int64_t began_us;
    int64_t ended_us;            /* UTC microseconds; 0: the alarm still needs attention */
    int64_t cleared_us;          /* when the alarm stopped being annunciated; 0: still annunciated */
    int64_t told_us;             /* time of the last notification; 0: none, or the alarm was acknowledged since */
    uint32_t rules;              /* bit mask of the rules that applied when the episode began */
    uint32_t told;               /* bit mask of the recipients notified */
    uint8_t steps[NOTIFY_RULES]; /* by rule: number of escalation steps taken */
    bool aside;                  /* the alarm is shelved, suppressed or out of service, so it is not notified */
    bool seen;                   /* outbox_put() was called for the alarm since the daemon started; false: it was only restored */
};

struct queued_item {
    struct outbox_item said;
    int episode; /* index of the episode; -1: the episode was removed */
};

struct queue {
    struct queued_item *at;
    size_t count, capacity;
};

struct recipient_box { /* messages queued for one recipient */
    struct queue waiting;
    struct outbox_item *batch; /* alarms of the message being sent or retried */
    size_t batch_count;
    char id[OUTBOX_ID_BYTES];
    int64_t batch_us;
    int64_t since_us; /* arrival time of the oldest queued alarm */
    int64_t sent_us;  /* time of the last delivery; 0: never */
    int64_t retry_us;
    int last_priority; /* highest priority in the last message */
    int attempts;
    int64_t left_out; /* number of alarms left out since the last message, because there were too many */
    bool changed;     /* for Alertmanager: some changes of alarms have not been sent yet */
};

struct outbox {
    const struct plant *plant;
    struct episode *episodes;
    size_t count, capacity;
    int *by_alarm;               /* 1 + index of the episode, by tag and alarm kind; 0: none */
    struct recipient_box *boxes; /* by index of the recipient */
    size_t items;                /* queued alarms of all recipients */
    int64_t lost, made;
    bool dirty;
};

/* Returns the index of an alarm's episode, or -1. */
int outbox_find(const struct outbox *outbox, const char *name, int tag, enum alarm_kind kind);
struct episode *outbox_add_episode(struct outbox *outbox, const char *name, int tag, enum alarm_kind kind);

#endif
