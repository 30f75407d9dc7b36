/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What outbox.c and outbox_json.c share. Private to them. */
#ifndef NOTIFY_OUTBOX_IMPL_H
#define NOTIFY_OUTBOX_IMPL_H
#include "notify/outbox.h"

struct episode { /* an alarm from when it first needs somebody until nobody is needed any more, and some time after that */
    char *name;
    int tag;
    enum alarm_kind kind;
    int priority;
    enum alarm_status status;
    double value, limit;
    int64_t raised_us;   /* of the alarm, when it was last seen */
    int64_t began_us;
    int64_t ended_us;    /* 0: it needs somebody */
    int64_t cleared_us;  /* when it stopped being annunciated; 0: it is */
    int64_t told_us;     /* when somebody was last told of it; 0: since then somebody acknowledged it */
    uint32_t rules;      /* bits: those that applied when it began */
    uint32_t told;       /* bits: recipients */
    uint8_t steps[NOTIFY_RULES]; /* how many of each rule have been taken */
    bool aside;          /* shelved, suppressed or out of service */
    bool seen;           /* since the start: it was put, not only restored */
};

struct queued_item {
    struct outbox_item said;
    int episode;         /* its index; -1: that is gone */
};

struct queue {
    struct queued_item *at;
    size_t count, capacity;
};

struct recipient_box { /* messages that wait for a recipient */
    struct queue waiting;
    struct outbox_item *batch; /* of the message that is being sent, or sent again */
    size_t batch_count;
    char id[OUTBOX_ID_BYTES];
    int64_t batch_us;
    int64_t since_us;    /* when the first that waits came */
    int64_t sent_us;     /* when a message was last delivered; 0: never */
    int64_t retry_us;
    int last_priority;   /* the most urgent of the last message */
    int attempts;
    int64_t left_out;    /* since the last message */
    bool changed;        /* of Alertmanager: not all of it has been told */
};

struct outbox {
    const struct plant *plant;
    struct episode *episodes;
    size_t count, capacity;
    int *by_alarm;       /* 1 + index of the episode, by tag and kind; 0: none */
    struct recipient_box *boxes; /* by recipient */
    size_t items;        /* that wait, of all */
    int64_t lost, made;
    bool dirty;
};

int outbox_find(const struct outbox *outbox, const char *name, int tag, enum alarm_kind kind); /* returns an index, or -1 */
struct episode *outbox_add_episode(struct outbox *outbox, const char *name, int tag, enum alarm_kind kind);

#endif
