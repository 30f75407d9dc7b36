/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plant file's `notify`: who is notified of which alarms, when and how. Immutable once loaded. Call from any thread. */
#ifndef PLANT_SECTIONS_NOTIFICATION_H
#define PLANT_SECTIONS_NOTIFICATION_H
#include <stddef.h>
#include <stdint.h>

enum {
    NOTIFY_RECIPIENTS = 32,
    NOTIFY_RULES = 32,
    NOTIFY_STEPS = 8,
    NOTIFY_LIST = 16 /* NOTIFY_LIST: maximum number of addresses or areas in one list */
};

enum notify_kind { NOTIFY_EMAIL, NOTIFY_WEBHOOK, NOTIFY_ALERTMANAGER };

struct notify_list {
    char *at[NOTIFY_LIST];
    size_t count;
};

struct notify_mail { /* SMTP server to which the daemon sends its e-mails */
    char *server;    /* URL of the mail server: smtps://HOST[:PORT], or smtp:// with STARTTLS; NULL: none */
    char *from;
    char *user, *password_file, *ca_file; /* NULL: none */
};

struct notify_recipient {
    char *id;
    enum notify_kind kind;
    struct notify_list addresses; /* e-mail addresses */
    char *url;                    /* URL of a webhook; for Alertmanager, its URL without /api/v2/alerts */
    char *token_file, *ca_file;   /* paths; NULL: none */
    int line;
};

struct notify_shift {     /* daily working hours of a shift, in the plant's time zone */
    unsigned days;        /* bit mask of the days on which the shift begins; the lowest bit is Monday */
    int from_min, to_min; /* minutes of the day; from_min equal to to_min: the whole day; to_min before from_min: ends on the next day */
};

struct notify_step {
    /* minutes from the alarm to this step of the notification: 0 in a rule's first step, ascending in later steps */
    double after_min;
    uint32_t to;      /* bit mask of the recipients notified in this step; bit n: recipient with index n */
};

struct notify_rule {
    char *id;
    int priority;             /* least urgent alarm priority that the rule covers */
    struct notify_list areas; /* patterns for the names of areas that the rule applies to; none: all areas */
    struct notify_shift shift;
    struct notify_step steps[NOTIFY_STEPS];
    size_t step_count;
    int line;
};

struct plant_notify {
    char *link; /* URL of this plant's page, for links in notifications; NULL: not stated */
    double gather_s, pause_s, timeout_s;
    struct notify_mail mail;
    struct notify_recipient *recipients;
    struct notify_rule *rules;
    size_t recipient_count, rule_count;
};

#endif
