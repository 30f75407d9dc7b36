/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What alarms are called, and which limit a reading is beyond. Pure. Thread: any. */
#ifndef VALUE_ALARM_H
#define VALUE_ALARM_H
#include "plant/plant.h"
#include "value/snapshot.h"

enum alarm_kind {
    ALARM_NONE,
    ALARM_LL,
    ALARM_L,
    ALARM_H,
    ALARM_HH,   /* 1 + enum limit */
    ALARM_ON,   /* of a bit of another alarm system */
    ALARM_BAD,  /* the measurement is bad */
    ALARM_LINK, /* of a device: none of its measurements can be used */
    ALARM_KINDS
};

enum alarm_status { /* the states of ISA-18.2 and IEC 62682, and one for alarms that somebody else's system keeps */
                    ALARM_NORMAL,
                    ALARM_ACTIVE, /* whether it was acknowledged, the other system knows */
                    ALARM_UNACKNOWLEDGED,
                    ALARM_ACKNOWLEDGED,
                    ALARM_RETURNED, /* to normal, not acknowledged */
                    ALARM_LATCHED,  /* the cause is gone; stays until it is reset */
                    ALARM_SHELVED,
                    ALARM_SUPPRESSED, /* by design */
                    ALARM_OUT_OF_SERVICE,
                    ALARM_STATUSES
};

const char *alarm_kind_name(enum alarm_kind kind);          /* "HH"; NULL: none */
enum alarm_kind alarm_kind_find(const char *name);          /* ALARM_NONE: there is none of that name */
const char *alarm_status_name(enum alarm_status status);    /* "out_of_service" */
enum alarm_status alarm_status_find(const char *name);      /* ALARM_STATUSES: likewise */
bool alarm_status_is_annunciated(enum alarm_status status); /* it is to be seen: neither normal nor set aside */
bool alarm_status_is_cleared(enum alarm_status status);     /* its cause is no longer there: returned or latched */

int alarm_priority(const struct plant_tag *tag, enum alarm_kind kind); /* 1, the most urgent, to ALARM_PRIORITIES */

/* Which of a tag's alarms stands for all of them: one whose cause is there before one whose cause has gone, then the more urgent, then the
   outer limit, which holds the inner one, then one that nobody has acknowledged. */
struct alarm_grade {
    int priority;
    enum alarm_kind kind;
    enum alarm_status status;
};
bool alarm_graver(const struct alarm_grade *a, const struct alarm_grade *b);

/* The limit that a usable reading is at or beyond, the graver of two; ALARM_NONE: none. */
enum alarm_kind alarm_beyond(const struct plant_tag *tag, const struct reading *reading);
/* Where no alarms are kept: what is beyond its limit is active. */
void alarm_by_limits(const struct plant *plant, struct snapshot *snapshot);

#endif
