/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the plant file's `notify` says: who is told of which alarms, when and how. Immutable once loaded. Thread: any. */
#ifndef PLANT_SECTIONS_NOTIFICATION_H
#define PLANT_SECTIONS_NOTIFICATION_H
#include <stddef.h>
#include <stdint.h>

enum { NOTIFY_RECIPIENTS = 32, NOTIFY_RULES = 32, NOTIFY_STEPS = 8, NOTIFY_LIST = 16 /* addresses, areas */ };

enum notify_kind { NOTIFY_EMAIL, NOTIFY_WEBHOOK, NOTIFY_ALERTMANAGER };

struct notify_list {
    char *at[NOTIFY_LIST];
    size_t count;
};

struct notify_mail { /* the server that takes e-mail */
    char *server;    /* smtps://HOST[:PORT], or smtp:// with STARTTLS; NULL: none */
    char *from;
    char *user, *password_file, *ca_file; /* NULL: none */
};

struct notify_recipient {
    char *id;
    enum notify_kind kind;
    struct notify_list addresses; /* of an e-mail */
    char *url;                    /* of a webhook; of Alertmanager, without /api/v2/alerts */
    char *token_file, *ca_file;   /* NULL: none */
    int line;
};

struct notify_shift {      /* in the plant's time zone */
    unsigned days;         /* bits, Monday is the lowest: the days on which it begins */
    int from_min, to_min;  /* of the day; equal: the whole day; to_min before from_min: it ends on the next day */
};

struct notify_step {
    double after_min; /* since the alarm; the first step has 0, later ones ascend */
    uint32_t to;      /* bits, by index in recipients */
};

struct notify_rule {
    char *id;
    int priority; /* this and more urgent ones */
    struct notify_list areas; /* patterns; none: everywhere */
    struct notify_shift shift;
    struct notify_step steps[NOTIFY_STEPS];
    size_t step_count;
    int line;
};

struct plant_notify {
    char *link; /* where the page is; NULL: not said */
    double gather_s, pause_s, timeout_s;
    struct notify_mail mail;
    struct notify_recipient *recipients;
    struct notify_rule *rules;
    size_t recipient_count, rule_count;
};

#endif
